// Any bytes are a checkpoint or a StorageError. The seal keeps damaged ones from HDF5, which crashes on some
// of them.
#include "in_memory.hpp"
#include "storage/checkpoint_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const rabiline::fuzz::InMemory file(data, size);
  try {
    rabiline::read_checkpoint(file.path());
  } catch (const rabiline::StorageError&) {
  }
  return 0;
}
