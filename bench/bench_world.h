/* A world as the benches see it: made from a scene, stepped, its kernels called alone. The engine's
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
    size_t bond_bytes, pair_bytes, particle_bytes; /* stored per item */
    size_t world_bytes;
    int64_t contact_steps, steps, rebuilds;
    double seconds_lists; /* since the start */
    double seconds_setup;
    int threads;
    const char *isa;
} bench_numbers;

enum { BENCH_MESSAGE_SIZE = 2048 };

/* The scene file with `extra` YAML behind it and overrides "key=value", NULL at the end. NULL with
 * a message on failure. */
bench_world *bench_world_create(const char *scene, const char *extra, const char *const *overrides,
                                char message[BENCH_MESSAGE_SIZE]);
void bench_world_free(bench_world *world);

/* Other threads and kernels for the same world; false if this machine has no such instruction set.
 * `isa` "auto" or a name of bench_isa_at. */
bool bench_world_use(bench_world *world, int threads, const char *isa);

/* `steps` steps; false with a message if the world went bad. */
bool bench_world_steps(bench_world *world, int steps, char message[BENCH_MESSAGE_SIZE]);

/* One step of several worlds at once, each in a thread of its own; `seconds` [count] is what each
 * took. */
bool bench_worlds_at_once(bench_world *const *worlds, int count, double *seconds,
                          char message[BENCH_MESSAGE_SIZE]);

bench_numbers bench_world_numbers(const bench_world *world);

/* The contact kernel over the first `blocks` blocks of the longer of the two lists, or over all of
 * it when it has fewer; with a time step of zero, so that the state stands still. Returns the
 * contacts visited. */
size_t bench_world_contact_kernel(bench_world *world, size_t blocks);

/* The same for the motion kernel; returns the particles visited. */
size_t bench_world_motion_kernel(bench_world *world, size_t blocks);

/* Names of the kernels that those two call, into `name`. */
void bench_world_contact_name(const bench_world *world, char *name, size_t size);
void bench_world_motion_name(const bench_world *world, char *name, size_t size);

/* Bytes that the contact kernel reads and writes in columns and rows of its list, particle rows
 * left out. */
void bench_world_contact_traffic(const bench_world *world, size_t *read, size_t *written);

const char *bench_version(void);
const char *bench_build(void);

/* Names of the instruction sets that this machine runs, from narrow to wide; NULL beyond the last.
 */
const char *bench_isa_at(int index);

#ifdef __cplusplus
}
#endif

#endif
