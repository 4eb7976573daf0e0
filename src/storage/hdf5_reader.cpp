#include "storage/hdf5_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "storage/seal.hpp"
#include "storage/trial.hpp"

namespace rabiline::hdf5 {
namespace {

[[noreturn]] void refuse(const std::string& where, std::string_view why) {
  throw StorageError(fmt::format("{}: refused ({})", where, why));
}

/// Our own chunks hold 1 MiB, or one text where that is longer.
constexpr hsize_t largest_chunk = 64 << 20;

Handle open_without_plugins(const std::filesystem::path& path) {
  silence();
  check(H5PLset_loading_state(0), path.string());
  return open_file(path.c_str(), path.string());
}

Handle open_image(std::span<const std::byte> image) {
  silence();
  constexpr std::size_t increment = 1 << 20;
  const std::string name = "memory";
  const Handle access = property_list(H5P_FILE_ACCESS, name);
  check(H5Pset_fapl_core(access.id(), increment, false), name);
  // HDF5 makes a copy, although it asks for bytes that it might change.
  check(H5Pset_file_image(access.id(), const_cast<std::byte*>(image.data()), image.size()), name);
  return {H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose, name};
}

void require_known_filters(hid_t properties, const std::string& where) {
  const int filters = check(H5Pget_nfilters(properties), where);
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr, &config);
    if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32) {
      refuse(where, "it is packed by an unknown filter");
    }
  }
}

/// Virtual and external datasets name other files, which whoever made this file may not be allowed to read.
void require_inside(hid_t properties, const std::string& where) {
  if (check(H5Pget_layout(properties), where) == H5D_VIRTUAL) refuse(where, "it is a virtual dataset");
  if (check(H5Pget_external_count(properties), where) != 0) refuse(where, "its data lie in another file");
}

void require_own_storage(hid_t dataset, std::size_t element_size, const std::string& where, int rank = 1) {
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose, where);
  require_inside(properties.id(), where);
  require_known_filters(properties.id(), where);
  if (H5Pget_layout(properties.id()) != H5D_CHUNKED) return;
  std::array<hsize_t, H5S_MAX_RANK> sizes{};
  if (check(H5Pget_chunk(properties.id(), H5S_MAX_RANK, sizes.data()), where) != rank)
    refuse(where, fmt::format("it has not {} dimension{}", rank, rank == 1 ? "" : "s"));
  hsize_t chunk = element_size;
  for (int i = 0; i < rank; ++i) {
    if (chunk > largest_chunk || sizes[static_cast<std::size_t>(i)] > largest_chunk / chunk)
      refuse(where, "its chunks are too large");
    chunk *= sizes[static_cast<std::size_t>(i)];
  }
}

/// Called by HDF5 for each name in the file: whether something is behind it, in this file. The first refusal
/// is kept, as no exception may pass through HDF5.
struct Visit {
  const std::string& file_name;
  std::vector<std::string>& names;
  std::string refusal{};
};
herr_t visit_name(hid_t group, const char* name, const H5L_info_t* link, void* visit_data) {
  Visit& visit = *static_cast<Visit*>(visit_data);
  const std::string where = fmt::format("{}: /{}", visit.file_name, name);
  try {
    if (link->type != H5L_TYPE_HARD) refuse(where, "it is a link to somewhere else");
    const Handle object(H5Oopen(group, name, H5P_DEFAULT), H5Oclose, where);
    visit.names.emplace_back(name);
    if (H5Iget_type(object.id()) != H5I_DATASET) return 0;
    const Handle properties(H5Dget_create_plist(object.id()), H5Pclose, where);
    require_inside(properties.id(), where);
    return 0;
  } catch (const StorageError& error) {
    visit.refusal = error.what();
    return -1;
  }
}

/// Deflate packs 1032 bytes into one at best. A small file thus cannot make us allocate much.
void require_stored(hid_t dataset, std::size_t size, const std::string& where) {
  constexpr std::size_t best_ratio = 1100;
  if (size / best_ratio > H5Dget_storage_size(dataset)) refuse(where, "it claims more than it stores");
}

/// The number of elements of a one-dimensional dataset that fits the limit.
std::size_t length_within(hid_t dataset, std::size_t limit, const std::string& where) {
  const Handle space(H5Dget_space(dataset), H5Sclose, where);
  hsize_t length = 0;
  if (check(H5Sget_simple_extent_ndims(space.id()), where) != 1) refuse(where, "it is not one-dimensional");
  check(H5Sget_simple_extent_dims(space.id(), &length, nullptr), where);
  if (length > limit) refuse(where, fmt::format("it is too long: {} where {} is the most", length, limit));
  return static_cast<std::size_t>(length);
}

