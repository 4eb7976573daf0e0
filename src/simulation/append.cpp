#include "simulation/append.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "particle/fate.hpp"

namespace rabiline {
namespace {

// What a result has for each point; each list in one place, whatever is done with it. Totals stay when the
// rest is dropped.
constexpr auto totals_of_result = std::tuple{&Result::emitted};
constexpr auto rest_of_result = std::tuple{&Result::aimed_fraction, &Result::emitted_quanta_high,
                                           &Result::emitted_quanta_low, &Result::emitted_by_level};
constexpr auto totals_of_detector = std::tuple{&DetectorResult::detected, &DetectorResult::detected_errors};
constexpr auto rest_of_detector =
    std::tuple{&DetectorResult::offset_x,        &DetectorResult::offset_z,
               &DetectorResult::counts,          &DetectorResult::counts_errors,
               &DetectorResult::counts_x,        &DetectorResult::counts_x_errors,
               &DetectorResult::counts_z,        &DetectorResult::counts_z_errors,
               &DetectorResult::detected_of_all, &DetectorResult::detected_of_all_errors,
               &DetectorResult::levels,          &DetectorResult::levels_errors,
               &DetectorResult::count_rate,      &DetectorResult::count_rate_errors};
constexpr auto of_monitor = std::tuple{&MonitorResult::passed, &MonitorResult::passed_errors};
constexpr auto of_tally = std::tuple{&TallyResult::counts, &TallyResult::counts_errors, &TallyResult::outside,
                                     &TallyResult::outside_errors};
constexpr auto of_axis = std::tuple{&TallyAxisResult::mean, &TallyAxisResult::mean_errors,
                                    &TallyAxisResult::deviation, &TallyAxisResult::deviation_errors};
constexpr auto of_fate = std::tuple{&FateResult::quanta_high, &FateResult::quanta_low, &FateResult::particles,
                                    &FateResult::by_level};

template <class T, class Columns>
void append_columns(T& from, T& to, const Columns& columns) {
  const auto move_behind = [](auto& more, auto& all) {
    all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  std::apply([&](auto... column) { (move_behind(from.*column, to.*column), ...); }, columns);
}

template <class T, class Columns>
void drop_columns(T& from, const Columns& columns) {
  std::apply([&](auto... column) { ((from.*column = {}), ...); }, columns);
}

/// One text stands for all points where they agree.
void append_texts(std::vector<std::string>& from, std::size_t more, std::vector<std::string>& to,
                  std::size_t points) {
  if (from.size() == 1 && from == to) return;
  if (to.size() == 1) to.resize(points, to.front());
  if (from.size() == 1) from.resize(more, from.front());
  std::ranges::move(from, std::back_inserter(to));
}

void require(bool alike) {
  if (!alike) throw std::logic_error("slabs of one scan have results of different shapes");
}
/// Calls it with each of some and what stands at the same place of others.
template <class T, class Append>
void append_each(std::vector<T>& from, std::vector<T>& to, Append append_one) {
  require(from.size() == to.size());
  for (std::size_t i = 0; i < from.size(); ++i) append_one(from[i], to[i]);
}

}  // namespace

void append(Result&& points, Result& all) {
  if (all.emitted.empty()) {
    all = std::move(points);
    return;
  }
  require(points.ledger_levels == all.ledger_levels);
  const std::size_t before = all.emitted.size(), more = points.emitted.size();
  append_texts(points.laws, more, all.laws, before);
  append_texts(points.species, more, all.species, before);
  append_columns(points, all, totals_of_result);
  append_columns(points, all, rest_of_result);
  append_each(points.detectors, all.detectors, [](DetectorResult& from, DetectorResult& to) {
    require(from.level_labels == to.level_labels && to.detected_covariance.empty());
    append_columns(from, to, totals_of_detector);
    append_columns(from, to, rest_of_detector);
  });
  append_each(points.monitors, all.monitors, [](MonitorResult& from, MonitorResult& to) {
    require(to.passed_covariance.empty());
    append_columns(from, to, of_monitor);
  });
  append_each(points.tallies, all.tallies, [](TallyResult& from, TallyResult& to) {
    append_columns(from, to, of_tally);
    append_each(from.axes, to.axes,
                [](TallyAxisResult& a, TallyAxisResult& b) { append_columns(a, b, of_axis); });
  });
  append_each(points.fates, all.fates, [](FateResult& from, FateResult& to) {
    require(from.fate == to.fate && from.where == to.where);
    append_columns(from, to, of_fate);
  });
}

void keep_totals(Result& points) {
  drop_columns(points, rest_of_result);
  for (DetectorResult& detector : points.detectors) drop_columns(detector, rest_of_detector);
  for (MonitorResult& monitor : points.monitors) drop_columns(monitor, of_monitor);
  for (TallyResult& tally : points.tallies) {
    drop_columns(tally, of_tally);
    for (TallyAxisResult& axis : tally.axes) drop_columns(axis, of_axis);
  }
  for (FateResult& line : points.fates) {
    std::vector<double> particles = std::move(line.particles);
    drop_columns(line, of_fate);
    if (line.fate == fate::overflowed) line.particles = std::move(particles);
  }
}

}  // namespace rabiline
