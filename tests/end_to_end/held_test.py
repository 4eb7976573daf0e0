"""What a fit says of a background that is not free."""
from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

pytest.importorskip("rabiline._core", reason="built without pybind11")
import rabiline  # noqa: E402
from rabiline.counts import Counts  # noqa: E402
from rabiline.counts_problem import Fisher  # noqa: E402
from rabiline.curve_model import CurveModel, NoFit  # noqa: E402
from rabiline.directions import analysis  # noqa: E402
from rabiline.fit_plots import _verdict  # noqa: E402
from rabiline.fitting import CountsFit, fit_counts  # noqa: E402
from rabiline.forecasting import forecast  # noqa: E402
from rabiline.held import Held, held  # noqa: E402


def test_a_background_that_chi_squared_does_not_show_is_told() -> None:
    clock = rabiline.load(Path(__file__).parents[2] / "beamline/caesium-clock.yaml")
    clock = clock.scan().scan("first.frequency", "9192631271.5 Hz:9192632271.5 Hz:51")
    expected = forecast(clock, ["C.field", "first.amplitude+second.amplitude"], rate=2e6)
    problem = replace(expected.problem, surface=replace(expected.problem.surface, covariance=np.zeros((51, 51))))
    generator = np.random.default_rng(3)

    def fitted(background: float) -> tuple[Held, float, np.ndarray]:
        counted = replace(problem, counts=generator.poisson(expected.counts + background).astype(float))
        values, badness = counted.least(expected.values)
        one, = held(counted, values, expected.errors)
        return one, float(stats.chi2.sf(badness, 48)), (values - expected.values) / expected.errors

    without = [fitted(0)[0] for _ in range(200)]
    assert np.mean([one.fall for one in without]) == pytest.approx(1, abs=0.3) and np.mean([one.is_wanted for one in without]) < 0.06
    one, p, off = fitted(0.02 * expected.counts.mean())
    assert one.is_wanted and one.fall > 20 and p > 0.01 and abs(off[0]) > 5
    assert one.moved[0] == pytest.approx(-off[0], rel=0.5) and one.by_part[0] == pytest.approx(-off[0] / 2, rel=0.5)


def test_a_free_background_starts_where_the_file_has_it() -> None:
    clock = rabiline.load(Path(__file__).parents[2] / "beamline/caesium-clock.yaml")
    clock = clock.scan().scan("first.frequency", "9192631271.5 Hz:9192632271.5 Hz:51").set(particles=2000)
    name, = clock.fly().scan.detectors
    stated = clock.set({f"{name}.background": "300 /s"})
    expected = forecast(stated, ["C.field", "background"], rate=2e6, seconds=4)
    assert expected.values[expected.names.index("background")] == pytest.approx(1200)
    table = Counts("counts", "first.frequency", tuple(f"{x!r} Hz" for x in np.linspace(9192631271.5, 9192632271.5, 51).tolist()),
                   np.linspace(9192631271.5, 9192632271.5, 51), "Hz", np.rint(expected.counts), np.full(51, 4.0), None, None)
    found = fit_counts(stated, table, ["background"], intervals=False)
    assert found["background"][0] == pytest.approx(1200, abs=4 * found["background"][1])
    with pytest.raises(NoFit, match="free `background` instead"):
        fit_counts(stated, table, [f"{name}.background"])
    with pytest.raises(NoFit, match="free `scale` instead"):
        fit_counts(stated, table, ["source.rate"])


def test_what_is_free_of_the_exposure_alone_comes_to_rest_where_it_fits_best() -> None:
    """However far away it starts."""
    clock = rabiline.load(Path(__file__).parents[2] / "beamline/caesium-clock.yaml").set(particles=2000)
    clock = clock.scan().scan("first.frequency", "9192631271.5 Hz:9192632271.5 Hz:51")
    scan, emitted = clock.fly().scan, np.full(51, 2e5)
    x = np.linspace(9192631271.5, 9192632271.5, 51)
    table = Counts("counts", "first.frequency", tuple(f"{one!r} Hz" for one in x.tolist()), x, "Hz",
                   np.random.default_rng(4).poisson(0.3 * emitted * scan.detected[0] + 298).astype(float), None, emitted, None)
    found = fit_counts(clock, table, ["scale", "background"], intervals=False)
    for name, true in (("scale", 0.3), ("background", 298)):
        value, error = found[name]
        assert abs(value - true) < 4 * error < true
    counts = replace(table, counts=np.random.default_rng(5).poisson(0.3 * emitted * scan.detected[0]).astype(float))
    alone = fit_counts(clock, counts, ["scale"])
    assert abs(alone["scale"][0] - 0.3) < 4 * alone["scale"][1] and not alone.held[0].is_wanted
    assert alone["scale"][1] / 0.3 == pytest.approx(np.sqrt(np.sum(scan.covariance[0])) / np.sum(scan.detected[0]), rel=0.5)  # hardly Poisson's


