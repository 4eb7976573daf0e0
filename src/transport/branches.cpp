#include "transport/branches.hpp"

#include <algorithm>
#include <cmath>

namespace rabiline {
namespace {

const Screen* screen_of(const ChainLink& link) {
  const auto* score = std::get_if<Score>(link.stage);
  return score != nullptr ? &score->screen : nullptr;
}

}  // namespace

bool can_be_booked(const Stage& stage) {
  if (const auto* stretch = std::get_if<SpinStretch>(&stage))
    return stretch->zones.empty() && stretch->transitions == nullptr;
  return std::holds_alternative<Drift>(stage) || std::holds_alternative<Passage>(stage) ||
         std::holds_alternative<LevelProjection>(stage) || std::holds_alternative<Deflection>(stage) ||
         std::holds_alternative<Steering>(stage) || std::holds_alternative<Score>(stage) ||
         std::holds_alternative<Exit>(stage);
}

void Branches::fly(const Batch& batch, const std::vector<ChainLink>& chain, std::uint64_t levels,
                   const Kernels& kernels, const RandomKey& key) {
  chain_ = chain;
  kernels_ = &kernels;
  key_ = key;
  stretch_.assign(chain.size(), -1);
  std::size_t most = 0;
  for (std::size_t k = 0; k < chain.size(); ++k) {
    most = std::max(most, sums_needed(*chain[k].stage));
    const auto* stretch = std::get_if<SpinStretch>(chain[k].stage);
    for (std::size_t s = 0; stretch != nullptr && s < k; ++s)
      if (const Screen* screen = screen_of(chain[s]); screen != nullptr && screen->part == stretch->part)
        stretch_[s] = static_cast<int>(k);
  }
  unused_.assign(most, 0);
  levels_.clear();
  for (int level = 0; level < most_levels; ++level)
    if ((levels >> level & 1) != 0) levels_.push_back(level);
  ends_.resize(levels_.size());
  for (const int level : levels_) fly_in(level, batch);
  keep_undecided(batch);
}

void Branches::fly_in(int level, const Batch& batch) {
  Ends& ends =
      ends_[static_cast<std::size_t>(std::find(levels_.begin(), levels_.end(), level) - levels_.begin())];
  flown_.copy_from(batch);
  BatchView& b = flown_.view();
  std::fill_n(b.level, b.padded, static_cast<std::uint64_t>(level));
  std::fill_n(b.sx, b.padded, 0.0);
  std::fill_n(b.sy, b.padded, 0.0);
  std::fill_n(b.sz, b.padded, 1.0);
  std::array<std::uint64_t, capacity> flying;
  for (std::size_t k = 0; k < chain_.size(); ++k) {
    if (only_reads(*chain_[k].stage)) continue;
    std::copy_n(b.flying, b.count, flying.begin());
    Flight flight{*kernels_, key_, flown_, unused_.data()};
    advance(*chain_[k].stage, flight);
    const bool is_screen = screen_of(chain_[k]) != nullptr;
    for (std::size_t i = 0; i < static_cast<std::size_t>(b.count); ++i) {
      if (flying[i] == 0 || b.flying[i] != 0) continue;
      ends.link[i] = static_cast<std::uint16_t>(k);
      ends.level[i] = static_cast<std::uint8_t>(b.level[i]);
      ends.bin[i] = is_screen ? static_cast<std::uint32_t>(b.scratch[i]) : not_counted;
    }
  }
}

/// Particles that end alike in every level, and are not counted by a screen, are booked at once.
void Branches::keep_undecided(const Batch& batch) {
  const BatchView& from = batch.view();
  BatchView& to = asked_.view();
  decided_.assign(chain_.size(), 0);
  decided_by_level_.assign(chain_.size() * most_levels, 0);
  int kept = 0;
  for (int i = 0; i < from.count; ++i) {
    if (from.flying[i] == 0) continue;
    const auto at = static_cast<std::size_t>(i);
    const Ends& first = ends_.front();
    const bool alike = std::all_of(ends_.begin(), ends_.end(), [&](const Ends& e) {
      return e.link[at] == first.link[at] && e.bin[at] == not_counted;
    });
    if (alike) {
      decided_[first.link[at]] += from.weight[i];
      decided_by_level_[first.link[at] * most_levels + from.prepared[i]] += from.weight[i];
      continue;
    }
    number_[static_cast<std::size_t>(kept)] = static_cast<std::uint16_t>(i);
    for (const auto column : {&BatchView::vy, &BatchView::t, &BatchView::sx, &BatchView::sy, &BatchView::sz})
      (to.*column)[kept] = (from.*column)[i];
    to.level[kept] = from.level[i];
    to.prepared[kept] = from.prepared[i];
    to.weight[kept] = from.weight[i];
    to.particle[kept] = from.particle[i];
    ++kept;
  }
  to.y = from.y;
  to.count = kept;
  to.padded = (kept + 7) / 8 * 8;
  for (int i = kept; i < to.padded; ++i) to.weight[i] = to.level[i] = to.particle[i] = 0;
  for (const auto column : {&BatchView::t, &BatchView::sx, &BatchView::sy, &BatchView::sz})
    std::fill(to.*column + kept, to.*column + to.padded, 0.0);
  std::fill(to.vy + kept, to.vy + to.padded, 1.0);
}

/// Books the shares of one particle that no screen counts; returns how many others there are.
int Branches::count_shares(int i, Caught* caught) {
  const std::uint64_t prepared = asked_.view().prepared[i];
  const auto number = static_cast<std::size_t>(number_[static_cast<std::size_t>(i)]);
  const auto padded = static_cast<std::size_t>(asked_.view().padded);
  int count = 0;
  for (std::size_t n = 0; n < levels_.size(); ++n) {
    const std::uint64_t q =
        shares_[static_cast<std::size_t>(levels_[n]) * padded + static_cast<std::size_t>(i)];
    if (q == 0) continue;
    const Ends& ends = ends_[n];
    const std::uint16_t link = ends.link[number];
    const Screen* screen = screen_of(chain_[link]);
    std::uint64_t* ledger = &ledger_[(link * most_levels + prepared) * 2];
    if (screen == nullptr) {
      ended_[link] += q;
      ledger[1] += q;
      continue;
    }
    const std::uint64_t counted =
        ends.bin[number] == not_counted ? 0
        : screen->efficiency == 1
            ? q
            : static_cast<std::uint64_t>(std::floor(static_cast<double>(q) * screen->efficiency));
    lost_[link] += q - counted;
    ledger[0] += counted;
    ledger[1] += q - counted;
    if (counted != 0) caught[count++] = {counted, ends.bin[number], link, ends.level[number]};
  }
  return count;
}

/// Sums of squares are of a particle's whole score: (a + b)^2 = a^2 + b (b + 2a).
void Branches::tally(int i, const Caught* caught, int count, Sum* sums) {
  const std::uint64_t particle = asked_.view().particle[i];
  for (int n = 0; n < count; ++n) {
    const Caught& now = caught[n];
    const auto link = static_cast<std::size_t>(now.link);
    const ScreenSums layout = sums_of(*screen_of(chain_[link]));
    const std::size_t x = now.bin / layout.bins_z, z = now.bin % layout.bins_z;
    std::uint64_t in_bin = 0, in_screen = 0, in_level = 0, beside_in_x = 0, beside_in_z = 0;
    for (int before = 0; before < n; ++before) {
      if (caught[before].link != now.link) continue;
      in_screen += caught[before].q;
      if (caught[before].bin == now.bin)
        in_bin += caught[before].q;
      else if (caught[before].bin / layout.bins_z == x)
        beside_in_x += caught[before].q;
      else if (caught[before].bin % layout.bins_z == z)
        beside_in_z += caught[before].q;
      if (caught[before].level == now.level) in_level += caught[before].q;
    }
    const auto square = [&](std::uint64_t earlier) {
      return static_cast<Sum>(now.q) * (now.q + 2 * earlier);
    };
    Sum* screen = sums + chain_[link].sums;
    screen[layout.bin(now.bin)] += now.q;
    screen[layout.bin(now.bin) + 1] += square(in_bin);
    screen[layout.total()] += now.q;
    screen[layout.total() + 1] += square(in_screen);
    screen[layout.group(particle % group_count)] += now.q;
    screen[layout.more_in_x(x)] += 2 * static_cast<Sum>(now.q) * beside_in_x;
    screen[layout.more_in_z(z)] += 2 * static_cast<Sum>(now.q) * beside_in_z;
    if (stretch_[link] < 0) continue;
    const ChainLink& asks = chain_[static_cast<std::size_t>(stretch_[link])];
    const LevelLayout levels{static_cast<std::size_t>(std::get<SpinStretch>(*asks.stage).levels)};
    Sum* level = sums + asks.sums;
    level[levels.q(now.level)] += now.q;
    level[levels.squares(now.level)] += square(in_level);
    if (!levels.has_products()) continue;
    std::uint64_t all = 0;
    for (int k = 0; k < count; ++k) all += caught[k].link == now.link ? caught[k].q : 0;
    level[levels.products(now.level)] += static_cast<Sum>(now.q) * all;
  }
}

void Branches::book(const LevelProjection& projection, Sum* sums, std::size_t shift) {
  sums += shift;
  const BatchView& asked = asked_.view();
  ended_.assign(chain_.size(), 0);
  lost_.assign(chain_.size(), 0);
  ledger_.assign(chain_.size() * most_levels * 2, 0);
  if (asked.count > 0) {
    kernels_->outcomes(question_of(projection, key_), asked, asked.weight, shares_.data());
    Caught caught[most_levels];
    for (int i = 0; i < asked.count; ++i) {
      const int count = count_shares(i, caught);
      if (count > 0) tally(i, caught, count, sums);
    }
  }
  for (std::size_t k = 0; k < chain_.size(); ++k) {
    const Screen* screen = screen_of(chain_[k]);
    for (std::size_t level = 0; chain_[k].ledger != 0 && level < static_cast<std::size_t>(projection.levels);
         ++level) {
      const std::size_t at = k * most_levels + level;
      sums[chain_[k].ledger + 2 * level] += ledger_[2 * at];
      sums[chain_[k].ledger + 2 * level + 1] += ledger_[2 * at + 1] + decided_by_level_[at];
    }
    if (screen != nullptr)
      sums[chain_[k].sums + sums_of(*screen).lost()] += lost_[k] + decided_[k];
    else if (ended_[k] + decided_[k] != 0)
      sums[chain_[k].sums] += ended_[k] + decided_[k];
  }
}

}  // namespace rabiline
