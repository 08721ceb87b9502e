/* The commit that the program was built from. */
#ifndef GN_CLI_COMMIT_H
#define GN_CLI_COMMIT_H

/* "0123abcd", with -dirty where files were changed after it; "": not built from a repository. */
const char *gn_commit(void);

#endif
