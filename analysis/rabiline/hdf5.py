"""HDF5 groups read with care: every problem is an UnreadableFile that names the file and the place in it.

A file may come from anybody, so nothing outside it is followed (external links, external storage, virtual
datasets) and sizes are looked at before anything is read. Its last line is a digest of all before it: a file that was
damaged or changed is refused.
"""
from __future__ import annotations

import hashlib
import shlex
from contextlib import contextmanager
from pathlib import Path
from typing import Iterator

import h5py
import numpy as np

from .errors import InputError, StorageError, printable

FORMAT_VERSION = 3  # the newest layout of files that is understood here; files without a version are older
SEALED_SINCE = 3  # the format version
SEAL = b"\nrabiline: SHA-256 of all before this line: "
SEAL_SIZE = len(SEAL) + 64 + 1
LARGEST_DATASET = 2**28  # elements; 2 GiB of doubles
ROUNDING = 1e-6  # of what is 1, or of variances in a covariance
INTERPOLATED = 1e-7  # of the mean square of a fraction, over the particles: what of a covariance follows from moments may be off by as much
EXPERIMENTS, TABLE = (".yaml", ".yml"), ".csv"  # how files end that are none

IN_MEMORY = Path("memory")  # what messages call a file that is no more than its bytes


class FileError(InputError):
    """A file that cannot be used: which one and why."""

    def __init__(self, path: Path | str, reason: str) -> None:
        super().__init__(f"{path}: {reason}")


class UnreadableFile(FileError, StorageError):
    """A file that cannot be read: missing, or a result that is damaged, forged, or no HDF5."""

    exit_code = 3


class Group:
    """A group of an open file."""

    def __init__(self, group: h5py.Group, path: Path) -> None:
        self._group, self._path = group, path
        self._names: list[str] | None = None  # of groups in this one, looked for once

    def error(self, reason: str) -> UnreadableFile:
        """The error to raise for something wrong with this group."""
        return UnreadableFile(self._path, f"{self._group.name}: {reason}")

    def __contains__(self, name: str) -> bool:
        return name in self._group

    def names(self) -> list[str]:
        """Names of the groups in this one."""
        if self._names is None:
            self._names = [name for name in self._group if self._is_group(name)]
        return self._names

    def group(self, name: str) -> Group:
        """The group `name`."""
        member = self._member(name)
        if not isinstance(member, h5py.Group):
            raise self.error(f"`{name}` is not a group")
        return Group(member, self._path)

    def numbers(self, name: str, shape: tuple[int, ...] | None = None, *, or_none: bool = False) -> np.ndarray:
        """[as in the file] The dataset `name` as finite doubles, or with `or_none` NaN where there is none; its number of elements must be
        that of `shape`, which it is given."""
        values = self._read(name)
        if values.dtype.kind not in "iuf":
            raise self.error(f"`{name}` holds no numbers")
        if (np.isinf(values) if or_none else ~np.isfinite(values)).any():
            raise self.error(f"`{name}` has values that are infinite or no numbers")
        if shape is None:
            return values.astype(float, copy=False)
        if values.size != np.prod(shape, dtype=int):
            raise self.error(f"`{name}` has the shape {values.shape} where {shape} belongs")
        return values.astype(float, copy=False).reshape(shape)

    def amounts(self, name: str, shape: tuple[int, ...] | None = None, *, or_none: bool = False) -> np.ndarray:
        """[as in the file, or `shape`] As `numbers`, of what is never below zero: counts, errors."""
        values = self.numbers(name, shape, or_none=or_none)
        if (values < 0).any():
            raise self.error(f"`{name}` has values below zero")
        return values

    def shares(self, name: str, shape: tuple[int, ...], *, or_none: bool = False) -> np.ndarray:
        """[as `shape`] As `amounts`, of parts of a whole: none above one, but for rounding."""
        values = self.amounts(name, shape, or_none=or_none)
        if (values > 1 + ROUNDING).any():
            raise self.error(f"`{name}` has values above one")
        return values

    def sizes(self, name: str, shape: tuple[int, ...] | None = None) -> np.ndarray:
        """[as in the file, or `shape`] As `numbers`, of what is always above zero."""
        values = self.numbers(name, shape)
        if values.size == 0 or not (values > 0).all():
            raise self.error(f"`{name}` has values that are not above zero")
        return values

    def edges(self, name: str) -> np.ndarray:
        """[n + 1] Those of n bins, which ascend."""
        values = self.numbers(name).ravel()
        if values.size < 2 or not (values[1:] > values[:-1]).all():
            raise self.error(f"`{name}` has edges that do not ascend")
        return values

    def covariance(self, name: str, shape: tuple[int, ...], unknown: float = 0.0) -> np.ndarray:
        """[..., n, n] Symmetric matrices without eigenvalues below zero, but for rounding, and for what each of the numbers may be off, `unknown`."""
        matrices = self.numbers(name, shape)
        for matrix in matrices.reshape(-1, *shape[-2:]):
            variances = np.diag(matrix)
            largest = variances.max(initial=0.0)
            if (variances < 0).any():
                raise self.error(f"`{name}` has variances below zero")
            if (matrix / 2 - matrix.T / 2 > ROUNDING * largest).any():  # halves do not overflow
                raise self.error(f"`{name}` is not symmetric")
            try:
                np.linalg.cholesky(matrix + np.diag(ROUNDING * variances + ROUNDING * largest + len(matrix) * unknown + np.finfo(float).tiny))
            except np.linalg.LinAlgError:
                raise self.error(f"`{name}` has eigenvalues below zero") from None
        return matrices

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

    def _is_group(self, name: str) -> bool:
        """Without opening it, unless it lies elsewhere or is missing."""
        own = name.encode("utf-8", "surrogateescape")
        if self._group.id.links.get_info(own).type != h5py.h5l.TYPE_HARD:
            return isinstance(self._member(name), h5py.Group)
        return h5py.h5o.get_info(self._group.id, own).type == h5py.h5o.TYPE_GROUP

    def _member(self, name: str) -> h5py.Group | h5py.Dataset:
        try:
            if not isinstance(self._group.get(name, getlink=True), h5py.ExternalLink):
                return self._group[name]
        except (KeyError, OSError, RuntimeError):
            raise self.error(f"`{name}` is missing") from None
        raise self.error(f"`{name}` lies in another file")

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
    file, sealed = _opened(source, path)
    try:
        with file:
            if "entry" not in file:
                raise FileError(path, "a shard or a checkpoint: `rabiline merge` joins shards, `rabiline resume` goes on from a checkpoint"
                                if "sums_low" in file else "not written by rabiline (it has no group /entry)")
            version = file.attrs.get("format_version", 1)
            if not isinstance(version, (int, np.integer)) or version > FORMAT_VERSION:
                raise UnreadableFile(path, f"has format version {version}; this program reads versions up to {FORMAT_VERSION}")
            if version >= SEALED_SINCE and not sealed:
                raise UnreadableFile(path, "has no seal at its end: it was cut short, or changed since rabiline wrote it")
            yield Group(file, path).group("entry")
    except InputError:
        raise
    except (ArithmeticError, LookupError, OSError, RuntimeError, TypeError, ValueError) as problem:
        raise UnreadableFile(path, f"cannot be used: {problem}") from problem


