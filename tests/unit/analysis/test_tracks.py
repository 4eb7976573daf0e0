"""Tracks: whose law they follow, and from where on their spins mean something."""
from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from matplotlib import pyplot as plt
from rabiline import tracks
from rabiline.__main__ import main
from rabiline.space_plots import draw_paths
from rabiline.regions import Region
from rabiline.track_plots import draw_tracks
from rabiline.units import law_name
from synthetic import DORADO, GAMMA, align, fly, write_tracks

BEFORE = (0.6, 0.0, 0.8)


def spinning(polar: np.ndarray, azimuth: np.ndarray | float = 0.0) -> dict[str, np.ndarray]:
    """A flight along y with the spin at these angles."""
    y = np.linspace(0, 1, polar.size)
    return {name: 0 * y for name in "x z vx vz".split()} | {
        "t": y * 1e-3, "y": y, "vy": 0 * y + 1000, "sx": np.sin(polar) * np.cos(azimuth),
        "sy": np.sin(polar) * np.sin(azimuth), "sz": np.cos(polar)}


def read_one(tmp_path: Path, flight: dict[str, np.ndarray]) -> tracks.Track:
    (track,) = tracks.read(write_tracks(tmp_path / "t.h5", [flight], law=DORADO)).tracks
    return track


def test_the_law_is_read_from_the_entry_and_from_each_particle(tmp_path: Path) -> None:
    path = write_tracks(tmp_path / "t.h5", [spinning(np.zeros(3))], law=DORADO)
    assert tracks.read(path).law == tracks.read(path).tracks[0].law == DORADO
    with h5py.File(path, "a") as file:
        del file["entry/law"]
    assert tracks.read(path).law == DORADO


def test_the_tilt_starts_with_the_alignment_and_grows_by_what_the_field_turns(tmp_path: Path) -> None:
    flight = align(fly("dorado", abs(GAMMA) * 10e-3 / (2 * np.pi)), 0, BEFORE)
    track = read_one(tmp_path, flight)
    (shown,) = track.stretches
    assert shown.start == 1 and track.tilt[1] == 0
    assert track.tilt[-1] == pytest.approx(abs(GAMMA) * 0.3e-6 * 0.2e-3, rel=5e-3)  # resonance: gamma H0 T


def test_without_an_alignment_the_tilt_is_shown_from_the_start(tmp_path: Path) -> None:
    track = read_one(tmp_path, spinning(np.full(50, 0.3), np.linspace(0, 40, 50)))
    assert track.stretches == [slice(0, track.time.size)]
    np.testing.assert_allclose(track.tilt, 0.3)


@pytest.mark.parametrize("azimuths", [np.zeros(200), np.linspace(0, 300, 200)])
def test_a_field_that_turns_the_spin_over_is_no_alignment(tmp_path: Path, azimuths: np.ndarray) -> None:
    polar = np.linspace(0, np.pi, 200)
    track = read_one(tmp_path, spinning(polar, azimuths))
    assert track.stretches == [slice(0, track.time.size)]
    np.testing.assert_allclose(track.tilt, polar, atol=1e-12)


def test_an_alignment_in_the_midst_of_a_field_is_told_from_the_field(tmp_path: Path) -> None:
    polar = np.where(np.arange(200) < 80, 1.0, np.pi - 1e-4 * np.maximum(np.arange(200) - 80, 0))
    track = read_one(tmp_path, spinning(polar, np.linspace(0, 300, 200)))
    assert [part.start for part in track.stretches] == [0, 80]
    assert track.tilt[-1] == pytest.approx(119e-4)


def test_what_turns_a_spin_fast_where_no_polarizer_stands_is_a_field(tmp_path: Path) -> None:
    polar = np.where(np.arange(200) < 80, 0.2, 1.8 + 1e-5 * np.arange(200))  # a coil, between two records
    track = read_one(tmp_path, spinning(polar, np.linspace(0, 300, 200)))
    assert len(track.stretches) == 2
    assert replace(track, polarizers=(0.1, 0.9)).stretches == replace(track, polarizers=()).stretches == [slice(0, 200)]
    assert len(replace(track, polarizers=(80 / 199,)).stretches) == 2


def test_a_spin_is_shown_between_its_alignments(tmp_path: Path) -> None:
    flight = align(align(spinning(np.linspace(0, 0.01, 20)), 12, BEFORE), 4, (0, 1, 0))
    track = read_one(tmp_path, flight)
    assert track.stretches == [slice(5, 14), slice(14, track.time.size)]


def test_fields_of_the_file_are_shaded_by_themselves(tmp_path: Path) -> None:
    part = tracks.Part("H0", "rotating_field", "the drive", 0.35, 0.55, True, True)
    file = replace(tracks.read(write_tracks(tmp_path / "a.h5", [fly("quantum", 281e3)], law="quantum")), parts=(part,))
    figure = draw_tracks([file], ["quantum"], "a title", [])
    assert [text.get_text() for text in figure.axes[0].texts] == ["the drive"]


