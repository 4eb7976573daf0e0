#pragma once
// HDF5's C interface with every return value checked and every identifier closed. Included by .cpp files of
// this folder only; HDF5 is used from one thread.
#include <hdf5.h>

#include <string_view>
#include <utility>

#include "storage/storage_error.hpp"

namespace rabiline::hdf5 {

/// Stops HDF5 from printing its error stack; `check` reads it instead.
void silence();

/// Throws StorageError "where: HDF5 failed (innermost line of its error stack)".
[[noreturn]] void fail(std::string_view where);

/// Passes a return value through, or throws where it says failure. `where` names the file and the place in
/// it.
template <class Value>
Value check(Value value, std::string_view where) {
  if (value < 0) fail(where);
  return value;
}

/// An identifier that closes itself.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close closer, std::string_view where) : id_(check(id, where)), close_(closer) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }

  hid_t id() const { return id_; }
  /// Closes now and checks: what is written is compressed only here, and that can fail.
  void close(std::string_view where) { check(close_(std::exchange(id_, H5I_INVALID_HID)), where); }

 private:
  hid_t id_;
  Close close_;
};

/// Property lists and types that several files need.
Handle property_list(hid_t list_class, std::string_view where);
/// A UTF-8 string type of fixed size in bytes (padded with zeros), or of variable size.
Handle fixed_text(std::size_t size, std::string_view where);
Handle variable_text(std::string_view where);
/// A file that exists, opened for reading only; no lock is taken, which some network file systems refuse.
Handle open_file(const char* path, std::string_view where);

}  // namespace rabiline::hdf5
