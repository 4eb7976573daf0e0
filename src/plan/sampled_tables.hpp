#pragma once
// Tables that kernels read, made once for a plan however many scan points and species use them.
#include <list>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "particle/channel.hpp"
#include "particle/species.hpp"
#include "particle/speed.hpp"
#include "spin/moment_table.hpp"
#include "spin/transition_table.hpp"
#include "transport/kernels.hpp"

namespace rabiline {

/// Owns the columns of a SampledLaw.
class SampledTable {
 public:
  /// A density that is linear between rising points; it need not be normalised. Drawing from it is exact.
  SampledTable(std::vector<double> at, std::vector<double> density);
  /// Sharp values with their weights.
  static SampledTable of_lines(const std::vector<double>& values, const std::vector<double>& weights);
  SampledLaw law() const;

 private:
  SampledTable() = default;
  void accumulate(const std::vector<double>& shares);
  std::vector<double> at_, density_, cumulative_;
  std::vector<int> guide_;
};

/// y^3 exp(-S^2 (y-1)^2), y = v/u, on 4096 cells over all y where it is above 1e-16 of its maximum. What is
/// drawn differs from the law by less than 1e-5 in total variation.
SampledTable supersonic_table(double speed_ratio);
/// The density of theta behind a channel, 2 j(theta) sin(theta) cos(theta)/W, on 2048 cells on either side of
/// its edge; less than 1e-5 in total variation.
SampledTable angle_table(const ChannelFlow&);

/// Everything known about one channel.
struct ChannelTables {
  explicit ChannelTables(double length_over_radius);
  double transmission;
  SampledTable angles;
  std::vector<double> inside, outside;
  double edge;
  ChannelShape shape() const;

 private:
  explicit ChannelTables(const ChannelFlow&);
};

/// Of the probabilities in a table of transitions, where no more points than 2^14 are needed.
inline constexpr double transition_tolerance = 1e-5;

/// Each table once, at an address that stays.
class SampledTables {
 public:
  const SampledTable& supersonic(double speed_ratio);
  const SampledTable& spectrum(const std::shared_ptr<const Spectrum>&);
  const SampledTable& lines(const std::vector<double>& speeds, const std::vector<double>& weights);
  const ChannelTables& channel(double length_over_radius);
  /// Transitions along driven zones, filled in by tabulate_transitions().
  const TransitionTable& transitions(const Structure&, const std::vector<LevelZone>&, double from, double to);
  /// A table of transitions with what it was made for.
  struct Driven {
    Structure structure;
    std::vector<LevelZone> zones;
    double from = 0, to = 0;  // [s/m]
    TransitionTable table{};
    double neglected = 0;  // DrivenLevels::neglected()
  };
  /// The one that a stage has the table of; it must be of these tables.
  const Driven& driven_by(const TransitionTable*) const;
  /// Works out the tables that were asked for, on so many threads; 0: on all cores.
  void tabulate_transitions(int threads);
  const MomentTable& moments(const Structure&);

 private:
  std::map<double, SampledTable> supersonic_;
  std::map<std::shared_ptr<const Spectrum>, SampledTable> spectra_;
  std::map<std::vector<double>, SampledTable> lines_;
  std::map<double, ChannelTables> channels_;
  std::list<Driven> driven_;
  std::list<std::pair<Structure, MomentTable>> moments_;
};

}  // namespace rabiline
