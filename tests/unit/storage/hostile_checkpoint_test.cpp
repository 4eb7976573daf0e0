// Checkpoints with a valid checksum whose HDF5 content was made to harm.
#include "samples.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cstring>
#include <functional>

#include "storage/checkpoint_file.hpp"
#include "storage/seal.hpp"

namespace rabiline::hostile_checkpoint_test {
namespace {

using samples::Folder;

/// Puts back the last line, as anybody could.
void seal(const std::filesystem::path& from, const std::filesystem::path& to) {
  const std::string contents = samples::bytes_of(from);
  samples::put_bytes(to, contents + seal_of(std::as_bytes(std::span(contents))));
}

void remove(hid_t file, const char* name) { ASSERT_GE(H5Ldelete(file, name, H5P_DEFAULT), 0); }

/// A one-dimensional dataset instead of the one that is there.
void put(hid_t file, const char* name, hid_t type, const std::vector<hsize_t>& dims,
         hid_t properties = H5P_DEFAULT) {
  remove(file, name);
  const hid_t space = H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr);
  ASSERT_GE(H5Dcreate2(file, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT), 0);
}

hid_t chunked(hsize_t size) {
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(properties, 1, &size);
  return properties;
}

hid_t external() {
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_external(properties, "/etc/passwd", 0, H5F_UNLIMITED);
  return properties;
}

hid_t virtual_of(hsize_t length) {
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(1, &length, nullptr);
  H5Pset_virtual(properties, space, "/etc/passwd", "data", space);
  return properties;
}

hid_t variable_text() {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  return type;
}

hid_t fixed_text() {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

void put_numbers(hid_t file, const char* name, const std::vector<std::uint64_t>& values) {
  put(file, name, H5T_STD_U64LE, {values.size()});
  const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
  H5Dwrite(dataset, H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Dclose(dataset);
}

struct Attack {
  std::string name;
  std::function<void(hid_t)> change;
  std::string refusal;
};
void PrintTo(const Attack& attack, std::ostream* out) { *out << attack.name; }

std::vector<Attack> attacks() {
  const hsize_t huge = hsize_t{1} << 50;
  return {
      {"NothingChanged", [](hid_t) {}, ""},
      {"ExternalLink",
       [](hid_t file) {
         remove(file, "sums_low");
         H5Lcreate_external("/etc/passwd", "/", file, "sums_low", H5P_DEFAULT, H5P_DEFAULT);
       },
       "/sums_low: refused (it is a link to somewhere else)"},
      {"SoftLink",
       [](hid_t file) {
         remove(file, "sums_low");
         H5Lcreate_soft("/sums_high", file, "sums_low", H5P_DEFAULT, H5P_DEFAULT);
       },
       "/sums_low: refused (it is a link to somewhere else)"},
      {"ExternalStorage", [](hid_t file) { put(file, "sums_low", H5T_STD_U64LE, {10}, external()); },
       "/sums_low: refused (its data lie in another file)"},
      {"VirtualDataset", [](hid_t file) { put(file, "sums_low", H5T_STD_U64LE, {10}, virtual_of(10)); },
       "/sums_low: refused (it is a virtual dataset)"},
      {"HugeNumbers", [=](hid_t file) { put(file, "sums_low", H5T_STD_U64LE, {huge}, chunked(1024)); },
       "/sums_low: refused (it is too long: 1125899906842624 where 536870912 is the most)"},
      {"HugeTexts", [=](hid_t file) { put(file, "arguments", H5T_C_S1, {huge}, chunked(1024)); },
       "/arguments: refused (it is too long: 1125899906842624 where 268435456 is the most)"},
      {"NumbersThatAreNotThere",
       [](hid_t file) { put(file, "sums_low", H5T_STD_U64LE, {500'000'000}, chunked(1024)); },
       "/sums_low: refused (it claims more than it stores)"},
      {"HugeChunks",
       [](hid_t file) { put(file, "sums_low", H5T_STD_U64LE, {500'000'000}, chunked(500'000'000)); },
       "/sums_low: refused (its chunks are too large)"},
      {"TwoDimensions",
       [](hid_t file) {
         put(file, "sums_low", H5T_STD_U64LE, {10, 10});
       },
       "/sums_low: refused (it is not one-dimensional)"},
      {"Doubles", [](hid_t file) { put(file, "sums_low", H5T_IEEE_F64LE, {10}); },
       "/sums_low: refused (it does not hold 64-bit unsigned integers)"},
      {"TextsOfVariableSize", [](hid_t file) { put(file, "arguments", variable_text(), {2}); },
       "/arguments: refused (it does not hold texts of fixed size)"},
      {"Missing", [](hid_t file) { remove(file, "finished_end"); }, "/finished_end: HDF5 failed ("},
      {"GroupForDataset",
       [](hid_t file) {
         remove(file, "sums_low");
         H5Gcreate2(file, "sums_low", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
       },
       "/sums_low: HDF5 failed ("},
      {"OverlappingParticles",
       [](hid_t file) {
         put_numbers(file, "finished_begin", {0, 4});
         put_numbers(file, "finished_end", {5, 9});
       },
       "(its particles are not in order)"},
      {"ParticlesThatEndBeforeTheyBegin",
       [](hid_t file) {
         put_numbers(file, "finished_begin", {9});
         put_numbers(file, "finished_end", {5});
       },
       "(its particles are not in order)"},
      {"ParticlesWithoutEnd", [](hid_t file) { put_numbers(file, "finished_end", {5}); },
       "(its particles are incomplete)"},
      {"HalfASum", [](hid_t file) { put_numbers(file, "sums_low", {5}); }, "(its sums are incomplete)"},
      {"SumsOutsideOfTheirSize",
       [](hid_t file) {
         put_numbers(file, "sums_at", {0, 1, 2, 3, 4, 5, 6, 7, 8, 20});
       },
       "(its sums are not in order)"},
      {"SumsTwice",
       [](hid_t file) {
         put_numbers(file, "sums_at", {0, 1, 2, 2, 4, 5, 6, 7, 8, 9});
       },
       "(its sums are not in order)"},
      {"InputWithoutText", [](hid_t file) { put(file, "input_texts", fixed_text(), {1}); },
       "(its texts are incomplete)"},
  };
}

class HostileCheckpoint : public testing::TestWithParam<Attack> {};

TEST_P(HostileCheckpoint, IsRefused) {
  const Folder folder;
  write_checkpoint(samples::snapshot(3, 10), folder / "honest");
  samples::put_bytes(folder / "contents", samples::bytes_of(folder / "honest"));
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  const hid_t file = H5Fopen((folder / "contents").c_str(), H5F_ACC_RDWR, access);
  ASSERT_GE(file, 0);
  GetParam().change(file);
  H5Fclose(file);
  seal(folder / "contents", folder / "hostile");

  std::string refusal;
  try {
    read_checkpoint(folder / "hostile");
  } catch (const StorageError& error) {
    refusal = error.what();
  }
  if (GetParam().refusal.empty()) {
    EXPECT_EQ(refusal, "");
  } else {
    EXPECT_THAT(refusal, testing::HasSubstr(GetParam().refusal));
  }
}

INSTANTIATE_TEST_SUITE_P(Attacks, HostileCheckpoint, testing::ValuesIn(attacks()),
                         [](const auto& attack) { return attack.param.name; });

}  // namespace
}  // namespace rabiline::hostile_checkpoint_test
