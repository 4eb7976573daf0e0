// Any text is an experiment, a model, or an InputError.
#include <cstddef>
#include <cstdint>
#include <string>

#include "rabiline.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    rabiline::load_text({reinterpret_cast<const char*>(data), size}, "/nowhere");
  } catch (const rabiline::InputError&) {
  }
  return 0;
}
