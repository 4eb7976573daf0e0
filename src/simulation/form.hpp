#pragma once
// What a run flies, and how its scan points come out of that.
//
// Where all points of a scan follow from moments of the slowness, the flight of one point serves them all. A
// scan of more points than fit into memory together is worked out in slabs of points, one behind the other,
// from such a flight, with the cells of the slowness of the whole scan: so slabs change no bit.
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "plan/plan.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// What a run may use without a word of its user [bytes].
inline constexpr std::uint64_t default_memory = std::uint64_t{1} << 31;

struct Form {
  Experiment flown;                    // the whole scan, or one point where the others follow from it
  Plan plan;                           // of what is flown
  std::vector<SlownessCells> cells{};  // of each place that keeps moments, where points follow
  std::size_t slabs = 1;
};

/// Points of one flight: that of `flown`, which has one point, in `moments.cells` where they are given.
/// Nothing where they do not follow from it, and then why not.
std::optional<Form> follow(const Experiment& flown, const Experiment& scan, const MomentsWanted& moments,
                           std::size_t slabs, std::string_view& why);
/// How many slabs are needed, where memory may be used up to so many bytes: that follows from the scan alone.
std::size_t slabs_of(const Experiment& flown, const Experiment& scan, const MomentsWanted&,
                     std::uint64_t max_memory);
/// In slabs where one slab would not do and all points follow from one flight; else all points fly.
Form form_of(const Experiment& scan, const MomentsWanted&, std::uint64_t max_memory, int threads = 0);

/// Whether every node serves all points, or is one whose points follow from moments. Otherwise, why not.
bool is_one_flight(const Plan&, std::string_view& why);
Experiment first_point_of(const Experiment&);

/// Called with the points of each slab in their order; what it drops of them is not in the result either.
/// Their axes are those of the whole scan.
using TakePoints = std::function<void(Result& points)>;

/// All points of a scan, from what has flown of its form: a part of the particles, so often halved.
Result finish(const Form&, const Experiment& scan, Sums, const std::vector<Straggler>&, int halvings, Isa,
              int threads, const TakePoints& = {});

}  // namespace rabiline
