/* Cutting tools that are shapes of rigid bodies. */
#ifndef GN_SCENE_TOOL_DEF_H
#define GN_SCENE_TOOL_DEF_H

typedef enum gn_tool_kind {
    GN_TOOL_NONE,
    GN_TOOL_DISC_CUTTER, /* ring of constant cross section with its axis along y */
    GN_TOOL_CHISEL,      /* cuts towards x; width along y (in 2D 1 m), rock below */
    GN_TOOL_WEDGE,       /* symmetric, with its edge along y; rock below */
    GN_TOOL_PICK         /* cone with its axis along z; rock below */
} gn_tool_kind;

/* The sizes of a tool of any kind; a kind uses some of them. Lengths in m, angles in rad. */
typedef struct gn_tool_def {
    double diameter;        /* disc cutter: diameter of the tip; pick: diameter of the body */
    double bore;            /* disc cutter: inner diameter; 0: half of the outer one */
    double tip_width;       /* disc cutter: distance between the two edges of the tip */
    double tip_radius;      /* radius to which the edges of the tip are rounded; 0: sharp */
    double bevel_angle;     /* disc cutter: angle between the two faces of the tip; pi: flat */
    double flank_angle;     /* disc cutter: angle between the flanks and the plane of the ring */
    double facet;           /* size of facets at the tip; 0: automatic */
    double rake, clearance; /* chisel */
    double width;           /* chisel and wedge, along y */
    double height;          /* chisel, wedge, pick */
    double length;          /* chisel: length of its lower face along x */
    double angle;           /* wedge and pick: angle between both faces */
} gn_tool_def;

#endif
