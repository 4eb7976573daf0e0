"""In what files of results or paths differ, and their scan points."""
from __future__ import annotations

from math import isnan
from pathlib import Path
from typing import Sequence

from .hdf5 import open_entry
from .units import format_value

MOST = 2  # that tell files apart in few words
WORDS = ("law", "species")  # whose values say by themselves what they are
OF_THE_RUN = {"title", "seed", "particles"}


def differing(paths: Sequence[Path]) -> list[dict[str, str]]:
    """For each file what it was flown with and others were not, by the names of `--set`, without laws and the numbers of particles and
    seeds; nothing where a file does not say, or where these are too many for a legend."""
    stated = [_stated(path) for path in paths]
    names = [name for name in stated[0] if all(name in one for one in stated) and len({one[name] for one in stated}) > 1]
    if "species.name" in names:  # which says the rest of it
        names = [name for name in names if not name.startswith("species.") or name == "species.name"]
    return [{name: one[name] for name in names} if len(names) <= MOST else {} for one in stated]


def said(label: str, own: dict[str, str]) -> str:
    """The label of a file with what tells it from others."""
    return ", ".join(filter(None, [label, *(f"{name} = {value}" for name, value in own.items())]))


def what_differs(rows: Sequence[dict[str, str]]) -> tuple[str, list[str]]:
    """A heading for a legend of `rows`, each of which says what it is by names and values, and a label for each: what is the same
    for all is left out, and one name of a number stands above. Empty labels where nothing differs."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    differing = [name for name in names if len({row.get(name) for row in rows}) > 1]
    if "species" in differing:
        differing = [name for name in differing if name != "species.name"]
    if len(differing) == 1 and differing[0]:
        return "" if differing[0] in WORDS else differing[0], [row.get(differing[0], "") for row in rows]
    return "", [", ".join(row[name] if name in WORDS else f"{name} = {row[name]}" for name in differing if name in row) for row in rows]


def _stated(path: Path) -> dict[str, str]:
    """What all points of a scan share."""
    with open_entry(path) as entry:
        if "parameters" not in entry:
            return {}
        group = entry.group("parameters")
        columns = (group.texts("name"), group.numbers("value", or_none=True).ravel(), group.texts("unit"), group.texts("word"))
        return {name: word if isnan(value) else format_value(value, unit).replace("-", "−") for name, value, unit, word in zip(*columns)
                if name not in OF_THE_RUN and name.partition(".")[0] != "law"}
