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

}  // namespace rabiline
