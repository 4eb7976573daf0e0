#include "simulation/flown.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

namespace rabiline {
namespace {

template <class Plain>
void append_all(std::vector<Plain>& to, const std::vector<Plain>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Plain numbers as bytes, behind their count.
template <class Plain>
void pack(std::string& to, const std::vector<Plain>& values) {
  const std::uint64_t count = values.size();
  to.append(reinterpret_cast<const char*>(&count), sizeof count);
  to.append(reinterpret_cast<const char*>(values.data()), count * sizeof(Plain));
}
template <class Plain>
std::vector<Plain> unpack(std::string_view& from) {
  std::uint64_t count = 0;
  std::memcpy(&count, from.data(), sizeof count);
  std::vector<Plain> values(count);
  if (count > 0)
    std::memcpy(static_cast<void*>(values.data()), from.data() + sizeof count, count * sizeof(Plain));
  from.remove_prefix(sizeof count + count * sizeof(Plain));
  return values;
}

}  // namespace

void ThreadSums::fly(TreeRunner& runner, const Plan& plan, const ParticleRange& range, const Call& stop,
                     bool slowly) {
  std::unique_lock guard(lock);
  const Heeding heeding(slowly || finished.list().empty() ? stop : Call{});
  if (slowly) {
    guard.unlock();
    Sums apart(plan.sums);
    runner.fly(plan.trees[range.tree], range.first, range.last, apart);
    guard.lock();
    sums.resize(plan.sums);
    add(sums, apart);
  } else {
    sums.resize(plan.sums);
    torn = true;
    runner.fly(plan.trees[range.tree], range.first, range.last, sums);
    torn = false;
  }
  finished.insert(range.place, range.place + (range.last - range.first));
  for (const std::uint64_t particle : runner.stragglers()) stragglers.push_back({range.tree, particle});
}

Flown::Flown(const Plan& plan, const Snapshot* start) : size_(plan.sums) {
  if (start == nullptr) return;
  sums = sums_of(start->sums);
  finished = Intervals(start->finished);
  stragglers = start->stragglers;
}

void Flown::collect(std::vector<ThreadSums>& threads, Ranks& ranks) {
  const bool alone = ranks.size() == 1;
  Sums of_rank;
  Sums& to = alone ? sums : of_rank;
  Intervals::List places;
  std::vector<Straggler> slow;
  for (ThreadSums& thread : threads) {
    const std::lock_guard guard(thread.lock);
    if (thread.torn) continue;
    if (to.empty()) {  // they may take hundreds of MiB, which are not worth a copy
      to.swap(thread.sums);
    } else if (!thread.sums.empty()) {
      add(to, thread.sums);
      std::fill(thread.sums.begin(), thread.sums.end(), 0);
    }
    append_all(places, std::exchange(thread.finished, {}).list());
    append_all(slow, std::exchange(thread.stragglers, {}));
  }
  to.resize(size_);
  if (!alone) ranks.add_up(of_rank);
  std::string packed;
  pack(packed, places);
  pack(packed, slow);
  for (const std::string& of_one : ranks.collect(packed)) {
    std::string_view rest = of_one;
    finished.insert(Intervals(unpack<Intervals::List::value_type>(rest)));
    append_all(stragglers, unpack<Straggler>(rest));
  }
  if (!alone && ranks.leads()) {
    sums.resize(size_);
    add(sums, of_rank);
  }
  std::sort(stragglers.begin(), stragglers.end());
  stragglers.erase(std::unique(stragglers.begin(), stragglers.end()), stragglers.end());
}

Snapshot Flown::snapshot() const {
  Snapshot snapshot;
  snapshot.finished = finished.list();
  snapshot.sums = kept(sums);
  snapshot.stragglers = stragglers;
  return snapshot;
}

}  // namespace rabiline
