#pragma once
// What a run flies, and how its scan points come out of that.
//
// Where all points of a scan follow from moments of the slowness, the flight of one point serves them all. A
// scan of more points than fit into memory together is worked out in slabs of points, one behind the other,
// from such a flight, with the cells of the slowness of the whole scan: so slabs change no bit. Where points
// do not follow from one flight, each slab flies by itself (simulation/form_flight.hpp).
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "plan/plan.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// What a run may use without a word of its user [bytes].
inline constexpr std::uint64_t default_memory = std::uint64_t{1} << 31;
/// [bytes]
struct MemoryLimits {
  std::uint64_t wanted = default_memory;                           // slabs are as long as that lets them be
  std::uint64_t most = std::numeric_limits<std::uint64_t>::max();  // beyond that nothing flies
};

struct Form {
  Experiment flown;                    // the whole scan; one point where the others follow; the first slab
  Plan plan;                           // of that
  std::vector<SlownessCells> cells{};  // of each place that keeps moments, where points follow
  std::size_t slabs = 1;

  bool flies_in_slabs() const { return slabs > 1 && cells.empty(); }
};
/// One of the slabs that the scan has in that form, all about as long.
Experiment slab_of(const Experiment& scan, const Form&, std::size_t slab);
/// Of a slab that flies by itself, on so many threads.
Plan plan_of_slab(const Experiment& slab, int threads);

/// Points of one flight: that of `flown`, which has one point, in `moments.cells` where they are given.
/// Nothing where they do not follow from it, and then why not.
std::optional<Form> follow(const Experiment& flown, const Experiment& scan, const MomentsWanted& moments,
                           std::size_t slabs, std::string_view& why);
/// How many slabs are needed, where memory may be used up to so many bytes: that follows from the scan alone.
std::size_t slabs_of(const Experiment& flown, const Experiment& scan, const MomentsWanted&,
                     std::uint64_t max_memory);
/// In slabs where one would not do. Points that fly do so together where a run may end before all of its
/// particles have flown, where they differ in more than numbers, and where a detector changes; throws
/// std::invalid_argument where that needs too much memory.
Form form_of(const Experiment&, const MomentsWanted&, const MemoryLimits&, int threads = 0);

/// Whether every node serves all points, or is one whose points follow from moments. Otherwise, why not.
bool is_one_flight(const Plan&, std::string_view& why);
Experiment first_point_of(const Experiment&);

/// Called with the points of each slab in their order; what it drops of them is not in the result either.
/// Their axes are those of the whole scan.
using TakePoints = std::function<void(Result& points)>;
/// Hands the points of the next slab on, and puts what is left of them behind the others. These have the axes
/// of the whole scan from the beginning.
void add_points(Result points, const TakePoints&, Result& all);

/// All points of a scan, from one flight of its form: a part of the particles, so often halved.
Result finish(const Form&, const Experiment& scan, Sums, const std::vector<Straggler>&, int halvings, Isa,
              int threads, const TakePoints& = {});

}  // namespace rabiline