def test_a_background_that_has_led_a_fit_far_away_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = rabiline.load(Path(__file__).parents[2] / "beamline/caesium-clock.yaml").scan().set(particles=20000)
    places, free = np.linspace(9192631271.5, 9192632271.5, 51), ["C.field", "first.amplitude+second.amplitude"]
    line = clock.scan("first.frequency", "9192631271.5 Hz:9192632271.5 Hz:51").set(particles=100000, seed=7).fly().detected

    def fitted(seed: int, background: float, amplitude: str, *more: str) -> CountsFit:
        counts = np.random.default_rng(seed).poisson(1000 * line / line.max() + background).astype(float)
        table = Counts("counts", "first.frequency", tuple(f"{x!r} Hz" for x in places.tolist()), places, "Hz", counts, None, None, None)
        return fit_counts(clock.set({"first.amplitude": amplitude, "second.amplitude": amplitude}), table, [*free, *more], intervals=False)

    led = fitted(5, 100, "0.46 uT")
    assert led["C.field"][0] < 4e-6 and led.p > 0.1 and led.held[0].searched
    assert led.held[0].value == pytest.approx(100, rel=0.2)
    assert led["C.field"][0] + led.held[0].moved[0] * led["C.field"][1] == pytest.approx(6.05e-6, rel=0.2)
    assert "`background` is not free, and the counts fit as well with 9" in str(led)
    assert "the counts ask for a free background" in _verdict(led)  # in the picture
    # The field is then hardly known, and yet no fit asks for one that is reversed, through which atoms fly in many steps.
    tried, at = [], CurveModel.at
    monkeypatch.setattr(CurveModel, "at", lambda model, values, *particles: tried.append(values[0]) or at(model, values, *particles))
    freed = fitted(2, 100, "0.46 uT", "background")
    assert abs(freed["C.field"][0] - 6.05e-6) < 2 * freed["C.field"][1] and freed["C.field"][1] > 1e-6 and min(tried) > 0
    away = fitted(5, 0, "0.38 uT")  # from far away, and rightly
    value, error = away["first.amplitude+second.amplitude"]
    assert value - 0.38e-6 > 4 * error and abs(value - 0.46e-6) < 3 * error and not away.held[0].is_wanted


SELECTOR = """rabiline: 1
species: Rb-85 atom
gravity: 0 m/s^2
law: quantum
source: {speed: {kind: effusive, temperature: 450 K}, opening: {radius: 0.5 mm}, direction: {kind: aimed, target: s, emission: cosine}}
parts:
  - {name: s, kind: slit, at: 0.3 m, width: 1 mm, height: 5 mm}
  - {name: sel, kind: velocity_selector, at: 0.5 m, speed: 300 m/s, resolution: 0.1, transmission: 0.8}
  - {name: det, kind: detector, at: 1 m, width: 1 cm, height: 2 cm, bins: [1, 1]}
particles: 100000
seed: 5
"""
SELECTED = [10, 23, 18, 40, 79, 103, 137, 143, 191, 231, 261, 297, 318, 382, 343, 352, 397, 402, 383, 387, 353, 358, 342, 298, 240, 252, 197, 216, 143,
            139, 122, 101, 89, 61, 49, 42]


def test_a_background_that_leads_to_values_that_cannot_be_ends_no_fit() -> None:
    """A part of the way to that background is a transmission above 1."""
    speeds = np.linspace(100, 800, 36)
    table = Counts("counts", "sel.speed", tuple(f"{v} m/s" for v in speeds), speeds, "m/s", np.array(SELECTED, float), None, np.full(36, 5000.0), None)
    fit = fit_counts(rabiline.load(SELECTOR), table, ["source.speed.temperature", "sel.transmission"], intervals=False)
    assert abs(fit["source.speed.temperature"][0] - 480) < 3 * fit["source.speed.temperature"][1] < 20
    assert [one.name for one in fit.held if one.is_wanted] == ["background"]


DEFLECTED = """rabiline: 1
species: K-39 atom
law: quantum
source: {speed: {kind: effusive, temperature: 500 K}, opening: {width: 1 mm, height: 0.1 mm}, direction: {kind: gaussian, x: 0.1 mrad, z: 0.1 mrad}}
parts:
  - {name: M, kind: gradient_magnet, at: 0.2 m, length: 0.1 m, field: 0.5 T, gradient: 80 T/m}
  - {name: D, kind: detector, at: 1 m, width: 10 mm, height: 0.2 mm, bins: [1, 1]}
particles: 20000
seed: 4
scan: {parameter: D.offset.z, from: -4 mm, to: 4 mm, points: 41}
"""


def test_places_that_no_particle_reaches_take_nothing_from_a_forecast() -> None:
    beam = rabiline.load(DEFLECTED)
    assert (np.ravel(beam.fly().detected) == 0).any()
    seen = forecast(beam, ["M.gradient"], rate=20000, known_rate=True)
    with_background = forecast(beam, ["M.gradient"], rate=20000, known_rate=True, background=0.1)
    assert not seen.degenerate and seen.errors[0] == pytest.approx(with_background.errors[0], rel=0.1) and "1e-09" not in str(seen)


def test_what_is_known_is_not_lost_with_what_the_noise_hides() -> None:
    noisy, clear = 1e-3, 1e4  # of two parameters that have nothing to do with each other, the first of which is in the noise of slopes
    together = 0.02 * np.sqrt(noisy * clear)  # eigenvectors of the correlation are half and half nevertheless
    matrix = np.array([[noisy, together], [together, clear]])
    fisher = Fisher(matrix, np.diag([0.9 * noisy, 0]), 0 * matrix, 0 * matrix)
    covariance, _, lost, _ = analysis(fisher, np.array([2.0, 3.0]), ("noisy", "clear"))
    assert [list(one.involved) for one in lost] == [[0]] and np.sqrt(covariance[1, 1]) == pytest.approx(clear**-0.5, rel=0.01)
