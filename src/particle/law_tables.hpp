#pragma once
// Tables that sources draw from, made once however many scan points and species use them.
#include <functional>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "particle/channel.hpp"
#include "particle/draw.hpp"

namespace rabiline {

/// Owns the columns of a SampledLaw.
class SampledTable {
 public:
  /// A density that is linear between rising points; it need not be normalised. Drawing from it is exact.
  SampledTable(std::vector<double> at, std::vector<double> density);
  /// Discrete values with their weights.
  static SampledTable of_lines(const std::vector<double>& values, const std::vector<double>& weights);
  SampledLaw law() const;

 private:
  SampledTable() = default;
  void accumulate(const std::vector<double>& shares);
  std::vector<double> at_, density_, cumulative_;
  std::vector<int> guide_;
};

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

/// Each table once, at an address that stays.
class LawTables {
 public:
  /// The table of a kind of law that follows from these numbers.
  SampledLaw sampled(std::string_view kind, const std::vector<double>& numbers,
                     const std::function<SampledTable()>& make);
  const ChannelTables& channel(double length_over_radius);

 private:
  std::map<std::pair<std::string_view, std::vector<double>>, SampledTable> sampled_;
  std::map<double, ChannelTables> channels_;
};

}  // namespace rabiline
