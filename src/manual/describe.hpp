#pragma once
// What a user can write, told from the tables alone.
#include <string>
#include <string_view>

namespace rabiline {

/// What there is to describe, and the keys of a file.
std::string describe_overview();
/// The keys of a part, law, source, scan, ... with unit, range, default and meaning, and a snippet; or a
/// species of the library. Throws InputError for a topic that is none.
std::string describe(std::string_view topic);
/// A JSON Schema (draft-07) of beamlines and models, for editors that check and complete while one writes.
std::string json_schema();

}  // namespace rabiline
