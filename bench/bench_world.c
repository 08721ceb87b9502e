#include "bench_world.h"

#include "base/timer.h"
#include "particles/particles.h"
#include "run/run.h"
#include "world/particle_step.h"
#include "world/world.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_OVERRIDES = 16 };

struct bench_world {
    gn_world world;
};

/* Returns the whole file with `extra` appended; NULL if it cannot be read. */
static char *read_text(const char *path, const char *extra) {
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    size_t room = strlen(extra) + 2, length = 0, got;
    char *text = NULL, part[4096];
    while ((got = fread(part, 1, sizeof part, file)) > 0) {
        char *more = realloc(text, length + got + room);
        if (!more) break;
        text = more;
        memcpy(text + length, part, got);
        length += got;
    }
    fclose(file);
    if (text) {
        text[length] = '\n';
        memcpy(text + length + 1, extra, room - 1);
    }
    return text;
}

/* Splits "key=value"; the texts are stored in `store`. */
static size_t split_overrides(const char *const *pairs, gn_override *overrides, char store[][256]) {
    size_t count = 0;
    for (; pairs && pairs[count] && count < MOST_OVERRIDES; count++) {
        snprintf(store[count], sizeof store[count], "%s", pairs[count]);
        char *equals = strchr(store[count], '=');
        if (!equals) break;
        *equals = 0;
        overrides[count] = (gn_override){store[count], equals + 1};
    }
    return count;
}

bench_world *bench_world_create(const char *path, const char *extra, const char *const *pairs,
                                char message[BENCH_MESSAGE_SIZE]) {
    gn_override overrides[MOST_OVERRIDES];
    char store[MOST_OVERRIDES][256], folder[GN_PATH_SIZE];
    size_t count = split_overrides(pairs, overrides, store);
    snprintf(folder, sizeof folder, "%s", path);
    char *slash = strrchr(folder, '/');
    if (slash) *slash = 0;
    char *text = read_text(path, extra ? extra : "");
    bench_world *b = calloc(1, sizeof *b);
    gneiss_error error = {0};
    gn_scene scene = {0};
    if (!text || !b) {
        gn_fail(&error, GNEISS_ERROR_IO, "%s: cannot be read", path);
    } else if (gn_scene_parse(text, path, slash ? folder : ".", overrides, count, &scene, &error) ==
               GNEISS_OK) {
        gn_world_create(&scene, &b->world, &error);
    }
    free(text);
    if (error.status == GNEISS_OK) return b;
    snprintf(message, BENCH_MESSAGE_SIZE, "%s", error.message);
    free(b);
    return NULL;
}

void bench_world_free(bench_world *b) {
    if (!b) return;
    gn_world_free(&b->world);
    free(b);
}

bool bench_world_use(bench_world *b, int threads, const char *isa) {
    for (gn_isa k = GN_ISA_AUTO; k < GN_ISA_COUNT; k++)
        if (strcmp(gn_isa_name(k), isa) == 0) b->world.ctx.scene.isa = k;
    b->world.ctx.scene.threads = threads;
    gneiss_error error;
    return gn_world_prepare(&b->world.ctx, &b->world.dem, &b->world.box, &error) == GNEISS_OK;
}

bool bench_world_steps(bench_world *b, int steps, char message[BENCH_MESSAGE_SIZE]) {
    gneiss_error error = {0};
    for (int k = 0; k < steps; k++) {
        if (gn_world_step(&b->world, false, &error) == GNEISS_OK) continue;
        snprintf(message, BENCH_MESSAGE_SIZE, "%s", error.message);
        return false;
    }
    return true;
}

bool bench_worlds_at_once(bench_world *const *worlds, int count, double *seconds,
                          char message[BENCH_MESSAGE_SIZE]) {
    bool well = true;
#pragma omp parallel for num_threads(count) schedule(static, 1)
    for (int k = 0; k < count; k++) {
        char text[BENCH_MESSAGE_SIZE];
        const double start = gn_now();
        const bool stepped = bench_world_steps(worlds[k], 1, text);
        seconds[k] = gn_now() - start;
        if (stepped) continue;
#pragma omp critical(bench_message)
        {
            snprintf(message, BENCH_MESSAGE_SIZE, "%s", text);
            well = false;
        }
    }
    return well;
}

bench_numbers bench_world_numbers(const bench_world *b) {
    const gn_world *w = &b->world;
    bench_numbers n = {0};
    n.particles = w->dem.particles.soa.count;
    n.bonds = w->dem.bonds.contacts.soa.count;
    n.pairs = w->dem.pairs.contacts.soa.count;
    n.wall_contacts = w->boundary.contacts.soa.count;
    n.bond_bytes = gn_record_bytes(&gn_contact_record, w->dem.bonds.contacts.soa.effects);
    n.pair_bytes = gn_record_bytes(&gn_contact_record, w->dem.pairs.contacts.soa.effects);
    n.particle_bytes = gn_record_bytes(&gn_particle_record, w->ctx.effects);
    n.world_bytes = gn_world_bytes(&w->ctx, &w->dem, &w->boundary, &w->solids);
    n.contact_steps = w->dem.contact_steps;
    n.steps = w->ctx.step;
    n.rebuilds = w->dem.verlet.rebuilds;
    n.seconds_lists = w->ctx.seconds[GN_PHASE_lists];
    n.seconds_setup = w->ctx.seconds[GN_PHASE_setup];
    n.threads = w->ctx.threads;
    n.isa = w->ctx.kernels->name;
    return n;
}