def require_file(path: Path) -> None:
    """Raises UnreadableFile where there is none; a pipe would be waited for."""
    if not path.exists():
        raise UnreadableFile(path, "no such file")
    if not path.is_file():
        raise UnreadableFile(path, "is not a file")


def is_hdf5(path: Path) -> bool:
    """Whether a file is HDF5 and no table; raises UnreadableFile where there is no file."""
    require_file(path)
    return h5py.is_hdf5(path)


def _has_seal(path: Path) -> bool:
    """Whether the last line of a file is a digest; if so, of what stands before it."""
    size = path.stat().st_size - SEAL_SIZE
    if size < 0:
        return False
    digest = hashlib.sha256()
    with path.open("rb") as file:
        file.seek(size)
        seal = file.read()
        if not seal.startswith(SEAL):
            return False
        file.seek(0)
        while size > 0:
            block = file.read(min(size, 1 << 22))
            if not block:
                break
            digest.update(block)
            size -= len(block)
    if seal != SEAL + digest.hexdigest().encode() + b"\n":
        raise UnreadableFile(path, "is damaged, or was changed since rabiline wrote it")
    return True


def _opened(source: Path | str | bytes, path: Path) -> tuple[h5py.File, bool]:
    """The file, and whether it is known to be whole."""
    if isinstance(source, bytes):
        return h5py.File(h5py.h5f.open_file_image(source)), True
    require_file(path)
    sealed = _has_seal(path)
    try:
        return h5py.File(path, "r"), sealed
    except (OSError, RuntimeError):
        raise UnreadableFile(path, _why_not(path)) from None


def _why_not(path: Path) -> str:
    """Why a file cannot be opened, and what is done with one of its kind."""
    name = shlex.quote(str(path))
    if h5py.is_hdf5(path):
        return "cannot be opened: damaged or unfinished"
    if path.suffix in EXPERIMENTS:
        return f"not an HDF5 file; `rabiline run {name}` makes one of an experiment"
    if path.suffix == TABLE:
        return (f"a table, not an HDF5 file\n  help: `rabiline plot-scan RESULT.h5 --data {name}` draws counts beside a curve, "
                f"`rabiline fit EXPERIMENT.yaml --data {name}` and `rabiline fit-line {name}` fit them")
    return "not an HDF5 file"


def _decoded(value: object) -> str:
    """A text without control characters, which would steer a terminal."""
    text = value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
    return printable(text)
