/* Division of the work among ranks, whenever lists were made. All ranks compute the same division
 * from the same lists. */
#include "base/new.h"
#include "ranks/ranks.h"
#include "ranks/ranks_private.h"

#include <math.h>

/* --- create, free --- */

gneiss_status gn_ranks_create(gn_ranks **ranks, gneiss_error *error) {
    const gn_transport *t = gn_transport_now();
    gn_ranks *r = NULL;
    *ranks = NULL;
    if (!t || t->count == 1) return GNEISS_OK;
    GN_TRY(gn_new(&r, 1, "ranks", error));
    *ranks = r;
    *r = (gn_ranks){.transport = t, .rank = t->rank, .count = t->count, .whole = true};
    const size_t count = (size_t)t->count;
    GN_TRY(gn_new(&r->block, count + 1, "ranks", error));
    GN_TRY(gn_new(&r->particle, count + 1, "ranks", error));
    size_t **ranges[] = {&r->range, &r->bytes, &r->wall_contact, &r->wall_block_first,
                         &r->prescribed_first};
    for (size_t k = 0; k < sizeof ranges / sizeof *ranges; k++)
        GN_TRY(gn_new(ranges[k], count + 1, "ranks", error));
    for (int l = 0; l < GN_LISTS_MOST; l++)
        GN_TRY(gn_new(&r->item_block[l], count + 1, "ranks", error));
    GN_TRY(gn_new(&r->share, count, "ranks", error));
    GN_TRY(gn_new(&r->busy_of, count, "ranks", error));
    for (size_t k = 0; k < count; k++) r->share[k] = 1.0 / (double)count;
    return gn_new(&r->peer, count, "ranks", error);
}

static void free_rows(gn_rank_rows *rows) {
    gn_free(rows->row);
    gn_free(rows->particle);
    *rows = (gn_rank_rows){0};
}

static void free_plan(gn_ranks *r) {
    gn_messages **groups[] = {&r->rows_out, &r->rows_in, &r->places_out, &r->places_in};
    for (size_t k = 0; k < sizeof groups / sizeof *groups; k++) {
        if (*groups[k]) r->transport->close(*groups[k]);
        *groups[k] = NULL;
    }
    for (int k = 0; r->peer && k < r->count; k++) {
        gn_rank_peer *p = &r->peer[k];
        free_rows(&p->out);
        free_rows(&p->in);
        unsigned char *buffers[] = {p->rows_out, p->rows_in, p->places_out, p->places_in};
        for (size_t b = 0; b < sizeof buffers / sizeof *buffers; b++) gn_free(buffers[b]);
        *p = (gn_rank_peer){0};
    }
    for (int l = 0; l < GN_LISTS_MOST; l++)
        for (int end = 0; end < 2; end++) {
            gn_free(r->own[l].touched[end]);
            r->own[l].touched[end] = NULL;
        }
    for (int l = 0; l < GN_LISTS_MOST; l++) {
        gn_free(r->is_early[l]);
        r->is_early[l] = NULL;
    }
    gn_free(r->early);
    gn_free(r->waits);
    gn_free(r->late);
    r->early = NULL;
    gn_free(r->seen);
    r->waits = NULL;
    r->late = r->seen = NULL;
}

void gn_ranks_free(gn_ranks *r) {
    if (!r) return;
    free_plan(r);
    gn_ranks_free_share(r, &r->sums);
    gn_ranks_free_share(r, &r->forces);
    void *blocks[] = {r->block,
                      r->particle,
                      r->peer,
                      r->range,
                      r->bytes,
                      r->share,
                      r->busy_of,
                      r->wall_contact,
                      r->wall_block_first,
                      r->wall_block,
                      r->prescribed_first,
                      r->prescribed};
    for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) gn_free(blocks[k]);
    for (int l = 0; l < GN_LISTS_MOST; l++) gn_free(r->item_block[l]);
    gn_free(r);
}

/* --- ranges --- */

static size_t blocks_of(const gn_deal_list *list) {
    return list->partials ? list->partials->blocks : 0;
}

