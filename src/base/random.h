/* Counter-based random numbers: a number depends on seed and index alone, so that it is the same in
 * any order and on any number of threads (the finaliser of SplitMix64; Steele, Lea & Flood 2014).
 */
#ifndef GN_BASE_RANDOM_H
#define GN_BASE_RANDOM_H

#include <stdint.h>

static inline uint64_t gn_random_bits(uint64_t seed, uint64_t index) {
    uint64_t z = seed * UINT64_C(0xd1342543de82ef95) + (index + 1) * UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

/* Returns a number uniformly distributed in [-1, 1). */
static inline double gn_random_symmetric(uint64_t seed, uint64_t index) {
    return (double)(gn_random_bits(seed, index) >> 11) * 0x1p-52 - 1.0;
}

#endif
