/* What only one kind of processor has, outside the kernels of its instruction sets. */
#ifndef GN_BASE_PROCESSOR_H
#define GN_BASE_PROCESSOR_H

/* Lets the other thread of a core go first for an instant, while this one spins. */
static inline void gn_spin_pause(void) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

#endif
