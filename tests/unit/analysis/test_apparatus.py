"""Drawings of an apparatus, and starter files."""
from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.colors import to_rgba

pytest.importorskip("rabiline._core", reason="built without pybind11")
import rabiline  # noqa: E402
from rabiline import starters  # noqa: E402
from rabiline.__main__ import main  # noqa: E402
from rabiline import apparatus  # noqa: E402
from rabiline.apparatus import draw_apparatus, pieces_of  # noqa: E402

BEAMLINES = Path(__file__).parents[3] / "beamline"


def test_parts_are_drawn_where_they_stand_with_their_openings() -> None:
    pieces = {piece.name: piece for piece in pieces_of(rabiline.load(BEAMLINES / "stern-gerlach.yaml").scan())}
    assert pieces["magnet"].begin == 0.034 and pieces["magnet"].length == 0.035
    assert pieces["slit"].half == {"x": 0.0004, "z": 1.75e-5} and pieces["magnet"].half["x"] == 0.002


def test_python_draws_an_apparatus_as_the_command_does(tmp_path: Path) -> None:
    experiment = rabiline.load(BEAMLINES / "ramsey.yaml")
    plt.close(experiment.draw(tmp_path / "a.png", paths=3, size="120x100"))
    assert main(["draw", str(BEAMLINES / "ramsey.yaml"), "-n", "3", "--size", "120x100", "-o", str(tmp_path / "b.png")]) == 0
    assert (plt.imread(tmp_path / "a.png") == plt.imread(tmp_path / "b.png")).all()
    with pytest.raises(rabiline.InputError, match="is a model, and no beamline to draw"):
        rabiline.load(BEAMLINES / "rotating-cylinder.yaml").draw()
    with pytest.raises(ValueError, match="paths"):
        experiment.draw(paths=-1)


def test_paths_are_told_apart_by_their_fate() -> None:
    figure = draw_apparatus(rabiline.load(BEAMLINES / "stern-gerlach.yaml").scan(), 50)
    shown = {text.get_text() for text in figure.axes[-1].get_legend().get_texts()}
    assert "detected at plate" in shown and "stopped by magnet" in shown
    plt.close(figure)


def test_a_path_is_drawn_to_its_end() -> None:
    experiment = rabiline.load(BEAMLINES / "muon-precession.yaml").scan()
    figure = draw_apparatus(experiment, 1)
    end = experiment.trace(1).tracks[0].position[-1, 1]
    assert max(line.get_xdata().max() for line in figure.axes[-1].get_lines() if len(line.get_xdata()) > 2) == end
    plt.close(figure)


def test_no_more_paths_are_flown_than_patience_allows(monkeypatch: pytest.MonkeyPatch) -> None:
    experiment = rabiline.load(BEAMLINES / "ramsey.yaml").scan()
    monkeypatch.setattr(apparatus, "PATIENCE", 0.0)
    assert len(apparatus._traced(experiment, None).tracks) == apparatus.AT_ONCE
    monkeypatch.setattr(apparatus, "PATIENCE", np.inf)
    numbers = [track.particle for track in apparatus._traced(experiment, None).tracks]
    assert numbers == list(range(apparatus.PATHS)) and len(apparatus._traced(experiment, 3).tracks) == 3


def test_a_file_of_few_particles_has_no_more_paths() -> None:
    experiment = rabiline.load(BEAMLINES / "ramsey.yaml").scan().set(particles=3)
    assert [len(apparatus._traced(experiment, asked).tracks) for asked in (None, 2, 9)] == [3, 2, 3]


def test_a_coil_is_shaded_where_its_field_is() -> None:
    experiment = rabiline.load(BEAMLINES / "neutron-spin-echo.yaml").scan()
    pieces = pieces_of(experiment)
    fields = apparatus.fields_along(experiment, pieces, 2.2)
    coil = next(piece for piece in pieces if piece.part == "first")
    shaded = apparatus._where_it_acts(coil, fields)
    assert coil.length == 0 and shaded.begin < 0.4 and shaded.begin + shaded.length > 0.8  # beyond its winding on both sides
    ends = experiment.field([(0, shaded.begin, 0), (0, 0.6, 0)])["first"]
    assert np.linalg.norm(ends[0]) == pytest.approx(0.1 * np.linalg.norm(ends[1]), rel=0.1)


