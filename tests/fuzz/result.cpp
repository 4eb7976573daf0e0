// Any bytes are a result or a StorageError.
#include "in_memory.hpp"
#include "storage/flight_file.hpp"
#include "storage/origin.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const rabiline::fuzz::InMemory file(data, size);
  try {
    rabiline::read_origin(file.path());
    rabiline::read_kept_flight(file.path());
  } catch (const rabiline::StorageError&) {
  }
  return 0;
}
