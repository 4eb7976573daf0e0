// Errors as Python's exceptions: their text is what the command line prints, with line and caret.
#include <stdexcept>
#include <utility>

#include "python/bindings.hpp"

namespace rabiline {
namespace {

namespace py = pybind11;

/// What is quoted of a file need not be UTF-8.
py::object text_of(const std::string& text) {
  return py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace"));
}

py::dict as_dict(const Diagnostic& diagnostic) {
  py::dict out;
  out["file"] = diagnostic.place.text ? diagnostic.place.text->name : std::string();
  out["line"] = diagnostic.place.line;
  out["column"] = diagnostic.place.column;
  out["message"] = text_of(diagnostic.message);
  out["help"] = text_of(diagnostic.suggestion);
  return out;
}

}  // namespace

void add_errors(py::module_& module) {
  const py::module_ package = py::module_::import("rabiline.errors");
  const py::tuple bases = py::make_tuple(package.attr("InputError"), py::handle(PyExc_ValueError));
  static const py::handle input_error = py::exception<InputError>(module, "InputError", bases).release();
  static const py::handle storage_error =
      py::exception<StorageError>(module, "StorageError", package.attr("StorageError")).release();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const InputError& error) {
      py::list diagnostics;
      for (const Diagnostic& diagnostic : error.diagnostics()) diagnostics.append(as_dict(diagnostic));
      py::object made =
          py::reinterpret_borrow<py::object>(input_error)(text_of("\n" + render(error.diagnostics())));
      made.attr("diagnostics") = diagnostics;
      PyErr_SetObject(input_error.ptr(), made.ptr());
    } catch (const StorageError& error) {
      PyErr_SetString(storage_error.ptr(), error.what());
    } catch (const std::invalid_argument& error) {
      PyErr_SetObject(PyExc_ValueError, text_of(printable(error.what())).ptr());
    }
  });
}

}  // namespace rabiline
