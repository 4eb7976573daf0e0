#pragma once
// What this process may have.
namespace rabiline {

/// [bytes] Of the machine, or what it allows one process where that is less.
double memory_there();

}  // namespace rabiline
