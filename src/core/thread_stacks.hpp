#pragma once

namespace rabiline {

/// Threads that start from now on have room for what they call: 8 MiB of stack at least, as most shells leave
/// them. Where a shell's `ulimit -s` is small they would inherit it.
void widen_thread_stacks();
/// Whether the first thread, whose stack is the shell's for good, has less.
bool first_thread_is_narrow();

}  // namespace rabiline
