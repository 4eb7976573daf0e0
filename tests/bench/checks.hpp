#pragma once

namespace rabiline::bench {

/// A limit that computes something else than the program is no limit: compares the two before anything is
/// timed. Throws std::logic_error where they differ.
void check_limits();

}  // namespace rabiline::bench
