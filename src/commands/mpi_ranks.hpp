#pragma once
// Processes that a launcher such as mpirun or srun started, joined by MPI.
#include <memory>
#include <string>
#include <vector>

#include "rabiline.hpp"

namespace rabiline {

/// Nothing where this process is alone, or flies a shard of its own, or its verb flies nothing. Throws
/// ArgumentError where there are others and no MPI that joins them.
std::unique_ptr<Ranks> launched_ranks(const std::vector<std::string>& arguments);
/// Whether this process was started beside another one that does by itself what its verb asks for.
bool is_left_to_the_first(const std::vector<std::string>& arguments);

}  // namespace rabiline
