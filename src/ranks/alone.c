/* A program that is a single process. */
#include "ranks/program.h"

void gn_program_begin(int *argc, char ***argv) {
    (void)argc;
    (void)argv;
}

void gn_program_end(int code, const char *message) {
    (void)code;
    (void)message;
}
