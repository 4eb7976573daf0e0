#pragma once
// What the stages behind a projection keep, as moments of the slowness can hold it.
#include <optional>
#include <string_view>
#include <vector>

#include "plan/plan.hpp"

namespace rabiline {

/// The stages behind a projection, one after the other; nothing where moments cannot hold all that they
/// count, and then why not.
std::optional<std::vector<TransitLink>> links_behind(const PlanNode& projection, std::string_view& why_not);

/// Whether a stage behind a projection tallies what was caught in front of that.
bool reads_earlier_catch(const Stage&, const PlanNode& projection);

}  // namespace rabiline
