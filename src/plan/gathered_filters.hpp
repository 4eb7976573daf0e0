#pragma once
// Filters that are asked where the first of them stands, so that a scan behind them costs one flight.
#include <string_view>
#include <vector>

#include "transport/stage.hpp"

namespace rabiline {

/// The chain with one projection in the place of its filters, of the fields between them and of what asks for
/// levels behind them: its outcomes are the levels and what each filter stops. Empty where it has no filter,
/// or where that would not tell the same: then why. `source`: with which spins particles start.
std::vector<Stage> with_gathered_filters(const std::vector<Stage>& chain, const SpinDraw& source,
                                         std::string_view& why_not);

}  // namespace rabiline
