// Flying from Python: without its lock, and so that Ctrl-C stops the flight.
#include <algorithm>
#include <chrono>
#include <future>
#include <mutex>

#include "core/units.hpp"
#include "python/bindings.hpp"
#include "scan/settings.hpp"

namespace rabiline {
namespace {

namespace py = pybind11;
using namespace std::chrono_literals;

KeptTransit transit_called(const std::string& name) {
  if (name == "auto") return KeptTransit::if_small;
  if (name == "none") return KeptTransit::none;
  if (name == "totals") return KeptTransit::totals;
  if (name == "images") return KeptTransit::images;
  throw std::invalid_argument("`transit` is auto, none, totals or images, not " + name);
}

/// What `flies` returns, in a thread of its own, as only the caller's may ask Python for signals: one makes
/// it `stop`, and is raised.
template <class Flies, class Tells>
auto watched(std::atomic<bool>& stop, const Flies& flies, const Tells& tells) {
  std::optional<py::error_already_set> interrupted;
  std::optional<decltype(flies())> result;
  {
    const py::gil_scoped_release released;
    auto flight = std::async(std::launch::async, flies);
    while (!interrupted && flight.wait_for(50ms) != std::future_status::ready) {
      const py::gil_scoped_acquire acquired;
      try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        tells();
      } catch (py::error_already_set& error) {
        stop = true;
        interrupted.emplace(error);
      }
    }
    try {
      result = flight.get();
    } catch (const Stopped&) {  // by that signal
    }
  }
  if (interrupted) throw py::error_already_set(*interrupted);
  return std::move(*result);
}

Result fly(const Setup& setup, int threads, const std::string& isa, const std::string& transit,
           const std::string& max_memory, const py::object& progress,
           const std::vector<std::string>& arguments, bool silent) {
  std::atomic<bool> stop{false};
  std::mutex mutex;
  Progress reached;
  RunSettings settings;
  settings.threads = threads;
  settings.isa = isa;
  settings.transit = transit_called(transit);
  if (!max_memory.empty()) settings.max_memory = read_memory_argument("max_memory", max_memory);
  settings.stop = &stop;
  settings.arguments = arguments;
  settings.silent = silent;
  settings.progress = [&](const Progress& now) {
    const std::scoped_lock lock(mutex);
    reached = now;
  };
  const bool shows = !progress.is_none();
  std::optional<Result> result = watched(
      stop, [&] { return run(setup, settings); },
      [&] {
        const auto now = [&] {
          const std::scoped_lock lock(mutex);
          return reached;
        }();
        if (shows) progress(now.done, now.seconds_left);
      });
  if (!result) throw std::runtime_error("the run was stopped");
  if (shows) progress(1.0, 0.0);
  return std::move(*result);
}

using Array = py::array_t<double>;

/// One quantity of all detectors, [detectors][...].
Array of_detectors(const Result& result, std::vector<double> DetectorResult::*quantity) {
  std::vector<double> all;
  for (const DetectorResult& detector : result.detectors)
    all.insert(all.end(), (detector.*quantity).begin(), (detector.*quantity).end());
  const auto rows = static_cast<py::ssize_t>(result.detectors.size());
  const auto columns = rows == 0 ? 0 : static_cast<py::ssize_t>(all.size()) / rows;
  return Array({rows, columns}, all.data());
}

py::bytes bytes_of(const std::vector<std::byte>& image) {
  return {reinterpret_cast<const char*>(image.data()), image.size()};
}

std::vector<std::string> names_of_detectors(const Result& result) {
  std::vector<std::string> names;
  for (const DetectorResult& detector : result.detectors) names.push_back(detector.name);
  return names;
}

/// [(part, B [n][3], E [n][3])], each place at a time of its own [s].
py::list probed(const Setup& setup, const std::vector<std::array<double, 3>>& places,
                const std::vector<double>& times) {
  struct Along {
    std::string part;
    std::vector<double> magnetic, electric;
  };
  std::vector<Along> fields;
  for (std::size_t i = 0; i < places.size(); ++i)
    for (const Probed::Contribution& own : probe(setup, places[i], times.at(i)).contributions) {
      auto found = std::ranges::find(fields, own.part, &Along::part);
      if (found == fields.end())
        found = fields.insert(fields.end(), {own.part, std::vector<double>(3 * places.size()),
                                             std::vector<double>(3 * places.size())});
      std::ranges::copy(own.field, found->magnetic.begin() + static_cast<std::ptrdiff_t>(3 * i));
      std::ranges::copy(own.electric, found->electric.begin() + static_cast<std::ptrdiff_t>(3 * i));
    }
  const auto array = [&](const std::vector<double>& values) {
    return Array({static_cast<py::ssize_t>(places.size()), py::ssize_t{3}}, values.data());
  };
  py::list out;
  for (const Along& along : fields)
    out.append(py::make_tuple(along.part, array(along.magnetic), array(along.electric)));
  return out;
}

/// [(parameter, unit, values, labels)]
py::list axes_of(const Result& result) {
  py::list out;
  for (const ScanAxis& axis : result.axes)
    out.append(py::make_tuple(
        axis.parameter, axis.dimension ? std::string(si_unit_of(*axis.dimension)) : std::string(),
        Array(static_cast<py::ssize_t>(axis.values.size()), axis.values.data()), axis.labels));
  return out;
}

}  // namespace

/// HDF5 is used with Python's lock held, as h5py does.
void add_flights(py::module_& module) {
  py::class_<Result>(module, "Result")
      .def_readonly("title", &Result::title)
      .def_readonly("particles", &Result::particles)
      .def_property_readonly("detectors", names_of_detectors)
      .def_property_readonly("axes", axes_of)
      .def_property_readonly("detected",
                             [](const Result& r) { return of_detectors(r, &DetectorResult::detected); })
      .def_property_readonly(
          "errors", [](const Result& r) { return of_detectors(r, &DetectorResult::detected_errors); })
      .def_property_readonly(
          "covariance", [](const Result& r) { return of_detectors(r, &DetectorResult::detected_covariance); })
      .def_property_readonly("warnings", [](const Result& r) { return r.provenance.warnings; })
      .def("image", [](const Result& r) { return bytes_of(image_of(r)); })
      .def("write", [](const Result& r, const std::filesystem::path& path) { write(r, path); });
  py::class_<SolvedModel>(module, "SolvedModel")
      .def("image", [](const SolvedModel& solved) { return bytes_of(image_of(solved)); })
      .def("write",
           [](const SolvedModel& solved, const std::filesystem::path& path) { write(solved, path); });
  module.def("fly", fly, py::arg("setup"), py::arg("threads"), py::arg("isa"), py::arg("transit"),
             py::arg("max_memory"), py::arg("progress"), py::arg("arguments"), py::arg("silent") = false);
  module.def("rescan",
             [](const std::filesystem::path& path, const Changes& changes) { return rescan(path, changes); });
  module.def("solve", [](const Setup& setup) {
    const py::gil_scoped_release released;
    return solve(setup);
  });
  module.def("trace", [](const Setup& setup, std::uint64_t first, std::uint64_t count) {
    std::atomic<bool> stop{false};
    RunSettings settings;
    settings.stop = &stop;
    const auto flies = [&] { return trace(setup, first, count, settings); };
    return bytes_of(image_of(watched(stop, flies, [] {}), setup));
  });
  module.def(
      "probe",
      [](const Setup& setup, const std::vector<std::array<double, 3>>& places,
         const std::vector<double>& times) { return probed(setup, places, times); },
      "[(part, B [n, 3], E [n, 3])] of every part with a field, at places [n, 3] and times [n]");
}

}  // namespace rabiline
