#include "storage/hdf5_handles.hpp"

#include <fmt/format.h>

#include <string>

namespace rabiline::hdf5 {
namespace {

/// Called by HDF5 for each line of its error stack; keeps the innermost, which says what went wrong first.
herr_t keep_innermost(unsigned number, const H5E_error2_t* line, void* text) {
  if (number == 0 && line->desc != nullptr) *static_cast<std::string*>(text) = line->desc;
  return 0;
}

Handle text_type(std::size_t size, std::string_view where) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, where);
  check(H5Tset_size(type.id(), size), where);
  check(H5Tset_cset(type.id(), H5T_CSET_UTF8), where);
  return type;
}

}  // namespace

void silence() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

void fail(std::string_view where) {
  std::string reason = "no reason given";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &reason);
  throw StorageError(fmt::format("{}: HDF5 failed ({})", where, reason));
}

Handle property_list(hid_t list_class, std::string_view where) {
  return {H5Pcreate(list_class), H5Pclose, where};
}

Handle fixed_text(std::size_t size, std::string_view where) {
  Handle type = text_type(size, where);
  check(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), where);
  return type;
}

Handle variable_text(std::string_view where) { return text_type(H5T_VARIABLE, where); }

Handle open_file(const char* path, std::string_view where) {
  const Handle access = property_list(H5P_FILE_ACCESS, where);
  check(H5Pset_file_locking(access.id(), 0, 1), where);
  return {H5Fopen(path, H5F_ACC_RDONLY, access.id()), H5Fclose, where};
}

}  // namespace rabiline::hdf5
