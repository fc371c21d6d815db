// What a scene's forces on all strands at once need on a device, and their launches in order.
#include "cuda/pair_forces/pair_forces_on_device.h"

#include <utility>

#include "solver/pair_forces/cohesion_forces.h"
#include "solver/pair_forces/pair_forces_coupling.h"

namespace wetcurl {

template <class T>
PairForcesOnDevice<T>::PairForcesOnDevice(const Scene& scene, const ChainState<T>& state)
    : scene_(scene),
      particles_(state.n),
      slots_(scene.integrator.substeps),
      x_(state.x.size()),
      mass_(particle_masses(scene)),
      saturation_(scene.saturation),
      energy_(energy_parts(x_.size())) {
    for_each_pair_force(scene, [&]<class Method>(const Method& method) {
        pulls_.push_back(pulls_of(method));
        name_ = std::is_same_v<Method, Cohesion> ? cohesion_in_the_solve : Method::table;
    });
    check_cuda(cudaStreamSynchronize(nullptr), "particles");  // streams of launches do not wait for this one
}

template <class T>
akinci2013::KernelTable PairForcesOnDevice<T>::take(const akinci2013::KernelSum& sum) {
    return {sum.cell(), kernel_sums_.emplace_back(sum.sum()).data()};
}
template <class T>
PairMemory PairForcesOnDevice<T>::pairs_within(double radius) {
    near_ = DeviceBuffer<Vec3f>(x_.size());
    search_.emplace(x_.size(), particles_, radius, Vec3f{0, 0, 0});
    point_ = DeviceBuffer<PairPoint>(x_.size());
    return {search_->view(), point_.data(), nullptr, nullptr};
}
template <class T>
AnyPulls PairForcesOnDevice<T>::pulls_of(const Cohesion& method) {
    return StrandPulls<CohesionPairs>{{method}, pairs_within(method.h_c)};
}
template <class T>
AnyPulls PairForcesOnDevice<T>::pulls_of(const Lin2015& method) {
    return StrandPulls<LinPairs>{{method, take({akinci2013::adhesion_kernel, method.h})},
                                 pairs_within(method.h)};
}
template <class T>
AnyPulls PairForcesOnDevice<T>::pulls_of(const Kim2016& method) {
    PairMemory memory = pairs_within(method.h);
    density_ = DeviceBuffer<double>(x_.size()), normal_ = DeviceBuffer<Vec3d>(x_.size());
    memory.density = density_.data(), memory.normal = normal_.data();
    return StrandPulls<KimPairs>{{method, take({akinci2013::cohesion_kernel, method.h})}, memory};
}
template <class T>
AnyPulls PairForcesOnDevice<T>::pulls_of(const BoundaryParticles2013& method) {
    const Stream stream;
    std::vector<SampledSurface> views;
    for (const auto& solid : scene_.solids) {
        const auto points = sampled_surface(solid.shape, method.spacing);
        if (points.empty()) continue;
        const DeviceBuffer<Vec3f> on_device(points);
        surface_volume_.emplace_back(boundary_volumes(points, method.h));
        surface_search_.emplace_back(points.size(), 1, search_radius(method), Vec3f{0, 0, 0});
        check_cuda(cudaStreamSynchronize(nullptr), "boundary particles");
        surface_search_.back().launch(on_device.data(), stream.handle);
        check_cuda(cudaStreamSynchronize(stream.handle), "boundary particles");
        views.push_back({surface_search_.back().view(), surface_volume_.back().data()});
        solids_.push_back(&solid);
    }
    surfaces_ = DeviceBuffer<SampledSurface>(views);
    const size_t poses = size_t(slots_ + 1) * solids_.size();
    host_pose_.emplace(poses), pose_ = DeviceBuffer<Pose>(poses);
    return BoundaryPulls{method,
                         take({akinci2013::adhesion_kernel, method.h}),
                         uint32_t(x_.size()),
                         surfaces_.data(),
                         pose_.data(),
                         int(solids_.size()),
                         x_.data(),
                         mass_.data(),
                         saturation_.data()};
}

template <class T>
void PairForcesOnDevice<T>::put_motion(int slot, double time) const {
    if (solids_.empty()) return;
    const Pose head = scene_.head_at(time);
    for (size_t k = 0; k < solids_.size(); ++k)
        (*host_pose_)[size_t(slot) * solids_.size() + k] = solids_[k]->at(time, head);
}
// Of those slots alone: a frame's are filled while the one for `potential` may still be on its way.
template <class T>
void PairForcesOnDevice<T>::upload_poses(int slot, int slots, cudaStream_t stream) const {
    if (solids_.empty()) return;
    const size_t first = size_t(slot) * solids_.size(), count = size_t(slots) * solids_.size();
    check_cuda(cudaMemcpyAsync(pose_.data() + first, host_pose_->data() + first, count * sizeof(Pose),
                               cudaMemcpyHostToDevice, stream),
               "motion of solids");
}

// Particles where the scheme expects them, where they are without one, and solids of the slot.
template <class T>
template <class Launch>
void PairForcesOnDevice<T>::for_each_seen(const StrandMemory<T>& memory, const Bdf2<T>* scheme, int slot,
                                          cudaStream_t stream, Launch launch) const {
    launch_sight(memory, scheme, x_.data(), near_.data(), stream);
    if (search_) search_->launch(near_.data(), stream);
    Write write = Write::new_values;
    for (AnyPulls pulls : pulls_) {
        std::visit(
            [&](auto& of) {
                if constexpr (requires { of.pose; })
                    of.pose = pose_.data() + size_t(slot) * solids_.size();
                else
                    launch_points(of.m, x_.data(), mass_.data(), saturation_.data(), stream);
            },
            pulls);
        launch(pulls, std::exchange(write, Write::added));
    }
}

template <class T>
void PairForcesOnDevice<T>::launch(const StrandMemory<T>& memory, const Bdf2<T>& scheme, int slot,
                                   Vec3<T>* force, T* stiffness, unsigned long long* pairs,
                                   cudaStream_t stream) const {
    for_each_seen(memory, has_stiffness() ? &scheme : nullptr, slot, stream,
                  [&](const AnyPulls& pulls, Write write) {
                      launch_pulls(pulls, write, force, stiffness, pairs, stream);
                  });
}

template <class T>
void PairForcesOnDevice<T>::launch_energies_at(const StrandMemory<T>& memory, double time,
                                               cudaStream_t stream) const {
    put_motion(slots_, time), upload_poses(slots_, 1, stream);
    for_each_seen(memory, nullptr, slots_, stream, [&](const AnyPulls& pulls, Write write) {
        launch_energies(pulls, write, energy_.device.data(), stream);
    });
}

template <class T>
void PairForcesOnDevice<T>::list(BufferList& buffers) const {
    size_t pairs = near_.bytes() + point_.bytes() + density_.bytes() + normal_.bytes(),
           solids = surfaces_.bytes() + pose_.bytes();
    size_t sums = 0;
    for (const auto& sum : kernel_sums_) sums += sum.bytes();
    if (search_) pairs += search_->bytes();
    for (const auto& search : surface_search_) solids += search.bytes();
    for (const auto& volume : surface_volume_) solids += volume.bytes();
    buffers.push_back({std::string(name_) + ": particles",
                       x_.bytes() + mass_.bytes() + saturation_.bytes() + sums + energy_.device.bytes()});
    buffers.push_back({std::string(name_) + ": lists", pairs + solids});
}

template class PairForcesOnDevice<float>;
template class PairForcesOnDevice<double>;

}  // namespace wetcurl
