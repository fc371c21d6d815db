// Calls of operator new, counted. In a file of its own: what inlines these finds pairs that do not match.
#include "tests/learn/allocations.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

static std::atomic<long> calls{0};

static void* counted(size_t bytes, size_t alignment) {
    ++calls;
    void* const room = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
    if (!room) throw std::bad_alloc();
    return room;
}
void* operator new(size_t bytes) { return counted(bytes, alignof(std::max_align_t)); }
void* operator new(size_t bytes, std::align_val_t alignment) { return counted(bytes, size_t(alignment)); }
void operator delete(void* room) noexcept { std::free(room); }
void operator delete(void* room, size_t) noexcept { std::free(room); }
void operator delete(void* room, std::align_val_t) noexcept { std::free(room); }
void operator delete(void* room, size_t, std::align_val_t) noexcept { std::free(room); }

namespace wetcurl::testing {

long allocations() { return calls; }

}  // namespace wetcurl::testing
