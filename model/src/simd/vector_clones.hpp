#pragma once

/// Compiles a function once for every length of vector registers; the one for the machine is chosen at run
/// time. For loops whose elements take the same operations whatever the length, so that all versions give the
/// same result. The address and thread sanitizers cannot run before the choice is made.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) &&     \
    !defined(__SANITIZE_THREAD__)
#define FRINGE_VECTOR_CLONES [[gnu::target_clones("avx512f", "avx2", "default")]]
#else
#define FRINGE_VECTOR_CLONES
#endif
