/* Starting points of the fit, distributed over the body, with a size each. */
#ifndef GN_PACK_SEEDS_H
#define GN_PACK_SEEDS_H

#include "pack/shape.h"

typedef struct gn_seeds {
    size_t count;
    /* [count][4]: x y z and the radius at the expected porosity, m; in Morton order; gn_alloc'ed */
    double *row;
} gn_seeds;

/* Returns the fraction of the body's volume that dense packings of discs (spheres) fill. */
static inline double gn_packed_fraction(int dimension) {
    return dimension == 3 ? 0.68 : 0.90;
}

/* Makes random points, or takes the inner nodes of the mesh; the result depends on the scene alone.
 * GNEISS_ERROR_INPUT: the body is too thin for such particles, or has no inner node;
 * GNEISS_ERROR_MEMORY: the machine has not enough memory for the particles. */
gneiss_status gn_seeds_create(const gn_scene *scene, const gn_pack_shape *body, gn_seeds *seeds,
                              gneiss_error *error);
void gn_seeds_free(gn_seeds *seeds);

#endif
