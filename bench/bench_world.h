/* A world for the benches: created from a scene, stepped, its kernels called alone. The engine's
 * headers are C; this one is C and C++. */
#ifndef GN_BENCH_WORLD_H
#define GN_BENCH_WORLD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bench_world bench_world;

typedef struct bench_numbers {
    size_t particles, bonds, pairs, wall_contacts;
    size_t bond_bytes, pair_bytes, particle_bytes; /* bytes per item */
    size_t world_bytes;
    int64_t contact_steps, steps, rebuilds;
    double seconds_lists; /* time since the start */
    double seconds_setup;
    int threads;
    const char *isa;
} bench_numbers;

enum { BENCH_MESSAGE_SIZE = 2048 };

/* Creates a world from the scene file with the YAML text `extra` appended and overrides
 * "key=value", NULL at the end. NULL with a message on failure. */
bench_world *bench_world_create(const char *scene, const char *extra, const char *const *overrides,
                                char message[BENCH_MESSAGE_SIZE]);
void bench_world_free(bench_world *world);

/* Sets threads and kernels of the world; false if this machine lacks the instruction set. `isa` is
 * "auto" or a name of bench_isa_at. */
bool bench_world_use(bench_world *world, int threads, const char *isa);

/* Takes `steps` steps; false with a message if the run failed. */
bool bench_world_steps(bench_world *world, int steps, char message[BENCH_MESSAGE_SIZE]);

/* Takes one step of several worlds at the same time, each in a thread of its own; `seconds` [count]
 * receives the time of each. */
bool bench_worlds_at_once(bench_world *const *worlds, int count, double *seconds,
                          char message[BENCH_MESSAGE_SIZE]);

bench_numbers bench_world_numbers(const bench_world *world);

/* Runs the contact kernel over the first `blocks` blocks of the longer of the two lists, or over
 * all of it if it has fewer, with a time step of zero, so that the state does not change. Returns
 * the number of contacts. */
size_t bench_world_contact_kernel(bench_world *world, size_t blocks);

/* Runs the motion kernel in the same way; returns the number of particles. */
size_t bench_world_motion_kernel(bench_world *world, size_t blocks);

/* Writes the names of the kernels that these two functions call. */
void bench_world_contact_name(const bench_world *world, char *name, size_t size);
void bench_world_motion_name(const bench_world *world, char *name, size_t size);

/* Computes the bytes that the contact kernel reads and writes in columns and rows of its list,
 * without particle rows. */
void bench_world_contact_traffic(const bench_world *world, size_t *read, size_t *written);

const char *bench_version(void);
const char *bench_build(void);

/* Returns the names of the instruction sets that this machine has, from narrow to wide; NULL beyond
 * the last. */
const char *bench_isa_at(int index);

#ifdef __cplusplus
}
#endif

#endif
