/* Names of the parts of a world, for prototypes: a header that passes a part on includes this, and
 * not the part's own header. */
#ifndef GN_FRAME_PARTS_H
#define GN_FRAME_PARTS_H

typedef struct gn_step_context gn_step_context;   /* frame/frame.h */
typedef struct gn_ledger gn_ledger;               /* frame/ledger.h */
typedef struct gn_dem gn_dem;                     /* particles/particles.h */
typedef struct gn_joint_faces gn_joint_faces;     /* particles/joint_faces.h */
typedef struct gn_boundary gn_boundary;           /* boundary/boundary.h */
typedef struct gn_solids gn_solids;               /* solids/solids.h */
typedef struct gn_membrane gn_membrane;           /* membrane/membrane.h */
typedef struct gn_zones gn_zones;                 /* zones/zone_state.h */
typedef struct gn_most_loaded gn_most_loaded;     /* zones/zone_state.h */
typedef struct gn_conversions gn_conversions;     /* conversion/records.h */
typedef struct gn_periodic_box gn_periodic_box;   /* frame/periodic_box.h */
typedef struct gn_gauge gn_gauge;                 /* laboratory/strain_gauge.h */
typedef struct gn_approach gn_approach;           /* laboratory/ends.h */
typedef struct gn_cutting gn_cutting;             /* laboratory/cutting.h */
typedef struct gn_bar_section gn_bar_section;     /* laboratory/laboratory.h */
typedef struct gn_features gn_features;           /* world/features.h */
typedef struct gn_stages gn_stages;               /* world/world.h */
typedef struct gn_ending gn_ending;               /* frame/frame.h */
typedef struct gn_surface gn_surface;             /* boundary/surface.h */
typedef struct gn_element_model gn_element_model; /* solids/solids.h */
typedef struct gn_world gn_world;                 /* world/world.h */

#endif
