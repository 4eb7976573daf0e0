#pragma once
// Takes from each stage what stands where among its sums.
#include <cstddef>
#include <string_view>

#include "transport/sum_layout.hpp"

namespace rabiline {

/// `at` counts from the stage's first sum. What a receiver does not care for it leaves as it is.
class SumSink {
 public:
  virtual ~SumSink() = default;
  /// The weight of what ended so, at a part, at the chamber or nowhere (no_part).
  virtual void fate(std::string_view word, int part, std::size_t at) = 0;
  virtual void screen(int part, const ScreenSums& layout, std::size_t at);
  virtual void levels(int part, int levels, std::size_t at);
  virtual void plane(int part, int plane, std::size_t at);
  virtual void histogram(int part, int tally, int plane, const HistogramSums& layout, std::size_t at);
};

inline void SumSink::screen(int, const ScreenSums&, std::size_t) {}
inline void SumSink::levels(int, int, std::size_t) {}
inline void SumSink::plane(int, int, std::size_t) {}
inline void SumSink::histogram(int, int, int, const HistogramSums&, std::size_t) {}

/// The same, from a place further on: for a stage that consists of others.
class ShiftedSums : public SumSink {
 public:
  ShiftedSums(SumSink& to, std::size_t shift) : to_(to), shift_(shift) {}
  void fate(std::string_view word, int part, std::size_t at) override { to_.fate(word, part, at + shift_); }
  void screen(int part, const ScreenSums& layout, std::size_t at) override {
    to_.screen(part, layout, at + shift_);
  }
  void levels(int part, int levels, std::size_t at) override { to_.levels(part, levels, at + shift_); }
  void plane(int part, int plane, std::size_t at) override { to_.plane(part, plane, at + shift_); }
  void histogram(int part, int tally, int plane, const HistogramSums& layout, std::size_t at) override {
    to_.histogram(part, tally, plane, layout, at + shift_);
  }

 private:
  SumSink& to_;
  const std::size_t shift_;
};

}  // namespace rabiline
