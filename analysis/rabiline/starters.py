"""The command new: a starter file for an experiment, from those that are shipped."""
from __future__ import annotations

import argparse
import re
from argparse import ArgumentParser
from contextlib import ExitStack
from pathlib import Path

from .errors import InputError
from .writing import whole

STARTERS = {  # the names of `rabiline new`, and the shipped files
    "ramsey": "ramsey", "rabi": "rabi-flop", "neutrons": "polarised-neutrons", "stern-gerlach": "stern-gerlach",
    "deflection": "deflection-potassium", "clock": "caesium-clock", "hydrogen": "hydrogen-source", "molecular-beam": "rabi-licl",
    "hyperfine": "kusch-millman-rabi-lithium", "muon": "muon-precession", "hypothesis": "suggested-experiment",
    "model": "rotating-cylinder"}
SCHEMA = "rabiline.schema.json"


def arguments(verb: str, parser: ArgumentParser) -> None:
    """Its options."""
    parser.set_defaults(command=new)
    parser.description = "A starter file for an experiment, complete and with comments."
    parser.epilog = "experiments:\n" + "\n".join(f"  {name:<15} {title_of(name)}" for name in STARTERS)
    parser.add_argument("experiment", metavar="EXPERIMENT", choices=list(STARTERS))
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.yaml", help="EXPERIMENT.yaml where it is missing")


def new(options: argparse.Namespace) -> None:
    """Writes it, and beside it the geometry that it includes and the schema for editors."""
    target = options.output or Path(f"{options.experiment}.yaml")
    source = folder() / f"{STARTERS[options.experiment]}.yaml"
    text = source.read_text(encoding="utf-8")
    beside = {target: text}
    for name in re.findall(r"^geometry: (\S+)", text, re.MULTILINE):
        shared = (source.parent / name).read_text(encoding="utf-8")
        beside[target.with_name(Path(name).name)] = shared.replace(f"$schema=../beamline/{SCHEMA}", f"$schema={SCHEMA}")
        beside[target] = text.replace(f"geometry: {name}", f"geometry: {Path(name).name}")
    schema = target.with_name(SCHEMA)
    if not schema.exists():
        beside[schema] = (folder() / SCHEMA).read_text(encoding="utf-8")
    for path, content in list(beside.items()):
        if not path.exists():
            continue
        if path == target or path.read_text(encoding="utf-8", errors="replace") != content:
            raise InputError(f"{path} is there already; `-o` names another file or folder")
        del beside[path]  # that of another starter
    with ExitStack() as together:  # all of them or none
        for path, content in beside.items():
            together.enter_context(whole(path)).write_text(content, encoding="utf-8")
    for path in beside:
        print(f"wrote {path}")
    drawn = "" if re.search("^model:", text, re.MULTILINE) else f"rabiline draw {target} -o apparatus.png; "
    print(f"next: rabiline check {target}; {drawn}rabiline run {target}")


def title_of(name: str) -> str:
    """Of a starter."""
    found = re.search(r"^title: (.*)$", (folder() / f"{STARTERS[name]}.yaml").read_text(encoding="utf-8"), re.MULTILINE)
    return found[1] if found else name


def folder() -> Path:
    """Where the shipped experiments are: in the sources, or below the prefix where the package is installed."""
    here = Path(__file__).resolve().parent
    for place in (here.parents[1] / "beamline", here.parents[3] / "share/rabiline/beamline"):
        if place.is_dir():
            return place
    raise InputError("the shipped experiments are not where the package expects them, in share/rabiline/beamline")
