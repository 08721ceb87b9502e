/* The quantities that the history records: one table from which the columns and rows of the
 * history, the final values of bodies and motions in results.h5 and docs/quantities.md are made. A
 * quantity has a name, a unit, a text, a shape, the instant at which it is read, a condition, and
 * the function that reads it. */
#ifndef GN_RUN_QUANTITIES_H
#define GN_RUN_QUANTITIES_H

#include "frame/parts.h"
#include "world/world.h"

/* In 2D a vector has two components, a rotation one (z), a tensor three. */
typedef enum gn_shape { GN_SCALAR, GN_VECTOR, GN_TURN, GN_TENSOR } gn_shape;

/* A row belongs to the instant at which a step starts: positions are read before the step, forces
 * and energies after it. */
typedef enum gn_instant { GN_BEFORE_STEP, GN_AFTER_STEP } gn_instant;

/* A quantity is recorded if both functions return true. */
typedef struct gn_condition {
    const char *text;                                   /* %s: the kinds of tests */
    bool (*holds)(const gn_world *world, size_t owner); /* NULL: always */
    bool (*of_kind)(const gn_test_descriptor *kind);    /* NULL: any kind, or no test */
} gn_condition;

typedef struct gn_quantity {
    const char *name, *unit, *text;
    gn_shape shape;
    gn_instant instant;
    const gn_condition *when;
    /* Reads one number, three, or nine (row by row; the recorded tensor is symmetric). */
    void (*read)(const gn_world *world, size_t owner, double *value);
    bool (*absent)(const gn_world *world); /* the quantity has no value at present; NULL: never */
} gn_quantity;

/* Quantities of the whole model (kind NULL: columns <name>_xx), or of each wall, body and so on
 * (columns <kind>_<owner>_<name>_x). */
typedef struct gn_quantity_group {
    const char *kind;
    size_t (*count)(const gn_world *world);
    const char *(*owner)(const gn_world *world, size_t k);
    const gn_quantity *quantities;
    size_t quantity_count;
    const char *ends; /* group of results.h5 with the final values; NULL: none */
    bool in_rows; /* the group holds arrays with a row for every owner; else a group for each owner
                   */
} gn_quantity_group;

enum {
    GN_QUANTITY_GROUPS = 11,
    GN_CUT_QUANTITIES = 8,
    GN_JOINT_QUANTITIES = 8,
    GN_GRAIN_QUANTITIES = 9
};
/* Quantities of a cutting test (quantities_cutting.c). */
extern const gn_quantity gn_cut_quantities[GN_CUT_QUANTITIES];
/* Quantities of joints, their number and names (quantities_joints.c). */
extern const gn_quantity gn_joint_quantities[GN_JOINT_QUANTITIES];
size_t gn_joint_quantity_count(const gn_world *world);
const char *gn_joint_quantity_owner(const gn_world *world, size_t k);
/* Quantities of the packing of particles (quantities_grains.c). */
extern const gn_quantity gn_grain_quantities[GN_GRAIN_QUANTITIES];
extern const gn_quantity_group gn_quantity_groups[GN_QUANTITY_GROUPS];

bool gn_condition_holds(const gn_condition *when, const gn_world *world, size_t owner);
/* Writes a condition as text: "in triaxial and biaxial tests". */
const char *gn_condition_text(const gn_condition *when, char *text, size_t size);

/* An iterator over the quantities of a world, in the order of the columns. It starts from zeros;
 * the step returns false at the end. */
typedef struct gn_quantity_place {
    const gn_quantity *quantity;
    const gn_quantity_group *group;
    size_t owner;
    size_t next_group, next_owner, next_quantity;
} gn_quantity_place;
bool gn_quantity_next(const gn_world *world, gn_quantity_place *place);

/* Components of a shape: their suffixes ("_xy"; "" for a scalar) and their indices in the array
 * that `read` fills. */
enum { GN_SHAPE_MOST = 6 };
typedef struct gn_shape_component {
    char suffix[4];
    int first, second; /* the component is the mean of both */
} gn_shape_component;
size_t gn_shape_components(gn_shape shape, int dimension, gn_shape_component out[GN_SHAPE_MOST]);
/* Extracts the components from the array that `read` filled. */
void gn_shape_take(const double *value, const gn_shape_component *part, size_t parts, double *to);

#endif
