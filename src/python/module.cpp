// The program inside Python: `rabiline._core`.
#include "commands/common.hpp"
#include "core/version.hpp"
#include "python/bindings.hpp"

namespace rabiline {
namespace {

namespace py = pybind11;

Changes changes_from(std::vector<std::string> set, std::vector<std::string> scan, bool without_scan) {
  Changes changes;
  changes.dashes.clear();
  changes.set = std::move(set);
  changes.scan = std::move(scan);
  changes.without_scan = without_scan;
  return changes;
}

}  // namespace

void add_setups(py::module_& module) {
  py::class_<Changes>(module, "Changes")
      .def(py::init(&changes_from), py::arg("set"), py::arg("scan"), py::arg("without_scan"));
  py::class_<Setup>(module, "Setup")
      .def_property_readonly("is_model", &Setup::is_model)
      .def_property_readonly("title", &Setup::title)
      .def_property_readonly("text", [](const Setup& setup) { return setup.inputs().front().text; })
      .def_property_readonly("points", &Setup::points)
      .def_property_readonly("fingerprint", &Setup::fingerprint)
      .def_property_readonly("parts",
                             [](const Setup& setup) {
                               py::list out;
                               for (const PartName& part : parts_of(setup))
                                 out.append(py::make_tuple(part.name, part.kind, part.label, part.begin,
                                                           part.end, part.field, part.drives));
                               return out;
                             })
      .def("value", [](const Setup& setup, const std::string& name) -> py::object {
        const std::optional<ParameterValue> found = value_of(setup, name);
        return found ? py::object(py::make_tuple(found->value, found->unit)) : py::object(py::none());
      });
  module.def("in_si", [](const std::string& text) -> py::object {
    const ParsedQuantity found = parse_quantity(text);
    if (!found.error.empty()) return py::none();
    return py::make_tuple(found.value, std::string(si_unit_of(found.dimension)));
  });
  module.def("load",
             [](const std::filesystem::path& file, const Changes& changes) { return load(file, changes); });
  module.def("load_again", [](const Setup& setup, const Changes& changes) { return load(setup, changes); });
  module.def("load_text", load_text);
  module.def("check", [](const Setup& setup) {
    const Report report = check(setup);
    std::vector<std::string> warnings;
    for (const Diagnostic& warning : report.warnings) warnings.push_back(render(warning));
    return report.cost ? py::make_tuple(report.text, warnings, report.cost->seconds, report.cost->memory)
                       : py::make_tuple(report.text, warnings);
  });
}

}  // namespace rabiline

PYBIND11_MODULE(_core, module) {
  module.attr("version") = rabiline::version;
  rabiline::add_errors(module);
  rabiline::add_setups(module);
  rabiline::add_flights(module);
  // The command line: its arguments without the program's name; its exit code.
  module.def("main", [](const std::vector<std::string>& arguments) {
    const pybind11::gil_scoped_release released;
    return rabiline::run_program(arguments);
  });
}
