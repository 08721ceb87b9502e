/* `plan` makes the world as a run makes it: packing, lists, limit and strain gauge take the same
 * memory. The peak is therefore read from the system and includes the memory of libraries. Added to
 * it is the memory that a run holds beside the world when it writes: each file, and the arrays of
 * one kind of item, are formed in memory. */
#include "cli/plan_memory.h"

#include "base/resident.h"
#include "io/h5.h"
#include "run/history_rows.h"
#include "run/spacing.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>

static double saved(const gn_record *record, const gn_soa *soa) {
    return (double)soa->count * (double)gn_record_bytes(record, soa->effects);
}

/* Bytes of the history: its columns, grown to a power of two of rows from columns of half that
 * length, whose place is lost, and once more where it stands in a file. */
static double bytes_of_history(const gn_world *world, double growth) {
    const double rows = growth * gn_run_rows_expected(world);
    gn_history columns;
    double bytes = 0.0, capacity = 256.0;
    while (capacity < rows) capacity *= 2.0;
    if (gn_history_begin(world, &columns, NULL) == GNEISS_OK)
        bytes = (double)columns.column_count * (8.0 * (1.5 * capacity + rows) + sizeof(gn_column));
    gn_history_free(&columns);
    return world->ctx.scene.history_rows > 0 ? bytes : 0.0;
}

/* Bytes of what follows the failure of a specimen: events, and contacts between what had bonds.
 * Measured per broken bond; a share of the bonds that tests have broken behind their peak (a tenth
 * to four tenths). */
static double bytes_of_failure(const gn_world *world) {
    static const double broken = 330.0, share = 0.2;
    const gn_test_descriptor *test = gn_scene_test(&world->ctx.scene);
    const bool crushed = test->prism && test->sign < 0 && !test->sides_stand;
    const bool fails = crushed || test->confined || test->disc || test->sheared;
    return fails ? share * broken * (double)world->dem.bonds.contacts.soa.count : 0.0;
}

/* Returns the bytes that a run holds beside the world when it writes. The numbers are those of the
 * fields of a snapshot, for each particle, contact and element, and of HDF5 itself, all measured.
 */
static double bytes_of_writing(const gn_world *world, const gn_plan_growth *growth) {
    static const double particle = 280.0, contact = 240.0, shown = 420.0, element = 290.0,
                        library = 4e6, listed = 3.0;
    const gn_dem *d = &world->dem;
    const double particles = (double)d->particles.soa.count, contacts = (double)gn_lists_count(d);
    double file = saved(&gn_particle_record, &d->particles.soa) +
                  saved(&gn_contact_record, &d->bonds.contacts.soa) +
                  saved(&gn_contact_record, &d->pairs.contacts.soa) +
                  saved(&gn_wall_contact_record, &world->boundary.contacts.soa);
    double arrays = fmax(particle * particles, contact * contacts);
    if (world->ctx.scene.contact_rows == GN_SWITCH_ON)
        arrays = fmax(arrays, 0.5 * particle * particles + shown * contacts);
    for (size_t k = 0; k < world->solids.count; k++) {
        const gn_fem_solid *solid = &world->solids.elements[k]->solid;
        file += saved(&gn_particle_record, &solid->nodes.soa) +
                saved(&gn_element_record, &solid->elements.soa);
        arrays = fmax(arrays, element * (double)solid->elements.soa.count);
    }
    const double come =
        particle + 2.0 * (double)gn_record_bytes(&gn_particle_record, world->ctx.effects) +
        listed * (contact +
                  2.0 * (double)gn_record_bytes(&gn_contact_record, d->pairs.contacts.soa.effects));
    return file + arrays + library + bytes_of_history(world, growth->rows) +
           bytes_of_failure(world) + growth->particles * come;
}

void gn_print_plan_memory(const gn_world *world, const gn_plan_growth *growth) {
    gn_resident r;
    const double state =
        (double)gn_world_bytes(&world->ctx, &world->dem, &world->boundary, &world->solids);
    gn_h5_load();
#ifdef __GLIBC__
    (void)malloc_trim(0); /* freed memory would otherwise count as used */
#endif
    if (!gn_resident_read(&r)) {
        printf("memory\n  in all %.1f MB of state; further memory of a run is unknown here\n",
               state / 1e6);
        return;
    }
    const double writing = r.now + bytes_of_writing(world, growth);
    printf("memory\n  state            %.1f MB, in fields and the rows of their sums\n",
           state / 1e6);
    printf("  in all %.1f MB at the peak of a run: %.1f MB while it is set up, %.1f MB while it "
           "writes\n",
           fmax(r.peak, writing) / 1e6, r.peak / 1e6, writing / 1e6);
}
