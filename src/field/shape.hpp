#pragma once

namespace rabiline {

/// How the size of a field runs along its length. In a header of its own, since kernels read it.
enum class Shape { rectangular, half_sine, gaussian };

}  // namespace rabiline
