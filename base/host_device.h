// Marks a function that runs on the CPU and on the GPU.
#pragma once

#ifdef __CUDACC__
#define WETCURL_HD __host__ __device__
#else
#define WETCURL_HD
#endif
