#pragma once
// In which form a run fits into memory, and whether it does.
#include "simulation/form.hpp"

namespace rabiline {

/// The form of a run that may use so much memory [bytes], or 2 GiB where 0 is stated.
Form form_of(const Experiment&, std::uint64_t max_memory, bool keep_moments, int threads);

/// `at_once`: scan points of which the result is in memory together.
/// Throws std::invalid_argument where sums of every thread and of the whole, what threads keep at planes, and
/// what follows from all that need more memory than may be used [bytes]; 0: than there is.
void require_memory(const Experiment&, const Form&, std::size_t at_once, int threads,
                    std::uint64_t max_memory);

/// Scan points of which the result is in memory together, where it goes to its file slab by slab.
std::size_t points_at_once(const Experiment&, const Form&);

/// What such a run is refused with, as a line of `check`; nothing where it is not.
std::string told_refusal(const Experiment&, const Form&, int threads, std::uint64_t max_memory);

}  // namespace rabiline
