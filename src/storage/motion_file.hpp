#pragma once
// The motions and findings of a model as one HDF5 file in NeXus base classes.
#include <cstddef>
#include <filesystem>
#include <vector>

#include "models/solved_model.hpp"
#include "storage/storage_error.hpp"

namespace rabiline {

/// Writes the file wholly and verified, or not at all. Throws StorageError.
///   /entry/<motion>            NXdata over `time`: x, y, z of the centre of mass, vectors [time][xyz],
///   numbers;
///                              of a scan /entry/point_<i>/<motion>
///   /entry/findings            `name`, `units`, `meaning`, `expectation` (a word of Expectation), `value`,
///                              `expected`; of a scan the last two are [finding][point], NaN where a point
///                              has none, and each finding is a dataset of its own over the scanned parameter
///   /entry/model, motions      kind of the model, names of its motions in order
void write_motions(const SolvedModel&, const std::filesystem::path&);
/// The bytes of such a file.
std::vector<std::byte> image_of(const SolvedModel&);

}  // namespace rabiline
