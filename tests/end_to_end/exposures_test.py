"""The background that an experiment states is part of what is counted, whatever a table says of its time."""
from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rabiline._core", reason="built without pybind11")
import rabiline  # noqa: E402
from rabiline.curves import curves  # noqa: E402
from rabiline.forecasting import forecast  # noqa: E402
from rabiline.measured import read_measured  # noqa: E402

FLIPPER = """
rabiline: 1
title: A flipper
species: neutron
law: quantum
source:
  speed: {kind: gaussian, mean: 1000 m/s, sigma: 10 m/s}
  opening: {radius: 1 mm}
  direction: parallel
  rate: 1e4 1/s
parts:
  - {name: pol, kind: spin_filter, at: 0.1 m, axis: z, up: 1, down: 0}
  - {name: guide, kind: uniform_field, at: 0.2 m, length: 1.2 m, field: 1 mT}
  - {name: rf, kind: oscillating_field, at: 0.6 m, length: 0.1 m, amplitude: 0.3 mT, frequency: 29.16 kHz, approximation: rotating_wave, phase: random}
  - {name: ana, kind: spin_filter, at: 1.5 m, axis: z, up: 1, down: 0}
  - {name: det, kind: detector, at: 2 m, radius: 5 mm, bins: [1, 1], background: 300 1/s}
particles: 4000
seed: 3
"""
SECONDS = 10.0
SCAN = "20 kHz:38 kHz:19"
TIMES = {"none": ("", ""), "seconds": (",seconds", f",{SECONDS:g}"), "emitted": (",emitted", f",{SECONDS * 1e4:.0f}")}


@pytest.fixture(scope="module")
def flipper() -> rabiline.Experiment:
    return rabiline.load(FLIPPER)


@pytest.fixture(scope="module", params=list(TIMES))
def table(request: pytest.FixtureRequest, flipper: rabiline.Experiment, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Counts of the experiment with an amplitude of 0.3 mT, by what they say of their time."""
    counted = np.random.default_rng(5).poisson(SECONDS * (1e4 * flipper.set(particles=100000, seed=9).scan("rf.frequency", SCAN).fly().detected + 300))
    header, each = TIMES[request.param]
    path = tmp_path_factory.mktemp("counts") / f"{request.param}.csv"
    path.write_text("\n".join([f"rf.frequency [kHz],counts{header}", *(f"{x:g},{n}{each}" for x, n in zip(np.linspace(20, 38, 19), counted))]))
    return path


def test_a_stated_background_is_counted_over_the_time_that_the_table_or_the_rate_tells(flipper: rabiline.Experiment, table: Path) -> None:
    found = flipper.fit(table, ["rf.amplitude"], intervals=False)
    value, error = found["rf.amplitude"]
    assert abs(value - 0.3e-3) < 4 * error < 0.02e-3 and found.p > 1e-3
    assert ("scale" in found.names) == (table.stem == "none")
    said = {"none": "the background is 300 1/s, as the file has it, over the time that `scale` means at the source's `rate`",
            "emitted": "the background is 300 1/s, as the file has it, over the time that `emitted` means at the source's `rate`"}
    assert found.about_background == said.get(table.stem, "") and said.get(table.stem, "") in str(found)


def test_a_free_background_starts_at_the_stated_one(flipper: rabiline.Experiment, table: Path) -> None:
    found = flipper.fit(table, ["background"], intervals=False)
    value, error = found["background"]
    assert abs(value - 300 * SECONDS) < 4 * error and found.about_background == ""


def test_a_stated_background_that_no_time_is_known_for_is_told(flipper: rabiline.Experiment, table: Path) -> None:
    without_rate = rabiline.load(FLIPPER.replace("  rate: 1e4 1/s\n", ""))
    said = str(without_rate.fit(table, ["rf.amplitude"], intervals=False))
    left_out = ("the background of 300 1/s in the file is left out, since the time at each point is not known\n"
                "  help: add a column `seconds`, or fit with `background` in --free")
    assert (left_out in said) == (table.stem != "seconds")


def test_points_beside_a_curve_are_without_the_background(flipper: rabiline.Experiment, table: Path) -> None:
    curve, = curves(flipper.scan("rf.frequency", SCAN).run(progress=False))
    shown = read_measured(table, curve, None)
    assert shown.y == pytest.approx(curve.y, abs=0.02)
    assert shown.label.endswith(", less the background") == (table.stem == "none")


def test_a_fit_of_nothing_is_refused_where_the_exposure_is_known_too(flipper: rabiline.Experiment, table: Path) -> None:
    if table.stem == "none":
        found = flipper.fit(table, [], intervals=False)
        assert found.names == ("scale",)
        with pytest.raises(TypeError, match="`dpi` is a number, not a text"):
            found.plot(dpi="300")
    else:
        with pytest.raises(rabiline.InputError, match="^nothing is free: name a parameter of the experiment"):
            flipper.fit(table, [])
        with pytest.raises(rabiline.InputError, match="^a name in `free` is empty"):
            flipper.fit(table, [" "])
        with pytest.raises(rabiline.InputError, match="^nothing is free"):
            forecast(flipper.scan("rf.frequency", SCAN), [], known_rate=True)
