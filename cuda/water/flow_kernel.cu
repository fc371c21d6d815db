// Kernels of the flow: a thread a strand, or a particle in the order of cells.
#include <numeric>

#include "base/strided.h"
#include "cuda/water/flow_kernel.h"

namespace wetcurl {

namespace {

// Strands are few, and each thread is long at work: small blocks reach all processors.
constexpr unsigned strand_threads = 32, particle_threads = 128;

unsigned blocks_for(size_t items, unsigned threads) { return unsigned((items + threads - 1) / threads); }

__global__ void __launch_bounds__(strand_threads)
    run_along(const FlowKernelBody b, int strands, const FlowingSource* sources, int source_count,
              const Vec3f* p, double dt, const Vec3d down, FlowRow* rows) {
    const int s = int(blockIdx.x * strand_threads + threadIdx.x);
    if (s >= strands) return;
    for (int k = 0; k < source_count; ++k)
        if (sources[k].taken > 0) b.wet(s, sources[k], p);
    b.run_along(s, p, dt, down, Strided<FlowRow>{rows + s, size_t(strands)});
}

// First the limits of all, then what is passed on within them.
template <bool limits>
__global__ void __launch_bounds__(particle_threads)
    exchange(const FlowKernelBody b, const CellSearch search, double dt) {
    const uint32_t k = blockIdx.x * particle_threads + threadIdx.x;
    if (k >= search.count) return;
    const SortedPoint own = search.sorted[k];
    auto contacts = [&](auto visit) { search.contacts(own, visit); };
    if constexpr (limits)
        b.find_limit(own.id, dt, contacts);
    else
        b.pass_on(own.id, dt, contacts);
}

// What others read of a strand.
__device__ void show(const FlowKernelBody& b, int s, float* shown, double* held) {
    for (size_t k = b.at(s, 0); k < b.at(s + 1, 0); ++k) shown[k] = float(b.sigma[k]);
    held[s] = water_held(b.mass + b.at(s, 0), b.sigma + b.at(s, 0), size_t(b.n));
}
__global__ void __launch_bounds__(strand_threads)
    end_step(const FlowKernelBody b, int strands, double share, float* shown, double* held) {
    const int s = int(blockIdx.x * strand_threads + threadIdx.x);
    if (s >= strands) return;
    b.shed_excess(s, b.next);
    b.dry(s, share);
    show(b, s, shown, held);
}
__global__ void __launch_bounds__(strand_threads)
    begin_anew(const FlowKernelBody b, int strands, float* shown, double* held) {
    const int s = int(blockIdx.x * strand_threads + threadIdx.x);
    if (s >= strands) return;
    b.ledger[s] = {};
    show(b, s, shown, held);
}

double total(const std::vector<double>& of_strands) {
    return std::accumulate(of_strands.begin(), of_strands.end(), 0.0);
}

}  // namespace

FlowDevice::FlowDevice(const Flow& flow, const FlowHair& hair, double absorbed, const Vec3d& gravity,
                       const Vec3f& origin)
    : flow_(flow),
      strands_(hair.strands),
      n_(hair.particles),
      density_(hair.density),
      absorbed_(absorbed),
      down_(FlowRules::down(gravity)),
      search_(hair.mass.size(), hair.particles, flow.reach, origin),
      sigma_(hair.mass.size()),
      next_(hair.mass.size()),
      limit_(hair.mass.size()),
      shown_(hair.mass.size()),
      rows_(hair.mass.size()),
      ledger_(size_t(strands_)),
      held_(size_t(strands_)),
      host_sources_(flow.sources.size()),
      sources_(flow.sources.size()) {
    mass_ = DeviceBuffer<double>(hair.mass), length_ = DeviceBuffer<double>(hair.length);
    for (const auto& source : flow.sources) {
        const auto* level_set = std::get_if<std::shared_ptr<const LevelSet>>(&source.shape);
        level_sets_.push_back(level_set ? DeviceBuffer<float>((*level_set)->phi()) : DeviceBuffer<float>());
    }
    check_cuda(cudaStreamSynchronize(nullptr), "water");  // streams of launches do not wait for this one
}

FlowKernelBody FlowDevice::bodies() const {
    return {flow_,         density_,      n_, mass_.data(), length_.data(), sigma_.data(), next_.data(),
            limit_.data(), ledger_.data()};
}

void FlowDevice::aim(double time, double dt) {
    dt_ = dt;
    for (size_t k = 0; k < host_sources_.size(); ++k) {
        FlowingSource now = flow_.sources[k].over(time, dt_);
        now.shape.grid.phi = level_sets_[k].data();
        host_sources_[k] = now;
    }
}

void FlowDevice::launch_step(const Vec3f* p, cudaStream_t stream) {
    const FlowKernelBody b = bodies();
    const unsigned strand_blocks = blocks_for(size_t(strands_), strand_threads),
                   particle_blocks = blocks_for(sigma_.size(), particle_threads);
    if (sources_.size())
        check_cuda(cudaMemcpyAsync(sources_.data(), host_sources_.data(), sources_.bytes(),
                                   cudaMemcpyHostToDevice, stream),
                   "sources of water");
    run_along<<<strand_blocks, strand_threads, 0, stream>>>(
        b, strands_, sources_.data(), int(sources_.size()), p, dt_, down_, rows_.data());
    search_.launch(p, stream);
    exchange<true><<<particle_blocks, particle_threads, 0, stream>>>(b, search_.view(), dt_);
    exchange<false><<<particle_blocks, particle_threads, 0, stream>>>(b, search_.view(), dt_);
    end_step<<<strand_blocks, strand_threads, 0, stream>>>(b, strands_, flow_.dried(dt_), shown_.data(),
                                                           held_.data());
    check_cuda(cudaGetLastError(), "launch of the flow");
}

void FlowDevice::restore(const std::vector<double>& saturation, cudaStream_t stream) {
    check_cuda(
        cudaMemcpyAsync(sigma_.data(), saturation.data(), sigma_.bytes(), cudaMemcpyHostToDevice, stream),
        "saturation");
    begin_anew<<<blocks_for(size_t(strands_), strand_threads), strand_threads, 0, stream>>>(
        bodies(), strands_, shown_.data(), held_.data());
    check_cuda(cudaGetLastError(), "launch of the flow");
    start_ = total(host(held_, stream));
}

template <class V>
std::vector<V> FlowDevice::host(const DeviceBuffer<V>& from, cudaStream_t stream) {
    std::vector<V> out(from.size());
    check_cuda(cudaMemcpyAsync(out.data(), from.data(), from.bytes(), cudaMemcpyDeviceToHost, stream),
               "water");
    check_cuda(cudaStreamSynchronize(stream), "water");
    return out;
}
template std::vector<double> FlowDevice::host(const DeviceBuffer<double>&, cudaStream_t);
template std::vector<float> FlowDevice::host(const DeviceBuffer<float>&, cudaStream_t);

std::vector<double> FlowDevice::counted(cudaStream_t stream) const {
    return carried_of(start_, host(ledger_, stream));
}
void FlowDevice::count_from(const std::vector<double>& counted, cudaStream_t stream) {
    std::vector<FlowLedger> ledger(ledger_.size());
    start_ = take_carried(counted, ledger);
    check_cuda(cudaStreamSynchronize(stream), "water");
    ledger_.upload(ledger.data(), ledger.size());
}

WaterBalance FlowDevice::water(const std::vector<double>& held, const std::vector<FlowLedger>& ledger) const {
    return water_balance(absorbed_, start_, total(held), ledger);
}
WaterBalance FlowDevice::water(cudaStream_t stream) const {
    return water(host(held_, stream), host(ledger_, stream));
}

void FlowDevice::begin_record(cudaStream_t stream) {
    if (!record_) record_.emplace(shown_.size(), held_.size());
    auto take = [stream](auto& to, const auto& from) {
        copy_on_device(to.device.data(), from.data(), from.size(), stream);
    };
    take(record_->saturation, shown_), take(record_->ledger, ledger_), take(record_->held, held_);
    record_->way.begin(stream, [this](cudaStream_t out) {
        record_->saturation.fetch(out), record_->ledger.fetch(out), record_->held.fetch(out);
    });
}
void FlowDevice::finish_record(RunFrame& frame) const {
    record_->way.wait();
    frame.saturation = record_->saturation.fetched();
    frame.water = water(record_->held.fetched(), record_->ledger.fetched()).columns();
}

size_t FlowDevice::bytes() const {
    size_t sum = search_.bytes() + shown_.bytes() + rows_.bytes() + ledger_.bytes() + sources_.bytes();
    for (const auto* b : {&mass_, &length_, &sigma_, &next_, &limit_, &held_}) sum += b->bytes();
    for (const auto& level_set : level_sets_) sum += level_set.bytes();
    if (record_)
        sum += record_->saturation.device.bytes() + record_->ledger.device.bytes() +
               record_->held.device.bytes();
    return sum;
}

}  // namespace wetcurl
