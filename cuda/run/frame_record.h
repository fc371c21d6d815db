// What a run keeps of each frame, taken out of a device's memory while the next frame is computed.
#pragma once

#include <vector>

#include "base/run_cache.h"
#include "cuda/chain/strand_memory.h"
#include "cuda/device/cuda_owners.h"

namespace wetcurl {

// energy (strand, kind) [J], kinds as of kinds_of_energy. contact (strand, particle), 1 in contact; null
// where the strands have none.
template <class T>
void launch_record(const StrandMemory<T>& memory, const ChainConstants<T>& constants, T* energy,
                   uint8_t* contact, cudaStream_t stream);

template <class T>
class FrameRecord {
  public:
    FrameRecord(int strands, int particles, size_t kinds, bool displayed, bool contact);

    // Of the strands as they are once the stream has come here: whatever follows on it may change them.
    void begin(const StrandMemory<T>& memory, const ChainConstants<T>& constants, const Vec3f* positions,
               const Vec3f* displayed, cudaStream_t stream);
    // Waits for it; on any thread, before the next begin.
    void finish(RunFrame& frame) const;
    size_t bytes() const { return points_.device.bytes() + energy_.device.bytes() + contact_.device.bytes(); }

  private:
    const int strands_, particles_;
    const bool displayed_;
    OnBoth<Vec3f> points_;  // positions, then what is displayed
    OnBoth<T> energy_;      // (strand, kind)
    OnBoth<uint8_t> contact_;
    WayOut way_;
};

extern template class FrameRecord<float>;
extern template class FrameRecord<double>;

}  // namespace wetcurl
