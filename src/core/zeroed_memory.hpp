#pragma once
// Memory for long arrays that hardly anything is written to.
#include <cstddef>
#include <new>
#include <utility>

namespace rabiline {

/// Memory of zeros from a multiple of 64 on, in large pages where there is much of it; what nobody touches
/// takes none of the machine's. Throws std::bad_alloc.
void* zeroed_memory(std::size_t bytes);
void free_zeroed_memory(void*, std::size_t bytes) noexcept;

/// For vectors that are never made shorter: elements that are added begin as the zeros that the memory holds.
template <class T>
struct ZeroedMemory {
  static_assert(alignof(T) <= 64);
  using value_type = T;
  ZeroedMemory() = default;
  template <class U>
  explicit ZeroedMemory(const ZeroedMemory<U>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(zeroed_memory(count * sizeof(T))); }
  void deallocate(T* begin, std::size_t count) noexcept { free_zeroed_memory(begin, count * sizeof(T)); }
  void construct(T* /*zero*/) noexcept {}
  template <class... Values>
  void construct(T* place, Values&&... values) {
    ::new (static_cast<void*>(place)) T(std::forward<Values>(values)...);
  }
  bool operator==(const ZeroedMemory&) const = default;
};

}  // namespace rabiline
