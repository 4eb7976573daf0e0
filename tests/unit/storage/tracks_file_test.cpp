#include "storage/tracks_file.hpp"

#include <gtest/gtest.h>
#include <hdf5.h>

#include "samples.hpp"

namespace rabiline::tracks_file_test {
namespace {

using samples::Folder;

/// A text in a file: an attribute of `object`, or the dataset itself where `attribute` is empty.
std::string text(const std::filesystem::path& path, const std::string& object, const std::string& attribute) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t owner = H5Oopen(file, object.c_str(), H5P_DEFAULT);
  const bool is_dataset = attribute.empty();
  const hid_t source = is_dataset ? owner : H5Aopen(owner, attribute.c_str(), H5P_DEFAULT);
  const hid_t type = is_dataset ? H5Dget_type(source) : H5Aget_type(source);
  std::string found;
  if (H5Tis_variable_str(type) > 0) {
    char* read = nullptr;
    is_dataset ? H5Dread(source, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &read) : H5Aread(source, type, &read);
    found = read == nullptr ? "" : read;
    H5free_memory(read);
  } else {
    found.resize(H5Tget_size(type));
    is_dataset ? H5Dread(source, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, found.data())
               : H5Aread(source, type, found.data());
    found = found.c_str();
  }
  H5Tclose(type);
  if (!is_dataset) H5Aclose(source);
  H5Oclose(owner);
  H5Fclose(file);
  return found;
}

TEST(TracksFile, NamesTheLawOnceForAllAndOfEachParticle) {
  const Folder folder;
  std::vector<Track> tracks = samples::tracks();
  for (Track& track : tracks) track.law = "dorado (torque, kappa = 1)";
  write_tracks({"Bench", {}, {}, tracks}, folder / "t.h5");
  EXPECT_EQ(text(folder / "t.h5", "/entry/law", ""), "dorado (torque, kappa = 1)");
  for (const char* name : {"particle_7", "particle_11", "particle_7_"})
    EXPECT_EQ(text(folder / "t.h5", std::string("/entry/") + name, "law"), "dorado (torque, kappa = 1)");
}

}  // namespace
}  // namespace rabiline::tracks_file_test
