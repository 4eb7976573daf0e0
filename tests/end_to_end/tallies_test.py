"""Monitors and tallies from the file of a beamline to pictures."""
from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from silx.io.nxdata import NXdata

PROGRAM = os.environ["RABILINE_PROGRAM"]
BEAMLINE = """
rabiline: 1
title: Tallies
species: neutron
law: quantum
source:
  speed: {kind: gaussian, mean: 1000 m/s, sigma: 10 m/s}
  opening: {width: 0.2 mm, height: 1 mm}
  direction: {kind: gaussian, x: 0.5 mrad, z: 1 mrad}
parts:
  - {name: B_prime, kind: polarizer, at: 0.10 m, length: 0.10 m, field: 10 mT, alignment: 0.6}
  - {name: B, kind: uniform_field, at: 0.30 m, length: 0.25 m, field: 10 mT}
  - {name: H0, kind: rotating_field, at: 0.35 m, length: 0.20 m, amplitude: 40 uT, frequency: 291.6 kHz, sense: co,
     phase: random}
  - name: M1
    kind: monitor
    at: 0.6 m
    radius: 1 mm
    tallies:
      - {name: states, axes: [prepared_level, level]}
      - name: cube
        axes: [{quantity: x, from: -1 mm, to: 1 mm, bins: 4}, {quantity: angle_x, from: -1 mrad, to: 1 mrad, bins: 5},
               {quantity: spin, axis: z, from: -1, to: 1, bins: 2}]
  - name: screen
    kind: detector
    at: 1.2 m
    radius: 4 mm
    bins: [8, 8]
    efficiency: 0.5
    dead: {width: 1 mm, height: 1 mm, offset: {x: 2 mm}}
    background: 3 1/min
    tallies: [{name: tof, axes: [{quantity: time_of_flight, from: 1.19 ms, to: 1.21 ms, bins: 20}]}]
particles: 4000
seed: 1938
"""
INSIDE = "  - {name: M, kind: monitor, at: 0.4 m, radius: 1 mm}\n"


def run(folder: Path, *arguments: str, text: str = BEAMLINE) -> tuple[Path, subprocess.CompletedProcess]:
    (folder / "a.yaml").write_text(text)
    done = subprocess.run([PROGRAM, "run", folder / "a.yaml", "-o", folder / "a.h5", "--threads", "1", *arguments],
                          capture_output=True, text=True)
    return folder / "a.h5", done


@pytest.fixture(scope="module")
def scanned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path, done = run(tmp_path_factory.mktemp("scan"), "--scan", "H0.frequency=280 kHz:300 kHz:3")
    assert done.returncode == 0, done.stderr
    return path


def test_every_tally_is_a_plot_that_viewers_know(scanned: Path) -> None:
    with h5py.File(scanned) as file:
        for name, axes in (("M1_states", ["H0_frequency", "prepared_level", "level"]),
                           ("M1_cube", ["H0_frequency", "x", "angle_x", "spin"]),
                           ("screen_tof", ["H0_frequency", "time_of_flight"]), ("M1", ["H0_frequency"])):
            group = file["entry"][name]
            data = NXdata(group)
            assert data.is_valid, data.issues
            assert list(group.attrs["axes"]) == axes
        tof = file["entry/screen_tof"]
        assert tof["time_of_flight"].attrs["units"] == "s"
        assert tof["time_of_flight_edges"].size == tof["time_of_flight"].size + 1
        assert "expectation" in file["entry/M1_states"].attrs["spin_outcomes"]
        assert file["entry/screen/background"][()] == pytest.approx(3 / 60)


def test_bins_and_what_is_outside_add_up_to_the_ledger(scanned: Path) -> None:
    with h5py.File(scanned) as file:
        entry = file["entry"]
        fates = {(fate, where): numbers for fate, where, numbers in zip(
            entry["fates/fate"].asstr(), entry["fates/where"].asstr(), entry["fates/particles"])}
        counts = entry["screen_tof/counts"][()].sum(axis=1) + entry["screen_tof/outside"][()]
        assert np.array_equal(counts, fates["detected", "screen"])
        assert entry["screen_tof/outside"][0] > 100
        assert fates["stopped", "screen"][0] > fates["detected", "screen"][0]
        passed = entry["M1/passed"][()] * 4000
        for name in ("M1_states", "M1_cube"):
            axes = tuple(range(1, entry[name]["counts"].ndim))
            total = entry[name]["counts"][()].sum(axis=axes) + entry[name]["outside"][()]
            assert np.allclose(total, passed, rtol=1e-13)


