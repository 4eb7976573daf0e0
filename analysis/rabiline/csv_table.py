"""Tables of numbers, in the one dialect of the program: lines that begin with # are comments; the first other line has the
names of the columns, with units in square brackets, `H0.frequency [kHz],counts`; commas between, points in numbers.
Round brackets are read too, and `H0.frequency / kHz`."""
from __future__ import annotations

import csv
import re
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from . import asked
from .hdf5 import EXPERIMENTS, FileError, UnreadableFile, is_hdf5, require_file

if TYPE_CHECKING:
    import pandas

LARGEST_TABLE = 10**7  # bytes
LARGEST_NUMBER = 1e100
COMMA = "\n  help: numbers have a decimal point, and no commas between thousands"


@dataclass(frozen=True)
class Table:
    """Cells as they stand."""

    path: Path
    header: int  # its line
    columns: tuple[tuple[str, str], ...]  # (name, unit), the unit empty where there is none
    rows: tuple[tuple[int, tuple[str, ...]], ...]  # with the numbers of their lines

    @property
    def names(self) -> list[str]:
        """Of the columns."""
        return [name for name, _ in self.columns]

    def column(self, name: str) -> list[str]:
        """All cells of one."""
        i = self.names.index(name)
        return [cells[i] for _, cells in self.rows]

    def numbers(self, name: str) -> list[float]:
        """A column as numbers, in its own unit; raises FileError with the line."""
        found = []
        for (line, _), cell in zip(self.rows, self.column(name)):
            try:
                found.append(asked.written_number(cell))
            except ValueError:
                wrong = f"`{cell}` is no number ({name}){COMMA if ',' in cell else ''}" if cell else f"a number of the column `{name}` is missing"
                raise FileError(self.path, f"line {line}: {wrong}") from None
            if not abs(found[-1]) <= LARGEST_NUMBER:
                raise FileError(self.path, f"line {line}: `{cell}` is out of range ({name})")
        return found


def read_table(source: Path | str | pandas.DataFrame) -> Table:
    """From a file, or from a frame whose columns are named as in one, or have their units in `attrs["units"]`. Raises FileError, and
    TypeError for what is neither."""
    path, lines = _lines_of(source)
    rows = [(number, _cells(path, number, line)) for number, line in enumerate(lines, 1)
            if line.strip(" \t,") and not line.lstrip().startswith("#") and line.strip() != "sep=,"]  # which is for Excel
    if not rows:
        raise FileError(path, "an empty table")
    header, names = rows[0]
    if len(names) == 1 and ";" in names[0]:
        raise FileError(path, f"line {header}: a comma stands between columns, and a point in numbers, not `;` and `,`")
    if len(names) == 1 and "\t" in lines[header - 1].strip():
        raise FileError(path, f"line {header}: a comma stands between columns, not a tab")
    if len(names) == 1 and len(names[0].split()) > 1 and all(len(cells) == 1 and len(cells[0].split()) > 1 for _, cells in rows):
        raise FileError(path, f"line {header}: a comma stands between columns, not a blank")
    if all(_is_number(name) for name in names):
        raise FileError(path, f"line {header}: the names of the columns are missing\n  help: write a line above it such as `C.frequency [kHz],counts`")
    if not names[-1]:  # a comma at the end of the lines
        names = names[:-1]
    rows = [(line, cells[:-1] if len(cells) == len(names) + 1 and not cells[-1] else cells) for line, cells in rows]
    columns = tuple(_column(text) for text in names)
    names = [name for name, _ in columns]
    if twice := [name for name, count in Counter(names).items() if count > 1]:
        raise FileError(path, f"line {header}: the column `{twice[0]}` is there twice")
    for line, cells in rows[1:]:
        if len(cells) != len(columns):
            raise FileError(path, f"line {line}: {_counted(len(cells), 'value')} in {_counted(len(columns), 'column')}"
                            + ("\n  help: a comma stands between columns, and numbers have a point" if len(cells) > len(columns) > 1 else ""))
    return Table(path, header, columns, tuple(rows[1:]))


def _cells(path: Path, number: int, line: str) -> tuple[str, ...]:
    try:
        return tuple(cell.strip() for cell in next(csv.reader([line])))
    except csv.Error as problem:
        raise FileError(path, f"line {number}: {problem}") from None


def _lines_of(source: Path | str | pandas.DataFrame) -> tuple[Path, list[str]]:
    """What messages call it, and what is written in it."""
    if "pandas" in sys.modules and isinstance(source, sys.modules["pandas"].DataFrame):
        units = source.attrs.get("units", {})
        frame = source.rename(columns={name: f"{name} [{unit}]" for name, unit in units.items()})
        return Path("DataFrame"), frame.to_csv(index=frame.index.name is not None, na_rep="nan").splitlines()
    if not isinstance(source, (str, Path)):
        raise TypeError(f"a table is the path of a file or a pandas.DataFrame, not {type(source).__name__}")
    path = Path(asked.path("data", source))
    require_file(path)
    if path.suffix in EXPERIMENTS:
        raise FileError(path, "an experiment, and a table of counts belongs here (CSV)")
    try:
        if path.stat().st_size > LARGEST_TABLE:
            raise FileError(path, f"larger than {LARGEST_TABLE} bytes")
        return path, path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise FileError(path, "a table of counts belongs here (CSV), and this is an HDF5 file" if is_hdf5(path) else
                        "neither an HDF5 file nor a table in UTF-8: save it as that") from None
    except OSError as problem:
        raise UnreadableFile(path, problem.strerror or str(problem)) from None


def _counted(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _is_number(text: str) -> bool:
    try:
        return bool(asked.written_number(text)) or True
    except ValueError:
        return False


def _column(text: str) -> tuple[str, str]:
    found = re.fullmatch(r"(.*?)\s*[\[(](.*)[\])]", text) or re.fullmatch(r"(.*?)\s+/\s+(\S+)", text)
    return (found[1].strip(), found[2].strip()) if found else (text, "")
