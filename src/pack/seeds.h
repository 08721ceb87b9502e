/* Where the fit starts: points spread over the body, with a size each. */
#ifndef GN_PACK_SEEDS_H
#define GN_PACK_SEEDS_H

#include "pack/shape.h"

typedef struct gn_seeds {
    size_t count;
    double *row; /* [count][4]: x y z and the radius that particles would have at the porosity that
                    is expected, m; in Morton order; gn_alloc'ed */
} gn_seeds;

/* Share of the body's volume that dense packings of discs (spheres) fill. */
static inline double gn_packed_fraction(int dimension) {
    return dimension == 3 ? 0.68 : 0.90;
}

/* Random points, or the inner nodes of the mesh. A pure function of the scene. GNEISS_ERROR_INPUT:
 * a body too thin for such particles, no inner node; GNEISS_ERROR_MEMORY: more particles than the
 * machine has memory for. */
gneiss_status gn_seeds_create(const gn_scene *scene, const gn_pack_shape *body, gn_seeds *seeds,
                              gneiss_error *error);
void gn_seeds_free(gn_seeds *seeds);

#endif
