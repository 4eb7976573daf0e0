"""HDF5 groups read with care: every problem is a FileError that names the file and the place in it.

A file may come from anybody, so nothing outside it is followed (external links, external storage, virtual
datasets) and sizes are looked at before anything is read.
"""
from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import Iterator

import h5py
import numpy as np

from .errors import BadInput

FORMAT_VERSION = 2  # the newest layout of files that is understood here; files without a version are older
LARGEST_DATASET = 2**28  # elements; 2 GiB of doubles


IN_MEMORY = Path("memory")  # what messages call a file that is no more than its bytes


class FileError(BadInput):
    """A file that cannot be used: which one and why."""

    def __init__(self, path: Path | str, reason: str) -> None:
        super().__init__(f"{path}: {reason}")


class Group:
    """A group of an open file."""

    def __init__(self, group: h5py.Group, path: Path) -> None:
        self._group, self._path = group, path

    def error(self, reason: str) -> FileError:
        """The error to raise for something wrong with this group."""
        return FileError(self._path, f"{self._group.name}: {reason}")

    def __contains__(self, name: str) -> bool:
        return name in self._group

    def names(self) -> list[str]:
        """Names of the groups in this one."""
        return [name for name in self._group if isinstance(self._member(name), h5py.Group)]

    def group(self, name: str) -> Group:
        """The group `name`."""
        member = self._member(name)
        if not isinstance(member, h5py.Group):
            raise self.error(f"`{name}` is not a group")
        return Group(member, self._path)

    def numbers(self, name: str, shape: tuple[int, ...] | None = None) -> np.ndarray:
        """The dataset `name` as doubles; its number of elements must be that of `shape`, which it is given."""
        values = self._read(name)
        if values.dtype.kind not in "iuf":
            raise self.error(f"`{name}` holds no numbers")
        if shape is None:
            return values.astype(float)
        if values.size != np.prod(shape, dtype=int):
            raise self.error(f"`{name}` has the shape {values.shape} where {shape} belongs")
        return values.astype(float).reshape(shape)

    def whole_number(self, name: str) -> int:
        """The first number of the dataset `name`, of up to 64 bits."""
        values = self._read(name)
        if values.dtype.kind not in "iu" or values.size == 0:
            raise self.error(f"`{name}` holds no whole number")
        return int(values.ravel()[0])

    def texts(self, name: str) -> tuple[str, ...]:
        """The dataset `name` as texts; a single text counts as one of them."""
        values = self._read(name)
        if values.dtype.kind not in "SO":
            raise self.error(f"`{name}` holds no text")
        return tuple(_decoded(value) for value in values.ravel())

    def text(self, name: str, default: str = "") -> str:
        """The first text of the dataset `name`, or `default` where there is none."""
        return next(iter(self.texts(name)), default) if name in self else default

    def attribute(self, name: str, of: str | None = None) -> tuple[str, ...]:
        """An attribute of this group, or of its member `of`, as texts; empty where it is missing."""
        owner = self._group if of is None else self._member(of)
        value = owner.attrs.get(name)
        return () if value is None else tuple(_decoded(text) for text in np.atleast_1d(value))

    def _member(self, name: str) -> h5py.Group | h5py.Dataset:
        try:
            if isinstance(self._group.get(name, getlink=True), h5py.ExternalLink):
                raise self.error(f"`{name}` lies in another file")
            return self._group[name]
        except (KeyError, OSError, RuntimeError):
            raise self.error(f"`{name}` is missing") from None

    def _read(self, name: str) -> np.ndarray:
        member = self._member(name)
        if not isinstance(member, h5py.Dataset):
            raise self.error(f"`{name}` is not a dataset")
        if member.external or member.is_virtual:
            raise self.error(f"`{name}` lies in another file")
        if member.size is None or member.size > LARGEST_DATASET:
            raise self.error(f"`{name}` is empty or larger than {LARGEST_DATASET} elements")
        try:
            return np.asarray(member[()])
        except (OSError, TypeError) as problem:
            raise self.error(f"`{name}` cannot be read ({problem})") from None


@contextmanager
def open_entry(source: Path | str | bytes) -> Iterator[Group]:
    """Opens the group `/entry` of a file, or of its bytes, for reading."""
    path = IN_MEMORY if isinstance(source, bytes) else Path(source)
    with _opened(source, path) as file:
        if "entry" not in file:
            raise FileError(path, "not written by rabiline (it has no group /entry)")
        version = file.attrs.get("format_version", FORMAT_VERSION)
        if not isinstance(version, (int, np.integer)) or version > FORMAT_VERSION:
            raise FileError(path, f"has format version {version}; this program reads versions up to {FORMAT_VERSION}")
        yield Group(file, path).group("entry")


def _opened(source: Path | str | bytes, path: Path) -> h5py.File:
    if isinstance(source, bytes):
        return h5py.File(h5py.h5f.open_file_image(source))
    if not path.exists():
        raise FileError(path, "no such file")
    if not path.is_file():
        raise FileError(path, "not a file")
    try:
        return h5py.File(path, "r")
    except OSError:
        whole = "cannot be opened: damaged or unfinished" if h5py.is_hdf5(path) else "not an HDF5 file"
        raise FileError(path, whole) from None


def _decoded(value: object) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
