#pragma once
// In which form a run fits into memory, and whether it does.
#include "simulation/form.hpp"

namespace rabiline {

/// The form of a run that may use so much memory [bytes], or 2 GiB where 0 is stated.
Form form_of(const Experiment&, std::uint64_t max_memory, bool keep_moments, int threads);

/// Throws std::invalid_argument where sums of every thread and of the whole, what threads keep at planes, and
/// what follows from all that need more memory than may be used [bytes]; 0: than there is.
void require_memory(const Experiment&, const Plan&, int threads, std::uint64_t max_memory);

/// What such a run is refused with, as a line of `check`; nothing where it is not.
std::string told_refusal(const Experiment&, const Plan&, int threads, std::uint64_t max_memory);

}  // namespace rabiline
