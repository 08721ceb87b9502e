/* What program this is. */
#ifndef GN_BASE_VERSION_H
#define GN_BASE_VERSION_H

/* "0.1.0", and the compiler and flags it was built with. */
const char *gn_version(void);
const char *gn_build(void);

#endif
