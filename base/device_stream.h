// A CUDA stream by its name alone, for headers that are read without CUDA too.
#pragma once

struct CUstream_st;

namespace wetcurl {

using DeviceStream = CUstream_st*;  // a cudaStream_t

}  // namespace wetcurl
