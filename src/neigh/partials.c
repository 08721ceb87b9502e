#include "base/memory.h"
#include "neigh/neigh.h"

#include <string.h>

/* Items with two to four particles each. A row width of 8 occurs only with two. */
typedef struct partial_items {
    const char *name; /* name for messages */
    size_t count;
    int members;
    const int32_t *member[4]; /* [members][count] */
    int width;                /* width of a row, see gn_partials */
    bool single;              /* rows in single precision */
} partial_items;

/* The particles of each block in the order in which its contacts refer to them: neighbours in the
 * list become neighbours in the rows. */
typedef struct numbering {
    int32_t *particle; /* [blocks][members length] the particle of each row */
    int32_t *count;    /* [blocks] rows */
} numbering;

static uint16_t place_of(int32_t particle, int width, int32_t *seen, int32_t *rows,
                         int32_t *count) {
    if (seen[particle] < 0) {
        seen[particle] = *count;
        rows[(*count)++] = particle;
    }
    return (uint16_t)(seen[particle] * width);
}

static inline __attribute__((always_inline)) void
number_members(const partial_items *items, size_t members, size_t block, int32_t *seen,
               const numbering *numbers, gn_partials *partials) {
    size_t begin = block * partials->length, end = begin + partials->length;
    if (end > items->count) end = items->count;
    int32_t *rows = numbers->particle + block * members * partials->length, count = 0;
    for (size_t c = begin; c < end; c++)
        for (size_t m = 0; m < members; m++)
            partials->place[members * c + m] =
                place_of(items->member[m][c], partials->width, seen, rows, &count);
    for (int32_t k = 0; k < count; k++) seen[rows[k]] = -1;
    numbers->count[block] = count;
}

/* Contact lists are rebuilt often, so that contacts have a loop of their own. */
static void number_block(const partial_items *items, size_t block, int32_t *seen,
                         const numbering *numbers, gn_partials *partials) {
    if (items->members == 2)
        number_members(items, 2, block, seen, numbers, partials);
    else
        number_members(items, (size_t)items->members, block, seen, numbers, partials);
}

_Static_assert(2 * GN_CONTACT_BLOCK * 8 <= UINT16_MAX + 1, "places of contacts fit in 16 bits");
_Static_assert(4 * GN_CONTACT_BLOCK * 4 <= UINT16_MAX + 1, "places of elements fit in 16 bits");

/* Numbers all blocks; every thread marks particles in its own array. Returns false without
 * memory. */
static bool number_blocks(const partial_items *items, size_t particles, int threads,
                          const numbering *numbers, gn_partials *partials) {
    bool held = true;
#pragma omp parallel num_threads(threads)
    {
        int32_t *seen = gn_alloc_array(particles + 1, sizeof *seen);
        if (!seen) {
#pragma omp atomic write
            held = false;
        }
        for (size_t p = 0; seen && p < particles; p++) seen[p] = -1;
#pragma omp for schedule(static)
        for (size_t b = 0; b < partials->blocks; b++)
            if (seen) number_block(items, b, seen, numbers, partials);
        gn_free(seen);
    }
    return held;
}

/* Lists the particle of each row; the entry beyond the last row is particle 0. */
static void name_rows(const numbering *numbers, size_t members, gn_partials *partials) {
    int32_t *next = partials->particle;
    for (size_t b = 0; b < partials->blocks; next += numbers->count[b++])
        memcpy(next, numbers->particle + b * members * partials->length,
               (size_t)numbers->count[b] * sizeof *next);
}

static bool make_touched(size_t particle_blocks, gn_partials *partials) {
    for (int end = 0; end < 2; end++) {
        partials->touched[end] =
            gn_alloc_array(particle_blocks + 1, sizeof *partials->touched[end]);
        if (!partials->touched[end]) return false;
        for (size_t p = 0; p < particle_blocks; p++)
            partials->touched[end][p] = end ? -1 : INT32_MAX;
    }
    return true;
}

/* Extends the range of contact blocks that touch a particle's block; contact blocks arrive in
 * ascending order. */
static void touch(gn_partials *partials, int32_t particle, size_t contact_block) {
    size_t p = (size_t)particle / GN_PARTICLE_BLOCK;
    if (partials->touched[1][p] < 0) partials->touched[0][p] = (int32_t)contact_block;
    partials->touched[1][p] = (int32_t)contact_block;
}

/* Sorts shares by particle (counting sort, which is stable, so that rows of a particle stay in
 * block order). */
