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
__all__ = ["load", "open", "Experiment", "InputError", "StorageError", "ExperimentWarning"]


def __getattr__(name: str) -> object:
    if name not in _FROM:
        raise AttributeError(f"module `rabiline` has no `{name}`")
    return getattr(import_module(f".{_FROM[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted({*_FROM, *(name for name in globals() if name.startswith("__"))})
