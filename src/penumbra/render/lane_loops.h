#pragma once

// Functions whose loops run over the lanes of a packet without branches, so that the compiler turns each into a few
// vector instructions; GCC clones them for wider vectors and picks at program start.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define PENUMBRA_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define PENUMBRA_CLONES
#endif

namespace penumbra {

// Both values are known already: a choice without a branch.
inline float pick(bool first, float a, float b) { return first ? a : b; }

}  // namespace penumbra
