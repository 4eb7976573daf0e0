#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "simulation/snapshot.hpp"

namespace rabiline {
namespace {

[[noreturn]] void refuse(const std::string& why) { throw std::invalid_argument(why); }

void add_sums(Snapshot& to, const Snapshot& from) {
  to.sums = added(to.sums, from.sums);
  to.stragglers.insert(to.stragglers.end(), from.stragglers.begin(), from.stragglers.end());
  to.seconds += from.seconds;
  to.begun = std::min(to.begun, from.begun);
}

Sum sum_at(const KeptSums& sums, std::size_t i) {
  return (static_cast<Sum>(sums.high[i]) << 64) | sums.low[i];
}

void append(KeptSums& to, std::uint64_t at, Sum sum) {
  to.at.push_back(at);
  to.high.push_back(static_cast<std::uint64_t>(sum >> 64));
  to.low.push_back(static_cast<std::uint64_t>(sum));
}

}  // namespace

KeptSums kept(const Sums& sums) {
  KeptSums out{sums.size()};
  for (std::size_t i = 0; i < sums.size(); ++i)
    if (sums[i] != 0) append(out, i, sums[i]);
  return out;
}

Sums sums_of(const KeptSums& kept) {
  Sums out(kept.size);
  for (std::size_t i = 0; i < kept.at.size(); ++i) out[kept.at[i]] = sum_at(kept, i);
  return out;
}

KeptSums added(const KeptSums& a, const KeptSums& b) {
  KeptSums out{a.size};
  for (std::size_t i = 0, j = 0; i < a.at.size() || j < b.at.size();) {
    const bool in_a = i < a.at.size() && (j == b.at.size() || a.at[i] <= b.at[j]),
               in_b = j < b.at.size() && (i == a.at.size() || b.at[j] <= a.at[i]);
    append(out, in_a ? a.at[i] : b.at[j], (in_a ? sum_at(a, i) : 0) + (in_b ? sum_at(b, j) : 0));
    i += in_a ? 1 : 0;
    j += in_b ? 1 : 0;
  }
  return out;
}

void Merger::add(const std::string& name, Snapshot shard) {
  const Shard which = shard.shard;
  constexpr std::uint64_t most_shards = 1 << 20;
  if (which.of > most_shards)
    refuse(fmt::format("{}: is one of {} shards, more than a run can have", name, which.of));
  if (which.is_whole())
    refuse(fmt::format(
        "{}: is of a run in one piece, not a shard of it\n  help: finish it with `rabiline resume`", name));
  const auto [begin, end] = which.places(shard.particles);
  const auto all = begin == end ? decltype(shard.finished){} : decltype(shard.finished){{begin, end}};
  if (shard.finished != all)
    refuse(fmt::format(
        "{}: shard {}/{} is not finished ({:.1f} % are)\n  help: continue it with `rabiline resume`", name,
        which.number, which.of, 100 * shard.done()));
  if (names_.empty()) {
    names_.resize(which.of);
    names_[which.number - 1] = name;
    sum_ = std::move(shard);
    return;
  }
  const std::string& first =
      *std::find_if(names_.begin(), names_.end(), [](const auto& n) { return !n.empty(); });
  if (shard.fingerprint != sum_.fingerprint || shard.transit != sum_.transit ||
      shard.particles != sum_.particles || shard.sums.size != sum_.sums.size)
    refuse(fmt::format("{}: is a shard of another run than {}\n  help: omit it", name, first));
  if (which.of != sum_.shard.of)
    refuse(fmt::format("{}: is one of {} shards, and {} one of {}", name, which.of, first, sum_.shard.of));
  std::string& place = names_[which.number - 1];
  if (!place.empty())
    refuse(fmt::format("{} and {} are both shard {}/{}\n  help: omit one of them", place, name, which.number,
                       which.of));
  place = name;
  add_sums(sum_, shard);
}

Snapshot Merger::finish() {
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (names_[i].empty()) missing.push_back(i + 1);
  if (!missing.empty())
    refuse(fmt::format("of the {} shards these are missing: {}\n  help: fly them with `--shard {}/{}`",
                       names_.size(), fmt::join(missing, ", "), missing.front(), names_.size()));
  sum_.shard = {};
  sum_.finished.clear();
  if (sum_.particles > 0) sum_.finished = {{0, sum_.particles}};
  std::sort(sum_.stragglers.begin(), sum_.stragglers.end());
  sum_.stragglers.erase(std::unique(sum_.stragglers.begin(), sum_.stragglers.end()), sum_.stragglers.end());
  return std::move(sum_);
}

}  // namespace rabiline
