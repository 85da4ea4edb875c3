// Which vector kernels this build and this processor can run. Kernels are single functions marked
// A2RT_AVX2 instead of files compiled with -mavx2: inline functions of headers would otherwise be
// emitted with AVX2 and could be picked by the linker for code that runs on older processors.
#pragma once

#if defined(__x86_64__)
#define A2RT_HAS_X86_VECTORS 1
#define A2RT_AVX2 __attribute__((target("avx2")))
#include <immintrin.h>
#else
#define A2RT_HAS_X86_VECTORS 0
#endif

namespace a2rt {

// Of the processor at hand; a plain flag, as it is asked at every test.
#if A2RT_HAS_X86_VECTORS
inline const bool kHasAvx2 = __builtin_cpu_supports("avx2") != 0;
#else
inline constexpr bool kHasAvx2 = false;
#endif
inline bool has_avx2() { return kHasAvx2; }

}  // namespace a2rt
