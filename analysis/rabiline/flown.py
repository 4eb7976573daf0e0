"""A result that comes from the program inside Python."""
from __future__ import annotations

from pathlib import Path

import numpy as np

from . import asked
from .errors import InputError
from .results import Results, read

OTHERS = (".csv", ".txt", ".png", ".pdf", ".svg")  # than what a result is


class Flown(Results):
    """A result that has just been flown: read from its own file in memory when more is asked for than what was detected."""

    def __init__(self, core: object) -> None:
        vars(self)["core"] = core

    def __getattr__(self, name: str) -> object:
        if name.startswith("__") or "scan" in vars(self) or "core" not in vars(self):
            raise AttributeError(f"a result has no `{name}`")
        vars(self).update(vars(read(self.core.image())))
        return getattr(self, name)

    def __dir__(self) -> list[str]:
        """What is read when it is asked for, too."""
        return sorted({*super().__dir__(), *Results.__dataclass_fields__})

    def __reduce__(self) -> tuple[object, tuple[bytes]]:
        """Copies and other processes have what its file has."""
        return read, (self.core.image(),)

    def __repr__(self) -> str:
        return f"<result of {self.title}>"

    @property
    def detected(self) -> np.ndarray:
        """[axes...] As that of any result, without reading the file."""
        return self._whole(self.core.detected)

    @property
    def errors(self) -> np.ndarray:
        """[axes...] Likewise."""
        return self._whole(self.core.errors)

    def _whole(self, values: np.ndarray) -> np.ndarray:
        detectors, axes = self.core.detectors, self.core.axes
        shape = ((len(detectors),) if len(detectors) > 1 else ()) + tuple(axis[2].size for axis in axes)
        return values.reshape(shape)[()]

    def write(self, path: Path | str) -> None:
        """Writes the file that `rabiline run` writes, whole and verified or not at all. Raises StorageError, TypeError, and InputError where
        it is named like a picture or a table."""
        if Path(asked.path("path", path)).suffix in OTHERS:
            raise InputError(f"{path}: HDF5 is written; name it .h5, or draw with `.plot()`, or write a table with `.to_csv()`")
        self.core.write(path)
