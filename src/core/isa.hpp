#pragma once
// Which of the compiled copies of the kernels runs: chosen at run time, so that one program runs on every
// processor of its family. All copies give the same bits (core/lanes.hpp); the choice is one of speed only.
#include <optional>
#include <string_view>

namespace rabiline {

/// In order of speed: the lowest of several machines runs on all of them.
enum class Isa { baseline, avx2, avx512 };

/// Can this processor, under this operating system, run kernels compiled for it?
bool supported(Isa);
/// The fastest one supported here.
Isa best_isa();

/// "x86-64", "avx2" or "avx512"; the baseline of another processor family is called "generic".
std::string_view name_of(Isa);
std::optional<Isa> parse_isa(std::string_view);
/// The one of this name; the fastest one supported here where the name is empty. Throws std::invalid_argument
/// where there is none, or this processor has not got it.
Isa isa_called(std::string_view name);

}  // namespace rabiline