/* --- kernels alone --- */

static const gn_contact_list *longer_list(const gn_world *w) {
    const gn_contact_list *bonds = &w->dem.bonds, *pairs = &w->dem.pairs;
    return bonds->contacts.soa.count > pairs->contacts.soa.count ? bonds : pairs;
}

size_t bench_world_contact_kernel(bench_world *b, size_t blocks) {
    gn_world *w = &b->world;
    gn_contact_args a = gn_dem_contact_args(&w->ctx, &w->dem, &w->box, longer_list(w), false);
    a.dt = 0.0; /* the state does not change */
    gn_contact_kernel *kernel = longer_list(w)->kernel;
    size_t length = a.partials->length, last = blocks * length;
    if (last > a.contacts->soa.count) last = a.contacts->soa.count;
    for (size_t first = 0; first < last; first += length) {
        gn_contact_sums sums = {0};
        size_t end = first + length < last ? first + length : last;
        kernel(&a, first, end, &sums);
    }
    return last;
}

size_t bench_world_motion_kernel(bench_world *b, size_t blocks) {
    gn_world *w = &b->world;
    gn_motion_args a = gn_world_motion_args(&w->ctx, &w->dem, &w->boundary, false);
    a.dt = a.dt_past = 0.0;
    size_t last = blocks * GN_PARTICLE_BLOCK;
    if (last > w->dem.particles.soa.count) last = w->dem.particles.soa.count;
    for (size_t first = 0; first < last; first += GN_PARTICLE_BLOCK) {
        gn_motion_sums sums = {.bad = -1};
        size_t end = first + GN_PARTICLE_BLOCK < last ? first + GN_PARTICLE_BLOCK : last;
        w->dem.motion_kernel(&a, first, end, &sums);
    }
    return last;
}

void bench_world_contact_name(const bench_world *b, char *name, size_t size) {
    gn_effects effects = longer_list(&b->world)->contacts.soa.effects;
    gn_contact_variant_name(gn_contact_variant(effects), name, size);
    size_t used = strlen(name);
    if (effects & GN_FX_MIXED) snprintf(name + used, size - used, "_mixed");
}

void bench_world_motion_name(const bench_world *b, char *name, size_t size) {
    gn_motion_variant_name(gn_motion_variant(b->world.ctx.effects), name, size);
}

static size_t width(const void *array, size_t bytes) {
    return array ? bytes : 0;
}

/* Returns the bytes of the columns that are streamed; parameters common to all contacts are read
 * from one place. */
static size_t parameters(const gn_contacts *k, const gn_uniform *u) {
    bool mixed = k->kn_f;
    size_t real = mixed ? 4 : 8, bytes = 0;
    bytes += width(u->kn ? NULL : k->kn, real) + width(u->kt ? NULL : k->kt, real);
    bytes += width(u->mu ? NULL : k->mu, real) + width(u->cn ? NULL : k->cn, real);
    bytes += width(u->mu1 && !k->soft ? NULL : k->mu1, real) + width(k->soft, real);
    bytes +=
        width(k->plastic, 8) + width(k->plastic_f, 4) + width(k->yields, 8) + width(k->yields_f, 4);
    bytes += width(k->length0, real) + width(k->rn, real) + width(k->rt, real);
    return bytes + width(k->branch_f, 12) + width(k->stretch_f, 4);
}

void bench_world_contact_traffic(const bench_world *b, size_t *read, size_t *written) {
    const gn_world *w = &b->world;
    const gn_contact_list *list = longer_list(w);
    const gn_contacts *k = &list->contacts;
    const gn_partials *q = &list->partials;
    size_t components = w->ctx.effects & GN_FX_SPACE ? 3 : 2;
    size_t state = width(k->shear, 8 * components) + width(k->shear_f, 4 * components) +
                   width(k->fd, 8) + width(k->fd_f, 4);
    /* a row is cleared, and then read and written by the contacts of its block from the cache */
    size_t count = q->blocks ? (size_t)q->first[q->blocks] : 0;
    size_t rows = count * gn_partials_row_bytes(q), named = count * sizeof *q->particle;
    *read = 2 * sizeof *k->i + 2 * sizeof *q->place + state + (rows + named) / k->soa.count +
            parameters(k, &list->uniform);
    *written = state + rows / k->soa.count;
}

const char *bench_version(void) {
    return gn_version();
}
const char *bench_build(void) {
    return gn_build();
}

const char *bench_isa_at(int index) {
    for (int k = 0; k < GN_KERNEL_SETS; k++)
        if (gn_kernel_set_supported(gn_kernel_set_at(k)) && index-- == 0)
            return gn_kernel_set_at(k)->name;
    return NULL;
}
