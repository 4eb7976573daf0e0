#include "simulation/dealer.hpp"

#include <algorithm>
#include <cmath>

namespace rabiline {

void Dealer::open(std::uint64_t begin, std::uint64_t end) {
  next_ = begin;
  end_ = end;
}

Deal Dealer::next(const Wish& wish) {
  Deal deal{next_, next_};
  while (next_ < end_ && (deal.cost < wish.cost || deal.particles < wish.least)) {
    const auto [from, until] = flown_.gap(next_);
    if (from >= end_) {
      next_ = deal.end = end_;
      break;
    }
    const ParticleRange range = row_.at(from);
    const double each = std::max(plan_.trees[range.tree].cost, 1e-12);
    const auto there = static_cast<double>(std::min({range.last - range.first, until - from, end_ - from}));
    const double wanted = std::max((wish.cost - deal.cost) / each,
                                   static_cast<double>(wish.least) - static_cast<double>(deal.particles));
    const double taken = std::min(there, 8 * std::ceil(wanted / 8));  // lanes are filled by eights
    deal.particles += static_cast<std::uint64_t>(taken);
    deal.cost += each * taken;
    next_ = deal.end = from + static_cast<std::uint64_t>(taken);
  }
  return deal;
}

std::vector<Deal> Dealer::deal(const std::vector<Wish>& wishes) {
  Wish all;
  for (const Wish& wish : wishes) all = {all.cost + wish.cost, all.least + wish.least};
  const std::uint64_t here = next_;
  const Deal there = next(all);
  const bool scarce = is_done() && there.cost < all.cost;
  next_ = here;
  std::vector<Deal> out;
  double left = all.cost;
  for (const Wish& wish : wishes) {
    left -= wish.cost;
    const bool last = scarce && wish.cost > 0 && !(left > 0);  // takes what the rounding left
    out.push_back(next(!scarce ? wish : last ? all : Wish{wish.cost * (there.cost / all.cost), 0}));
  }
  return out;
}

}  // namespace rabiline
