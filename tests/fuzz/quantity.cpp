// Any text is a quantity or says why it is none; what is written of one reads as the same number.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/units.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const rabiline::ParsedQuantity read = rabiline::parse_quantity(text);
  if (!read.error.empty()) return 0;
  if (!std::isfinite(read.value)) std::abort();
  if (rabiline::parse_quantity(rabiline::write_quantity(read.value, read.dimension)).value != read.value)
    std::abort();
  return 0;
}
