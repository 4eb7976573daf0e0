#include "transport/transit.hpp"

#ifndef RABILINE_ISA  // what the host does

#include <bit>
#include <utility>

namespace rabiline {

TransitLayout::TransitLayout(const SlownessCells& cells, const std::vector<std::uint64_t>& reachable,
                             const std::vector<TransitLink>& links, bool weights_alike)
    : cells_(cells), weights_alike_(weights_alike), outcomes_(reachable.size()), links_(links) {
  for (std::size_t from = 0; from < reachable.size(); ++from)
    for (int to = 0; to < most_levels; ++to)
      if ((reachable[from] >> to & 1) != 0) outcomes_[from].push_back(to);
  for (std::size_t link = 0; link < links.size(); ++link) add_link(link, reachable);
}

void TransitLayout::add_link(std::size_t number, const std::vector<std::uint64_t>& reachable) {
  const TransitLink& link = links_[number];
  RowsOfLink& rows = rows_of_.emplace_back();
  for (const std::uint64_t found : reachable) {
    const auto n = static_cast<std::size_t>(std::popcount(found & ((std::uint64_t{1} << link.outcomes) - 1)));
    rows.paths_before.push_back(rows.paths_before.back() + n);
    rows.pairs_before.push_back(rows.pairs_before.back() + n * (n - 1) / 2);
  }
  const auto next = [&](std::size_t size) { return std::exchange(rows_, rows_ + size); };
  rows.stops = next(link.ends ? paths(number) : 0);
  rows.shares = next(paths(number) * link.bins);
  rows.squares = next(pairs(number, !weights_alike_) * link.bins);
  rows.across = next(link.is_screen() ? pairs(number, false) * (link.columns + link.rows + 1) : 0);
  rows.means = next(link.axes > 0 ? paths(number) * (1 + 2 * link.axes) * moment_groups : 0);
}

}  // namespace rabiline

#else  // its kernel, compiled once for each instruction set

#include "core/lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// A number below 2^51 in size gets a whole number's bits by adding 1.5 2^52.
void add_moments(const TransitEntry* entries, std::size_t count, CellMoments* moments) {
  constexpr double shift = 0x1.8p52;
  const words shift_bits = bit_pattern(broadcast(shift));
  for (std::size_t n = 0; n < count; ++n) {
    const double t = entries[n].t, t2 = t * t, t4 = t2 * t2;
    alignas(64) const double powers[transit_powers] = {1, t, t2, t2 * t, t4, t4 * t, t4 * t2, t4 * (t2 * t)};
    const real weight = broadcast(entries[n].weight);
    std::int64_t* sums = moments[entries[n].cell].of;
    for (int k = 0; k < transit_powers; k += lane_count) {
      auto* to = reinterpret_cast<unsigned long*>(sums + k);
      store(to, load(to) + (bit_pattern(load(powers + k) * weight + shift) - shift_bits));
    }
  }
}

/// Lanes are rows, so that every sum goes over the columns in their order.
void add_products(const double* a, const double* b, std::ptrdiff_t rows, std::ptrdiff_t columns,
                  double* sums) {
  using vector [[gnu::aligned(8), gnu::may_alias]] = double __attribute__((vector_size(8 * lane_count)));
  constexpr int vectors = 8 / lane_count, at_once = 4;
  constexpr std::ptrdiff_t chunk = 512;  // of columns, which stay in the cache
  for (std::ptrdiff_t begin = 0; begin < columns; begin += chunk) {
    const std::ptrdiff_t end = begin + chunk < columns ? begin + chunk : columns;
    for (std::ptrdiff_t j = 0; j < rows; j += at_once)
      for (std::ptrdiff_t i = j / 8 * 8; i < rows; i += 8) {
        vector sum[at_once][vectors];
        for (int q = 0; q < at_once; ++q)
          for (int v = 0; v < vectors; ++v)
            sum[q][v] = *reinterpret_cast<const vector*>(sums + (j + q) * rows + i + v * lane_count);
        for (std::ptrdiff_t k = begin; k < end; ++k)
          for (int v = 0; v < vectors; ++v) {
            const vector of_a = *reinterpret_cast<const vector*>(a + k * rows + i + v * lane_count);
            for (int q = 0; q < at_once; ++q) sum[q][v] = sum[q][v] + of_a * b[k * rows + j + q];
          }
        for (int q = 0; q < at_once; ++q)
          for (int v = 0; v < vectors; ++v)
            *reinterpret_cast<vector*>(sums + (j + q) * rows + i + v * lane_count) = sum[q][v];
      }
  }
}

}  // namespace rabiline::RABILINE_ISA

#endif
