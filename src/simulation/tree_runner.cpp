#include "simulation/tree_runner.hpp"

#include <algorithm>
#include <utility>

#include "plan/transit_links.hpp"

namespace rabiline {
namespace {

/// All that follows only reads.
bool leaves_untouched(const PlanNode& node) {
  return traits_of(node.stage).only_reads &&
         std::all_of(node.next.begin(), node.next.end(), leaves_untouched);
}

void count_emitted(const PlanTree& tree, const BatchView& batch, Sum* all) {
  Sum* sums = all + tree.sums;
  for (int i = 0; i < batch.count && tree.ledger_levels > 0; ++i)
    all[tree.ledger + batch.prepared[i]] += batch.weight[i];
  if (!sums_of(tree.source).weights_differ) {
    const auto count = static_cast<Sum>(batch.count);
    sums[EmissionSums::q()] += count * quanta_per_particle;
    sums[EmissionSums::q2()] += count * square(quanta_per_particle);
    return;
  }
  for (int i = 0; i < batch.count; ++i) {
    sums[EmissionSums::q()] += batch.weight[i];
    sums[EmissionSums::q2()] += square(batch.weight[i]);
    sums[EmissionSums::group(batch.particle[i] % group_count)] += batch.weight[i];
  }
}

/// Books what ended at a stage by the level that it was prepared in.
class LedgerBook {
 public:
  explicit LedgerBook(const BatchView& batch) : batch_(batch) {
    for (int i = 0; i < batch.count; ++i) before_[i] = batch.weight[i] & batch.flying[i];
  }
  void book(Sum* sums) const {
    for (int i = 0; i < batch_.count; ++i) {
      if (before_[i] == 0) continue;
      const std::uint64_t flying = batch_.weight[i] & batch_.flying[i];
      const std::uint64_t caught = batch_.flying[i] == 0 && batch_.caught_by[i] != 0 ? batch_.weight[i] : 0;
      sums[LedgerSums::caught(batch_.prepared[i])] += caught;
      sums[LedgerSums::ended(batch_.prepared[i])] += before_[i] - flying - caught;
    }
  }

