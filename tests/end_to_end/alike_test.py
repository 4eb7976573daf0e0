"""Particles that fly alike, or nearly so: results of them, and lines that their flight times make."""
from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from runs import rabiline, run

pytest.importorskip("rabiline._core", reason="built without pybind11")
from rabiline import results  # noqa: E402
from rabiline.__main__ import main  # noqa: E402
from rabiline.curves import curves  # noqa: E402
from rabiline.errors import InputError  # noqa: E402

FLIPPER = """rabiline: 1
species: neutron
law: quantum
source:
  speed: {kind: gaussian, mean: 800 m/s, sigma: 40 m/s}
  opening: {width: 1 cm, height: 4 cm}
  direction: parallel
  spin: {kind: polarised, axis: z, degree: 1}
parts:
  - {name: guide, kind: uniform_field, at: 0.1 m, length: 3 m, field: 1 mT}
  - {name: C, kind: rotating_field, at: 0.5 m, length: 10 cm, amplitude: 110 uT, frequency: 29.1647 kHz, sense: co, phase: random}
  - {name: analyser, kind: spin_filter, axis: z, at: 3 m, up: 0.98, down: 0.02}
  - {name: counter, kind: detector, at: 4 m, width: 2 cm, height: 5 cm, bins: [5, 5]}
particles: 1000
seed: 4
"""
STRENGTH = 29164.6935 * 0.110  # Hz, gamma B/2pi


def flown(folder: Path, *more: object) -> Path:
    (folder / "a.yaml").write_text(FLIPPER)
    return run(folder / "a.h5", "--scan", "C.frequency=20 kHz:40 kHz:61", *more, experiment=folder / "a.yaml")


@pytest.mark.parametrize("speed", ["{kind: single, value: 800 m/s}", "{kind: gaussian, mean: 800 m/s, sigma: 0.01 m/s}", "{kind: gaussian, mean: 800 m/s, sigma: 1 m/s}"])
def test_a_result_of_particles_of_one_speed_can_be_read(tmp_path: Path, speed: str) -> None:
    more = "--set", f"source.speed={speed}", "--particles", 20000
    read = results.read(flown(tmp_path, *more))
    spread = 0.1 if "sigma: 1 " in speed else 1e-3
    assert (read.scan.errors[0] < spread / np.sqrt(20000)).all()  # all of them do the same
    matrix = read.scan.covariance[0]
    assert np.diag(matrix) == pytest.approx(read.scan.errors[0]**2)
    values = np.linalg.eigvalsh(curves(read)[0].covariance)
    assert values.min() > -1e-4 * values.max()  # where only some points are told apart, what moments are interpolated to stays


def test_rabis_line_is_averaged_over_the_flight_times_of_a_result(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    for speed, most in (("{kind: gaussian, mean: 800 m/s, sigma: 40 m/s}", 0.01), ("{kind: effusive, temperature: 40 K}", 0.1)):
        assert main(["fit-line", str(flown(tmp_path, "--set", f"source.speed={speed}", "--particles", 30000))]) == 0
        told = {line.split()[0]: float(line.split()[1]) for line in capsys.readouterr().out.splitlines() if "±" in line}
        assert told["strength"] == pytest.approx(STRENGTH / 1e3, rel=most) and told["length"] == pytest.approx(100, rel=most)


def test_a_line_deeper_than_what_is_there_says_that_flight_times_differ(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["fit-line", str(flown(tmp_path, "--set", "scan.particles=independent"))]) == 0
    assert "no line can be that deep: flight times differ" in capsys.readouterr().out
    assert main(["fit-line", str(flown(tmp_path, "--set", "scan.particles=independent", "--set", "source.speed={kind: single, value: 800 m/s}"))]) == 0
    out = capsys.readouterr().out
    assert "no line can be that deep" not in out and "\ntime       125." in out


def test_verify_looks_at_every_file(tmp_path: Path) -> None:
    whole, cut = flown(tmp_path), tmp_path / "cut.h5"
    cut.write_bytes(whole.read_bytes()[:5000])
    done = rabiline("verify", cut, tmp_path / "none.h5", whole)
    assert done.returncode != 0 and "cut.h5" in done.stderr and "none.h5" in done.stderr and f"{whole}: whole" in done.stdout
    with pytest.raises(InputError):
        results.read(cut)
