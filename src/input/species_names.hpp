#pragma once
// What people may have meant by the name of a species.
#include <string>
#include <string_view>

namespace rabiline {

/// "write which isotope: `Li-6` or `Li-7`, or with its electron `Li-6 atom` or `Li-7 atom`", for `Li`,
/// `lithium` and `Li atom`; empty where the name is that of no element.
std::string species_of_element(std::string_view name);
/// What to write instead of a name that is no species.
std::string suggest_species(std::string_view name);

}  // namespace rabiline