def test_a_picture_names_every_file_and_shows_no_spin_from_before_the_alignment(tmp_path: Path) -> None:
    flown = fly("dorado", 281e3)
    files = [tracks.read(write_tracks(tmp_path / "a.h5", [align(flown, 0, BEFORE)], law=DORADO)),
             tracks.read(write_tracks(tmp_path / "q.h5", [fly("quantum", 281e3)], law="quantum"))]
    labels = [law_name(file.law) for file in files]
    figure = draw_tracks(files, labels, "a title", [Region("H0", 0.35, 0.55), Region("B", 0.3, 0.55)])
    x, z, tilt, sphere = figure.axes
    words = [text.get_text() for text in x.texts + z.texts + tilt.get_legend().texts]
    assert words == ["B", "H0", "dorado (hypothesis), torque, κ = 1", "quantum", "detected"]
    (line,) = tilt.lines
    assert np.nanmax(line.get_ydata()) < 0.2 and tilt.get_ylabel() == "spin's tilt from z (°)"
    assert sphere.get_zlabel() == "$S_y$ (10$^{-3}$)"


def test_paths_in_space_are_drawn_whole_in_their_own_units(tmp_path: Path) -> None:
    flight = spinning(np.zeros(20))
    flight["x"] = -5e-3 * flight["y"] ** 2
    bent = tracks.read(write_tracks(tmp_path / "bent.h5", [flight], law=DORADO))
    straight = tracks.read(write_tracks(tmp_path / "straight.h5", [spinning(np.zeros(20))], law="quantum"))
    figure = draw_paths([straight, bent], ["quantum", "dorado"], "a title", [Region("B", 0.2, 0.5)])
    (axes,) = figure.axes
    assert (axes.get_xlabel(), axes.get_ylabel(), axes.get_zlabel()) == ("x (mm)", "y, along the beam (m)", "z (mm)")
    low, high = axes.get_xlim()
    assert low < -5 and high > 0
    ends = [line.get_data_3d() for line in axes.lines if len(line.get_data_3d()[0]) == 1]
    assert [float(end[0][0]) for end in ends] == pytest.approx([0, -5])
    assert "B" in [text.get_text() for text in axes.texts]
    assert [text.get_text() for text in axes.get_legend().texts] == ["quantum", "dorado", "detected", "passed"]


@pytest.mark.parametrize("tilt", [1.5, 0.1])
def test_the_spin_that_is_drawn_by_itself_is_named(tmp_path: Path, tilt: float) -> None:
    file = tracks.read(write_tracks(tmp_path / "t.h5", [spinning(np.linspace(0, most, 50)) for most in (tilt / 2, tilt, tilt / 3)]))
    figure = draw_tracks([file], [""], "", [])
    assert figure.axes[-1].get_title().startswith("the spin that tilts farthest, of particle 1:\n")
    assert draw_tracks([file, file], ["a", "b"], "", []).axes[-1].get_title().startswith("of each file the spin that tilts farthest:\n")
    plt.close("all")


def test_paths_are_told_in_words_and_written_as_a_table(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    path = write_tracks(tmp_path / "t.h5", [spinning(np.zeros(3)), spinning(np.zeros(4))], law=DORADO)
    assert main(["summary", str(path)]) == 0
    told = capsys.readouterr().out
    assert "paths        2, of 7 records" in told and "fate         detected at screen: 2" in told and "end          at y = 1 m, after 1 ms" in told
    assert main(["summary", str(path), "--json"]) == 0
    assert [one["records"] for one in json.loads(capsys.readouterr().out)["tracks"]] == [3, 4]
    assert main(["summary", str(path), "--detector", "wire"]) == 2
    assert "holds the paths of single particles, and no detector" in capsys.readouterr().err
    tracks.read(path).to_csv(tmp_path / "t.csv")
    rows = list(csv.DictReader((tmp_path / "t.csv").read_text().splitlines()[2:]))
    assert ",".join(rows[0]) == "particle,law,species,fate,where,t [s],x [m],y [m],z [m],vx [m/s],vy [m/s],vz [m/s],sx,sy,sz,weight" and len(rows) == 7
    assert (rows[4]["particle"], rows[4]["law"], rows[4]["y [m]"], rows[4]["z [m]"]) == ("1", DORADO, repr(float(1 / 3)), "0.0")
    frame = tracks.read(path).to_dataframe()
    assert frame["t"].tolist()[:3] == pytest.approx([0, 5e-4, 1e-3]) and frame.attrs["units"]["vy"] == "m/s"