/// Type and shape as bytes, before the values that follow.
struct Kind {
  Handle type, space;
  std::size_t size;   // of one value [bytes]
  std::size_t count;  // of values
  bool varies;        // texts of any length
  std::string bytes;
};
Kind kind_of(Handle type, Handle space, const std::string& where) {
  const H5T_class_t kind = H5Tget_class(type.id());
  if (kind != H5T_INTEGER && kind != H5T_FLOAT && kind != H5T_STRING)
    refuse(where, "it holds neither numbers nor texts");
  const bool varies = kind == H5T_STRING && check(H5Tis_variable_str(type.id()), where) != 0;
  std::size_t size = 0;
  check(H5Tencode(type.id(), nullptr, &size), where);
  std::string bytes(size, '\0');
  check(H5Tencode(type.id(), bytes.data(), &size), where);
  std::array<hsize_t, H5S_MAX_RANK> sizes{};
  const int rank = check(H5Sget_simple_extent_dims(space.id(), sizes.data(), nullptr), where);
  bytes += fmt::format("{} {}", static_cast<int>(H5Sget_simple_extent_type(space.id())),
                       fmt::join(sizes.begin(), sizes.begin() + rank, " "));
  const auto count = static_cast<std::size_t>(check(H5Sget_simple_extent_npoints(space.id()), where));
  const std::size_t of_one = H5Tget_size(type.id());
  return {std::move(type), std::move(space), of_one, count, varies, std::move(bytes)};
}

/// Called by HDF5 for each attribute in the order of their names.
struct Attributed {
  std::string where;
  std::span<const std::string_view> but;
  bool texts_are_sound;  // known already, of the whole file
  std::string bytes{}, refusal{};
};
herr_t add_attribute(hid_t object, const char* name, const H5A_info_t*, void* data) {
  constexpr std::size_t most = 1 << 16;
  Attributed& all = *static_cast<Attributed*>(data);
  if (std::ranges::find(all.but, name) != all.but.end()) return 0;
  const std::string where = fmt::format("{}, attribute {}", all.where, name);
  try {
    const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, where);
    const Kind kind = kind_of({H5Aget_type(attribute.id()), H5Tclose, where},
                              {H5Aget_space(attribute.id()), H5Sclose, where}, where);
    if (kind.size > most || kind.count > most / kind.size) refuse(where, "it is too large");
    all.bytes += fmt::format("@{}={}", name, kind.bytes);
    std::string values(kind.count * kind.size, '\0');
    const auto read = [&] { return H5Aread(attribute.id(), kind.type.id(), values.data()) >= 0; };
    if (kind.varies && !all.texts_are_sound && !ends_well(read)) refuse(where, "its text cannot be read");
    check(H5Aread(attribute.id(), kind.type.id(), values.data()), where);
    if (!kind.varies) {
      all.bytes += values;
      return 0;
    }
    std::vector<char*> texts(kind.count);
    std::memcpy(texts.data(), values.data(), values.size());
    for (const char* text : texts) all.bytes.append(text == nullptr ? "" : text).push_back('\0');
    check(H5Dvlen_reclaim(kind.type.id(), kind.space.id(), H5P_DEFAULT, texts.data()), where);
    return 0;
  } catch (const StorageError& error) {
    all.refusal = error.what();
    return -1;
  }
}

}  // namespace

FileReader::FileReader(const std::filesystem::path& path, Writer writer)
    : file_name_(path.string()),
      digest_(writer == Writer::rabiline ? require_seal(path) : std::string()),
      file_(open_without_plugins(path)) {
  find_names();
}
FileReader::FileReader(std::span<const std::byte> image) : file_name_("memory"), file_(open_image(image)) {
  find_names();
}

void FileReader::find_names() {
  Visit visit{file_name_, names_};
  const herr_t visited = H5Lvisit(file_.id(), H5_INDEX_NAME, H5_ITER_NATIVE, visit_name, &visit);
  if (!visit.refusal.empty()) throw StorageError(visit.refusal);
  check(visited, file_name_);
  std::ranges::sort(names_);
}

std::string FileReader::where(const std::string& name) const {
  return fmt::format("{}: /{}", file_name_, name);
}

