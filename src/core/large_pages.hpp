#pragma once
// Memory for sums by the hundred MiB: what the system does for each page of 4 KiB would cost more than what
// is added to them.
#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rabiline {

/// Makes a vector longer, with zeros at its end, on pages of 2 MiB where the system has them.
template <class T>
void resize_on_large_pages(std::vector<T>& v, std::size_t size) {
  if (size == v.size()) return;
  v.reserve(size);
  constexpr std::uintptr_t page = 4096, large_page = std::uintptr_t{1} << 21;
  const auto begin = reinterpret_cast<std::uintptr_t>(v.data()), end = begin + size * sizeof(T);
  const std::uintptr_t first = (begin + page - 1) / page * page, last = end / page * page;
  if (last > first + large_page)  // a hint, which may be refused
    static_cast<void>(madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE));
  v.resize(size);
}

}  // namespace rabiline