def test_fields_on_the_axis_are_drawn_as_they_act() -> None:
    experiment = rabiline.load(BEAMLINES / "ramsey.yaml").scan()
    field = experiment.field([(0, 0.5, 0), (0, 0.36, 0), (0, 1.15, 0)])
    assert field["B"][:, 2].tolist() == [0.01, 0.01, 0.0] and 0 < abs(field["first"][1]).max() < 1e-4
    figure = draw_apparatus(experiment, 0)
    static, driven = figure.axes[1].get_lines()
    assert np.nanmax(static.get_ydata()) == pytest.approx(0.01) and np.nanmax(driven.get_ydata()) == pytest.approx(85.719e-6)
    assert figure.axes[1].get_yscale() == "log" and figure.axes[1].get_ylabel() == "B on axis"
    plt.close(figure)


def test_drives_are_drawn_with_their_amplitude_whatever_their_phase() -> None:
    experiment = rabiline.load("""
rabiline: 1
title: drives
species: neutron
law: quantum
source: {speed: {kind: single, value: 800 m/s}, opening: {radius: 1 mm}, direction: parallel}
parts:
  - {name: B, kind: uniform_field, at: 0.1 m, length: 3 m, field: 1 mT}
  - {name: late, kind: oscillating_field, at: 0.5 m, length: 0.1 m, amplitude: 110 uT, frequency: 29 kHz, approximation: none, phase: 90 deg,
     pulses: {begin: 1 ms, end: 2 ms}}
  - {name: follower, kind: oscillating_field, at: 1.5 m, length: 0.1 m, amplitude: 50 uT, oscillator: late, approximation: none, phase: locked}
  - {name: turns, kind: rotating_field, at: 2.7 m, length: 0.1 m, amplitude: 70 uT, frequency: 29 kHz, sense: co, phase: 30 deg}
  - {name: coil, kind: solenoid, at: 2.2 m, winding: 0.2 m, radius: 50 mm, turns: 100, current: 1 A, reach: 0.3 m,
     oscillates: {frequency: 1 kHz, phase: 90 deg}}
  - {name: screen, kind: detector, at: 4 m, width: 2 cm, height: 5 cm, bins: [1, 1]}
particles: 10
seed: 4
""")
    fields = apparatus.fields_along(experiment, pieces_of(experiment), 4)
    assert np.interp([0.55, 1.55, 2.75], fields.y, fields.drives) == pytest.approx([110e-6, 50e-6, 70e-6])
    standing = experiment.set({"coil.oscillates.phase": "0 deg"}).field([(0, 2.2, 0)])["coil"]
    assert np.interp(2.2, fields.y, fields.drives) == pytest.approx(np.linalg.norm(standing), rel=1e-3) and fields.static.max() == 1e-3
    figure = draw_apparatus(experiment, 0)
    assert [line.get_label() for line in figure.axes[1].get_lines()] == ["|B|, static", "|B|, oscillating:\namplitude"]
    plt.close(figure)


def test_electric_fields_are_drawn_beside_the_magnetic_ones() -> None:
    experiment = rabiline.load(BEAMLINES / "wien-filter.yaml").scan()
    places = [(0, 0.2, 0), (0, 0.5, 0)]
    assert experiment.electric_field(places)["E"].tolist() == [[-1e4, 0, 0], [0, 0, 0]] and list(experiment.field(places)) == ["B"]
    figure = draw_apparatus(experiment, 0)
    magnetic, electric = figure.axes[1:3]
    assert (magnetic.get_ylabel(), electric.get_ylabel()) == ("B on axis (mT)", "E on axis (kV/m)")
    line, = electric.get_lines()
    assert line.get_ydata().max() == 10 and np.ptp(line.get_xdata()[line.get_ydata() > 0]) == pytest.approx(0.2, abs=1e-5)
    plt.close(figure)


