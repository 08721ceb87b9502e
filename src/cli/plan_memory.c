/* `plan` makes the world as a run makes it: packing, lists, limit and strain gauge take the same
 * memory. The peak is therefore read from the system and includes the memory of libraries. Added to
 * it is the memory that a run holds beside the world when it writes: each file, and the arrays of
 * one kind of item, are formed in memory. */
#include "cli/plan_memory.h"

#include "base/resident.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>

static double saved(const gn_record *record, const gn_soa *soa) {
    return (double)soa->count * (double)gn_record_bytes(record, soa->effects);
}

/* Returns the bytes that a run holds beside the world when it writes. The numbers are those of the
 * fields of a snapshot, for each particle, contact and element, and of HDF5 itself, all measured.
 */
static double bytes_of_writing(const gn_world *world) {
    static const double particle = 280.0, contact = 240.0, element = 290.0, library = 4e6;
    const gn_dem *d = &world->dem;
    double file = saved(&gn_particle_record, &d->particles.soa) +
                  saved(&gn_contact_record, &d->bonds.soa) +
                  saved(&gn_contact_record, &d->pairs.soa) +
                  saved(&gn_wall_contact_record, &world->boundary.contacts.soa);
    double arrays = fmax(particle * (double)d->particles.soa.count,
                         contact * (double)(d->bonds.soa.count + d->pairs.soa.count));
    for (size_t k = 0; k < world->element_count; k++) {
        const gn_fem_solid *solid = &world->elements[k]->solid;
        file += saved(&gn_particle_record, &solid->nodes.soa) +
                saved(&gn_element_record, &solid->elements.soa);
        arrays = fmax(arrays, element * (double)solid->elements.soa.count);
    }
    return file + arrays + library;
}

void gn_print_plan_memory(const gn_world *world) {
    gn_resident r;
    const double state = (double)gn_world_bytes(world);
#ifdef __GLIBC__
    (void)malloc_trim(0); /* freed memory would otherwise count as used */
#endif
    if (!gn_resident_read(&r)) {
        printf("memory\n  in all %.1f MB of state; further memory of a run is unknown here\n",
               state / 1e6);
        return;
    }
    const double writing = r.now + bytes_of_writing(world);
    printf("memory\n  state            %.1f MB, in fields and the rows of their sums\n",
           state / 1e6);
    printf("  in all %.1f MB at the peak of a run: %.1f MB while it is set up, %.1f MB while it "
           "writes\n",
           fmax(r.peak, writing) / 1e6, r.peak / 1e6, writing / 1e6);
}