 private:
  const BatchView& batch_;
  std::uint64_t before_[Batch::capacity];  // [quanta] of what flew
};

/// What a class of particles is booked at, and how far its sums are behind those of the first reweighting:
/// frequency nodes, or for those behind the last class each reweighting.
template <class F>
void each_setting(const PlanNode& node, std::size_t number, F f) {
  if (number == node.classes.size()) {
    for (const PlanNode::Reweighting& reweighting : node.reweightings)
      f(reweighting.stage, reweighting.shift);
    return;
  }
  for (const FrequencyNodes& family : node.classes[number].families)
    for (std::size_t k = 0; k < family.nodes.size(); ++k)
      f(family.nodes[k], family.sums + k * sums_of_reweighting(node) - node.sums);
}

}  // namespace

Batch& TreeRunner::batch(std::size_t depth) {
  while (batches_.size() <= depth) batches_.push_back(std::make_unique<Batch>());
  return *batches_[depth];
}

void TreeRunner::fly(const PlanTree& tree, std::uint64_t first, std::uint64_t last, Sums& sums) {
  stragglers_.clear();
  for (std::uint64_t begin = first; begin < last; begin += static_cast<std::uint64_t>(batch_size_)) {
    Batch& start = batch(0);
    start.view().count =
        static_cast<int>(std::min<std::uint64_t>(last - begin, static_cast<std::uint64_t>(batch_size_)));
    start.view().padded = (start.view().count + 7) / 8 * 8;
    kernel::emit(isa_)(tree.source, begin, start.view());
    count_emitted(tree, start.view(), sums.data());
    propagate(tree.next, 0, tree.source.key, sums);
  }
  follow_waiting(tree.source.key, sums);
  flush_moments(sums);
}

void TreeRunner::flush_moments(Sums& sums) {
  for (auto& [node, buffer] : moments_) {
    for (const std::uint64_t cell : buffer.touched) {
      Sum* to = sums.data() + node->moments + cell * transit_powers;
      for (std::int64_t& moment : buffer.cells[cell].of) *to++ += static_cast<Sum>(std::exchange(moment, 0));
    }
    buffer.touched.clear();
  }
}

void TreeRunner::follow_branches(const PlanNode& node, Batch& batch, const RandomKey& key, Sums& sums) {
  if (node.classes.empty()) return follow_class(node, 0, batch, key, sums);
  std::vector<Batch>& waiting = waiting_[&node];
  waiting.resize(node.classes.size() + 1);
  const BatchView& b = batch.view();
  for (int i = 0; i < b.count; ++i) {
    if (b.flying[i] == 0) continue;
    std::size_t number = 0;
    while (number < node.classes.size() && b.slowness[i] > node.classes[number].last) ++number;
    Batch& of_class = waiting[number];
    of_class.add(b, i);
    if (of_class.view().count < batch_size_) continue;
    follow_class(node, number, of_class, key, sums);
    of_class.view().count = 0;
  }
}

void TreeRunner::follow_waiting(const RandomKey& key, Sums& sums) {
  for (auto& [node, waiting] : waiting_)
    for (std::size_t number = 0; number < waiting.size(); ++number) {
      BatchView& left = waiting[number].view();
      if (left.count > 0) follow_class(*node, number, waiting[number], key, sums);
      left.count = 0;
    }
}

void TreeRunner::follow_class(const PlanNode& node, std::size_t number, Batch& batch, const RandomKey& key,
                              Sums& sums) {
  std::vector<ChainLink> chain;
  for (const PlanNode* next = &node; !next->next.empty();) {
    next = &next->next.front();
    chain.push_back({&next->stage, next->sums, next->ledger});
  }
  branches_->fly(batch, path_of(node.stage)->axis, chain, node.reachable_levels, isa_, key,
                 node.transit.get());
  if (node.transit) {
    if (branches_->book_moments(*node.transit, batch, moments_[&node], sums.data() + node.moments)) return;
    const BatchView& b = batch.view();
    for (int i = 0; i < b.count; ++i)
      if (b.flying[i] != 0 && !node.transit->cells().contains(b.slowness[i]))
        stragglers_.push_back(b.particle[i]);
  }
  each_setting(node, number, [&](const Stage& setting, std::size_t shift) {
    branches_->book(*path_of(setting), sums.data(), shift);
    for (const ChainLink& link : chain) {
      if (!reads_earlier_catch(*link.stage, node)) continue;
      StageContext context{isa_, key, batch, sums.data() + link.sums + shift};
      advance(*link.stage, context);
    }
  });
}

/// Levels at a screen, of all points by moments; what flew too slowly or too fast for their cells is read for
/// each point.
void TreeRunner::read_levels(const PlanNode& node, const Batch& batch, const RandomKey& key, Sums& sums) {
  const int part = reads_catch_of(node.stage);
  if (transits_.add_catch(*node.transit, batch.view(), part, isa_, moments_[&node])) return;
  outside_.copy_from(batch);
  BatchView& outside = outside_.view();
  for (int i = 0; i < outside.count; ++i)
    if (node.transit->cells().contains(outside.slowness[i]))
      outside.caught_by[i] = 0;
    else if (outside.caught_by[i] == static_cast<std::uint64_t>(part) + 1)
      stragglers_.push_back(outside.particle[i]);
  for (const PlanNode::Reweighting& reweighting : node.reweightings) {
    StageContext context{isa_, key, outside_, sums.data() + node.sums + reweighting.shift};
    advance(reweighting.stage, context);
  }
}

void TreeRunner::pass(const PlanNode& node, Batch& batch, const RandomKey& key, Sums& sums) {
  StageContext context{isa_, key, batch, sums.data() + node.sums};
  if (node.ledger == 0) return advance(node.stage, context);
  const LedgerBook book(batch.view());
  advance(node.stage, context);
  book.book(sums.data() + node.ledger);
}

void TreeRunner::propagate(const std::vector<PlanNode>& nodes, std::size_t depth, const RandomKey& key,
                           Sums& sums) {
  // All branches but the last are flown to their ends; the last one is followed by the loop, as a beamline of
  // a thousand planes is a chain of as many stages.
  for (const std::vector<PlanNode>* here = &nodes; !here->empty();) {
    for (std::size_t i = 0; i + 1 < here->size(); ++i) {
      const PlanNode& node = (*here)[i];
      std::size_t own = depth;
      if (!leaves_untouched(node)) {
        own = depth + 1;
        batch(own).copy_from(batch(depth));
      }
      if (splits(node.stage)) {
        follow_branches(node, batch(own), key, sums);
        continue;
      }
      if (node.transit) {
        read_levels(node, batch(own), key, sums);
        continue;
      }
      pass(node, batch(own), key, sums);
      propagate(node.next, own, key, sums);
    }
    const PlanNode& last = here->back();
    if (splits(last.stage)) return follow_branches(last, batch(depth), key, sums);
    if (last.transit) return read_levels(last, batch(depth), key, sums);
    pass(last, batch(depth), key, sums);
    here = &last.next;
  }
}

}  // namespace rabiline