Handle FileReader::open_dataset(const std::string& name) const {
  const std::string place = where(name);
  return {H5Dopen2(file_.id(), name.c_str(), H5P_DEFAULT), H5Dclose, place};
}

bool FileReader::contains(const std::string& name) const {
  for (std::size_t end = 0; end != name.npos;) {
    end = name.find('/', end + 1);
    if (check(H5Lexists(file_.id(), name.substr(0, end).c_str(), H5P_DEFAULT), where(name)) == 0)
      return false;
  }
  return true;
}

bool FileReader::texts_are_sound() const {
  const auto read_all = [&] {
    const auto read_of = [&](const std::string& name) {
      const Handle object(H5Oopen(file_.id(), name.c_str(), H5P_DEFAULT), H5Oclose, name);
      Attributed attributes{name, {}, true};
      return H5Aiterate2(object.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add_attribute, &attributes) >= 0;
    };
    return read_of("/") && std::ranges::all_of(names_, read_of);
  };
  if (!texts_are_sound_) texts_are_sound_ = ends_well(read_all);
  return *texts_are_sound_;
}

std::string FileReader::everything(const std::string& name, std::span<const std::string_view> but) const {
  const std::string place = where(name);
  const Handle object(H5Oopen(file_.id(), name.c_str(), H5P_DEFAULT), H5Oclose, place);
  Attributed attributes{place, but, texts_are_sound()};
  const herr_t iterated =
      H5Aiterate2(object.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add_attribute, &attributes);
  if (!attributes.refusal.empty()) throw StorageError(attributes.refusal);
  check(iterated, place);
  if (H5Iget_type(object.id()) != H5I_DATASET) return "group " + attributes.bytes;
  Kind kind = kind_of({H5Dget_type(object.id()), H5Tclose, place},
                      {H5Dget_space(object.id()), H5Sclose, place}, place);
  if (kind.varies) refuse(place, "its texts are of any length");
  require_own_storage(object.id(), kind.size, place, H5Sget_simple_extent_ndims(kind.space.id()));
  require_stored(object.id(), kind.count * kind.size, place);
  std::string values(kind.count * kind.size, '\0');
  check(H5Dread(object.id(), kind.type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), place);
  return fmt::format("dataset {}={}{}", attributes.bytes, kind.bytes, values);
}

template <class Number>
std::vector<Number> FileReader::numbers_of(const std::string& name, std::size_t most, hid_t file_type,
                                           hid_t memory_type, std::string_view kind) const {
  const std::string place = where(name);
  const Handle dataset = open_dataset(name), type(H5Dget_type(dataset.id()), H5Tclose, place);
  if (check(H5Tequal(type.id(), file_type), place) == 0)
    refuse(place, fmt::format("it does not hold {}", kind));
  require_own_storage(dataset.id(), sizeof(Number), place);
  const std::size_t length = length_within(dataset.id(), most, place);
  require_stored(dataset.id(), length * sizeof(Number), place);
  std::vector<Number> values(length);
  check(H5Dread(dataset.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), place);
  return values;
}

std::vector<std::uint64_t> FileReader::numbers(const std::string& name, std::size_t most_numbers) const {
  return numbers_of<std::uint64_t>(name, most_numbers, H5T_STD_U64LE, H5T_NATIVE_UINT64,
                                   "64-bit unsigned integers");
}
std::vector<double> FileReader::reals(const std::string& name, std::size_t most_numbers) const {
  return numbers_of<double>(name, most_numbers, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, "64-bit real numbers");
}

std::vector<double> FileReader::reals_of_any_size(const std::string& name, std::size_t most) const {
  const std::string place = where(name);
  const Handle dataset = open_dataset(name);
  return grid(name, {length_within(dataset.id(), most, place)});
}

std::vector<double> FileReader::grid(const std::string& name, const std::vector<std::size_t>& sizes) const {
  const std::string place = where(name);
  const Handle dataset = open_dataset(name), type(H5Dget_type(dataset.id()), H5Tclose, place),
               space(H5Dget_space(dataset.id()), H5Sclose, place);
  if (H5Tget_class(type.id()) != H5T_FLOAT) refuse(place, "it does not hold real numbers");
  const std::size_t width = H5Tget_size(type.id());
  if (width != sizeof(float) && width != sizeof(double))
    refuse(place, "its numbers have neither 32 nor 64 bits");
  const int rank = static_cast<int>(sizes.size());
  require_own_storage(dataset.id(), width, place, rank);
  std::vector<hsize_t> there(H5S_MAX_RANK);
  if (check(H5Sget_simple_extent_dims(space.id(), there.data(), nullptr), place) != rank)
    refuse(place, fmt::format("it has not {} dimension{}", rank, rank == 1 ? "" : "s"));
  std::size_t count = 1;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (there[i] != sizes[i])
      refuse(place, fmt::format("it has {} numbers where its axis has {}", there[i], sizes[i]));
    count *= sizes[i];
  }
  require_stored(dataset.id(), count * width, place);
  std::vector<double> values(count);
  check(H5Dread(dataset.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), place);
  return values;
}

