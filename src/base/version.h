/* Version of the program. */
#ifndef GN_BASE_VERSION_H
#define GN_BASE_VERSION_H

/* Returns the version, e.g. "0.1.0", with compiler and flags. */
const char *gn_version(void);
const char *gn_build(void);

#endif