static bool sort_shares(size_t particles, gn_partials *partials) {
    const int32_t rows = partials->first[partials->blocks];
    size_t particle_blocks = (particles + GN_PARTICLE_BLOCK - 1) / GN_PARTICLE_BLOCK;
    int32_t *next = gn_alloc_array(particles + 2, sizeof *next);
    partials->start = gn_alloc_array(particle_blocks + 1, sizeof *partials->start);
    partials->share = gn_alloc_array((size_t)rows + 1, sizeof *partials->share);
    bool held =
        next && partials->start && partials->share && make_touched(particle_blocks, partials);
    for (int32_t r = 0; held && r < rows; r++) next[partials->particle[r] + 1]++;
    for (size_t p = 1; held && p <= particles; p++) next[p] += next[p - 1];
    for (size_t b = 0; held && b <= particle_blocks; b++) {
        size_t p = b * GN_PARTICLE_BLOCK;
        partials->start[b] = next[p < particles ? p : particles];
    }
    for (size_t b = 0; held && b < partials->blocks; b++)
        for (int32_t r = partials->first[b]; r < partials->first[b + 1]; r++) {
            int32_t p = partials->particle[r];
            partials->share[next[p]++] = (gn_share){p, r};
            touch(partials, p, b);
        }
    gn_free(next);
    return held;
}

/* Returns the length of blocks. Long blocks have fewer rows in total, but short lists need several
 * blocks that threads can share. */
static size_t block_length(size_t count) {
    enum { BLOCKS_WANTED = 48 };
    size_t length = GN_CONTACT_BLOCK_LEAST;
    while (length < GN_CONTACT_BLOCK && length * BLOCKS_WANTED < count) length *= 2;
    return length;
}

static gneiss_status build_items(const partial_items *items, size_t particle_count, int threads,
                                 gn_partials *partials, gneiss_error *error) {
    gn_partials *q = partials;
    size_t count = items->count, members = (size_t)items->members, length = block_length(count);
    size_t blocks = (count + length - 1) / length;
    gn_partials_free(q);
    q->length = length;
    q->width = items->width;
    q->blocks = blocks;
    numbering n = {gn_alloc_array(blocks + 1, members * length * sizeof *n.particle),
                   gn_alloc_array(blocks + 1, sizeof *n.count)};
    q->place = gn_alloc_array(count + GN_LANES_MAX, members * sizeof *q->place);
    q->first = gn_alloc_array(blocks + 1, sizeof *q->first);
    bool held = n.particle && n.count && q->place && q->first &&
                number_blocks(items, particle_count, threads, &n, q);
    if (held) {
        for (size_t b = 0; b < blocks; b++) q->first[b + 1] = q->first[b] + n.count[b];
        const size_t rows = (size_t)q->first[blocks] + 1, width = (size_t)q->width;
        if (items->single)
            q->row_f = gn_alloc_array(rows, width * sizeof *q->row_f);
        else
            q->row = gn_alloc_array(rows, width * sizeof *q->row);
        q->particle = gn_alloc_array((size_t)q->first[blocks] + GN_LANES_MAX, sizeof *q->particle);
        if (q->particle) name_rows(&n, members, q);
        held = (q->row || q->row_f) && q->particle && sort_shares(particle_count, q);
    }
    gn_free(n.particle);
    gn_free(n.count);
    if (held) return GNEISS_OK;
    gn_partials_free(q);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to sum the forces of %zu %s", count,
                   items->name);
}

gneiss_status gn_partials_build(const gn_contacts *contacts, size_t particle_count, int threads,
                                gn_partials *partials, gneiss_error *error) {
    const partial_items items = {.name = "contacts",
                                 .count = contacts->soa.count,
                                 .members = 2,
                                 .member = {contacts->i, contacts->j},
                                 .width = gn_contacts_row_width(contacts),
                                 .single = contacts->soa.effects & GN_FX_MIXED};
    return build_items(&items, particle_count, threads, partials, error);
}

gneiss_status gn_element_partials_build(const gn_elements *elements, size_t node_count, int threads,
                                        gn_partials *partials, gneiss_error *error) {
    partial_items items = {.name = "elements",
                           .count = elements->soa.count,
                           .members = gn_elements_dimension(elements) + 1,
                           .width = 4};
    for (int a = 0; a < items.members; a++) items.member[a] = gn_elements_node(elements, a);
    return build_items(&items, node_count, threads, partials, error);
}

size_t gn_partials_bytes(const gn_partials *partials, size_t items, int members) {
    const gn_partials *q = partials;
    if (!q->blocks) return 0;
    size_t row = gn_partials_row_bytes(q) + sizeof *q->share + sizeof *q->particle;
    return (size_t)q->first[q->blocks] * row + items * (size_t)members * sizeof *q->place;
}

void gn_partials_free(gn_partials *partials) {
    gn_partials *q = partials;
    gn_free(q->first);
    gn_free(q->place);
    gn_free(q->row);
    gn_free(q->row_f);
    gn_free(q->particle);
    gn_free(q->start);
    gn_free(q->share);
    gn_free(q->touched[0]);
    gn_free(q->touched[1]);
    *q = (gn_partials){0};
}
