"""Particle beams with spin through magnetic fields, by Monte Carlo.

    import rabiline
    experiment = rabiline.load("ramsey.yaml").set({"B.field": "9 mT"})
    result = experiment.scan("first.frequency", "260 kHz:270 kHz:101").run()
    result.to_csv("ramsey.csv"); result.plot("ramsey.png")
    same = rabiline.open("ramsey.h5")       # what `rabiline run` wrote

Modules are imported when they are used.
"""
from __future__ import annotations

from importlib import import_module

_FROM = {"load": "experiment", "Experiment": "experiment", "InputError": "errors", "StorageError": "errors",
         "ExperimentWarning": "experiment", "open": "files", "__version__": "experiment"}
_METHODS = {  # that are looked for in the module, and how they are called
    'rabiline.load("experiment.yaml").{}()': ("run", "check", "fly", "trace", "set", "scan"),
    'rabiline.load("experiment.yaml").fit("counts.csv", ["B.field"])': ("fit",),
    'rabiline.open("result.h5")': ("read", "results"),
    'rabiline.open("result.h5").{}()': ("plot", "summary", "to_csv", "to_dataframe", "to_xarray")}
__all__ = ["load", "open", "Experiment", "InputError", "StorageError", "ExperimentWarning"]


def __getattr__(name: str) -> object:
    if name not in _FROM:
        raise AttributeError(f"module `rabiline` has no `{name}`" + next((f": call {call.format(name)}" for call, names in _METHODS.items() if name in names), ""))
    return getattr(import_module(f".{_FROM[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted({*_FROM, *(name for name in globals() if name.startswith("__"))})
