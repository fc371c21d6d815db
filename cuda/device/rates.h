// What a CUDA device does at most, measured on the spot.
#pragma once

namespace wetcurl {

struct CudaRates {
    double copy_bytes;  // a second, read and written, of a copy within its memory
    double operations;  // a second, of float multiply-adds, two each
};
// `device` counts from 0 and is there. Throws Error where it has not 512 MB to spare.
CudaRates measured_cuda_rates(int device);

}  // namespace wetcurl
