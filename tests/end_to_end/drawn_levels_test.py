"""Fits of curves whose points err together, since levels are drawn at a filter; forms over flight times of many cells; tables that are no counts, or over no
frequency."""
from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rabiline._core", reason="built without pybind11")
import rabiline  # noqa: E402
from rabiline.__main__ import main  # noqa: E402
from rabiline.counts import Counts  # noqa: E402

CLOCK = """rabiline: 1
title: a clock whose probe draws levels
species: Rb-87 atom
law: quantum
source:
  speed: {kind: effusive, temperature: 393 K}
  opening: {width: 1 mm, height: 1 mm}
  direction: {kind: gaussian, x: 1 mrad, z: 1 mrad}
  spin: {kind: levels, levels: [F=1 m=0]}
parts:
  - {name: C, kind: uniform_field, at: 0.1 m, length: 0.7 m, field: 5 uT}
  - {name: R1, kind: oscillating_field, at: 0.2 m, length: 10 mm, amplitude: 1 uT, direction: z, frequency: 6834682610.9 Hz, approximation: rotating_wave, phase: random}
  - {name: R2, kind: oscillating_field, at: 0.7 m, length: 10 mm, amplitude: 1 uT, direction: z, oscillator: R1, approximation: rotating_wave, phase: locked}
  - {name: probe, kind: spin_filter, at: 0.75 m, levels: [F=2 m=0], up: 1, down: 0}
  - {name: D, kind: detector, at: 0.9 m, width: 10 mm, height: 10 mm, bins: [1, 1]}
particles: 5000
seed: 1
"""


def test_an_amplitude_is_known_where_the_noise_of_drawn_levels_is_common_to_all_points() -> None:
    places = tuple(f"{6834682610.9 + off:.1f} Hz" for off in np.linspace(-1000, 1000, 41))
    clock = rabiline.load(CLOCK)
    told = clock.set(particles=200000, seed=5).scan("R1.frequency", ",".join(places)).fly()
    emitted = np.full(len(places), 2e5)
    counts = np.random.default_rng(5).poisson(emitted * np.ravel(told.detected)).astype(float)
    fit = clock.fit(Counts("counts", "R1.frequency", places, np.array([float(place[:-3]) for place in places]), "Hz", counts, None, emitted, None),
                    ["R1.amplitude+R2.amplitude"], intervals=False)
    assert not fit.degenerate and fit.errors[0] < 0.02e-6
    assert abs(fit.values[0] - 1e-6) < 3 * fit.errors[0]


NUCLEI = """rabiline: 1
title: nuclei in a wide scan of the field
species: {name: CsF, mass: 151.9 u, charge: 0 e, spin: 1/2, gyromagnetic_ratio: 40.07758 MHz/T}
law: quantum
source:
  speed: {kind: maxwell, temperature: 900 K}
  opening: {width: 2 mm, height: 20 um}
  direction: {kind: box, x: 1.5 mrad, z: 0.2 mrad}
parts:
  - {name: A, kind: gradient_magnet, at: 0.1 m, length: 0.5 m, field: 1 T, gradient: 800 T/m}
  - {name: S, kind: slit, at: 0.7 m, width: 2 mm, height: 20 um}
  - {name: C, kind: uniform_field, at: 0.72 m, length: 0.16 m, field: 0.3 T}
  - {name: RF, kind: oscillating_field, at: 0.75 m, length: 0.1 m, amplitude: 0.3 mT, frequency: 12.0 MHz, approximation: rotating_wave, phase: random}
  - {name: B, kind: gradient_magnet, at: 0.9 m, length: 0.6 m, field: 1 T, gradient: -800 T/m}
  - {name: D, kind: detector, at: 1.6 m, width: 2 mm, height: 30 um, bins: [1, 1]}
particles: 1000000
seed: 1
scan: {parameter: C.field, from: 0.29 T, to: 0.31 T, points: 81}
"""


def test_a_line_is_averaged_over_flight_times_however_many_cells_they_have(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    rabiline.load(NUCLEI).run().write(tmp_path / "out.h5")
    assert main(["fit-line", str(tmp_path / "out.h5")]) == 0
    told = dict(line.split(None, 1) for line in capsys.readouterr().out.splitlines() if not line.startswith(" "))
    centre, length = (float(told[name].split()[0]) for name in ("centre", "length"))
    assert centre == pytest.approx(12.0 / 40.07758, rel=1e-4)
    assert length == pytest.approx(0.1 * 40.07758e6, rel=0.15) and told["length"].endswith("m Hz/T")
    assert float(told["chi²"].split()[0]) < 5


def test_rates_in_place_of_counts_are_told(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "clock.yaml").write_text(CLOCK)
    shown = np.random.default_rng(3).poisson(np.linspace(400, 900, 13))
    for factor, told in ((1, ""), (50, "  all counts are multiples of 50: are they rates?")):
        rows = [f"{6834682410.9 + 40 * i:.1f},{factor * n:.1f},1000000" for i, n in enumerate(shown)]
        (tmp_path / "counts.csv").write_text("\n".join(["R1.frequency [Hz],counts,emitted", *rows]))
        assert main(["fit", str(tmp_path / "clock.yaml"), "--data", str(tmp_path / "counts.csv"), "--free", "scale", "--particles", "500"]) == 0
        found = [line for line in capsys.readouterr().out.splitlines() if "are they rates" in line]
        assert [line.startswith(told) for line in found] == [True] * bool(told)


def test_offsets_of_a_frequency_are_told(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "clock.yaml").write_text(CLOCK)
    (tmp_path / "counts.csv").write_text("\n".join(["R1.frequency [kHz],counts,emitted", *(f"{i / 10},{400 + i},1000" for i in range(-5, 6))]))
    assert main(["fit", str(tmp_path / "clock.yaml"), "--data", str(tmp_path / "counts.csv"), "--free", "C.field"]) == 2
    assert "help: write whole frequencies, not how far they are from a line" in capsys.readouterr().err
