"""Whole runs give the same bits on a processor with and without fused multiply-add.

The C library chooses its sin, exp, pow, ... by the processor; GLIBC_TUNABLES makes it choose as on a plain x86-64. The
kernels ask the processor themselves and keep their instruction set: that all of them agree is tested elsewhere, and without
the instruction they would take minutes.
"""
from __future__ import annotations

import math
import os
import platform
import re
import subprocess
import sys
from pathlib import Path

import h5py
import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ["RABILINE_PROGRAM"]
PLAIN = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2_Usable,-FMA_Usable,-AVX2,-FMA,-AVX512F,-FMA4"}
OF_THE_RUN = {"seconds", "start_time", "end_time", "date", "arguments", "instruction_set", "file_name"}
SHIPPED = sorted((ROOT / "beamline").glob("*.yaml"))
FIELDS_AND_SOURCES = """
rabiline: 1
title: Fields and sources
species: neutron
law: {law}
source: {{speed: {speed}, opening: {{radius: 1 mm}}, direction: {direction},
         spin: {{kind: polarised, axis: [0.2, 0.1, 0.9], degree: 0.9}}}}
parts:
  - {{name: C, kind: coil, at: 5 cm, length: 5 cm, axis: [1, 2, 3], angle: 77 deg, speed: 1100 m/s, tilt: {{z: 0.1 rad}}}}
  - {{name: G, kind: guide_field, at: 20 cm, length: 20 cm, field: 70 uT, from: [0.3, 0, 1], to: [1, 0.3, 0]}}
  - {{name: D, kind: detector, at: 1 m, width: 9 cm, height: 9 cm, bins: [20, 20], tilt: {{y: 0.2 rad}}}}
particles: 16
seed: 7
"""


def shortened(folder: Path, points: int) -> Path:
    """All experiments with scans of few points, beside what they name."""
    place = folder / "beamline"
    place.mkdir()
    (folder / "geometries").symlink_to(ROOT / "geometries")
    for file in (ROOT / "beamline").iterdir():
        if file.suffix == ".yaml":
            fewer = re.sub(r"\bpoints: (\d+)", lambda found: f"points: {min(points, int(found[1]))}", file.read_text())
            (place / file.name).write_text(fewer)
        else:
            (place / file.name).symlink_to(file)
    return place


def datasets(path: Path) -> dict[str, bytes]:
    found = {}

    def keep(name: str, item: h5py.Group | h5py.Dataset) -> None:
        if isinstance(item, h5py.Dataset) and name.split("/")[-1] not in OF_THE_RUN:
            value = item[()]
            found[name] = value.tobytes() if hasattr(value, "tobytes") else value

    with h5py.File(path) as file:
        file.visititems(keep)
    return found


def run(experiment: Path, output: Path, environment: dict[str, str], *arguments: str) -> dict[str, bytes]:
    subprocess.run([PROGRAM, "run", experiment, "-o", output, *arguments], env={**os.environ, **environment},
                   check=True, capture_output=True, timeout=300)
    return datasets(output)


def expect_same_bits(experiment: Path, folder: Path) -> None:
    few = [] if "model:" in experiment.read_text() else ["--particles", "16", "--threads", "1"]
    here = run(experiment, folder / "here.h5", {}, *few)
    plain = run(experiment, folder / "plain.h5", PLAIN, *few)
    assert here.keys() == plain.keys() and here
    different = [name for name in here if here[name] != plain[name]]
    assert not different, different


@pytest.fixture(autouse=True)
def needs_x86_64() -> None:
    if platform.machine() not in ("x86_64", "AMD64"):
        pytest.skip("the C library has no variants to choose from here")


def test_the_library_takes_the_variants_of_a_plain_processor() -> None:
    """Else the tests below would compare a run with itself."""
    if " fma " not in Path("/proc/cpuinfo").read_text():
        pytest.skip("this processor is plain")
    sines = "import math; print([math.sin(1 + k / 1000).hex() for k in range(200000)])"
    plain = subprocess.run([sys.executable, "-c", sines], env={**os.environ, **PLAIN}, check=True, capture_output=True, text=True)
    assert plain.stdout.strip() != str([math.sin(1 + k / 1000).hex() for k in range(200000)])


@pytest.fixture(scope="module")
def few_points(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return shortened(tmp_path_factory.mktemp("shortened"), 5)


@pytest.mark.parametrize("name", [path.stem for path in SHIPPED])
@pytest.mark.slow
def test_a_shipped_experiment_gives_the_same_bits_without_fused_multiply_add(name: str, few_points: Path, tmp_path: Path) -> None:
    expect_same_bits(few_points / f"{name}.yaml", tmp_path)


@pytest.mark.parametrize(("law", "speed", "direction"), [
    ("classical", "{kind: supersonic, temperature: 300 K, adiabatic_exponent: 1.6, speed_ratio: 7}",
     "{kind: channel, length: 5 mm, radius: 1 mm}"),
    ("dorado", "{kind: gaussian, mean: 2 angstrom, sigma: 0.1 angstrom}", "{kind: cone, half_angle: 0.4 deg}, tilt: {x: 3 mrad}"),
    ("quantum", "{kind: maxwell, temperature: 40 K}", "{kind: gaussian, x: 1 mrad, z: 2 mrad}, tilt: {z: -2 mrad}"),
])
def test_fields_and_sources_give_the_same_bits_without_fused_multiply_add(law: str, speed: str, direction: str,
                                                                          tmp_path: Path) -> None:
    experiment = tmp_path / "fields.yaml"
    experiment.write_text(FIELDS_AND_SOURCES.format(law=law, speed=speed, direction=direction))
    expect_same_bits(experiment, tmp_path)
