#include "core/zeroed_memory.hpp"

#include <sys/mman.h>

#include <cstdlib>
#include <cstring>

namespace rabiline {
namespace {

constexpr std::size_t much = std::size_t{8} << 20, line = 64;  // [bytes]

}  // namespace

void* zeroed_memory(std::size_t bytes) {
  if (bytes < much) {
    void* const memory = std::aligned_alloc(line, (bytes + line) / line * line);
    if (memory == nullptr) throw std::bad_alloc();
    return std::memset(memory, 0, bytes);
  }
  void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
#if defined(MADV_HUGEPAGE)
  madvise(memory, bytes, MADV_HUGEPAGE);  // a wish, which may be refused
#endif
  return memory;
}

void free_zeroed_memory(void* memory, std::size_t bytes) noexcept {
  if (bytes < much)
    std::free(memory);
  else
    munmap(memory, bytes);
}

}  // namespace rabiline
