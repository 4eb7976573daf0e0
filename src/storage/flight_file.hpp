#pragma once
// What a result keeps of its flight: /entry/flight, and with it what `rabiline rescan` needs.
#include <filesystem>
#include <string>
#include <vector>

#include "simulation/flight_record.hpp"
#include "storage/storage_error.hpp"

namespace rabiline {
namespace hdf5 {
class GroupWriter;
}

/// A flight with the texts that it was made from.
struct KeptFlight {
  std::vector<InputText> inputs;
  std::vector<std::string> changes;
  FlightRecord record;
};

/// About what a record takes in a file [bytes].
std::size_t size_in_file(const FlightRecord&);

namespace nexus {
void write_flight(const hdf5::GroupWriter& entry, const FlightRecord&);
}  // namespace nexus

/// Reads it from a result. Throws StorageError where the file is no result, is damaged, or has no flight.
KeptFlight read_kept_flight(const std::filesystem::path&);

}  // namespace rabiline