/* Returns the first block of items whose first particle is in block `particles` or a later one. */
static size_t block_from(const gn_deal_list *list, size_t particles) {
    size_t low = 0, high = blocks_of(list);
    while (low < high) {
        const size_t middle = (low + high) / 2;
        const int32_t leader = list->leader[middle * list->partials->length];
        if ((size_t)leader / GN_PARTICLE_BLOCK < particles)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Work before a block of particles, in items: those of the blocks of items before it, and a share
 * for the motion of each particle. */
static double work_before(const gn_deal_list *list, int lists, size_t particles) {
    static const double motion = 0.7;
    double work = motion * GN_PARTICLE_BLOCK * (double)particles;
    for (int l = 0; l < lists; l++)
        if (blocks_of(&list[l]))
            work += (double)list[l].partials->length * (double)block_from(&list[l], particles);
    return work;
}

/* Moves the shares towards equal times, by what the ranks took for theirs since the last plan. */
static void follow_pace(gn_ranks *r) {
    static const double pace = 0.5, most = 1.5;
    double *busy = r->busy_of, sum = 0.0, shares = 0.0;
    for (int k = 0; k <= r->count; k++) r->range[k] = (size_t)k * sizeof *busy;
    busy[r->rank] = r->busy;
    r->busy = 0.0;
    r->transport->gather(busy, r->range);
    for (int k = 0; k < r->count; k++) sum += busy[k];
    for (int k = 0; k < r->count; k++) {
        const double ratio = busy[k] > 0.0 ? sum / r->count / busy[k] : 1.0;
        r->share[k] *= 1.0 + pace * (fmin(most, fmax(1.0 / most, ratio)) - 1.0);
        shares += r->share[k];
    }
    for (int k = 0; k < r->count; k++) r->share[k] /= shares;
}

/* Divides the blocks of particles so that the ranks have their shares of the work. */
static void cut(gn_ranks *r, const gn_deal_list *list, int lists, size_t blocks) {
    const double all = work_before(list, lists, blocks);
    double share = 0.0;
    size_t at = 0;
    for (int k = 0; k <= r->count; share += k < r->count ? r->share[k] : 0.0, k++) {
        const double wanted = all * share;
        while (at < blocks && work_before(list, lists, at + 1) <= wanted) at++;
        if (k == r->count) at = blocks;
        r->block[k] = at;
        r->particle[k] =
            at * GN_PARTICLE_BLOCK < r->particles ? at * GN_PARTICLE_BLOCK : r->particles;
        for (int l = 0; l < lists; l++) r->item_block[l][k] = block_from(&list[l], at);
    }
}

static int owner_of(const gn_ranks *r, int32_t particle) {
    const size_t block = (size_t)particle / GN_PARTICLE_BLOCK;
    int low = 0, high = r->count - 1; /* the last rank whose range does not begin after it */
    while (low < high) {
        const int middle = (low + high + 1) / 2;
        if (r->block[middle] <= block)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

/* --- rows of others --- */

/* Where a row goes: from the rank of its block of items to the owner of its particle. NULL: this
 * rank is neither, or both. */
static gn_rank_rows *rows_between(gn_ranks *r, int worker, int owner) {
    if (worker == owner || (worker != r->rank && owner != r->rank)) return NULL;
    return worker == r->rank ? &r->peer[owner].out : &r->peer[worker].in;
}

/* Counts the rows (first[l + 1]), or writes them down after gn_rank_rows.row was allocated. */
static void visit_rows(gn_ranks *r, int l, bool writes) {
    const gn_partials *q = r->partials[l];
    for (int worker = 0; q->blocks && worker < r->count; worker++) {
        const int32_t begin = q->first[r->item_block[l][worker]],
                      end = q->first[r->item_block[l][worker + 1]];
        for (int32_t k = begin; k < end; k++) {
            const int32_t particle = q->particle[k];
            const int owner = owner_of(r, particle);
            gn_rank_rows *rows = rows_between(r, worker, owner);
            if (!rows) continue;
            if (writes) rows->row[rows->first[l + 1]] = k;
            rows->first[l + 1]++;
            if (owner == r->rank) r->waits[particle / GN_PARTICLE_BLOCK] = 1;
        }
    }
}

static gneiss_status allocate_rows(gn_rank_rows *rows, int lists, gneiss_error *error) {
    size_t count = 0;
    for (int l = 1; l <= lists; l++) {
        const size_t of_list = rows->first[l];
        rows->first[l] = count; /* writing advances it to the end of the list */
        count += of_list;
    }
    GN_TRY(gn_new(&rows->row, count + 1, "rows of other ranks", error));
    return gn_new(&rows->particle, count + 1, "particles of other ranks", error);
}

/* Lists the particles of rows, each once; both ranks find the same order. */
static void list_particles(gn_ranks *r, gn_rank_rows *rows, int lists, int32_t mark) {
    for (int l = 0; l < lists; l++)
        for (size_t k = rows->first[l]; k < rows->first[l + 1]; k++) {
            const int32_t p = r->partials[l]->particle[rows->row[k]];
            if (r->seen[p] == mark) continue;
            r->seen[p] = mark;
            rows->particle[rows->particles++] = p;
        }
}

static gneiss_status find_rows(gn_ranks *r, int lists, gneiss_error *error) {
    int32_t mark = 0;
    for (int l = 0; l < lists; l++) visit_rows(r, l, false);
    for (int k = 0; k < r->count; k++) {
        GN_TRY(allocate_rows(&r->peer[k].out, lists, error));
        GN_TRY(allocate_rows(&r->peer[k].in, lists, error));
    }
    for (int l = 0; l < lists; l++) visit_rows(r, l, true);
    for (int k = 0; k < r->count; k++) {
        list_particles(r, &r->peer[k].out, lists, ++mark);
        list_particles(r, &r->peer[k].in, lists, ++mark);
    }
    return GNEISS_OK;
}

/* --- messages --- */

static size_t rows_size(const gn_ranks *r, const gn_rank_rows *rows, int lists) {
    size_t size = 0;
    for (int l = 0; l < lists; l++)
        if (r->partials[l]->blocks)
            size += (rows->first[l + 1] - rows->first[l]) * gn_partials_row_bytes(r->partials[l]);
    return size;
}

static size_t places_size(const gn_ranks *r, const gn_rank_rows *rows) {
    size_t size = 0;
    for (int f = 0; f < r->fields; f++) size += rows->particles * r->field[f].bytes;
    return size;
}

static void find_fields(gn_ranks *r, const gn_particles *q) {
    const struct {
        void *data;
        size_t bytes;
    } all[GN_RANK_FIELDS] = {
        {q->pos, 4 * sizeof *q->pos},     {q->vel, 4 * sizeof *q->vel},
        {q->spin, 4 * sizeof *q->spin},   {q->travel_f, 4 * sizeof *q->travel_f},
        {q->vel_f, 4 * sizeof *q->vel_f}, {q->spin_f, 4 * sizeof *q->spin_f}};
    r->fields = 0;
    for (int f = 0; f < GN_RANK_FIELDS; f++) {
        if (!all[f].data) continue;
        r->field[r->fields].data = all[f].data;
        r->field[r->fields++].bytes = all[f].bytes;
    }
}

/* Opens one message per peer; tags tell rows and places apart. */
static gneiss_status open_messages(gn_ranks *r, gneiss_error *error) {
    GN_FREED gn_message *list = NULL;
    GN_TRY(gn_new(&list, 4 * (size_t)r->count, "messages", error));
    gn_message *of[4];
    size_t count[4] = {0};
    for (int g = 0; g < 4; g++) of[g] = list + (size_t)g * (size_t)r->count;
    for (int k = 0; k < r->count; k++) {
        gn_rank_peer *p = &r->peer[k];
        const size_t size[4] = {rows_size(r, &p->out, r->lists), rows_size(r, &p->in, r->lists),
                                places_size(r, &p->in), places_size(r, &p->out)};
        unsigned char **buffer[4] = {&p->rows_out, &p->rows_in, &p->places_out, &p->places_in};
        for (int g = 0; g < 4; g++) {
            if (!size[g]) continue;
            GN_TRY(gn_new(buffer[g], size[g], "bytes of a message", error));
            of[g][count[g]++] = (gn_message){k, *buffer[g], size[g]};
        }
    }
    gn_messages **group[4] = {&r->rows_out, &r->rows_in, &r->places_out, &r->places_in};
    for (int g = 0; g < 4; g++) {
        *group[g] = r->transport->open(of[g], count[g], g % 2 ? GN_RECEIVED : GN_SENT,
                                       g < 2 ? GN_TAG_ROWS : GN_TAG_PLACES);
        if (!*group[g]) return gn_no_memory(error, "messages");
    }
    return GNEISS_OK;
}

/* --- the plan --- */

/* The first and the last own block of items that touch each block of particles. */
static gneiss_status view_own(gn_ranks *r, int l, size_t blocks, gneiss_error *error) {
    const gn_partials *all = r->partials[l];
    const size_t begin = r->item_block[l][r->rank], end = r->item_block[l][r->rank + 1];
    gn_partials *own = &r->own[l];
    *own = (gn_partials){.width = all->width, .length = all->length, .blocks = end - begin};
    for (int side = 0; side < 2; side++) {
        GN_TRY(gn_new(&own->touched[side], blocks + 1, "blocks of a rank", error));
        for (size_t p = 0; p < blocks; p++) own->touched[side][p] = side ? -1 : INT32_MAX;
    }
    for (size_t b = begin; b < end; b++)
        for (int32_t k = all->first[b]; k < all->first[b + 1]; k++) {
            const size_t p = (size_t)all->particle[k] / GN_PARTICLE_BLOCK;
            if (own->touched[1][p] < 0) own->touched[0][p] = (int32_t)(b - begin);
            own->touched[1][p] = (int32_t)(b - begin);
        }
    return GNEISS_OK;
}

/* Own blocks that await rows are late; blocks of other ranks wait for ever. */
static gneiss_status find_late(gn_ranks *r, size_t blocks, gneiss_error *error) {
    GN_TRY(gn_new(&r->late, blocks + 1, "blocks of a rank", error));
    r->late_count = 0;
    for (size_t b = 0; b < blocks; b++) {
        const bool own = b >= r->block[r->rank] && b < r->block[r->rank + 1];
        if (own && r->waits[b]) r->late[r->late_count++] = (int32_t)b;
        if (!own) r->waits[b] = 1;
    }
    return GNEISS_OK;
}

static bool has_rows_of_others(const gn_ranks *r, const gn_partials *q, size_t block) {
    for (int32_t k = q->first[block]; k < q->first[block + 1]; k++)
        if (owner_of(r, q->particle[k]) != r->rank) return true;
    return false;
}

static gneiss_status find_early(gn_ranks *r, gneiss_error *error) {
    size_t own = 0;
    for (int l = 0; l < r->lists; l++)
        own += r->item_block[l][r->rank + 1] - r->item_block[l][r->rank];
    GN_TRY(gn_new(&r->early, own + 1, "blocks of a rank", error));
    r->early_count = 0;
    for (int l = 0; l < r->lists; l++) {
        const size_t begin = r->item_block[l][r->rank], end = r->item_block[l][r->rank + 1];
        GN_TRY(gn_new(&r->is_early[l], end - begin + 1, "blocks of a rank", error));
        for (size_t b = begin; b < end; b++) {
            if (!has_rows_of_others(r, r->partials[l], b)) continue;
            r->is_early[l][b - begin] = 1;
            r->early[r->early_count++] = (struct gn_rank_block){l, b};
        }
    }
    return GNEISS_OK;
}

gneiss_status gn_ranks_plan(gn_ranks *r, const gn_particles *particles, gn_deal_list *list,
                            int lists, gneiss_error *error) {
    const size_t blocks = (particles->soa.count + GN_PARTICLE_BLOCK - 1) / GN_PARTICLE_BLOCK;
    free_plan(r);
    follow_pace(r);
    r->particles = particles->soa.count;
    r->lists = lists;
    for (int l = 0; l < lists; l++) r->partials[l] = list[l].partials;
    cut(r, list, lists, blocks);
    GN_TRY(gn_new(&r->waits, blocks + 1, "blocks of a rank", error));
    GN_TRY(gn_new(&r->seen, r->particles + 1, "particles of a rank", error));
    GN_TRY(find_rows(r, lists, error));
    GN_TRY(find_late(r, blocks, error));
    GN_TRY(find_early(r, error));
    find_fields(r, particles);
    GN_TRY(open_messages(r, error));
    for (int l = 0; l < lists; l++) {
        if (!blocks_of(&list[l])) continue;
        GN_TRY(view_own(r, l, blocks, error));
        list[l].leader += r->item_block[l][r->rank] * list[l].partials->length;
        list[l].partials = &r->own[l];
    }
    return GNEISS_OK;
}
