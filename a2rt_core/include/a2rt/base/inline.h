// For the few small functions that every simulated ray goes through dozens of times: compilers
// weigh the size of the caller against them and decide wrongly.
#pragma once

#define A2RT_INLINE [[gnu::always_inline]] inline
#define A2RT_NOINLINE [[gnu::noinline]]
