#include "plan/sampled_tables.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <numbers>
#include <stdexcept>

#include "core/portable_math.hpp"

namespace rabiline {

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

SampledTable supersonic_table(double s) {
  constexpr int cells = 4096;
  const double low = std::max(0.0, 1 - 6.2 / s), high = 1 + 7.5 / s;
  std::vector<double> at, density;
  for (int i = 0; i <= cells; ++i) {
    const double y = std::lerp(low, high, static_cast<double>(i) / cells);
    at.push_back(y);
    density.push_back(y * y * y * portable::exp(-s * s * (y - 1) * (y - 1)));
  }
  return {std::move(at), std::move(density)};
}

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

const SampledTable& SampledTables::supersonic(double speed_ratio) {
  auto found = supersonic_.find(speed_ratio);
  if (found == supersonic_.end())
    found = supersonic_.emplace(speed_ratio, supersonic_table(speed_ratio)).first;
  return found->second;
}

const SampledTable& SampledTables::spectrum(const std::shared_ptr<const Spectrum>& spectrum) {
  auto found = spectra_.find(spectrum);
  if (found == spectra_.end())
    found = spectra_.emplace(spectrum, SampledTable(spectrum->at, spectrum->flux)).first;
  return found->second;
}

const SampledTable& SampledTables::lines(const std::vector<double>& speeds,
                                         const std::vector<double>& weights) {
  std::vector<double> key = speeds;
  key.insert(key.end(), weights.begin(), weights.end());
  auto found = lines_.find(key);
  if (found == lines_.end()) found = lines_.emplace(key, SampledTable::of_lines(speeds, weights)).first;
  return found->second;
}

const ChannelTables& SampledTables::channel(double length_over_radius) {
  return channels_.try_emplace(length_over_radius, length_over_radius).first->second;
}

const TransitionTable& SampledTables::transitions(const Structure& structure,
                                                  const std::vector<LevelZone>& zones, double from,
                                                  double to) {
  const auto found = std::find_if(driven_.begin(), driven_.end(), [&](const Driven& d) {
    return d.from == from && d.to == to && d.structure == structure && d.zones == zones;
  });
  if (found != driven_.end()) return found->table;
  driven_.push_back({structure, zones, from, to, {}});
  return driven_.back().table;
}

const SampledTables::Driven& SampledTables::driven_by(const TransitionTable* table) const {
  const auto found =
      std::find_if(driven_.begin(), driven_.end(), [&](const Driven& d) { return &d.table == table; });
  if (found == driven_.end()) throw std::invalid_argument("a table of transitions of another plan");
  return *found;
}

void SampledTables::tabulate_transitions(int threads) {
  std::vector<Driven*> open;
  for (Driven& driven : driven_)
    if (driven.table.points == 0) open.push_back(&driven);
  std::exception_ptr error;
  const int workers = threads > 0 ? threads : omp_get_max_threads();
#pragma omp parallel for schedule(dynamic) num_threads(workers)
  for (std::size_t i = 0; i < open.size(); ++i) {
    try {
      Driven& d = *open[i];
      const DrivenLevels driven(coupled_spins(d.structure), d.zones, d.to);
      d.table = tabulate(driven, d.from, d.to, transition_tolerance);
      d.neglected = driven.neglected();
    } catch (...) {
#pragma omp critical
      error = std::current_exception();
    }
  }
  if (error) std::rethrow_exception(error);
}

const MomentTable& SampledTables::moments(const Structure& structure) {
  const auto found = std::find_if(moments_.begin(), moments_.end(),
                                  [&](const auto& entry) { return entry.first == structure; });
  if (found != moments_.end()) return found->second;
  return moments_.emplace_back(structure, MomentTable(coupled_spins(structure))).second;
}

}  // namespace rabiline
