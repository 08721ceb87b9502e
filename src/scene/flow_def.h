/* Definitions of sources and sinks of particles. */
#ifndef GN_SCENE_FLOW_DEF_H
#define GN_SCENE_FLOW_DEF_H

#include "scene/place.h"
#include "scene/size_def.h"
#include "scene/values.h"

/* A region of space: exactly one of rectangle, disc, polygon (2D), box, cylinder (3D). */
typedef struct gn_flow_region {
    bool has_rectangle, has_disc, has_box, has_cylinder;
    double size[3];   /* m, of a rectangle (two) and a box */
    double diameter;  /* m, of a disc and a cylinder */
    double height;    /* m, of a cylinder */
    double origin[3]; /* m, as of the shapes of a specimen; 0 with a polygon */
    size_t corner_count;
    double *corners; /* polygon corners, [corner_count][2], m */
} gn_flow_region;

/* A source creates particles at a rate, the first at `start`. */
typedef struct gn_source_def {
    char name[GN_NAME_SIZE], material[GN_NAME_SIZE];
    gn_flow_region region;  /* region of the particles' centres */
    double rate, mass_rate; /* 1/s, kg/s; one of the two is 0 */
    double start, end;      /* s; end 0: none */
    int64_t total;          /* 0: no limit */
    double mean_radius;     /* m, by number */
    gn_pack_sizes sizes;    /* without GN_SIZES_FITTED */
    double size_ratio;      /* largest over smallest */
    double size_variation;  /* normal: standard deviation over the mean; -1: automatic */
    size_t sieve_count;
    double *sieve;      /* [sieve_count][2]: size over the largest, share of the mass that passes */
    double velocity[3]; /* m/s */
    double random_velocity; /* m/s, added components uniform in +- this */
    gn_scene_place where;
} gn_source_def;

/* A sink takes particles that are wholly inside a region or wholly beyond a plane. */
typedef struct gn_sink_def {
    char name[GN_NAME_SIZE];
    bool has_plane;
    double point[3], normal[3]; /* m; outward, a unit vector once read */
    gn_flow_region region;
    bool remove; /* false: particles stay; centres that cross the plane are counted, returning ones
                    subtracted */
    gn_scene_place where;
} gn_sink_def;

#endif
