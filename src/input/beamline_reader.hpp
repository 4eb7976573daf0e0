#pragma once
// The beamline's own table and how one point of it is read from a tree.
#include "beamline/experiment.hpp"
#include "input/document.hpp"
#include "input/keys.hpp"
#include "input/values.hpp"

namespace rabiline {

/// A particle weighs 2^40 quanta and squares of weights are summed in 128 bits.
inline constexpr Range particle_numbers{1, 1e14, true, true, "from 1 to 1e14"};
inline constexpr Range seeds{0, 0x1p64, true, true, "from 0 to 2^64 - 1 = 18446744073709551615"};

template <>
inline constexpr auto parameters<Beamline> = std::tuple{
    param("title", &Beamline::title, "what the experiment is called", std::string_view{}),
    param("species", &Beamline::species,
          "what flies: a library name, a definition, or a list with fractions"),
    param("law", &Beamline::law, "law of motion"),
    param("source", &Beamline::source, "where particles start"),
    param("chamber", &Beamline::chamber, "round wall along the whole beam; none if omitted"),
    param("gravity", &Beamline::gravity, "free fall; off if omitted"),
    param("parts", &Beamline::parts, "what stands on the beam"),
    param("particles", &Beamline::particles, Dimension::number, particle_numbers,
          "how many fly, per scan point; at most, where there is an `until`"),
    param("until", &Beamline::until, "the precision at which fewer are enough; all fly if omitted"),
    param("seed", &Beamline::seed, Dimension::number, seeds, "key of the random numbers"),
};

/// Every file says which version of the format it is written in.
void check_version(const Node& root, Keys&);
/// Reads and checks a whole file's tree; `scan` is left alone. Whether all is well shows in the Reading.
Beamline read_beamline(const Node& root, Reading&);
/// The same in two steps: the values by the tables, every part in the order of the file; then the parts that
/// are enabled, in order of `at`.
Beamline read_beamline_values(const Node& root, Reading&);
void finish_beamline(Beamline&);

}  // namespace rabiline
