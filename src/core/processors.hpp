#pragma once

namespace rabiline {

/// How many processors this process may run on, at least one: those that it was bound to, as by `taskset` or
/// `mpirun`.
int processors();

}  // namespace rabiline
