// Dry strands in a device's memory.
#include "cuda/water/soaking_device.h"

#include "cuda/water/soaking_setup.h"

namespace wetcurl {

template <class T>
SoakingDevice::SoakingDevice(const Scene& scene, const std::vector<T>& rest_length)
    : count_(rest_length.size()),
      printed_edge_(printed_edges(scene, rest_length)),
      springs_(dry_springs(scene)) {
    const DryCurlArrays arrays = dry_curl_arrays(scene);
    curl_ = DeviceBuffer<CurlOfStrand>(arrays.curl), vectors_ = DeviceBuffer<Vec3d>(arrays.vectors);
    rotations_ = DeviceBuffer<Quatd>(arrays.rotations), lengths_ = DeviceBuffer<double>(arrays.lengths);
    weighing_ = weighing(scene, printed_edge_.data(), springs_.data());
    dry_ = dry_curls(scene, curl_.data(), vectors_.data(), rotations_.data(), lengths_.data());
    if (dry_.curl)
        target_ = DeviceBuffer<Vec3d>(arrays.vectors.size() / 5), points_ = DeviceBuffer<Vec3d>(count_);
    check_cuda(cudaStreamSynchronize(nullptr), "curls");  // streams of launches do not wait for this one
}

size_t SoakingDevice::bytes() const {
    return curl_.bytes() + vectors_.bytes() + printed_edge_.bytes() + rotations_.bytes() + lengths_.bytes() +
           springs_.bytes() + target_.bytes() + points_.bytes();
}

template SoakingDevice::SoakingDevice(const Scene&, const std::vector<float>&);
template SoakingDevice::SoakingDevice(const Scene&, const std::vector<double>&);

}  // namespace wetcurl
