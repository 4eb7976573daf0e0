#include "simulation/sums_copy.hpp"

#include <stdexcept>

namespace rabiline {
namespace {

/// One layout's moments to another's; the bins of screens are added up, and tallies left out, where the other
/// does so.
class MomentsCopy {
 public:
  MomentsCopy(const TransitLayout& a, const Sum* from, const TransitLayout& b, Sum* to)
      : a_(a), from_(from), b_(b), to_(to) {}

  void copy() {
    require(a_.all_outcomes() == b_.all_outcomes() && a_.cells().count == b_.cells().count &&
            a_.weights_alike() == b_.weights_alike());
    std::size_t next = 0;
    for (std::size_t link = 0; link < a_.links(); ++link)
      if (a_.links() == b_.links() || !a_.link(link).is_tally()) copy_link(link, next++);
    require(next == b_.links());
  }

 private:
  static void require(bool alike) {
    if (!alike) throw std::invalid_argument("the moments that were kept are of another beam");
  }

  void copy_link(std::size_t k, std::size_t l) {
    require(l < b_.links() && a_.link(k).outcomes == b_.link(l).outcomes &&
            a_.link(k).ends == b_.link(l).ends && a_.link(k).axes == b_.link(l).axes);
    for (std::size_t from = 0; from < a_.levels(); ++from) {
      to_[b_.decided(l, from)] += from_[a_.decided(k, from)];
      for (std::size_t rank = 0; rank < a_.paths(k, from); ++rank) {
        if (a_.link(k).ends) add(a_.stop(k, from, rank), b_.stop(l, from, rank));
        copy_bins(k, l, from, rank);
        for (std::size_t group = 0; a_.link(k).axes > 0 && group < moment_groups; ++group)
          copy_places(k, l, group, from, rank);
      }
    }
  }
  void copy_bins(std::size_t k, std::size_t l, std::size_t from, std::size_t a) {
    const TransitLink& kind = a_.link(k);
    const bool same = kind.bins == b_.link(l).bins;
    for (std::size_t bin = 0; bin < kind.bins; ++bin) {
      add(a_.share(k, bin, from, a), b_.share(l, same ? bin : 0, from, a));
      for (std::size_t b = 0; b < a + (a_.weights_alike() ? 0 : 1); ++b)
        add(a_.square(k, bin, from, a, b), b_.square(l, same ? bin : 0, from, a, b));
    }
    for (std::size_t b = 0; kind.is_screen() && b < a; ++b) {
      add(a_.screen(k, from, a, b), same ? b_.screen(l, from, a, b) : b_.square(l, 0, from, a, b));
      if (!same) continue;
      for (std::size_t x = 0; x < kind.columns; ++x)
        add(a_.column(k, x, from, a, b), b_.column(l, x, from, a, b));
      for (std::size_t z = 0; z < kind.rows; ++z) add(a_.row(k, z, from, a, b), b_.row(l, z, from, a, b));
    }
  }
  void copy_places(std::size_t k, std::size_t l, std::size_t group, std::size_t from, std::size_t rank) {
    add(a_.inside(k, group, from, rank), b_.inside(l, group, from, rank));
    for (std::size_t axis = 0; axis < a_.link(k).axes; ++axis)
      for (const int power : {1, 2})
        add(a_.place(k, axis, group, power, from, rank), b_.place(l, axis, group, power, from, rank));
  }
  void add(std::size_t row, std::size_t to) {
    const std::size_t length = static_cast<std::size_t>(a_.cells().count) * transit_powers;
    for (std::size_t i = 0; i < length; ++i) to_[b_.moment(to, 0, 0) + i] += from_[a_.moment(row, 0, 0) + i];
  }

  const TransitLayout& a_;
  const Sum* from_;
  const TransitLayout& b_;
  Sum* to_;
};

/// What does not depend on the scan point, from the sums of one plan to those of another of the same flight.
class SumsCopy {
 public:
  SumsCopy(const Sums& from, Sums& to) : from_(from), to_(to) {}

  void copy(const Plan& a, const Plan& b) {
    require(a.trees.size() == b.trees.size());
    for (std::size_t k = 0; k < a.trees.size(); ++k) {
      const PlanTree &tree = a.trees[k], &other = b.trees[k];
      require(tree.first == other.first && tree.last == other.last &&
              tree.ledger_levels == other.ledger_levels &&
              sums_of(tree.source).size() == sums_of(other.source).size());
      add(tree.sums, other.sums, sums_of(tree.source).size());
      add(tree.ledger, other.ledger, tree.ledger_levels);
      ledger_size_ = LedgerSums{tree.ledger_levels}.size();
      copy(tree.next, other.next);
    }
  }

 private:
  void copy(const std::vector<PlanNode>& a, const std::vector<PlanNode>& b) {
    require(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      require((a[i].transit == nullptr) == (b[i].transit == nullptr));
      if (a[i].transit) {
        MomentsCopy(*a[i].transit, &from_[a[i].moments], *b[i].transit, &to_[b[i].moments]).copy();
        continue;
      }
      require(sums_needed(a[i].stage) == sums_needed(b[i].stage) && (a[i].ledger == 0) == (b[i].ledger == 0));
      add(a[i].sums, b[i].sums, sums_needed(a[i].stage));
      if (a[i].ledger != 0) add(a[i].ledger, b[i].ledger, ledger_size_);
      copy(a[i].next, b[i].next);
    }
  }
  void add(std::size_t from, std::size_t to, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) to_[to + i] += from_[from + i];
  }
  static void require(bool alike) {
    if (!alike) throw std::invalid_argument("what was kept is of another beam");
  }

  const Sums& from_;
  Sums& to_;
  std::size_t ledger_size_ = 0;
};

}  // namespace

void copy_flight(const Plan& of, const Sums& from, const Plan& plan, Sums& to) {
  SumsCopy(from, to).copy(of, plan);
}

}  // namespace rabiline
