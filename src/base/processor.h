/* Instructions that only some processors have, outside the kernels of an instruction set. */
#ifndef GN_BASE_PROCESSOR_H
#define GN_BASE_PROCESSOR_H

/* Yields the core to its other hardware thread for a moment while this one spins. */
static inline void gn_spin_pause(void) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

#endif
