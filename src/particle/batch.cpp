#include "particle/batch.hpp"

#include <cstdlib>
#include <cstring>
#include <new>

namespace rabiline {

void Batch::Free::operator()(void* p) const { std::free(p); }

Batch::Batch() : memory_(static_cast<double*>(std::aligned_alloc(64, bytes))) {
  static_assert(sizeof(double) == sizeof(std::uint64_t));
  if (!memory_) throw std::bad_alloc();
  std::memset(static_cast<void*>(memory_.get()), 0, bytes);
  double* next = memory_.get();
  for (const auto column : real_columns) {
    view_.*column = next;
    next += capacity;
  }
  for (const auto column : word_columns) {
    view_.*column = reinterpret_cast<std::uint64_t*>(next);
    next += capacity;
  }
}

void Batch::copy_from(const Batch& other) {
  std::memcpy(static_cast<void*>(memory_.get()), other.memory_.get(), bytes);
  view_.count = other.view_.count;
  view_.padded = other.view_.padded;
  view_.y = other.view_.y;
  view_.fall = other.view_.fall;
  view_.up = other.view_.up;
}

void Batch::add(const BatchView& from, int particle) {
  view_.y = from.y;
  view_.fall = from.fall;
  view_.up = false;
  const int at = view_.count++;
  view_.padded = (view_.count + 7) / 8 * 8;
  for (const auto column : real_columns) (view_.*column)[at] = (from.*column)[particle];
  for (const auto column : word_columns) (view_.*column)[at] = (from.*column)[particle];
}

}  // namespace rabiline
