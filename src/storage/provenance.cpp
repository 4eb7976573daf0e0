#include "storage/provenance.hpp"

#include <fmt/format.h>
#include <gnu/libc-version.h>
#include <gsl/gsl_version.h>
#include <openssl/crypto.h>

#include <Eigen/Core>

#include "field/formula_parser.hpp"

namespace rabiline::nexus {

hdf5::GroupWriter write_provenance(const hdf5::GroupWriter& entry, const Provenance& provenance) {
  hdf5::GroupWriter simulation = entry.group("simulation", "NXprocess");
  simulation.text("program", "rabiline");
  simulation.text("version", provenance.version);
  simulation.text("compiler", provenance.compiler);
  simulation.text("commit", provenance.commit, {{"long_name", "of the program's source"}});
  const std::vector<std::string> libraries{
      fmt::format("glibc {}", gnu_get_libc_version()),
      fmt::format("GSL {}", GSL_VERSION),
      fmt::format("Eigen {}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION),
      formula_parser_version(),
      fmt::format("HDF5 {}.{}.{}", H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE),
      OpenSSL_version(OPENSSL_VERSION)};
  simulation.dataset("libraries", {libraries.size()}, libraries,
                     {{"long_name", "libraries that the numbers and the file depend on"}});
  simulation.text("processor", provenance.processor);
  if (!provenance.instruction_set.empty()) simulation.text("instruction_set", provenance.instruction_set);
  simulation.text("host", provenance.host);
  simulation.number("threads", static_cast<std::uint64_t>(provenance.threads), {{"units", "1"}});
  simulation.number("ranks", static_cast<std::uint64_t>(provenance.ranks),
                    {{"units", "1"}, {"long_name", "processes that flew together, each with its threads"}});
  simulation.number("seconds", provenance.seconds,
                    {{"units", "s"}, {"long_name", "time that the run took (s)"}});
  simulation.text("start_time", provenance.start_time);
  simulation.text("end_time", provenance.end_time);
  simulation.text("date", provenance.end_time);
  simulation.dataset("arguments", {provenance.arguments.size()}, provenance.arguments,
                     {{"long_name", "the command line"}});
  if (!provenance.changes.empty())
    simulation.dataset("changes", {provenance.changes.size()}, provenance.changes,
                       {{"long_name", "what the command line changed in the input"}});
  if (!provenance.warnings.empty())
    simulation.dataset("warnings", {provenance.warnings.size()}, provenance.warnings,
                       {{"long_name", "what the run warned of"}});
  for (std::size_t i = 0; i < provenance.inputs.size(); ++i) {
    const hdf5::GroupWriter note = simulation.group(fmt::format("input_{}", i), "NXnote");
    note.text("type", "application/yaml");
    note.text("file_name", provenance.inputs[i].path);
    note.text("data", provenance.inputs[i].text);
  }
  return simulation;
}

}  // namespace rabiline::nexus