def test_gas_is_drawn_where_it_is() -> None:
    text = (BEAMLINES / "stern-gerlach.yaml").read_text()
    cell = "parts:\n  - {name: gas, kind: gas_cell, at: 0.08 m, length: 0.02 m, pressure: 0.1 Pa, temperature: 300 K, cross_section: 100 angstrom^2}\n"
    figure = draw_apparatus(rabiline.load(text.replace("parts:\n", cell, 1)).scan(), 0)
    drawn = [patch for patch in figure.axes[-1].patches if patch.get_facecolor() == to_rgba(apparatus.GAS)]
    assert [(patch.get_x(), patch.get_width()) for patch in drawn] == [(0.08, pytest.approx(0.02))]
    plt.close(figure)


def test_a_new_model_is_not_told_to_be_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    for name, drawn in (("model", False), ("ramsey", True)):
        assert main(["new", name]) == 0
        assert ("rabiline draw" in capsys.readouterr().out) == drawn


def test_every_starter_is_a_file_without_a_fault(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in starters.STARTERS:
        assert main(["new", name]) == 0
        rabiline.load(tmp_path / f"{name}.yaml").check()
    assert main(["new", "ramsey"]) == 2  # it is there already
    assert main(["new", "rabi", "-o", "other.yaml"]) == 0  # the geometry beside it may be


def test_every_shipped_file_names_the_schema_that_the_program_writes(tmp_path: Path) -> None:
    import os
    written = subprocess.run([os.environ["RABILINE_PROGRAM"], "describe", "--schema"], check=True, capture_output=True,
                             text=True).stdout
    same = (BEAMLINES / starters.SCHEMA).read_text() == written  # pytest would compare 200,000 letters for minutes
    assert same, "write it anew: rabiline describe --schema"
    for path in BEAMLINES.glob("*.yaml"):
        assert path.read_text().startswith(f"# yaml-language-server: $schema={starters.SCHEMA}\n"), path
    for path in (BEAMLINES.parent / "geometries").glob("*.yaml"):
        assert path.read_text().startswith(f"# yaml-language-server: $schema=../beamline/{starters.SCHEMA}\n"), path


def test_a_drive_draws_no_line_where_it_is_not() -> None:
    experiment = rabiline.load(BEAMLINES / "rabi-flop.yaml").set({"H0.amplitude": "3 mT"}).scan()
    figure = draw_apparatus(experiment, 0)
    static, driven = figure.axes[1].get_lines()
    assert figure.axes[1].get_yscale() == "linear"
    y, amplitude = driven.get_data()
    assert np.isnan(amplitude[(y < 0.34) | (y > 0.56)]).all() and np.nanmax(amplitude) == pytest.approx(3) and np.nanmax(static.get_ydata()) == pytest.approx(10)
    plt.close(figure)


def test_the_name_of_a_map_stands_over_its_field() -> None:
    experiment = rabiline.load("""
rabiline: 1
title: a formula
species: neutron
law: quantum
source: {speed: {kind: single, value: 800 m/s}, opening: {radius: 1 mm}, direction: parallel}
parts:
  - {name: hill, kind: formula_field, at: 0 m, formula: {Bz: "1e-3*exp(-((y-0.7)/0.1)^2)", width: 1 cm, height: 1 cm, length: 2 m, step: 1 cm}}
  - {name: screen, kind: detector, at: 2 m, width: 2 cm, height: 5 cm, bins: [1, 1]}
particles: 10
seed: 4
""")
    figure = draw_apparatus(experiment, 0)
    (name,) = (text for text in figure.axes[0].texts if text.get_text().startswith("hill"))
    assert name.get_position()[0] == pytest.approx(0.7, abs=0.02)
    plt.close(figure)
