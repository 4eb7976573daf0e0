#pragma once
// Other scans of a flight that was flown already.
//
// Moments of the slowness do not depend on how the fields between the magnets turn spins. So the sums of a
// flight, with every scan point left out, are those of any other scan of these fields, and what each point
// counts follows from them as it does at the end of a run. Particles outside the cells of moments, which are
// few, are flown again by their numbers.
#include <optional>
#include <string_view>

#include "core/isa.hpp"
#include "plan/plan.hpp"
#include "simulation/flight_record.hpp"
#include "simulation/form.hpp"

namespace rabiline {

/// Bins behind projections are kept, or added up.
enum class KeptBins { totals, images };

struct RunOutcome;

/// What is kept of a flight; nothing where moments do not serve all of its points, and then why not.
std::optional<FlightRecord> record_of(const Experiment&, const Plan&, const RunOutcome&, KeptBins,
                                      std::string_view& why_not);

/// The result of another scan. `flown`: the experiment of the record. Throws std::invalid_argument where the
/// scan changes anything but how spins turn between two places that ask for their level, or turns them faster
/// than the moments resolve; or where the record is not of that experiment. `max_memory`: as for form_of();
/// `take`: as for finish().
Result rescan(const Experiment& flown, const FlightRecord&, const Experiment& wanted,
              std::uint64_t max_memory, Isa, int threads = 1, const TakePoints& take = {});

}  // namespace rabiline
