/* Fragments, the sets of particles that bonds connect (particles/fragments.h), in results.h5. */
#include "particles/fragments.h"
#include "run/output_table.h"
#include "run/part_files.h"

#include <string.h>

#define READ(name, expression)                                                                     \
    static void read_##name(const void *view, size_t k, double *value) {                           \
        const gn_fragment *f = &((const gn_fragment_list *)view)->row[k];                          \
        *value = (expression);                                                                     \
    }
READ(particles, f->particles)
READ(first, f->first)
READ(mass, f->mass)
READ(volume, f->volume)
static void read_centre(const void *view, size_t k, double *value) {
    memcpy(value, ((const gn_fragment_list *)view)->row[k].centre, 3 * sizeof *value);
}
static void read_velocity(const void *view, size_t k, double *value) {
    memcpy(value, ((const gn_fragment_list *)view)->row[k].velocity, 3 * sizeof *value);
}

static const gn_output_field of_fragments[] = {
    {"particles", "1", "number of particles, one or more", GN_IN_RESULTS, GN_I32, false, 1,
     read_particles, 0},
    {"first", "1", "smallest id of its particles", GN_IN_RESULTS, GN_I32, false, 1, read_first, 0},
    {"mass", "kg", "mass without that added by mass scaling", GN_IN_RESULTS, GN_F64, false, 1,
     read_mass, 0},
    {"volume", "m3", "volume of its particles, in 2D m2 x 1 m", GN_IN_RESULTS, GN_F64, false, 1,
     read_volume, 0},
    {"centre", "m",
     "centre of mass; in periodic boxes that of the images nearest to its first particle",
     GN_IN_RESULTS, GN_F64, false, 3, read_centre, 0},
    {"velocity", "m/s", "velocity of the centre of mass, half a step before the instant",
     GN_IN_RESULTS, GN_F64, false, 3, read_velocity, 0},
};
const gn_output_table gn_fragment_outputs = {"fragments", of_fragments,
                                             sizeof of_fragments / sizeof *of_fragments};

gneiss_status gn_fragments_results(const gn_world *world, gn_h5 *file, gneiss_error *error) {
    gn_fragment_list list;
    if (!(world->ctx.effects & GN_FX_BONDS) || !world->dem.particles.soa.count) return GNEISS_OK;
    gneiss_status status = gn_fragments_list(&world->ctx, &world->dem, &list, error);
    const gn_output_source source = {&gn_fragment_outputs, &list, 0, list.count, NULL, NULL, 0};
    if (status == GNEISS_OK) status = gn_output_put(&source, file, error);
    gn_fragments_free(&list);
    return status;
}
