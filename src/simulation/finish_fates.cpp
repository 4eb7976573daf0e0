#include "simulation/finish_fates.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

#include "particle/fate.hpp"
#include "section/section.hpp"
#include "simulation/counting.hpp"

namespace rabiline {
namespace {

class FateFinisher {
 public:
  FateFinisher(const Summed& run, Result& result)
      : run_(run), result_(result), points_(run.experiment.points.size()) {}

  void finish() {
    name_ledger_columns();
    const std::size_t levels = result_.ledger_levels.size();
    std::vector<Sum> left(points_ * levels);
    std::vector<bool> has_ledger(points_ * levels);
    for (const PlanTree& tree : run_.plan.trees)
      for (const int p : tree.points)
        for (std::size_t level = 0; level < tree.ledger_levels; ++level) {
          const std::size_t at = ledger_place(p, tree.component, level);
          left[at] += run_.sums[tree.ledger + level];
          has_ledger[at] = true;
        }
    const auto shown = [&](const std::vector<Sum>& sums) {
      std::vector<double> out;
      for (std::size_t at = 0; at < sums.size(); ++at)
        out.push_back(has_ledger[at] ? particles(sums[at]) : std::numeric_limits<double>::quiet_NaN());
      return out;
    };
    result_.emitted_by_level = shown(left);
    std::map<std::pair<std::string, std::string>, LedgerRow> ledger;
    for (const FateTally& tally : run_.tallies.fates)
      for (const int p : *tally.points) {
        const auto point = static_cast<std::size_t>(p);
        const std::string where = tally.part == chamber_number ? "chamber"
                                  : tally.part == no_part      ? ""
                                                               : run_.parts.name(tally.part, point);
        LedgerRow& row = ledger[{std::string(tally.fate), where}];
        row.all.resize(points_);
        row.by_level.resize(points_ * levels);
        row.all[point] += run_.sums[tally.at];
        for (std::size_t level = 0; tally.ledger != 0 && level < tally.levels; ++level) {
          const std::size_t at = ledger_place(p, tally.component, level);
          const Sum q = run_.sums[tally.ledger + (tally.fate == fate::detected ? LedgerSums::caught(level)
                                                                               : LedgerSums::ended(level))];
          row.by_level[at] += q;
          left[at] -= q;
        }
      }
    for (const auto& [key, row] : ledger) {
      FateResult ended{key.first, key.second, {}, {}, {}, shown(row.by_level)};
      for (const Sum q : row.all) {
        ended.quanta_high.push_back(static_cast<std::uint64_t>(q >> 64));
        ended.quanta_low.push_back(static_cast<std::uint64_t>(q));
        ended.particles.push_back(particles(q));
      }
      result_.fates.push_back(std::move(ended));
    }
    for (std::size_t p = 0; p < points_; ++p) {
      Sum all = 0;
      for (const auto& [key, row] : ledger) all += row.all[p];
      if (all != run_.emitted[p].q)
        throw std::logic_error(
            fmt::format("the fates of scan point {} do not add up to what was emitted", p));
    }
    if (std::any_of(left.begin(), left.end(), [](Sum q) { return q != 0; }))
      throw std::logic_error(
          "the fates of the particles prepared in a level do not add up to what was emitted");
  }

 private:
  struct LedgerRow {
    std::vector<Sum> all, by_level;  // [points], [points][levels]
  };

  /// One column of the ledger by level for every label that occurs.
  void name_ledger_columns() {
    using Levels = std::tuple<std::string, int, int, std::size_t>;  // species, I, J, how many
    std::map<std::pair<int, Levels>, std::vector<std::size_t>> known;
    ledger_columns_.resize(points_);
    for (const PlanTree& tree : run_.plan.trees)
      for (const int p : tree.points) {
        if (tree.ledger_levels == 0) continue;
        const Beamline& beamline = run_.experiment.points[static_cast<std::size_t>(p)];
        const Species& species = beamline.species[static_cast<std::size_t>(tree.component)].species;
        const Levels key{species.name, species.structure ? species.structure->i.twice : -1,
                         species.spin.twice, tree.ledger_levels};
        std::vector<std::size_t>& columns = known[{tree.component, key}];
        if (columns.empty())
          for (const std::string& label :
               labels_of(beamline, tree.component, static_cast<int>(tree.ledger_levels)))
            columns.push_back(ledger_column(label));
        ledger_columns_[static_cast<std::size_t>(p)][tree.component] = columns;
      }
  }
  std::size_t ledger_column(const std::string& label) {
    const auto found = std::find(result_.ledger_levels.begin(), result_.ledger_levels.end(), label);
    if (found == result_.ledger_levels.end()) {
      result_.ledger_levels.push_back(label);
      return result_.ledger_levels.size() - 1;
    }
    return static_cast<std::size_t>(found - result_.ledger_levels.begin());
  }
  std::size_t ledger_place(int point, int component, std::size_t level) const {
    const auto p = static_cast<std::size_t>(point);
    return p * result_.ledger_levels.size() + ledger_columns_[p].at(component)[level];
  }

  const Summed& run_;
  Result& result_;
  const std::size_t points_;
  std::vector<std::map<int, std::vector<std::size_t>>> ledger_columns_;  // [points]: component, [levels]
};

}  // namespace

void finish_fates(const Summed& run, Result& result) { FateFinisher(run, result).finish(); }

}  // namespace rabiline
