// Frames out of a device's memory.
#include "cuda/run/frame_record.h"
#include "solver/chain/energies.h"

namespace wetcurl {

namespace {

constexpr int threads = 64;

template <class T>
__global__ void take_energies(const StrandMemory<T> m, const ChainConstants<T> constants, T* energy) {
    const int strand = int(blockIdx.x) * threads + int(threadIdx.x);
    if (strand >= m.strands) return;
    ChainView<T> view{};
    view.n = m.n;
    view.set_arrays(arrays_of(m, size_t(strand), m.n));
    T e[most_kinds_of_energy];
    const int kinds = energies(constants.rules.terms, view, constants.gravity, e);
    for (int kind = 0; kind < kinds; ++kind) energy[strand * kinds + kind] = e[kind];
}

template <class T>
__global__ void take_contact(const T* touching, size_t count, uint8_t* contact) {
    const size_t k = size_t(blockIdx.x) * threads + threadIdx.x;
    if (k < count) contact[k] = uint8_t(touching[k]);
}

unsigned blocks_of(size_t count) { return unsigned((count + threads - 1) / threads); }

}  // namespace

template <class T>
void launch_record(const StrandMemory<T>& memory, const ChainConstants<T>& constants, T* energy,
                   uint8_t* contact, cudaStream_t stream) {
    take_energies<<<blocks_of(size_t(memory.strands)), threads, 0, stream>>>(memory, constants, energy);
    check_cuda(cudaGetLastError(), "launch of the energies");
    if (!contact) return;
    const size_t count = size_t(memory.strands) * size_t(memory.n);
    take_contact<<<blocks_of(count), threads, 0, stream>>>(memory.touching, count, contact);
    check_cuda(cudaGetLastError(), "launch of the contacts");
}

template <class T>
FrameRecord<T>::FrameRecord(int strands, int particles, size_t kinds, bool displayed, bool contact)
    : strands_(strands),
      particles_(particles),
      displayed_(displayed),
      points_(size_t(strands) * size_t(particles) * (displayed ? 2 : 1)),
      energy_(size_t(strands) * kinds),
      contact_(contact ? size_t(strands) * size_t(particles) : 0) {}

template <class T>
void FrameRecord<T>::begin(const StrandMemory<T>& memory, const ChainConstants<T>& constants,
                           const Vec3f* positions, const Vec3f* displayed, cudaStream_t stream) {
    launch_record(memory, constants, energy_.device.data(), contact_.device.data(), stream);
    const size_t count = size_t(strands_) * size_t(particles_);
    copy_on_device(points_.device.data(), positions, count, stream);
    if (displayed_) copy_on_device(points_.device.data() + count, displayed, count, stream);
    way_.begin(stream,
               [&](cudaStream_t out) { points_.fetch(out), energy_.fetch(out), contact_.fetch(out); });
}

template <class T>
void FrameRecord<T>::finish(RunFrame& frame) const {
    way_.wait();
    const size_t count = size_t(strands_) * size_t(particles_);
    auto take = [&](const Vec3f* from, Strands& to) {
        to.count = strands_, to.particles = particles_;
        to.points.assign(from, from + count);
    };
    take(points_.host.data(), frame.positions);
    if (displayed_)
        take(points_.host.data() + count, frame.displayed);
    else
        frame.displayed = {};
    const auto sum = sum_over_strands(energy_.host.data(), strands_, energy_.host.size() / size_t(strands_));
    frame.energy.assign(sum.begin(), sum.end());
    frame.contact = contact_.fetched();
}

template class FrameRecord<float>;
template class FrameRecord<double>;
template void launch_record(const StrandMemory<float>&, const ChainConstants<float>&, float*, uint8_t*,
                            cudaStream_t);
template void launch_record(const StrandMemory<double>&, const ChainConstants<double>&, double*, uint8_t*,
                            cudaStream_t);

}  // namespace wetcurl
