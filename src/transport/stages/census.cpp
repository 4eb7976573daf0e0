#include "transport/stages/census.hpp"

#include <array>
#include <vector>

#include "transport/cost.hpp"
#include "transport/paths.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {
namespace {

/// What crosses the face; totals stay in registers until all of a batch has.
class Crossed {
 public:
  explicit Crossed(Sum* sums) : sums_(sums) {}
  void add(std::uint64_t q, std::uint64_t particle) {
    total_ += q;
    squares_ += square(q);
    sums_[CensusSums::group(particle % group_count)] += q;
  }
  void put() {
    sums_[CensusSums::total()] += total_;
    sums_[CensusSums::total() + 1] += squares_;
  }

 private:
  Sum* sums_;
  Sum total_ = 0, squares_ = 0;
};

/// Which particles cross the face on each path.
class CensusPaths : public PathTally {
 public:
  explicit CensusPaths(const Census& census) : census_(census) {}

  void see(std::size_t path, StageContext& here, const std::uint16_t* numbers) override {
    alignas(64) std::uint64_t weights[Batch::capacity];
    const BatchView& batch = here.batch.view();
    kernel::cross(here.isa)(census_.face, batch, weights);
    if (places_.size() <= path) places_.resize(path + 1);
    places_[path].bin.fill(PathPlaces::nowhere);
    for (int n = 0; n < batch.count; ++n)
      if (weights[n] != 0) places_[path].bin[numbers[n]] = 0;
  }
  const PathPlaces* places(std::size_t path) const override { return &places_[path]; }
  void add(const Paths& paths, const PathWeights& weights, Sum* sums, Sum*) override {
    Crossed crossed(sums);
    for (std::size_t k = 0; k < paths.count(); ++k) {
      std::uint64_t q = 0;
      for (std::size_t path = 0; path < paths.levels.size(); ++path)
        q += places_[path].bin[paths.number[k]] == 0 ? weights.of[path][k] : 0;
      crossed.add(q, paths.asked.view().particle[k]);
    }
    crossed.put();
  }

 private:
  const Census& census_;
  std::vector<PathPlaces> places_;  // [path]
};

}  // namespace

std::size_t Census::sums() const { return CensusSums::size(); }
void Census::pass(StageContext& context) const {
  const BatchView& batch = context.batch.view();
  alignas(64) std::uint64_t weights[Batch::capacity];
  kernel::cross(context.isa)(face, batch, weights);
  Crossed crossed(context.sums);
  for (int i = 0; i < batch.count; ++i) crossed.add(weights[i], batch.particle[i]);
  crossed.put();
}
void Census::list_sums(SumSink& sink) const { sink.plane(part, plane, 0); }
double Census::y() const { return face.y; }
double Census::cost(double) const { return cost::plane; }
bool Census::follows_paths() const { return true; }
std::unique_ptr<PathTally> Census::tally_paths() const { return std::make_unique<CensusPaths>(*this); }

/// Of a monitor with several planes the first one stands for all.
void Census::explain(PlanReport& report) const {
  if (plane > 0) return;
  const PlacedPart& placed = report.part(part);
  const auto& monitor = std::get<Monitor>(placed.part);
  report.line(
      "{}  {}: counts what passes{}{}", PlanReport::metres(face.y), report.name_of(part),
      monitor.planes > 1
          ? fmt::format(" it and each of {} more planes, to {}", monitor.planes - 1,
                        PlanReport::metres(place_of_plane(monitor, placed.placement, monitor.planes - 1)))
          : "",
      report.reuse);
}

}  // namespace rabiline
