#include "particle/law_tables.hpp"
#include "core/portable_math.hpp"

#include <cmath>
#include <numbers>

namespace rabiline {
namespace {

/// The density of theta behind a channel, 2 j(theta) sin(theta) cos(theta)/W, on 2048 cells on either side of
/// its edge; less than 1e-5 in total variation.
SampledTable angle_table(const ChannelFlow& flow) {
  constexpr int cells = 2048;  // on either side
  const double edge = portable::atan(flow.edge_tangent()), last = std::numbers::pi / 2;
  std::vector<double> at, density;
  for (int i = 0; i < 2 * cells; ++i) {
    const double theta =
        i < cells ? edge * i / cells : std::lerp(edge, last, static_cast<double>(i - cells) / cells);
    at.push_back(theta);
    density.push_back(flow.angular(portable::tan(theta)) * portable::sin(2 * theta));
  }
  at.push_back(last);
  density.push_back(0);
  return {std::move(at), std::move(density)};
}

}  // namespace

SampledTable::SampledTable(std::vector<double> at, std::vector<double> density)
    : at_(std::move(at)), density_(std::move(density)) {
  std::vector<double> shares;
  for (std::size_t i = 0; i + 1 < at_.size(); ++i)
    shares.push_back((at_[i + 1] - at_[i]) * (density_[i] + density_[i + 1]));
  accumulate(shares);
}

SampledTable SampledTable::of_lines(const std::vector<double>& values, const std::vector<double>& weights) {
  SampledTable table;
  table.at_ = values;
  table.accumulate(weights);
  return table;
}

void SampledTable::accumulate(const std::vector<double>& shares) {
  cumulative_.assign(1, 0.0);
  for (const double share : shares) cumulative_.push_back(cumulative_.back() + share);
  const double all = cumulative_.back();
  for (double& c : cumulative_) c /= all;
  cumulative_.back() = 1;
  int cell = 0;
  for (int k = 0; k < SampledLaw::guides; ++k) {
    while (cumulative_[static_cast<std::size_t>(cell) + 1] < static_cast<double>(k) / SampledLaw::guides)
      ++cell;
    guide_.push_back(cell);
  }
}

SampledLaw SampledTable::law() const {
  return {at_.data(), density_.empty() ? nullptr : density_.data(), cumulative_.data(), guide_.data(),
          static_cast<int>(cumulative_.size()) - 1};
}

ChannelTables::ChannelTables(double length_over_radius) : ChannelTables(ChannelFlow(length_over_radius)) {}

ChannelTables::ChannelTables(const ChannelFlow& flow)
    : transmission(flow.transmission()), angles(angle_table(flow)), edge(flow.edge_tangent()) {
  constexpr int cells = 4096;
  for (int i = 0; i <= cells; ++i) {
    const double p = static_cast<double>(i) / cells;
    inside.push_back(flow.angular(p * edge));
    outside.push_back(i == 0 ? 0.0 : flow.angular(edge / p));
  }
  outside[0] = 2 * outside[1] - outside[2];
}

ChannelShape ChannelTables::shape() const {
  return {inside.data(), outside.data(), static_cast<int>(inside.size()) - 1, edge};
}

SampledLaw LawTables::sampled(std::string_view kind, const std::vector<double>& numbers,
                              const std::function<SampledTable()>& make) {
  auto found = sampled_.find({kind, numbers});
  if (found == sampled_.end()) found = sampled_.emplace(std::pair(kind, numbers), make()).first;
  return found->second.law();
}

const ChannelTables& LawTables::channel(double length_over_radius) {
  return channels_.try_emplace(length_over_radius, length_over_radius).first->second;
}

}  // namespace rabiline
