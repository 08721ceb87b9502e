/* Names of other programs for what a key of a scene gives. */
#ifndef GN_SCENE_FOREIGN_H
#define GN_SCENE_FOREIGN_H

#include <stddef.h>

typedef struct gn_foreign_name {
    const char *program, *name;
    const char *key;   /* path of the key, such as materials[].friction */
    const char *value; /* what to write, in terms of the name; "": its value */
    const char *page;  /* the page of the documentation that states it */
} gn_foreign_name;

/* Returns the first entry with a name after the entry `after` (NULL: of all), without regard to
 * case; NULL: there is none. The entries are static. */
const gn_foreign_name *gn_foreign_next(const char *name, const gn_foreign_name *after);

/* Writes "pb_emod of PFC is materials[].contact_modulus: pi/4 pb_emod (PAGE)". */
enum { GN_FOREIGN_SIZE = 256 };
void gn_foreign_describe(const gn_foreign_name *entry, char *text, size_t size);

#endif
