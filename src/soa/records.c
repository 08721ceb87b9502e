/* The tables list all fields, even those of effects that the build leaves out. */
#define GN_EVERY_EFFECT
#include "soa/records.h"

#define GN_DESCRIBE(struct_type, name, ctype, type, components, layout, role, care, needs, unless, \
                    unit, text, single_of)                                                         \
    {#name,                                                                                        \
     type,                                                                                         \
     layout,                                                                                       \
     role,                                                                                         \
     care,                                                                                         \
     components,                                                                                   \
     needs,                                                                                        \
     unless,                                                                                       \
     unit,                                                                                         \
     text,                                                                                         \
     offsetof(struct_type, name),                                                                  \
     offsetof(struct_type, single_of)},
#define GN_COUNT(table) (sizeof(table) / sizeof *(table))

static const gn_field particle_fields[] = {
#define X(name, ctype, type, components, layout, role, needs, unless, unit, text)                  \
    GN_DESCRIBE(gn_particles, name, ctype, type, components, layout, role, 0, needs, unless, unit, \
                text, soa)
    GN_PARTICLE_FIELDS(X)
#undef X
};

static const gn_field contact_fields[] = {
#define X(...) GN_DESCRIBE(gn_contacts, __VA_ARGS__)
    GN_CONTACT_FIELDS(X)
#undef X
};

static const gn_field wall_contact_fields[] = {
#define X(...) GN_DESCRIBE(gn_wall_contacts, __VA_ARGS__)
    GN_WALL_CONTACT_FIELDS(X)
#undef X
};

static const gn_field element_fields[] = {
#define X(...) GN_DESCRIBE(gn_elements, __VA_ARGS__)
    GN_ELEMENT_FIELDS(X)
#undef X
};

const gn_record gn_particle_record = {"particles", particle_fields, GN_COUNT(particle_fields)};
const gn_record gn_contact_record = {"contacts", contact_fields, GN_COUNT(contact_fields)};
const gn_record gn_wall_contact_record = {"wall_contacts", wall_contact_fields,
                                          GN_COUNT(wall_contact_fields)};
const gn_record gn_element_record = {"elements", element_fields, GN_COUNT(element_fields)};

_Static_assert(offsetof(gn_particles, soa) == 0 && offsetof(gn_contacts, soa) == 0 &&
                   offsetof(gn_wall_contacts, soa) == 0 && offsetof(gn_elements, soa) == 0,
               "gn_soa must be the first member of every record");

void gn_particles_set_null(gn_particles *particles, double distance) {
    double *pos = particles->pos + 4 * particles->soa.count;
    for (int k = 0; k < 8; k++) pos[k] = 0.0;
    pos[4] = distance;
}

void gn_contacts_pad(gn_contacts *contacts, const gn_particles *particles) {
    for (size_t c = contacts->soa.count; c < contacts->soa.capacity; c++) {
        contacts->i[c] = gn_null_first(particles);
        contacts->j[c] = gn_null_second(particles);
    }
}

void gn_elements_pad(gn_elements *elements, const gn_particles *nodes) {
    for (int a = 0; a <= gn_elements_dimension(elements); a++) {
        int32_t *column = gn_elements_node(elements, a);
        for (size_t e = elements->soa.count; e < elements->soa.capacity; e++)
            column[e] = gn_null_first(nodes);
    }
}
