/* Selects the pairs that act soon, and packs their columns; compiled once per instruction set, in
 * double. */
#include "kernels/near.h"

#include "kernels/block_rows.h"
#include "kernels/simd_pack.h"

_Static_assert(GN_NEAR_GROUP % GN_W == 0, "a group has whole vectors");

/* Returns the margins of both ends of one vector of pairs, from c on. */
GN_INLINE gn_v margins(const gn_near_args *args, size_t c) {
    double both[GN_W];
    for (size_t k = 0; k < GN_W; k++)
        both[k] = args->paths[(size_t)args->i[c + k] / GN_PARTICLE_BLOCK].margin +
                  args->paths[(size_t)args->j[c + k] / GN_PARTICLE_BLOCK].margin;
    return gn_load(both);
}

/* Returns the active pairs of one vector, from c on. Centres at the distance vector d with the
 * relative velocity v are never closer than d.(d + v t)/|d|, at any time t. */
GN_INLINE unsigned acting(const gn_near_args *args, size_t c, int periodic) {
    gn_v p[4], q[4], v[4], d[3], d2 = gn_set(0.0), along = gn_set(0.0);
    gn_rows4(args->pos, args->i + c, p);
    gn_rows4(args->pos, args->j + c, q);
    gn_rows4_less(args->vel, args->j + c, args->i + c, v);
    for (int k = 0; k < 3; k++) {
        d[k] = q[k] - p[k];
        if (periodic)
            d[k] = gn_fnma(gn_set(args->period[k]),
                           gn_round(d[k] * gn_set(args->inverse_period[k])), d[k]);
        d2 = gn_fma(d[k], d[k], d2);
        along = gn_fma(d[k], v[k], along);
    }
    gn_v distance = gn_sqrt(d2),
         reach = gn_fma(gn_set(args->widening), p[3] + q[3], margins(args, c));
    gn_v way = gn_max(gn_set(-args->ahead) * along, gn_set(args->behind) * along);
    gn_m near = gn_less(distance, reach);
    return gn_bits(gn_or(near, gn_less(distance * (distance - reach), way)));
}

/* Rows are prefetched for the kernel, which processes a block in a fraction of the time of this
 * search. */
GN_INLINE size_t find_core(const gn_near_args *args, uint8_t *act, int periodic) {
    size_t found = 0;
    gn_block_particles ahead = {args->particle, args->particle + args->particles};
    const int kinds = args->prefetched ? 3 : 2;
    const double *const rows[3] = {args->pos, args->vel, args->prefetched};
    gn_fetch_ahead(&ahead, rows, kinds, 16);
    for (size_t c = 0; c < args->count; c += GN_NEAR_GROUP) {
        unsigned now = 0;
        gn_fetch_ahead(&ahead, rows, kinds, 4);
        for (size_t v = 0; v < GN_NEAR_GROUP; v += GN_W) now |= acting(args, c + v, periodic) << v;
        if (c + GN_NEAR_GROUP > args->count) now &= (1u << (args->count - c)) - 1u;
        act[c / GN_NEAR_GROUP] = (uint8_t)now;
        found += (size_t)__builtin_popcount(now);
    }
    return found;
}

static size_t find(const gn_near_args *args, uint8_t *act) {
    return args->periodic ? find_core(args, act, 1) : find_core(args, act, 0);
}

static void pack(double *to, const double *from, const uint8_t *act, size_t groups) {
    for (size_t g = 0; g < groups; to += __builtin_popcount(act[g++]))
        gn_pack_f64(to, from + GN_NEAR_GROUP * g, act[g]);
}

static void pack32(void *to, const void *from, const uint8_t *act, size_t groups) {
    int32_t *out = to;
    for (size_t g = 0; g < groups; out += __builtin_popcount(act[g++]))
        gn_pack_32(out, (const int32_t *)from + GN_NEAR_GROUP * g, act[g]);
}

static void unpack(double *to, const double *from, const uint8_t *act, size_t groups) {
    for (size_t g = 0; g < groups; from += __builtin_popcount(act[g++]))
        gn_unpack_f64(to + GN_NEAR_GROUP * g, from, act[g]);
}

static void repack(double *to, const double *from, const uint8_t *was, const uint8_t *act,
                   size_t groups) {
    for (size_t g = 0; g < groups; g++) {
        gn_repack_f64(to, from, was[g], act[g]);
        from += __builtin_popcount(was[g]);
        to += __builtin_popcount(act[g]);
    }
}

const gn_near_kernels GN_TABLE(near) = {find, pack, pack32, unpack, repack};
