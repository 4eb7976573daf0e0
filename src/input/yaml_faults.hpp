#pragma once
// What a mistake in YAML itself is called.
#include <string_view>

#include "core/diagnostics.hpp"

namespace rabiline {

/// The parser's words for what somebody forgot, in plainer ones, at the place where it is missing.
Diagnostic explain_yaml(Place place, std::string_view message);

}  // namespace rabiline
