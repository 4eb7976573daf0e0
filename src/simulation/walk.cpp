#include "simulation/walk.hpp"

#include <algorithm>

namespace rabiline {
namespace {

/// All that follows only reads.
bool leaves_untouched(const PlanNode& node) {
  return only_reads(node.stage) && std::all_of(node.next.begin(), node.next.end(), leaves_untouched);
}

}  // namespace

Batch& Walker::batch(std::size_t depth) {
  while (batches_.size() <= depth) batches_.push_back(std::make_unique<Batch>());
  return *batches_[depth];
}

void Walker::fly(const PlanTree& tree, std::uint64_t first, std::uint64_t last, Sums& sums) {
  for (std::uint64_t begin = first; begin < last; begin += static_cast<std::uint64_t>(batch_size_)) {
    Batch& start = batch(0);
    start.view().count =
        static_cast<int>(std::min<std::uint64_t>(last - begin, static_cast<std::uint64_t>(batch_size_)));
    start.view().padded = (start.view().count + 7) / 8 * 8;
    kernels_.emit(tree.source, begin, start.view());
    Moments emitted;
    for (int i = 0; i < start.view().count; ++i) {
      const std::uint64_t weight = start.view().weight[i];
      emitted.q += weight;
      emitted.q2 += static_cast<Sum>(weight) * weight;
    }
    sums[tree.sums] += emitted.q;
    sums[tree.sums + 1] += emitted.q2;
    walk(tree.next, 0, tree.source.key, sums);
  }
}

void Walker::walk(const std::vector<PlanNode>& nodes, std::size_t depth, const RandomKey& key, Sums& sums) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    std::size_t own = depth;
    if (i + 1 < nodes.size() && !leaves_untouched(nodes[i])) {
      own = depth + 1;
      batch(own).copy_from(batch(depth));
    }
    Flight flight{kernels_, key, batch(own), sums.data() + nodes[i].sums};
    advance(nodes[i].stage, flight);
    walk(nodes[i].next, own, key, sums);
  }
}

}  // namespace rabiline
