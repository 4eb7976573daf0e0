#include "storage/disk_file.hpp"

#include <algorithm>
#include <memory>
#include <new>

namespace rabiline::hdf5 {
namespace {

/// What HDF5 copies from an access to the files that are opened by it.
struct Info {
  DiskFile* disk = nullptr;
};
/// What HDF5 has of an open file; its own part comes first.
struct Opened {
  H5FD_t own{};
  DiskFile* disk = nullptr;
  haddr_t end_of_addresses = 0, end_of_file = 0;
};
Opened& opened(H5FD_t* file) { return *reinterpret_cast<Opened*>(file); }
const Opened& opened(const H5FD_t* file) { return *reinterpret_cast<const Opened*>(file); }

H5FD_t* open_disk(const char* /*name*/, unsigned /*flags*/, hid_t access, haddr_t /*most*/) {
  const auto* info = static_cast<const Info*>(H5Pget_driver_info(access));
  if (info == nullptr) return nullptr;
  auto made = std::make_unique<Opened>();
  made->disk = info->disk;
  return &made.release()->own;
}
herr_t close_disk(H5FD_t* file) {
  const std::unique_ptr<Opened> gone(&opened(file));
  gone->disk->end(gone->end_of_addresses);
  return 0;
}
/// As HDF5's own driver of files in memory says of itself.
herr_t query_disk(const H5FD_t* /*file*/, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}
haddr_t end_of_addresses(const H5FD_t* file, H5FD_mem_t /*kind*/) { return opened(file).end_of_addresses; }
herr_t set_end_of_addresses(H5FD_t* file, H5FD_mem_t /*kind*/, haddr_t end) {
  opened(file).end_of_addresses = end;
  return 0;
}
haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t /*kind*/) { return opened(file).end_of_file; }
herr_t read_disk(H5FD_t* file, H5FD_mem_t /*kind*/, hid_t /*transfer*/, haddr_t at, std::size_t size,
                 void* bytes) {
  opened(file).disk->read(at, {static_cast<std::byte*>(bytes), size});
  return 0;
}
herr_t write_disk(H5FD_t* file, H5FD_mem_t /*kind*/, hid_t /*transfer*/, haddr_t at, std::size_t size,
                  const void* bytes) {
  try {
    opened(file).disk->write(at, {static_cast<const std::byte*>(bytes), size});
  } catch (const std::bad_alloc&) {
    return -1;
  }
  opened(file).end_of_file = std::max<haddr_t>(opened(file).end_of_file, at + size);
  return 0;
}

hid_t registered() {
  H5FD_class_t driver{};
#ifdef H5FD_CLASS_VERSION
  driver.version = H5FD_CLASS_VERSION;
  driver.value = static_cast<H5FD_class_value_t>(H5_VFD_RESERVED + 1);
#endif
  driver.name = "rabiline";
  driver.maxaddr = (haddr_t{1} << 62) - 1;
  driver.fc_degree = H5F_CLOSE_STRONG;
  driver.fapl_size = sizeof(Info);
  driver.open = open_disk;
  driver.close = close_disk;
  driver.query = query_disk;
  driver.get_eoa = end_of_addresses;
  driver.set_eoa = set_end_of_addresses;
  driver.get_eof = end_of_file;
  driver.read = read_disk;
  driver.write = write_disk;
  constexpr H5FD_mem_t of_each_kind[] = H5FD_FLMAP_DICHOTOMY;
  std::ranges::copy(of_each_kind, driver.fl_map);
  return H5FDregister(&driver);
}

}  // namespace

void DiskFile::write(std::size_t offset, std::span<const std::byte> bytes) {
  if (error_ == 0) error_ = file_.put(offset, bytes);
  if (error_ != 0) unwritten_.emplace_back(offset, std::vector(bytes.begin(), bytes.end()));
}

void DiskFile::read(std::size_t offset, std::span<std::byte> bytes) const {
  file_.get(offset, bytes);
  for (const auto& [at, piece] : unwritten_) {  // what came later goes over what came before
    const std::size_t begin = std::max(offset, at), end = std::min(offset + bytes.size(), at + piece.size());
    if (begin < end)
      std::ranges::copy(std::span(piece).subspan(begin - at, end - begin), &bytes[begin - offset]);
  }
}

void DiskFile::require_written() const {
  if (error_ != 0) file_.refuse_for(error_);
}

NewFile& DiskFile::closed() {
  require_written();
  file_.cut(size_);
  return file_;
}

Handle access_to(DiskFile& disk, std::string_view where) {
  static const hid_t driver = registered();
  Handle access = property_list(H5P_FILE_ACCESS, where);
  const Info info{&disk};
  check(H5Pset_driver(access.id(), driver, &info), where);
  return access;
}

}  // namespace rabiline::hdf5