std::string FileReader::attribute(const std::string& name, const char* attribute_name) const {
  constexpr std::size_t longest = 64;
  const std::string place = fmt::format("{}, attribute {}", where(name), attribute_name);
  const Handle dataset = open_dataset(name);
  if (check(H5Aexists(dataset.id(), attribute_name), place) == 0) refuse(place, "there is none");
  const Handle attribute(H5Aopen(dataset.id(), attribute_name, H5P_DEFAULT), H5Aclose, place),
      type(H5Aget_type(attribute.id()), H5Tclose, place),
      space(H5Aget_space(attribute.id()), H5Sclose, place);
  if (H5Tget_class(type.id()) != H5T_STRING || H5Sget_simple_extent_npoints(space.id()) != 1)
    refuse(place, "it is not a single text");
  if (check(H5Tis_variable_str(type.id()), place) != 0) {
    char* text = nullptr;
    const Handle memory = variable_text(place);
    const hid_t as = H5Tget_cset(type.id()) == H5T_CSET_ASCII ? type.id() : memory.id();
    if (!ends_well([&] { return H5Aread(attribute.id(), as, &text) >= 0; }))
      refuse(place, "its text cannot be read");
    check(H5Aread(attribute.id(), as, &text), place);
    std::string out = text == nullptr ? "" : std::string(text).substr(0, longest);
    H5free_memory(text);
    return out;
  }
  const std::size_t size = H5Tget_size(type.id());
  if (size == 0 || size > longest) refuse(place, "it is not a text of a reasonable length");
  std::string bytes(size + 1, '\0');
  check(H5Aread(attribute.id(), type.id(), bytes.data()), place);
  return bytes.c_str();
}

std::string FileReader::text(const std::string& name, std::size_t most_bytes) const {
  const std::string place = where(name);
  const Handle dataset = open_dataset(name), type(H5Dget_type(dataset.id()), H5Tclose, place),
               space(H5Dget_space(dataset.id()), H5Sclose, place);
  const std::size_t size = H5Tget_size(type.id());
  if (H5Tget_class(type.id()) != H5T_STRING || check(H5Tis_variable_str(type.id()), place) != 0 ||
      H5Sget_simple_extent_type(space.id()) != H5S_SCALAR || size == 0 || size > most_bytes)
    refuse(place, "it is not a single text of a reasonable length");
  require_own_storage(dataset.id(), size, place);
  std::string bytes(size, '\0');
  const Handle memory = fixed_text(size, place);
  check(H5Dread(dataset.id(), memory.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()), place);
  return bytes.substr(0, bytes.find_last_not_of('\0') + 1);
}

std::vector<std::string> FileReader::texts(const std::string& name, std::size_t most_bytes) const {
  const std::string place = where(name);
  const Handle dataset = open_dataset(name), type(H5Dget_type(dataset.id()), H5Tclose, place);
  const std::size_t size = H5Tget_size(type.id());
  if (H5Tget_class(type.id()) != H5T_STRING || check(H5Tis_variable_str(type.id()), place) != 0 ||
      size == 0) {
    refuse(place, "it does not hold texts of fixed size");
  }
  require_own_storage(dataset.id(), size, place);
  const std::size_t length = length_within(dataset.id(), most_bytes / size, place);
  require_stored(dataset.id(), length * size, place);
  std::string bytes(length * size, '\0');
  const Handle memory = fixed_text(size, place);
  check(H5Dread(dataset.id(), memory.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()), place);
  std::vector<std::string> texts;
  for (std::size_t begin = 0; begin < bytes.size(); begin += size) {
    const std::string padded = bytes.substr(begin, size);
    texts.push_back(padded.substr(0, padded.find_last_not_of('\0') + 1));
  }
  return texts;
}

}  // namespace rabiline::hdf5
