// Marks a function that runs on the CPU and on the GPU, and a loop that is written out so many times there,
// so that arrays which it goes through lie in registers.
#pragma once

#ifdef __CUDACC__
#define WETCURL_HD __host__ __device__
#define WETCURL_PRAGMA(text) _Pragma(#text)
#define WETCURL_UNROLL(times) WETCURL_PRAGMA(unroll times)
#else
#define WETCURL_HD
#define WETCURL_UNROLL(times)
#endif
