"""Other scans of a result, without another flight."""
from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from runs import BEAM_OF_POINTS

PROGRAM = os.environ["RABILINE_PROGRAM"]
BEAMLINE = BEAM_OF_POINTS + """geometry: magnets.yaml
parts:
  - {name: C, kind: uniform_field, at: 0.25 m, length: 0.20 m, field: 1 mT}
  - {name: RF, kind: rotating_field, at: 0.30 m, length: 0.05 m, amplitude: 1 uT, frequency: 9.3265 MHz, sense: co, phase: random}
  - {name: screen, kind: detector, at: 0.8 m, width: 4 mm, height: 0.6 mm, bins: [3, 4]}
particles: 20000
seed: 1938
scan: {parameter: RF.frequency, from: 9.30 MHz, to: 9.35 MHz, points: 21}
"""
MAGNETS = """
rabiline: 1
parts:
  - {name: A, kind: gradient_magnet, at: 0.1 m, length: 0.1 m, field: 1 T, gradient: 8 T/m}
  - {name: B, kind: gradient_magnet, at: 0.5 m, length: 0.1 m, field: 1 T, gradient: 20 T/m}
"""
NARROW = "RF.frequency=9.32 MHz:9.33 MHz:8"


def rabiline(*arguments: object, cwd: Path) -> subprocess.CompletedProcess:
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, cwd=cwd)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With a result that keeps its flight; what it was made from is gone."""
    folder = tmp_path_factory.mktemp("rescan")
    (folder / "rabi.yaml").write_text(BEAMLINE)
    (folder / "magnets.yaml").write_text(MAGNETS)
    for output, *arguments in (("rabi.h5",), ("narrow.h5", "--scan", NARROW, "--no-scan", "--transit", "none"),
                               ("plain.h5", "--transit", "none"), ("images.h5", "--transit", "images"),
                               ("drawn.h5", "--set", "law.outcomes=sample")):
        done = rabiline("run", "rabi.yaml", "-o", output, "--threads", 1, "--progress", "none", *arguments, cwd=folder)
        assert done.returncode == 0, done.stderr
    (folder / "rabi.yaml").unlink()
    (folder / "magnets.yaml").unlink()
    for arguments in (("new", "ramsey"), ("run", "ramsey.yaml", "-o", "levels.h5", "--transit", "totals", "--progress", "none")):
        assert rabiline(*arguments, cwd=folder).returncode == 0
    return folder


def numbers(path: Path, name: str) -> np.ndarray:
    with h5py.File(path) as file:
        return file[name][()]


def test_points_that_were_not_flown_are_as_if_they_had_been(folder: Path) -> None:
    done = rabiline("rescan", "rabi.h5", "--scan", NARROW, "-o", "new.h5", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "Rabi's apparatus: 8 scan points, 20000 particles each" in done.stdout
    for name in ("detected", "detected_errors", "RF_frequency"):
        assert numbers(folder / "new.h5", f"entry/scan/{name}") == pytest.approx(
            numbers(folder / "narrow.h5", f"entry/scan/{name}"), abs=1e-9)
    assert numbers(folder / "new.h5", "entry/fates/particles") == pytest.approx(
        numbers(folder / "narrow.h5", "entry/fates/particles"), abs=1e-9 * 20000)
    assert numbers(folder / "new.h5", "entry/screen/counts").shape == (8, 1, 1)


def test_a_magnet_whose_field_points_against_z_keeps_levels_along_z(tmp_path: Path) -> None:
    magnet = "kind: two_wire_magnet, length: 0.1 m, half_distance: 4 mm, wire_radius: 1 mm"
    found = {}
    (tmp_path / "rabi.yaml").write_text(BEAMLINE)
    for kind, beside in (("alone", ""), ("overlapped", "  - {name: G, kind: uniform_field, at: 0.55 m, length: 0.02 m, field: -1 mT}\n")):
        (tmp_path / "magnets.yaml").write_text(
            f"rabiline: 1\nparts:\n  - {{name: A, at: 0.1 m, {magnet}, field: 200 mT}}\n  - {{name: B, at: 0.5 m, {magnet}, field: -400 mT}}\n{beside}")
        for output, *scan in (("rabi.h5",), ("narrow.h5", "--scan", NARROW, "--no-scan", "--transit", "none")):
            done = rabiline("run", "rabi.yaml", "-o", output, "--progress", "none", *scan, cwd=tmp_path)
            assert done.returncode == 0, done.stderr
        done = rabiline("rescan", "rabi.h5", "--scan", NARROW, "-o", "new.h5", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        found[kind] = numbers(tmp_path / "narrow.h5", "entry/scan/detected")
        assert np.ptp(found[kind]) > 0.05  # the magnets part what flipped
        assert numbers(tmp_path / "new.h5", "entry/scan/detected") == pytest.approx(found[kind], abs=1e-9)
    assert found["overlapped"] == pytest.approx(found["alone"], abs=1e-4)  # a field along that of the magnet pushes nothing


def test_the_same_points_have_the_same_bits_where_all_bins_are_kept(folder: Path) -> None:
    assert rabiline("rescan", "images.h5", "-o", "again.h5", cwd=folder).returncode == 0
    for name in ("scan/detected", "scan/detected_covariance", "screen/counts", "screen_levels/levels_errors",
                 "fates/quanta_low"):
        assert (numbers(folder / "again.h5", f"entry/{name}") == numbers(folder / "images.h5", f"entry/{name}")).all()


def test_a_rescan_is_a_result_that_can_be_scanned_again(folder: Path) -> None:
    assert rabiline("rescan", "rabi.h5", "--scan", NARROW, "-o", "first.h5", cwd=folder).returncode == 0
    done = rabiline("rescan", "first.h5", "--scan", "C.field=0.999 mT:1.001 mT:5", "--set", "RF.amplitude=0.7 uT", "-o",
                    "second.h5", cwd=folder)
    assert done.returncode == 0, done.stderr
    with h5py.File(folder / "second.h5") as file:
        assert [text.decode() for text in file["entry/simulation/changes"][()]] == [
            "--set", "RF.amplitude=0.7 uT", "--scan", "C.field=0.999 mT:1.001 mT:5", "--no-scan"]
        assert file["entry/scan/detected"].shape == (5,)


@pytest.mark.parametrize(("result", "arguments", "reason", "code"), [
    ("rabi.h5", ("--scan", "A.gradient=8 T/m,9 T/m"), "changes more than how spins turn", 2),
    ("rabi.h5", ("--scan", "RF.amplitude=1 uT,100 uT"), "spins turn faster than the moments", 2),
    ("levels.h5", ("--scan", "first.frequency=290 kHz:390 kHz:3"), "spins turn faster than the moments", 2),
    ("rabi.h5", ("--scan", "source.speed.temperature=900 K,901 K"), "changes more than how spins turn", 2),
    ("rabi.h5", ("--scan", "RF.frequncy=1 MHz,2 MHz"), "did you mean `frequency`?", 2),
    ("rabi.h5", ("--set", "geometry=other.yaml"), "geometry", 2),
    ("plain.h5", (), "keeps no moments of its flight", 3),
    ("drawn.h5", (), "keeps no moments of its flight", 3),
    ("nothing.h5", (), "nothing.h5", 3),
    (".", (), "cannot be read", 3),
    ("rabi.h5", ("--set", "seed=3"), "the `seed`", 2),
    ("rabi.h5", ("--set", "until.detected_error=1 %"), "the `until` of its flight", 2),
])
def test_what_does_not_follow_from_the_flight_is_refused(folder: Path, result: str, arguments: tuple[str, ...],
                                                         reason: str, code: int) -> None:
    done = rabiline("rescan", result, *arguments, "-o", "refused.h5", cwd=folder)
    assert reason in done.stderr and done.returncode == code, done.stderr
    assert not (folder / "refused.h5").exists()


def test_reproduce_says_that_a_rescan_has_the_bits_of_another_scan(folder: Path) -> None:
    weaker = ("--scan", "RF.amplitude=0.5 uT:1 uT:3")
    assert rabiline("rescan", "rabi.h5", *weaker, "-o", "weaker.h5", cwd=folder).returncode == 0
    done = rabiline("reproduce", "weaker.h5", cwd=folder)
    assert done.returncode == 2 and "`rabiline rescan` worked it out from a flight for another scan" in done.stderr, done.stderr
    assert not (folder / "weaker-again.h5").exists()


def test_a_result_is_not_replaced_by_its_rescan(folder: Path) -> None:
    done = rabiline("rescan", "rabi.h5", "-o", "rabi.h5", cwd=folder)
    assert done.returncode == 2 and "rabi.h5" in done.stderr


@pytest.mark.parametrize("name", ["place", "low", "cells_width", "sums", "straggler_trees", "zero", "halvings", "version", "input"])
def test_a_damaged_flight_is_refused(folder: Path, name: str) -> None:
    damaged = folder / "damaged.h5"
    damaged.write_bytes((folder / "rabi.h5").read_bytes())
    with h5py.File(damaged, "a") as file:
        where = {"zero": "entry/flight/low", "input": "entry/simulation/input_0/data"}.get(name, f"entry/flight/{name}")
        values = file[where][()]
        if name == "input":
            file[where][...] = values.replace(b"900 K", b"901 K")
        else:
            del file[where]
            file[where] = {"place": values + 10**9, "low": values[:-1], "cells_width": -values, "sums": values + 1, "zero": 0 * values,
                           "halvings": values + 3, "version": values - 1, "straggler_trees": np.arange(7, dtype=np.uint64)}[name]
    done = rabiline("rescan", "damaged.h5", "-o", "refused.h5", cwd=folder)
    assert done.returncode in (2, 3) and done.stderr.startswith("error: "), done.stderr


def test_what_cannot_be_kept_is_told(folder: Path) -> None:
    (folder / "rabi.yaml").write_text(BEAMLINE)
    (folder / "magnets.yaml").write_text(MAGNETS)
    done = rabiline("run", "rabi.yaml", "--set", "law.outcomes=sample", "--transit", "totals", "--particles", 100, "-o", "a.h5",
                    cwd=folder)
    assert done.returncode == 0 and "nothing is kept for `rabiline rescan`" in done.stderr


@pytest.mark.parametrize("result", ["rabi.h5", "plain.h5", "drawn.h5"])
def test_covariances_have_the_squares_of_the_errors_on_their_diagonal_in_every_form(folder: Path, result: str) -> None:
    errors, covariance = numbers(folder / result, "entry/scan/detected_errors"), numbers(folder / result, "entry/scan/detected_covariance")
    np.testing.assert_allclose(np.diag(covariance), errors**2, rtol=1e-12)


def test_transits_are_drawn(folder: Path) -> None:
    transit = "entry/screen/transit"
    caught, edges = numbers(folder / "rabi.h5", f"{transit}/caught"), numbers(folder / "rabi.h5", f"{transit}/slowness_edges")
    assert caught.shape == (4, edges.size - 1)
    assert 0 < caught.sum() <= 2 * 20000  # each particle flies in two levels
    analysis = dict(os.environ, PYTHONPATH=str(Path(__file__).parents[2] / "analysis"))
    for result, code in (("rabi.h5", 0), ("drawn.h5", 2)):
        done = subprocess.run([sys.executable, "-m", "rabiline", "plot-transit", folder / result, "-o", folder / "transit.png"],
                              capture_output=True, text=True, env=analysis)
        assert done.returncode == code, done.stderr
    assert "has no times of flight to `screen`" in done.stderr


def test_a_scan_in_slabs_has_the_bits_of_one_in_one_piece(folder: Path) -> None:
    (folder / "rabi.yaml").write_text(BEAMLINE)
    (folder / "magnets.yaml").write_text(MAGNETS)
    scan = ("--no-scan", "--scan", "RF.frequency=9.32 MHz:9.33 MHz:4200", "--particles", 2000)
    checked = rabiline("check", "rabi.yaml", *scan, "--max-memory", "20MiB", cwd=folder)
    assert "scan points follow from one flight in 2 slabs" in checked.stdout, checked.stdout + checked.stderr
    assert "reweighted for 4200 settings by moments" in checked.stdout
    for name, *more in (("whole.h5",), ("slabs.h5", "--max-memory", "20MiB")):
        done = rabiline("run", "rabi.yaml", *scan, "--transit", "totals", "-o", name, *more, cwd=folder)
        assert done.returncode == 0, done.stderr
    for name in ("scan/detected", "scan/detected_errors", "screen/counts_errors", "screen_levels/levels_errors", "fates/quanta_low",
                 "flight/low", "parameters/scanned/RF.frequency"):
        assert (numbers(folder / "slabs.h5", f"entry/{name}") == numbers(folder / "whole.h5", f"entry/{name}")).all(), name
    assert [numbers(folder / name, "entry/simulation/slabs")[0] for name in ("whole.h5", "slabs.h5")] == [1, 2]
    again = rabiline("reproduce", "slabs.h5", cwd=folder)
    assert again.returncode == 0 and "same" in again.stdout, again.stdout + again.stderr
    more = rabiline("rescan", "slabs.h5", "--scan", "RF.frequency=9.32 MHz:9.33 MHz:5000", "--max-memory", "20MiB", "-o", "more.h5", cwd=folder)
    assert more.returncode == 0 and numbers(folder / "more.h5", "entry/simulation/slabs")[0] == 2, more.stderr


def test_memory_is_stated_as_a_size(folder: Path) -> None:
    (folder / "rabi.yaml").write_text(BEAMLINE)
    (folder / "magnets.yaml").write_text(MAGNETS)
    for size in ("2", "2 GB", "-1GiB", "nothing"):
        refused = rabiline("check", "rabi.yaml", "--max-memory", size, cwd=folder)
        assert refused.returncode == 2 and "is not a size of memory" in refused.stderr
    done = rabiline("run", "rabi.yaml", "--max-memory", "1 MiB", "--set", "screen.bins=[2000, 2000]", "-o", "a.h5", cwd=folder)
    assert done.returncode == 2 and ", and --max-memory allows 1 MiB\n  help: use fewer `bins` or fewer scan points" in done.stderr, done.stderr
    alone = rabiline("run", "rabi.yaml", "--max-memory", "1 MiB", "--set", "screen.bins=[2000, 2000]", "--no-scan", "--threads", "1", cwd=folder)
    assert "the histograms need " in alone.stderr and " on one thread, and" in alone.stderr, alone.stderr
    assert "help: use fewer `bins`, or allow more" in alone.stderr


def test_a_rescan_that_is_stopped_says_that_nothing_was_written(folder: Path) -> None:
    begun = subprocess.Popen([PROGRAM, "rescan", "rabi.h5", "--scan", "C.field=0.9 mT:1.1 mT:400001", "-o", "long.h5"], cwd=folder, stderr=subprocess.PIPE, text=True)
    time.sleep(1.5)
    begun.terminate()
    told = begun.communicate(timeout=10)[1]
    assert begun.returncode == 4 and told.endswith("\nstopped; nothing was written\n") and "before the flight" not in told, told
    assert not (folder / "long.h5").exists() and not list(folder.glob(".*.tmp"))
