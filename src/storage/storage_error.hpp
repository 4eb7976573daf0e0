#pragma once
// The one failure of this folder.
#include <stdexcept>

namespace rabiline {

/// A file that could not be written or read: "FILE: what failed (why); what would mend it".
class StorageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rabiline
