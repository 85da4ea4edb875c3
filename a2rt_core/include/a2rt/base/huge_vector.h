// Vectors for large structures that are read at random: on huge pages where the system grants them,
// which spares most page faults while building and most TLB misses while traversing.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

namespace a2rt {

template <class T>
struct HugePageAllocator {
  using value_type = T;
  static constexpr std::size_t kPage = std::size_t{1} << 21;

  HugePageAllocator() = default;
  template <class U>
  HugePageAllocator(const HugePageAllocator<U>&) {}

  T* allocate(std::size_t n) {
    const std::size_t bytes = n * sizeof(T);
    // Below two pages the rounding would cost more memory than it saves time.
    const bool huge = bytes >= 2 * kPage;
    const std::size_t alignment = huge ? kPage : alignof(T) < 64 ? 64 : alignof(T);
    const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
    void* memory = std::aligned_alloc(alignment, rounded == 0 ? alignment : rounded);
    if (memory == nullptr) {
      throw std::bad_alloc();
    }
    if (huge) {
      // A request only; without huge pages everything works the same.
      (void)madvise(memory, rounded, MADV_HUGEPAGE);
    }
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t) { std::free(memory); }

  template <class U>
  friend bool operator==(const HugePageAllocator&, const HugePageAllocator<U>&) {
    return true;
  }
};

template <class T>
using HugeVector = std::vector<T, HugePageAllocator<T>>;

}  // namespace a2rt
