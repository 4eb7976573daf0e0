#pragma once
// What the sources of the Python module share. Python sees plain functions here;
// analysis/rabiline/experiment.py makes the objects of them that people use.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "rabiline.hpp"

namespace rabiline {

/// InputError with its diagnostics, StorageError.
void add_errors(pybind11::module_&);
/// Setup, Result and what makes them.
void add_setups(pybind11::module_&);
void add_flights(pybind11::module_&);

}  // namespace rabiline
