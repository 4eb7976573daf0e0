#pragma once
// NeXus base classes as silx, h5web and nexpy plot them by default (https://manual.nexusformat.org, NXdata).
#include <set>
#include <span>
#include <string>
#include <vector>

#include "storage/hdf5_writer.hpp"

namespace rabiline::nexus {

/// The attribute `format_version` of every file: raised when a reader of the format before would misread a
/// file.
constexpr std::uint64_t format_version = 3;

/// One dimension of a plot: bin centres, or an index whose entries have labels.
struct Axis {
  std::string name, units, long_name;
  std::vector<double> values;
  std::vector<std::string> labels;  // of an index, else empty
  std::string parameter;            // dotted name of a scanned parameter, else empty
};

/// What a plot shows: values over its axes, row-major, the first axis slowest.
struct Signal {
  std::string name, units, long_name;
  std::span<const double> values, errors;  // no errors where there are none
  std::string interpretation;              // "spectrum": curves; "image": pictures; empty: the viewer decides
};

/// An axis 0, 1, ... with a label each.
Axis index_axis(const std::string& name, const std::string& meaning, const std::vector<std::string>& labels);

/// "x (m)"; units are left away where they say nothing.
std::string long_name(const std::string& name, const std::string& units);

/// Of a plot over scan points: the axes of the scan, and those in front of them and behind.
struct Axes {
  std::vector<Axis> before;
  const std::vector<Axis>& scan;
  std::vector<Axis> behind;
};

/// An NXdata group; where there is no axis, the signal is one number.
hdf5::GroupWriter write_data(const hdf5::GroupWriter& parent, const std::string& name,
                             const std::string& title, const Signal&, const std::vector<Axis>&);
/// The same over scan points; the signal is of those of the slab.
hdf5::GroupWriter write_data(const hdf5::GroupWriter& parent, const std::string& name,
                             const std::string& title, const Signal&, const Axes&);
/// The shape of such a signal.
hdf5::OverPoints shape_of(const Axes&);
/// Of a scan, row-major.
std::size_t count_of_points(const std::vector<Axis>& scan);

/// The attributes of "/" and the group "/entry" with its title.
hdf5::GroupWriter write_entry(hdf5::FileWriter&, const std::string& file_name, const std::string& title,
                              const std::string& version);

/// Hands out names within one group; a name that is taken already gets underscores behind it.
class Names {
 public:
  explicit Names(std::set<std::string> taken) : taken_(std::move(taken)) {}
  /// A stem such that stem + suffix is free for every suffix; takes them all.
  std::string claim(std::string stem, const std::vector<std::string>& suffixes);

 private:
  std::set<std::string> taken_;
};

}  // namespace rabiline::nexus
