// Writes a file of each shape into the folder given, for the checks in Python.
#include "samples.hpp"
#include "storage/results_file.hpp"
#include "storage/tracks_file.hpp"

int main(int, char** arguments) {
  using namespace rabiline;
  const std::filesystem::path folder = arguments[1];
  std::filesystem::create_directories(folder);
  write_results(samples::result({}, {"screen"}), folder / "single.h5");
  write_results(samples::result({samples::frequency_axis(11)}, {"screen"}), folder / "scan.h5");
  write_results(samples::result({samples::frequency_axis(11)}, {"left", "right"}), folder / "detectors.h5");
  write_results(samples::result({samples::frequency_axis(11), samples::field_axis(3)}, {"screen"}),
                folder / "grid.h5");
  write_results(samples::result({samples::frequency_axis(11), samples::field_axis(3)}, {"left", "right"}),
                folder / "grid_detectors.h5");
  write_results(samples::result({samples::law_axis()}, {"screen"}), folder / "law.h5");
  write_tracks({"Bench", {}, {}, samples::tracks()}, folder / "tracks.h5");
}