@pytest.mark.slow
def test_summary_and_pictures_know_tallies(scanned: Path, tmp_path: Path) -> None:
    def analysis(*arguments: object) -> subprocess.CompletedProcess:
        return subprocess.run([sys.executable, "-m", "rabiline", *map(str, arguments)], capture_output=True, text=True)

    words = analysis("summary", scanned).stdout
    assert "tally M1_states (expectation of the spin)" in words and "monitor M1" in words
    assert "time_of_flight   20 bins, mean 1." in words
    for arguments in (["screen_tof", "--points", "0,2"], ["M1_states", "--points", "0,1"], ["M1_cube"],
                      ["M1_cube", "--axes", "spin,x"], ["M1_cube", "--axes", "spin"]):
        done = analysis("plot-tally", scanned, *arguments, "-o", tmp_path / "a.png")
        assert done.returncode == 0, done.stderr
        assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    for arguments, message in ((["screen_tif"], "no tally `screen_tif` (there is"),
                               (["M1_cube", "--axes", "x,y"], "name one or two of x, angle_x, spin"),
                               (["M1_cube", "--points", "3"], "the scan points are 0 to 2")):
        done = analysis("plot-tally", scanned, *arguments, "-o", tmp_path / "b.png")
        assert done.returncode == 2 and message in done.stderr and done.stderr.count("\n") == 1, done.stderr


def test_a_monitor_inside_of_fields_counts_everybody_once_under_every_law(tmp_path: Path) -> None:
    text = BEAMLINE.replace("particles:", INSIDE + "particles:").replace("axes: [prepared_level, level]",
                                                                        "axes: [{quantity: x, from: 0 m, to: 1 m, bins: 1}]")
    for law in ("quantum", "classical", "dorado"):
        path, done = run(tmp_path, "--set", f"law={law}", "--set", "H0.amplitude=0.3 uT", text=text)
        assert done.returncode == 0, done.stderr
        with h5py.File(path) as file:
            assert 0.2 < file["entry/M/passed"][()].item() <= 1


def test_a_monitor_of_several_planes_is_a_plot_over_y_that_viewers_know(tmp_path: Path) -> None:
    several = ("  - {name: M, kind: monitor, at: 0.4 m, length: 0.1 m, planes: 5, radius: 1 mm, tallies: [{name: a, axes: "
               "[{quantity: spin_azimuth, from: -180 deg, to: 180 deg, bins: 6}]}]}\n")
    text = BEAMLINE.replace("particles:", several + "particles:").replace(
        "axes: [prepared_level, level]", "axes: [{quantity: x, from: 0 m, to: 1 m, bins: 1}]")
    path, done = run(tmp_path, "--set", "law=dorado", "--set", "H0.amplitude=0.3 uT", "--scan",
                     "H0.frequency=280 kHz:300 kHz:3", text=text)
    assert done.returncode == 0, done.stderr
    with h5py.File(path) as file:
        for name, axes, shape in (("M_a", ["H0_frequency", "y", "spin_azimuth"], (3, 5, 6)),
                                  ("M", ["H0_frequency", "y"], (3, 5))):
            data = NXdata(file["entry"][name])
            assert data.is_valid, data.issues
            assert list(file["entry"][name].attrs["axes"]) == axes and data.signal.shape == shape
        assert file["entry/M_a/spin_azimuth_mean"].shape == (3, 5) and file["entry/M/passed_covariance"].shape == (5, 3, 3)
        assert np.allclose(file["entry/M_a/y"], np.linspace(0.4, 0.5, 5))
        assert np.allclose(file["entry/M_a/counts"][()].sum(axis=2) / 4000, file["entry/M/passed"])
    done = subprocess.run([sys.executable, "-m", "rabiline", "summary", path], capture_output=True, text=True)
    assert "5 planes, 400 mm to 500 mm" in done.stdout, done.stderr


def test_angles_are_drawn_where_they_are_and_refused_where_not(scanned: Path, tmp_path: Path) -> None:
    def plot(*arguments: object) -> subprocess.CompletedProcess:
        return subprocess.run([sys.executable, "-m", "rabiline", "plot-angles", *map(str, arguments), "-o",
                               tmp_path / "a.png"], capture_output=True, text=True)

    beamline = Path(__file__).resolve().parents[2] / "beamline" / "spin-angles.yaml"
    path, done = run(tmp_path, "--set", "particles=200", text=beamline.read_text())
    assert done.returncode == 0, done.stderr
    done = plot(path, "--polar-rate=-139.99", "--azimuth-rate", "2.91646935 kHz")
    assert done.returncode == 0, done.stderr
    assert "polar angle θ: -139.9" in done.stdout and "azimuth φ: 2.91" in done.stdout
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    done = plot(scanned)
    assert done.returncode == 2 and "no tally over spin_azimuth, spin_polar_angle, time_of_flight" in done.stderr
