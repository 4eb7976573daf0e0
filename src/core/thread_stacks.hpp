#pragma once

namespace rabiline {

/// Threads that start from now on have room for what they call: 1 MiB of stack at least. Where a shell's
/// `ulimit -s` is small they would inherit it.
void widen_thread_stacks();

}  // namespace rabiline
