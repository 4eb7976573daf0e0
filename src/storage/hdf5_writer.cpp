#include "storage/hdf5_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <numeric>

#include "storage/disk_file.hpp"
#include "storage/safe_file.hpp"
#include "storage/seal.hpp"

namespace rabiline::hdf5 {
namespace {

constexpr std::size_t mebibyte = 1 << 20;

std::size_t count_of(const Shape& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

/// Chunks of at most 1 MiB, HDF5's chunk cache. The slowest dimensions are cut first, so a chunk holds whole
/// images.
std::vector<hsize_t> chunk_of(const Shape& shape, std::size_t element_size) {
  Shape chunk = shape;
  for (std::size_t& length : chunk) {
    const std::size_t others = count_of(chunk) / length * element_size;
    length = std::clamp<std::size_t>(mebibyte / others, 1, length);
  }
  return {chunk.begin(), chunk.end()};
}

void require_count(const std::string& where, std::size_t there, std::size_t wanted) {
  if (there != wanted) throw StorageError(fmt::format("{}: {} values where {} belong", where, there, wanted));
}

Shape joined(Shape slow, const Shape& fast) {
  slow.insert(slow.end(), fast.begin(), fast.end());
  return slow;
}
Shape whole(const OverPoints& over) { return joined(joined(over.before, over.grid), over.behind); }

/// Calls it with each box [start, start + count) of a grid that together are the points [begin, end), in
/// their order.
template <class Call>
void each_box(const Shape& grid, std::size_t begin, std::size_t end, Call call) {
  for (std::size_t at = begin; at < end;) {
    std::size_t dimension = grid.size() - 1, stride = 1;  // the slowest of which whole rows begin here
    while (dimension > 0 && at % (stride * grid[dimension]) == 0 && at + stride * grid[dimension] <= end)
      stride *= grid[dimension--];
    Shape start(grid.size()), count(grid.size(), 1);
    for (std::size_t d = grid.size(), rest = at; d-- > 0; rest /= grid[d]) start[d] = rest % grid[d];
    for (std::size_t d = dimension + 1; d < grid.size(); ++d) count[d] = grid[d];
    count[dimension] = std::min((end - at) / stride, grid[dimension] - start[dimension]);
    call(start, count);
    at += count[dimension] * stride;
  }
}

Handle dataspace(const Shape& shape, const std::string& where) {
  if (shape.empty()) return {H5Screate(H5S_SCALAR), H5Sclose, where};
  const std::vector<hsize_t> dims(shape.begin(), shape.end());
  return {H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr), H5Sclose, where};
}

Handle creation_properties(const Shape& shape, std::size_t element_size, const std::string& where) {
  Handle properties = property_list(H5P_DATASET_CREATE, where);
  check(H5Pset_obj_track_times(properties.id(), false), where);
  if (shape.empty() || count_of(shape) == 0) return properties;
  const std::vector<hsize_t> chunk = chunk_of(shape, element_size);
  check(H5Pset_chunk(properties.id(), static_cast<int>(chunk.size()), chunk.data()), where);
  check(H5Pset_shuffle(properties.id()), where);
  check(H5Pset_deflate(properties.id(), 4), where);
  check(H5Pset_fletcher32(properties.id()), where);
  return properties;
}

/// Of a dataset whose points come slab by slab: no chunk is packed before it is full.
Handle access_of_slabs(const OverPoints& over, std::size_t element_size, const std::string& where) {
  const std::vector<hsize_t> chunk = chunk_of(whole(over), element_size);
  std::size_t bytes = count_of({chunk.begin(), chunk.end()}) * element_size;
  for (std::size_t d = 0; d < over.before.size(); ++d) bytes *= (over.before[d] + chunk[d] - 1) / chunk[d];
  constexpr std::size_t slots = 12421;     // a prime, many times as many as there are chunks
  constexpr double full_chunks_first = 1;  // are forgotten
  Handle properties = property_list(H5P_DATASET_ACCESS, where);
  check(H5Pset_chunk_cache(properties.id(), slots, bytes, full_chunks_first), where);
  return properties;
}

void write_box(const Handle& dataset, const Shape& start, const Shape& count, hid_t memory_type,
               const void* values, const std::string& where) {
  const Handle file(H5Dget_space(dataset.id()), H5Sclose, where), memory = dataspace(count, where);
  const std::vector<hsize_t> from(start.begin(), start.end()), size(count.begin(), count.end());
  check(H5Sselect_hyperslab(file.id(), H5S_SELECT_SET, from.data(), nullptr, size.data(), nullptr), where);
  check(H5Dwrite(dataset.id(), memory_type, memory.id(), file.id(), H5P_DEFAULT, values), where);
}

void write_attribute(hid_t object, const std::string& name, hid_t type, const Shape& shape, const void* data,
                     const std::string& where) {
  const Handle space = dataspace(shape, where);
  Handle attribute(H5Acreate2(object, name.c_str(), type, space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                   where);
  check(H5Awrite(attribute.id(), type, data), where);
  attribute.close(where);
}

void write_text_attribute(hid_t object, const std::string& name, std::string_view value,
                          const std::string& where) {
  const std::string ended(value);
  const char* const pointer = ended.c_str();
  write_attribute(object, name, variable_text(where).id(), {}, &pointer, where);
}

/// The texts one behind the other, each padded to the longest.
struct PackedTexts {
  std::size_t size = 1;
  std::string bytes;
};
PackedTexts pack(std::span<const std::string> texts) {
  PackedTexts packed;
  for (const std::string& text : texts) packed.size = std::max(packed.size, text.size());
  packed.bytes.reserve(packed.size * texts.size());
  for (const std::string& text : texts) packed.bytes.append(text).append(packed.size - text.size(), '\0');
  return packed;
}

Handle access_to_memory(const std::string& name) {
  Handle access = property_list(H5P_FILE_ACCESS, name);
  check(H5Pset_fapl_core(access.id(), mebibyte, false), name);
  return access;
}

/// In the oldest format, which every reader knows. Of the newer ones, H5Fget_file_image of HDF5 1.10 gives
/// back a superblock with a wrong checksum (HDFGroup/hdf5, pull request 5489).
Handle new_file(const std::string& name, DiskFile* disk) {
  silence();
  const Handle access = disk ? access_to(*disk, name) : access_to_memory(name),
               creation = property_list(H5P_FILE_CREATE, name);
  check(H5Pset_obj_track_times(creation.id(), false), name);
  return {H5Fcreate(name.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose, name};
}

/// Before a file is given its name.
void require_whole(const std::filesystem::path& temporary, const std::string& seal, const std::string& name) {
  try {
    if (seal.find(require_seal(temporary)) != seal.npos) return;
  } catch (const StorageError&) {
  }
  throw StorageError(fmt::format("{}: reads back other than it was written; check the disk", name));
}

}  // namespace

GroupWriter::GroupWriter(Handle group, std::string file, std::string path, SlabWriting& slabs)
    : group_(std::move(group)), file_(std::move(file)), path_(std::move(path)), slabs_(&slabs) {}

std::string GroupWriter::where(const std::string& name) const {
  return fmt::format("{}: {}/{}", file_, path_, name);
}

GroupWriter GroupWriter::group(const std::string& name, std::string_view nx_class) const {
  const std::string path = path_ + "/" + name;
  if (goes_on())
    return {Handle(H5Gopen2(group_.id(), name.c_str(), H5P_DEFAULT), H5Gclose, where(name)), file_, path,
            *slabs_};
  const Handle properties = property_list(H5P_GROUP_CREATE, where(name));
  check(H5Pset_obj_track_times(properties.id(), false), where(name));
  Handle handle(H5Gcreate2(group_.id(), name.c_str(), H5P_DEFAULT, properties.id(), H5P_DEFAULT), H5Gclose,
                where(name));
  GroupWriter made(std::move(handle), file_, path, *slabs_);
  if (!nx_class.empty()) made.attribute("NX_class", nx_class);
  return made;
}

void GroupWriter::attribute(const std::string& name, std::string_view value) const {
  if (!goes_on()) write_text_attribute(group_.id(), name, value, where("@" + name));
}

void GroupWriter::attribute(const std::string& name, const std::vector<std::string>& values) const {
  if (goes_on()) return;
  std::vector<const char*> pointers;
  pointers.reserve(values.size());
  for (const std::string& value : values) pointers.push_back(value.c_str());
  const std::string place = where("@" + name);
  write_attribute(group_.id(), name, variable_text(place).id(), {values.size()}, pointers.data(), place);
}

void GroupWriter::attribute(const std::string& name, std::uint64_t value) const {
  if (!goes_on()) write_attribute(group_.id(), name, H5T_NATIVE_UINT64, {}, &value, where("@" + name));
}

Handle GroupWriter::create(const std::string& name, const Shape& shape, const Elements& elements,
                           const Attributes& attributes, const Handle& access) const {
  const std::string place = where(name);
  const Handle space = dataspace(shape, place), properties = creation_properties(shape, elements.size, place);
  Handle dataset(H5Dcreate2(group_.id(), name.c_str(), elements.file_type, space.id(), H5P_DEFAULT,
                            properties.id(), access.id()),
                 H5Dclose, place);
  for (const auto& [key, value] : attributes) write_text_attribute(dataset.id(), key, value, place);
  return dataset;
}

void GroupWriter::write(const std::string& name, const Shape& shape, const Elements& elements,
                        const Attributes& attributes) const {
  const std::string place = where(name);
  require_count(place, elements.count, count_of(shape));
  Handle dataset = create(name, shape, elements, attributes, property_list(H5P_DATASET_ACCESS, place));
  check(H5Dwrite(dataset.id(), elements.memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, elements.data), place);
  dataset.close(place);
}

void GroupWriter::write_points(const std::string& name, const OverPoints& over, const Elements& elements,
                               const Attributes& attributes) const {
  const Slab& slab = slabs_->slab;
  const Shape shape = whole(over);
  if (slab.is_whole()) return write(name, shape, elements, attributes);
  const std::string place = where(name);
  const std::size_t rows = count_of(over.before), row = count_of(over.behind);
  require_count(place, elements.count, rows * slab.count * row);
  if (!goes_on())
    slabs_->open.emplace(
        place, create(name, shape, elements, attributes, access_of_slabs(over, elements.size, place)));
  const Handle& dataset = slabs_->open.at(place);
  const auto* next = static_cast<const std::byte*>(elements.data);
  for (std::size_t i = 0; i < rows; ++i)
    each_box(joined(over.before, over.grid), i * slab.all + slab.first,
             i * slab.all + slab.first + slab.count, [&](const Shape& start, const Shape& count) {
               write_box(dataset, joined(start, Shape(over.behind.size())), joined(count, over.behind),
                         elements.memory_type, next, place);
               next += count_of(count) * row * elements.size;
             });
}

GroupWriter::Elements GroupWriter::elements_of(std::span<const double> values) {
  return {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, sizeof(double), values.size(), values.data()};
}
GroupWriter::Elements GroupWriter::elements_of(std::span<const std::uint64_t> values) {
  return {H5T_NATIVE_UINT64, H5T_STD_U64LE, sizeof(std::uint64_t), values.size(), values.data()};
}

void GroupWriter::dataset(const std::string& name, const Shape& shape, std::span<const double> values,
                          const Attributes& attributes) const {
  if (!goes_on()) write(name, shape, elements_of(values), attributes);
}

void GroupWriter::dataset(const std::string& name, const Shape& shape, std::span<const std::uint64_t> values,
                          const Attributes& attributes) const {
  if (!goes_on()) write(name, shape, elements_of(values), attributes);
}

void GroupWriter::over_points(const std::string& name, const OverPoints& over, std::span<const double> values,
                              const Attributes& attributes) const {
  write_points(name, over, elements_of(values), attributes);
}

void GroupWriter::over_points(const std::string& name, const OverPoints& over,
                              std::span<const std::uint64_t> values, const Attributes& attributes) const {
  write_points(name, over, elements_of(values), attributes);
}

void GroupWriter::dataset(const std::string& name, const Shape& shape, std::span<const std::string> values,
                          const Attributes& attributes) const {
  if (goes_on()) return;
  const PackedTexts packed = pack(values);
  const Handle type = fixed_text(packed.size, where(name));
  write(name, shape, {type.id(), type.id(), packed.size, values.size(), packed.bytes.data()}, attributes);
}

void GroupWriter::text(const std::string& name, const std::string& value,
                       const Attributes& attributes) const {
  dataset(name, {}, std::span(&value, 1), attributes);
}

void GroupWriter::number(const std::string& name, double value, const Attributes& attributes) const {
  dataset(name, {}, std::span(&value, 1), attributes);
}

void GroupWriter::number(const std::string& name, std::uint64_t value, const Attributes& attributes) const {
  dataset(name, {}, std::span(&value, 1), attributes);
}

void GroupWriter::link(const std::string& name, const std::string& target) const {
  if (goes_on()) return;
  check(H5Lcreate_hard(group_.id(), target.c_str(), group_.id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
        where(name));
}

FileWriter::FileWriter(std::filesystem::path target, Place place)
    : target_(std::move(target)),
      disk_(place == Place::disk ? std::make_unique<DiskFile>(target_) : nullptr),
      file_(new_file(target_.string(), disk_.get())) {}
FileWriter::FileWriter(FileWriter&&) noexcept = default;
FileWriter::~FileWriter() = default;

GroupWriter FileWriter::root() {
  return {Handle(H5Gopen2(file_.id(), "/", H5P_DEFAULT), H5Gclose, target_.string()), target_.string(), "",
          *slabs_};
}

void FileWriter::turn_to(const Slab& slab) { slabs_->slab = slab; }

void FileWriter::require_written() const {
  if (disk_) disk_->require_written();
}

void FileWriter::end_slabs() {
  for (auto& [place, dataset] : slabs_->open) dataset.close(place);
  *slabs_ = {};
}

std::size_t FileWriter::size() const {
  const std::string name = target_.string();
  check(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL), name);
  hsize_t size = 0;
  check(H5Fget_filesize(file_.id(), &size), name);
  return static_cast<std::size_t>(size);
}

std::vector<std::byte> FileWriter::image() const {
  const std::string name = target_.string();
  check(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL), name);
  const ssize_t size = check(H5Fget_file_image(file_.id(), nullptr, 0), name);
  std::vector<std::byte> bytes(static_cast<std::size_t>(size));
  check(H5Fget_file_image(file_.id(), bytes.data(), bytes.size()), name);
  return bytes;
}

void FileWriter::save() {
  const std::string name = target_.string();
  std::string seal;
  const auto last_line = [&] { return std::as_bytes(std::span(seal)); };
  const auto verify = [&](const std::filesystem::path& temporary) { require_whole(temporary, seal, name); };
  if (disk_) {
    file_.close(name);
    NewFile& file = disk_->closed();
    seal = seal_of(file.path());
    file.append(last_line());
    file.become_target(verify);
    return;
  }
  std::vector<std::byte> bytes = image();
  seal = seal_of(bytes);
  bytes.insert(bytes.end(), last_line().begin(), last_line().end());
  replace_file(target_, bytes, verify);
}

}  // namespace rabiline::hdf5
