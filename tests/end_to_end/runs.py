"""Runs of the program as a user meets it, a crowded beam, and what two results have in common."""
from __future__ import annotations

import os
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("RABILINE_PROGRAM", str(ROOT / "build" / "release" / "rabiline"))
EXPERIMENT = ROOT / "beamline" / "suggested-experiment.yaml"
DONE, BAD_INPUT, NOT_WRITTEN, STOPPED = 0, 2, 3, 4
QUANTA = 2**40  # of one particle
LAWS = ("--scan", "law=quantum,classical,dorado")
EDGES = ("--scan", "H0.frequency=270 kHz,288.1 kHz,295.6 kHz")  # dorado's dip: far off and on both slopes

# Every fate there is: a spread beam, a slit that stops some of it, two species, spins of both signs.
CROWDED = """rabiline: 1
title: A crowded beam
species: [{name: neutron, fraction: 0.75}, {name: H, fraction: 0.25}]
law: quantum
source:
  speed: {kind: gaussian, mean: 1000 m/s, sigma: 50 m/s}
  opening: {radius: 0.3 mm}
  direction: {kind: gaussian, x: 2 mrad, z: 2 mrad}
chamber: {radius: 5 mm}
parts:
  - {name: B_prime, kind: polarizer,      at: 0.10 m, length: 0.10 m, field: 10 mT, alignment: 0.5}
  - {name: hole,    kind: slit,           at: 0.25 m, width: 1 mm, height: 2 mm}
  - {name: B,       kind: uniform_field,  at: 0.30 m, length: 0.25 m, field: 10 mT}
  - {name: H0,      kind: rotating_field, at: 0.35 m, length: 0.20 m, amplitude: 60 uT, frequency: 291.6 kHz,
     sense: positive, phase: random}
  - {name: screen,  kind: detector,       at: 1.2 m, width: 4 mm, height: 4 mm, bins: [20, 30]}
particles: 1003
seed: 7
scan: [{parameter: law, values: [quantum, classical, dorado]},
       {parameter: H0.frequency, from: 288 kHz, to: 294 kHz, points: 3}]
"""


# Of points that magnets split by their levels; what else a file needs follows.
BEAM_OF_POINTS = """rabiline: 1
title: Rabi's apparatus
species: {name: point, mass: 20 u, charge: 0 e, spin: 1/2, gyromagnetic_ratio: 5.86e10 rad/s/T, source: invented}
law: {name: quantum, outcomes: split}
source:
  speed: {kind: effusive, temperature: 900 K}
  opening: {width: 0.2 mm, height: 0.1 mm}
  direction: {kind: box, x: 0.1 mrad, z: 0.1 mrad}
"""


def rabiline(*arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run([PROGRAM, *map(str, arguments)], cwd=cwd, text=True, capture_output=True, timeout=300)


def run(output: Path, *arguments: object, experiment: Path = EXPERIMENT) -> Path:
    """A run that has to succeed, in one thread unless told otherwise; its output."""
    threads = () if "--threads" in arguments else ("--threads", 1)
    done = rabiline("run", experiment, "-o", output, "--progress", "none", *threads, *arguments)
    assert done.returncode == DONE, done.stderr
    assert done.stderr == "" and f"wrote {output}" in done.stdout
    return output


def contents(path: Path) -> dict[str, np.ndarray]:
    """Every dataset, and every attribute of groups and datasets, outside /entry/simulation."""
    found = {}

    def visit(name: str, item: h5py.Group | h5py.Dataset) -> None:
        if name.startswith("entry/simulation"):
            return
        if isinstance(item, h5py.Dataset):
            found[name] = item[()]
        for key, value in item.attrs.items():
            found[f"{name}@{key}"] = value

    with h5py.File(path) as file:
        file.visititems(visit)
    assert "entry/scan/detected" in found and "entry/fates/quanta_low" in found
    return found


def bits(value: object) -> tuple:
    array = np.asarray(value)
    return array.dtype, array.shape, array.tolist() if array.dtype == object else array.tobytes()


def assert_same_bits(one: Path, other: Path) -> None:
    a, b = contents(one), contents(other)
    assert a.keys() == b.keys()
    assert not [name for name in a if bits(a[name]) != bits(b[name])]


def read(path: Path, name: str) -> np.ndarray:
    with h5py.File(path) as file:
        return file["entry"][name][()]


def provenance(path: Path) -> list[str]:
    return [argument.decode() for argument in read(path, "simulation/arguments")]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("runs")


@pytest.fixture(scope="module")
def crowded(folder: Path) -> Path:
    path = folder / "crowded.yaml"
    path.write_text(CROWDED)
    return path


@pytest.fixture(scope="module")
def reference(folder: Path) -> Path:
    return run(folder / "reference.h5", "--particles", 2003, *LAWS, *EDGES)


@pytest.fixture(scope="module")
def crowded_reference(folder: Path, crowded: Path) -> Path:
    return run(folder / "crowded.h5", experiment=crowded)
