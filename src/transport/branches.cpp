#include "transport/branches.hpp"

#include <algorithm>
#include <utility>

namespace rabiline {
namespace {

constexpr std::uint64_t yes = ~std::uint64_t{0};

/// Particles of one batch, by their numbers in it, become the first ones of another; column by column, so
/// that each is read and written at once.
void gather_particles(const BatchView& from, const std::uint16_t* numbers, int count, const BatchView& to) {
  const auto copy = [&](const auto* source, auto* target) {
    for (int i = 0; i < count; ++i) target[i] = source[numbers[i]];
  };
  for (const auto column : real_columns) copy(from.*column, to.*column);
  for (const auto column : word_columns) copy(from.*column, to.*column);
}

}  // namespace

// ---- paths ----

void Branches::fly(const Batch& batch, const UnitVector& axis, const std::vector<ChainLink>& chain,
                   const std::vector<std::uint64_t>& reachable, Isa isa, const RandomKey& key,
                   const TransitLayout* layout) {
  axis_ = axis;
  chain_ = chain;
  isa_ = isa;
  key_ = key;
  std::size_t most = 0;
  std::uint64_t levels = 0;
  for (const ChainLink& link : chain) most = std::max(most, sums_needed(*link.stage));
  unused_.assign(most, 0);
  for (const std::uint64_t mask : reachable) levels |= mask;
  paths_.levels.clear();
  for (int level = 0; level < most_levels; ++level)
    if ((levels >> level & 1) != 0) paths_.levels.push_back(level);
  paths_.ends.resize(paths_.levels.size());
  paths_.levels_stay = true;
  tallies_.clear();
  sees_all_ = false;
  for (const ChainLink& link : chain) {
    const StageTraits& traits = traits_of(*link.stage);
    tallies_.push_back(tally_paths(*link.stage));
    sees_all_ = sees_all_ || (traits.only_reads && reads_catch_of(*link.stage) == no_part);
    paths_.levels_stay = paths_.levels_stay && traits.spins != SpinEffect::set;
  }
  for (std::size_t path = 0; path < paths_.levels.size(); ++path) fly_on(path, batch, reachable);
  keep_undecided(batch, layout);
  find_stops();
  for (std::size_t link = 0; link < chain.size(); ++link)
    if (tallies_[link]) tallies_[link]->gather(paths_, link, isa);
}

/// Particles that may be found in a level, one after the other, in that level.
void Branches::gather(const Batch& batch, int level, const std::vector<std::uint64_t>& reachable) {
  const BatchView& from = batch.view();
  BatchView& to = flown_.view();
  to.y = from.y;
  to.fall = from.fall;
  int count = 0;
  for (int i = 0; i < from.count; ++i) {
    if (from.flying[i] == 0 || (reachable[from.level[i]] >> level & 1) == 0) continue;
    flown_number_[number(count++)] = static_cast<std::uint16_t>(i);
  }
  gather_particles(from, flown_number_.data(), count, to);
  to.count = count;
  to.padded = (count + 7) / 8 * 8;
  for (const auto column : real_columns) std::fill(to.*column + count, to.*column + to.padded, 0.0);
  for (const auto column : word_columns) std::fill(to.*column + count, to.*column + to.padded, 0);
  std::fill(to.vy + count, to.vy + to.padded, 1.0);
  std::fill(to.slowness + count, to.slowness + to.padded, 1.0);
  std::fill_n(to.caught_by, to.padded, 0);
  std::fill_n(to.level, to.padded, static_cast<std::uint64_t>(level));
  std::fill_n(to.sx, to.padded, axis_.x);
  std::fill_n(to.sy, to.padded, axis_.y);
  std::fill_n(to.sz, to.padded, axis_.z);
}

void Branches::fly_on(std::size_t path, const Batch& batch, const std::vector<std::uint64_t>& reachable) {
  PathEnds& ends = paths_.ends[path];
  ends.link.fill(PathEnds::not_flown);
  gather(batch, paths_.levels[path], reachable);
  const BatchView& b = flown_.view();
  std::array<std::uint64_t, capacity> flying;
  StageContext context{isa_, key_, flown_, unused_.data()};
  for (std::size_t k = 0; k < chain_.size(); ++k) {
    if (traits_of(*chain_[k].stage).only_reads) {
      if (tallies_[k]) tallies_[k]->see(path, context, flown_number_.data());
      continue;
    }
    std::copy_n(b.flying, b.count, flying.begin());
    advance(*chain_[k].stage, context);
    for (std::size_t n = 0; n < number(b.count); ++n) {
      if (flying[n] == 0 || b.flying[n] != 0) continue;
      const std::size_t i = flown_number_[n];
      ends.link[i] = static_cast<std::uint16_t>(k);
      ends.level[i] = static_cast<std::uint8_t>(b.level[n]);
      ends.bin[i] = b.caught_by[n] != 0 ? static_cast<std::uint32_t>(b.scratch[n]) : PathEnds::not_caught;
    }
  }
}

/// Particles that end alike in every level, and are not counted by a screen, are decided. The others are put
/// together by the level that they were prepared in.
void Branches::keep_undecided(const Batch& batch, const TransitLayout* layout) {
  const BatchView& from = batch.view();
  decided_.assign(chain_.size() * most_levels, 0);
  std::array<std::vector<int>, most_levels> undecided;
  in_cells_.clear();
  for (int i = 0; i < from.count; ++i) {
    if (from.flying[i] == 0) continue;
    const std::size_t at = number(i);
    const PathEnds& first = *std::find_if(paths_.ends.begin(), paths_.ends.end(), [&](const PathEnds& e) {
      return e.link[at] != PathEnds::not_flown;
    });
    const bool alike = std::all_of(paths_.ends.begin(), paths_.ends.end(), [&](const PathEnds& e) {
      return e.link[at] == PathEnds::not_flown ||
             (e.link[at] == first.link[at] && e.bin[at] == PathEnds::not_caught);
    });
    if (alike && !sees_all_)
      decided_[std::size_t{first.link[at]} * most_levels + from.prepared[i]] += from.weight[i];
    else if (layout != nullptr && layout->cells().contains(from.slowness[i]))
      in_cells_.push_back(i);
    else
      undecided[from.prepared[i]].push_back(i);
  }
  BatchView& to = paths_.asked.view();
  to.y = from.y;
  to.fall = from.fall;
  to.count = 0;
  paths_.groups.clear();
  for (std::size_t prepared = 0; prepared < most_levels; ++prepared) {
    if (undecided[prepared].empty()) continue;
    const int begin = to.count;
    for (const int i : undecided[prepared]) paths_.number[number(to.count++)] = static_cast<std::uint16_t>(i);
    paths_.groups.push_back({begin, to.count, prepared});
  }
  // Whole lanes: what fills them up weighs nothing.
  to.padded = (to.count + 7) / 8 * 8;
  for (int i = to.count; i < to.padded; ++i) paths_.number[number(i)] = paths_.number[0];
  gather_particles(from, paths_.number.data(), to.padded, to);
  std::fill(to.weight + to.count, to.weight + to.padded, 0);
}

void Branches::find_stops() {
  stops_.clear();
  for (std::size_t path = 0; path < paths_.levels.size(); ++path) {
    const std::size_t known = stops_.size();
    for (std::size_t k = 0; k < paths_.count(); ++k) {
      const std::size_t at = paths_.number[k], link = paths_.ends[path].link[at];
      if (link == PathEnds::not_flown || paths_.ends[path].bin[at] != PathEnds::not_caught) continue;
      auto stop = std::find_if(stops_.begin() + static_cast<std::ptrdiff_t>(known), stops_.end(),
                               [&](const Stop& s) { return s.link == link; });
      if (stop == stops_.end())
        stop = stops_.insert(stops_.end(), {path, link, std::vector<std::uint64_t>(paths_.padded())});
      stop->mask[k] = yes;
    }
  }
  for (Stop& stop : stops_)
    for (const PreparedGroup& group : paths_.groups)
      if (std::any_of(stop.mask.begin() + group.begin, stop.mask.begin() + group.end,
                      [](std::uint64_t mask) { return mask != 0; }))
        stop.groups.push_back(group);
}

// ---- all sets of weights ----

bool Branches::book_moments(const TransitLayout& layout, const Batch& batch, MomentBuffer& moments,
                            Sum* sums) {
  transits_.add(layout, paths_, tallies_, batch.view(), in_cells_, isa_, moments);
  for (std::size_t k = 0; k < chain_.size(); ++k)
    for (std::size_t from = 0; from < layout.levels(); ++from)
      sums[layout.decided(k, from)] += std::exchange(decided_[k * most_levels + from], 0);
  return paths_.asked.view().count == 0;
}

// ---- one set of weights ----

void Branches::book(const SpinPath& projection, Sum* sums, std::size_t shift) {
  sums += shift;
  const BatchView& asked = paths_.asked.view();
  if (asked.count > 0) {
    share_levels(projection, key_, isa_, asked, asked.weight, shares_.data());
    PathWeights weights;
    weights.shares = shares_.data();
    for (std::size_t path = 0; path < paths_.levels.size(); ++path)
      weights.of[path] = shares_.data() + number(paths_.levels[path]) * paths_.padded();
    book_stops(sums);
    book_tallies(weights, sums);
  }
  book_decided(sums);
}

/// Weights of a batch add up to less than 2^64.
void Branches::book_stops(Sum* sums) const {
  for (const Stop& stop : stops_) {
    const std::uint64_t* shares = &shares_[number(paths_.levels[stop.path]) * paths_.padded()];
    const ChainLink& link = chain_[stop.link];
    for (const PreparedGroup& group : stop.groups) {
      std::uint64_t q = 0;
      for (int i = group.begin; i < group.end; ++i) q += shares[i] & stop.mask[number(i)];
      sums[link.sums] += q;
      if (link.ledger != 0) sums[link.ledger + 2 * group.prepared + 1] += q;
    }
  }
}

void Branches::book_decided(Sum* sums) const {
  for (std::size_t k = 0; k < chain_.size(); ++k)
    for (std::size_t level = 0; level < most_levels; ++level) {
      const std::uint64_t q = decided_[k * most_levels + level];
      if (q == 0) continue;
      sums[chain_[k].sums] += q;
      if (chain_[k].ledger != 0) sums[chain_[k].ledger + 2 * level + 1] += q;
    }
}

/// What reads the catch of a screen follows that screen at once.
void Branches::book_tallies(const PathWeights& weights, Sum* sums) {
  const auto add = [&](std::size_t link, const PathWeights& of) {
    Sum* ledger = chain_[link].ledger != 0 ? sums + chain_[link].ledger : nullptr;
    tallies_[link]->add(paths_, of, sums + chain_[link].sums, ledger);
  };
  for (std::size_t k = 0; k < chain_.size(); ++k) {
    if (!tallies_[k] || reads_catch_of(*chain_[k].stage) != no_part) continue;
    add(k, weights);
    const int part = catches(*chain_[k].stage);
    for (std::size_t reader = k + 1; part != no_part && reader < chain_.size(); ++reader)
      if (reads_catch_of(*chain_[reader].stage) == part) add(reader, *tallies_[k]->caught());
  }
}

}  // namespace rabiline
