"""Fits of counts give back what they were made with, know their errors, and say what they do not know."""
from __future__ import annotations

import os
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rabiline._core", reason="built without pybind11")
import rabiline  # noqa: E402
from rabiline.counts import Counts  # noqa: E402
from rabiline.curve_model import NOISE, SPREAD, CurveModel, NoFit, noise_of, unknown  # noqa: E402
from rabiline.errors import InputError  # noqa: E402
from rabiline.fitting import CountsFit, fit_counts  # noqa: E402
from rabiline.forecasting import forecast  # noqa: E402

PROGRAM = os.environ["RABILINE_PROGRAM"]
RAMSEY = (Path(__file__).parents[2] / "docs/example/ramsey-fringes.yaml").read_text(encoding="utf-8")
WIRE = """
rabiline: 1
title: A hot wire across a potassium beam
species: K-39 atom
law: quantum
source:
  speed: {kind: effusive, temperature: 500 K}
  opening: {width: 2 mm, height: 30 um}
  direction: {kind: aimed, target: s1, emission: cosine}
  spin: {kind: thermal, temperature: 500 K}
parts:
  - {name: s1, kind: slit, at: 0.3 m, width: 2 mm, height: 30 um}
  - {name: mag, kind: gradient_magnet, at: 0.35 m, length: 0.1 m, field: 0.8 T, gradient: 80 T/m, gap: {width: 5 mm, height: 2 mm}}
  - {name: wire, kind: detector, at: 0.9 m, width: 10 mm, height: 50 um, bins: [1, 1]}
particles: 100000
seed: 4
"""
TRUTH = {"guide.field": 1.0003e-3, "C1.amplitude+C2.amplitude": 113e-6, "source.speed.mean": 805.0}


def measured(experiment: rabiline.Experiment, parameter: str, x: np.ndarray, unit: str, truth: dict[str, float], each: float,
             seed: int = 1) -> Counts:
    """Counts of an experiment that is flown with other particles."""
    places = tuple(f"{value!r} {unit}" for value in x.tolist())
    changes = {name: value for names, value in truth.items() for name in names.split("+")}
    y = experiment.scan().set(changes).set(seed=1000 + seed, particles=1000000).scan(parameter, places).fly().detected
    return Counts("counts", parameter, places, x, unit, np.random.default_rng(seed).poisson(each * y).astype(float), None,
                  None, None)


@pytest.fixture(scope="module")
def ramsey() -> rabiline.Experiment:
    return rabiline.load(RAMSEY)


@pytest.fixture(scope="module")
def fringes(ramsey: rabiline.Experiment) -> Counts:
    return measured(ramsey, "C1.frequency", np.linspace(28664.7, 29664.7, 41), "Hz", TRUTH, 40000)


@pytest.fixture(scope="module")
def fitted(ramsey: rabiline.Experiment, fringes: Counts) -> CountsFit:
    return fit_counts(ramsey, fringes, list(TRUTH))


def test_field_amplitude_and_speed_come_back_within_their_errors(fitted: CountsFit) -> None:
    for name, true in TRUTH.items():
        value, error = fitted[name]
        assert abs(value - true) < 3.5 * error, name
        low, high = fitted.intervals[fitted.names.index(name)]
        assert 0.7 * error < value - low < 1.4 * error and 0.7 * error < high - value < 1.4 * error
    assert fitted["guide.field"][1] < 1e-8 and fitted["source.speed.mean"][1] < 1.5
    assert 1e-3 < fitted.p < 1 - 1e-6 and not fitted.degenerate


def test_few_particles_explore_and_all_conclude(ramsey: rabiline.Experiment, fringes: Counts, fitted: CountsFit) -> None:
    flown: list[int] = []
    every = fit_counts(ramsey, fringes, list(TRUTH), explore=50000, intervals=False, told=lambda _, particles, *rest: flown.append(particles))
    assert set(flown) == {50000}
    few = fit_counts(ramsey, fringes, list(TRUTH), intervals=False, told=lambda _, particles, *rest: flown.append(particles))
    assert sorted(set(flown)) == [5000, 50000] and flown.count(50000) - every.flights <= 3
    assert (np.abs(few.values - every.values) < 0.2 * every.errors).all() and few.errors == pytest.approx(every.errors, rel=0.1)


def test_all_particles_fly_twice_at_most_where_the_noise_of_slopes_does_not_matter() -> None:
    """On any number of threads, with the same bits."""
    clock = rabiline.load(Path(__file__).parents[2] / "beamline/caesium-clock.yaml").scan()
    truth = {"C.field": 6.05e-6, "first.amplitude+second.amplitude": 0.48e-6}
    counts = measured(clock, "first.frequency", np.linspace(9192631271.5, 9192632271.5, 41), "Hz", truth, 100000)
    flown: list[int] = []
    one, two = (fit_counts(clock.set(particles=200000), counts, list(truth), intervals=False, threads=threads,
                           told=lambda _, particles, *rest: flown.append(particles)) for threads in (1, 2))
    assert flown.count(200000) <= 4  # twice in each fit
    assert one.values.tolist() == two.values.tolist() and one.covariance.tolist() == two.covariance.tolist()
    assert all(abs(one[name][0] - true) < 3.5 * one[name][1] for name, true in truth.items())


def test_what_groups_of_particles_differ_in_is_the_noise_of_a_slope() -> None:
    generator, n = np.random.default_rng(8), 2000
    slope = np.sin(np.linspace(0, 9, n))
    variance, ways = noise_of(slope + 0.5 * generator.normal(size=(4, n)), np.ones(n))
    assert variance == pytest.approx(0.5**2 / 4 / np.mean(slope**2), rel=0.1) and ways > 100
    together = 0.1 * np.array([1, -1, 2, 0])[:, None] * np.cos(np.linspace(0, 9, n))
    assert noise_of(slope + together, np.ones(n))[1] == pytest.approx(1.5)  # one way, of at most three that four groups can tell
    assert noise_of(np.array([slope, -slope, slope, -slope]), np.ones(n))[0] == np.inf
    more = np.ones((4, 1)) + together  # of everything, which a free factor takes up: what is left are the groups' differences
    assert noise_of(more, np.ones(n))[0] < 0.01 and noise_of(more, np.ones(n), scaled=True)[0] > 1


def test_a_trembling_slope_gets_a_wider_step_or_more_particles() -> None:
    clock = rabiline.load(Path(__file__).parents[2] / "beamline/caesium-clock.yaml").set(particles=40000)
    model = CurveModel(clock, "first.frequency", [f"{9192631700 + 10 * i} Hz" for i in range(12)], ["C.field"])
    step = model.step(model.start(), 0, 6e-9)  # lines with m of 42 kHz per 6 uT turn by 0.17 of a turn over that
    near, far = (noise_of(model.at(model.start() + by).groups - model.at(model.start()).groups, model.at(model.start()).y)
                 for by in (6e-9, step))
    assert near[0] > 0.3 and step > 6e-8 and far[0] <= NOISE * max(SPREAD, far[1])


def test_two_scans_are_fitted_at_once(ramsey: rabiline.Experiment, tmp_path: Path) -> None:
    places = np.linspace(28.6647, 29.6647, 11)
    true = ramsey.scan().set({"guide.field": 1.0003e-3, "seed": 9, "particles": 200000})
    y = true.scan("C2.phase", "0 deg,90 deg").scan("C1.frequency", "28.6647 kHz:29.6647 kHz:11").fly().detected
    counts = np.random.default_rng(2).poisson(40000 * y)
    rows = [f"{phase},{place:.4f},{n}" for phase, row in zip((0, 90), counts) for place, n in zip(places, row)]
    (tmp_path / "two.csv").write_text("\n".join(["C2.phase [deg],C1.frequency [kHz],counts", *rows[:5], *rows[6:]]))  # one is missing
    found = ramsey.fit(tmp_path / "two.csv", ["guide.field"])
    value, error = found["guide.field"]
    assert abs(value - 1.0003e-3) < 3.5 * error < 5e-8 and found.freedom == 19 and found.p > 1e-3
    assert "over C1.frequency and C2.phase" in str(found)
    (tmp_path / "no-grid.csv").write_text("\n".join(["C2.phase [deg],C1.frequency [kHz],counts", *(
        f"{i},{place:.4f},10" for i, place in enumerate(places))]))
    with pytest.raises(NoFit, match="make a grid"):
        ramsey.fit(tmp_path / "no-grid.csv", ["guide.field"])


def test_a_variable_may_be_free(fringes: Counts) -> None:
    text = RAMSEY.replace("seed: 4", 'seed: 4\nvariables: {B1: 113 uT}').replace("amplitude: 110 uT", "amplitude: ${B1}")
    found = fit_counts(rabiline.load(text), fringes, ["variables.B1", "guide.field"], intervals=False)
    assert found.units[0] == "T" and abs(found["variables.B1"][0] - 113e-6) < 3.5 * found["variables.B1"][1] < 3e-6
    experiment = rabiline.load(text)
    assert " µT" in str(found) and (experiment.value("variables.B1"), experiment.unit("variables.B1")) == (113e-6, "T")
    assert experiment.set({"variables.B1": 40e-6}).value("C1.amplitude") == 40e-6
    with pytest.raises(NoFit, match="`C1.amplitude` follows `variables.B1`, which is scanned"):
        CurveModel(experiment, "variables.B1", ["110 uT", "113 uT", "116 uT"], ["C1.amplitude"])


def test_counts_of_another_experiment_do_not_fit(ramsey: rabiline.Experiment, fringes: Counts) -> None:
    wrong = fit_counts(ramsey.set({"source.speed.sigma": "20 m/s"}), fringes, ["guide.field"], intervals=False)
    assert wrong.p < 1e-6 and "does not describe these counts" in str(wrong)


@pytest.mark.parametrize(("free", "says"), [("seed", "a number of the simulation, not of the beam"),
                                            ("guide.field+C1.amplitude", "is to be one value, and starts at")])
def test_what_is_no_parameter_of_a_beam_is_not_fitted(ramsey: rabiline.Experiment, fringes: Counts, free: str, says: str) -> None:
    with pytest.raises(NoFit, match=says):
        fit_counts(ramsey, fringes, [free], intervals=False)


def test_a_simulation_of_few_particles_is_no_verdict_on_the_counts(ramsey: rabiline.Experiment, fringes: Counts) -> None:
    few = fit_counts(ramsey.set({"particles": 20}), fringes, ["guide.field"], intervals=False)
    assert "too few particles to tell more" in str(few) and "does not describe" not in str(few)


def test_a_factor_stays_above_zero_where_the_curve_is_far_from_the_counts(ramsey: rabiline.Experiment, fringes: Counts) -> None:
    far = ramsey.set({"guide.field": "1.01 mT", "particles": 200})
    lost = fit_counts(far, fringes, ["background"], intervals=False)
    assert lost["scale"][0] > 0 and "does not describe these counts" in str(lost)
    with pytest.raises(ValueError, match="`explore` is 0 or above, not -5"):
        fit_counts(far, fringes, ["background"], explore=-5)


def test_a_known_exposure_has_no_free_scale(ramsey: rabiline.Experiment, fringes: Counts) -> None:
    known = Counts(**{**vars(fringes), "emitted": np.full(41, 40000.0)})
    assert fit_counts(ramsey, known, ["guide.field"], intervals=False).names == ("guide.field",)


def test_a_forecast_is_what_a_fit_of_enough_particles_finds(ramsey: rabiline.Experiment, fitted: CountsFit) -> None:
    expected = forecast(ramsey.set({"C1.amplitude": 113e-6, "C2.amplitude": 113e-6}), list(TRUTH), rate=40000)
    statistical = fitted.errors[:3] * np.sqrt(1 - fitted.shares_of_simulation)
    assert expected.errors[:3] == pytest.approx(statistical, rel=0.25)
    twice = forecast(ramsey, list(TRUTH), rate=40000, seconds=4)
    assert twice.errors[0] == pytest.approx(expected.errors[0] / 2, rel=0.1)


@pytest.mark.parametrize("option", [{"rate": np.nan}, {"rate": 1e308}, {"rate": 1e6, "seconds": np.inf}, {"rate": 1e6, "background": -1.0}])
def test_a_forecast_of_a_rate_that_cannot_be_is_refused(ramsey: rabiline.Experiment, option: dict[str, float]) -> None:
    with pytest.raises(NoFit, match="must be (above 0|0 or above), up to 1e\\+30"):
        forecast(ramsey, ["guide.field"], **option)


def test_an_error_of_many_fringes_is_no_forecast(ramsey: rabiline.Experiment) -> None:
    assert forecast(ramsey, ["guide.field"], rate=40000).bent == ()
    few = forecast(ramsey, ["guide.field"], rate=1e-3)
    assert few.bent == ("guide.field",)
    assert "over such an error of `guide.field` the counts do not change in proportion: take it as not known" in str(few)


def test_a_forecast_of_too_few_particles_says_how_many_may_tell() -> None:
    clock = rabiline.load(Path(__file__).parents[2] / "beamline/caesium-clock.yaml")
    free = ["C.field", "first.amplitude+second.amplitude", "B.gradient", "source.speed.temperature"]
    few = forecast(clock.set(particles=1250), free, rate=2e4)
    assert few.degenerate and "1250 particles at each point may be too few to tell: try --particles " in str(few)
    enough = forecast(clock.set(particles=int(few.wanted_particles)), free, rate=2e4)
    assert not enough.degenerate and "try --particles" not in str(enough) and " 0.460 ± 0.0" in str(enough).replace("0.4600", "0.460")


def test_a_forecast_is_the_scatter_of_two_hundred_measurements(ramsey: rabiline.Experiment) -> None:
    expected = forecast(ramsey, list(TRUTH), rate=40000)
    exact = replace(expected.problem.surface, covariance=np.zeros_like(expected.problem.surface.covariance))
    generator = np.random.default_rng(3)
    found = np.array([replace(expected.problem, surface=exact, counts=generator.poisson(expected.counts).astype(float)).least(
        expected.values)[0] for _ in range(200)])
    assert np.std(found, axis=0, ddof=1) == pytest.approx(expected.errors, rel=0.1)  # of 200 it is known to 5 %
    assert (np.abs(found.mean(axis=0) - expected.values) < 4 * expected.errors / np.sqrt(200)).all()


def test_what_a_fit_takes_as_known_is_told(fitted: CountsFit, fringes: Counts, ramsey: rabiline.Experiment) -> None:
    assert "`background` is taken as known: 1% of the counts more by it would move C1.amplitude+C2.amplitude by" in str(fitted)
    known = Counts(**{**vars(fringes), "emitted": np.full(41, 36000.0)})  # a tenth of what was emitted is not in the table
    told = str(fit_counts(ramsey, known, ["guide.field", "source.speed.mean", "background"], intervals=False))
    assert "`scale` is not free, and the counts lean towards 1." in told and "fit with `scale` in --free" in told


@pytest.mark.slow
def test_temperature_over_gradient_comes_back_and_both_are_told_to_be_degenerate() -> None:
    wire = rabiline.load(WIRE)
    counts = measured(wire, "wire.offset.z", np.linspace(-1.5, 1.5, 61) * 1e-3, "m", {"source.speed.temperature": 504.8}, 2e5)
    one = fit_counts(wire, counts, ["source.speed.temperature"], intervals=False)
    assert abs(one["source.speed.temperature"][0] - 504.8) < 3.5 * one["source.speed.temperature"][1] < 12
    both = fit_counts(wire, counts, ["source.speed.temperature", "mag.gradient"])
    (name, ratio, error), = both.combined
    assert name == "source.speed.temperature / mag.gradient" and abs(ratio - 504.8 / 80) < 3.5 * error < 0.15
    assert "degenerate: `source.speed.temperature` by" in str(both) and "`mag.gradient` by" in str(both)
    assert "not known by itself" in str(both)


def test_what_the_noise_of_few_particles_hides_is_not_called_degenerate() -> None:
    magnet = rabiline.load("""
rabiline: 1
species: natural Ag atom
law: quantum
source: {speed: {kind: effusive, temperature: 1300 K}, opening: {width: 1 mm, height: 0.03 mm}, direction: {kind: aimed, target: s1}}
parts:
  - {name: s1, kind: slit, at: 0.05 m, width: 1 mm, height: 0.03 mm}
  - {name: mag, kind: gradient_magnet, at: 0.1 m, length: 3.5 cm, field: 1 T, gradient: 1500 T/m}
  - {name: wire, kind: detector, at: 0.3 m, width: 5 mm, height: 0.02 mm, bins: [1, 1]}
particles: 30000
seed: 3
""")
    counts = measured(magnet, "wire.offset.z", np.linspace(-1, 1, 61) * 1e-3, "m", {"mag.gradient": 1400}, 2e4)
    free = ["mag.gradient", "background"]
    few = fit_counts(magnet, replace(counts, counts=counts.counts + 8), free, intervals=False)
    assert all(direction.hidden for direction in few.degenerate) and few.wanted_particles > few.particles
    assert "mag.gradient  lost in the simulation's noise, held near 1" in str(few) and "degenerate" not in str(few)
    assert "help: 30000 particles at each point may be too few to tell: try --particles " in str(few)
    many = fit_counts(magnet.set(particles=300000), replace(counts, counts=counts.counts + 8), free, intervals=False)
    assert not many.degenerate and abs(many["mag.gradient"][0] - 1400) < 3.5 * many["mag.gradient"][1] < 150


def test_what_has_no_effect_is_refused(ramsey: rabiline.Experiment, fringes: Counts) -> None:
    with pytest.raises(NoFit, match="has no effect"):
        fit_counts(ramsey, fringes, ["guide.length"])
    with pytest.raises(NoFit, match="did you mean `field`"):
        fit_counts(ramsey, fringes, ["guide.filed"])
    with pytest.raises(NoFit, match="is no number that the file states"):
        fit_counts(ramsey, fringes, ["law"])
    with pytest.raises(NoFit, match=r"`guide` is a part\n  help: name one of its numbers, such as `guide.field`"):
        fit_counts(ramsey, fringes, ["guide"])
    with pytest.raises(NoFit, match="`guide.field` is free twice"):
        fit_counts(ramsey, fringes, ["guide.field", "guide.field+C1.amplitude"])
    with pytest.raises(InputError, match="`background` is free twice"):
        fit_counts(ramsey, fringes, ["guide.field", "background", "background"])
    with pytest.raises(NoFit, match="names have commas between"):
        fit_counts(ramsey, fringes, ["guide.field C1.amplitude"])


def test_counts_far_from_the_line_are_asked_for_their_unit(ramsey: rabiline.Experiment, fringes: Counts) -> None:
    places = tuple(place.replace("Hz", "kHz") for place in fringes.places)
    lost = fit_counts(ramsey, replace(fringes, places=places, unit="kHz"), ["guide.field"], intervals=False)
    assert "28664.7 kHz to 29664.7 kHz, and the simulated curve does not: is the unit of the column `C1.frequency` right, or does the fit start too far away?" in str(lost)
    assert "unit" not in str(fit_counts(ramsey, fringes, ["guide.field"], intervals=False))
    chance = replace(fringes, places=places, counts=np.random.default_rng(1).poisson(np.full(fringes.x.size, 900.0)).astype(float))
    assert "unit" not in str(fit_counts(ramsey, chance, ["guide.field"], intervals=False))
    with pytest.raises(NoFit, match="`ana.at` has no effect .*\n  help: at these places `C1.frequency` has none either: is its unit right?"):
        fit_counts(ramsey, replace(fringes, places=places, unit="kHz"), ["ana.at"])


def test_an_error_that_leaves_nothing_of_a_parameter_is_told_in_words(fitted: CountsFit) -> None:
    i = fitted.names.index("guide.field")
    errors, intervals = fitted.errors.copy(), list(fitted.intervals)
    errors[i], intervals[i] = 8.0, (fitted.values[i] - 0.05, fitted.values[i] + 0.05)
    lost = replace(fitted, errors=errors, intervals=tuple(intervals))
    line = next(line for line in str(lost).splitlines() if line.split()[0] == "guide.field")
    assert line.endswith("not determined by these counts") and "not determined" not in str(fitted)
    assert any("guide.field not determined" in axes.get_title() for axes in lost.plot().axes)
    intervals[i] = (fitted.values[i] - 7.0, fitted.values[i] + 9.0)  # a parameter near 0 may have such an error
    assert "not determined" not in str(replace(lost, intervals=tuple(intervals)))


@pytest.mark.parametrize(("text", "name", "value", "limit", "within"), [
    (WIRE, "source.speed.temperature", -5.0, 0.0, None), (RAMSEY, "C1.amplitude+C2.amplitude", -1e-6, 0.0, 1e-6),
    (RAMSEY, "pol.up", 1.05, 1.0, 0.95)], ids=["temperature", "amplitude", "efficiency"])
def test_a_curve_goes_on_straight_beyond_what_a_parameter_may_be(text: str, name: str, value: float, limit: float, within: float | None) -> None:
    places = ("wire.offset.z", ("-1 mm", "1 mm")) if text == WIRE else ("C1.frequency", ("29 kHz", "30 kHz"))
    model = CurveModel(rabiline.load(text), *places, [name])
    beyond = model.limits.beyond(np.array([value]))[0]
    assert beyond == pytest.approx(limit, abs=2e-3 * abs(value - model.start()[0]))
    assert (beyond - value) * (model.start()[0] - beyond) >= 0 and not model.limits.beyond(model.start())
    if within is not None:
        at = {each: model.at([each]) for each in (value, limit, within)}
        np.testing.assert_allclose(at[value].groups, 2 * at[limit].groups - at[within].groups, atol=1e-12)
    assert np.isfinite(model.at([value]).y).all()


@pytest.mark.parametrize(("text", "name", "value", "says"), [
    (RAMSEY, "guide.field", 1e9, "the fit tries 1e+09 T for `guide.field`: neutron would turn by"),
])
def test_a_fit_that_leaves_the_range_of_a_parameter_says_which(text: str, name: str, value: float, says: str) -> None:
    places = ("wire.offset.z", ("-1 mm", "1 mm")) if text == WIRE else ("C1.frequency", ("29 kHz", "30 kHz"))
    with pytest.raises(NoFit) as caught:
        CurveModel(rabiline.load(text), *places, [name]).at([value])
    assert str(caught.value).startswith(says) and str(caught.value).endswith("  help: start farther from there, or hold `" + name.split("+")[0] + "`")


def test_no_help_is_left_empty() -> None:
    wire = rabiline.load(WIRE)
    assert unknown(wire, "source.speed.temperature", "0 K") == ["`temperature` must be greater than zero, but is `0 K`"]
    assert "\n  help: write `0.015`" in unknown(rabiline.load(RAMSEY), "pol.up", 1.5)[0]


def test_the_legend_of_a_fit_is_not_among_its_counts(fitted: CountsFit) -> None:
    figure = fitted.plot()
    above, below = figure.axes
    assert above.get_legend() is None and "counted" in [text.get_text() for text in below.get_legend().get_texts()]
    figure.draw_without_rendering()
    assert below.get_legend().get_window_extent().y1 < below.get_window_extent().y0


def test_the_picture_of_a_fit_has_the_size_and_the_title_that_are_asked_for(fitted: CountsFit, tmp_path: Path) -> None:
    for size in ("86x60", (86, 60)):
        figure = fitted.plot(tmp_path / "fit.pdf", size=size, title="Fringes")
        assert figure.get_size_inches() * 25.4 == pytest.approx([86, 60]) and figure._suptitle.get_text() == "Fringes"
    with pytest.raises(InputError, match="`size`: `86` is no size"):
        fitted.plot(size="86")


def test_a_fit_is_printed_in_a_line(fitted: CountsFit) -> None:
    assert repr(fitted).startswith(f"<fit of {fitted.title}: guide.field = 1.000") and "\n" not in repr(fitted) and len(repr(fitted)) < 200


def test_the_command_fits_a_table_and_draws_it(tmp_path: Path, fringes: Counts) -> None:
    (tmp_path / "ramsey.yaml").write_text(RAMSEY)
    (tmp_path / "counts.csv").write_text("# measured\nC1.frequency [kHz], counts\n" + "".join(
        f"{x / 1000!r}, {n:.0f}\n" for x, n in zip(fringes.x.tolist(), fringes.counts)))
    done = subprocess.run([PROGRAM, "fit", tmp_path / "ramsey.yaml", "--data", tmp_path / "counts.csv", "--free", "guide.field",
                           "--set", "C1.amplitude=113 uT", "--set", "C2.amplitude=113 uT", "-o", tmp_path / "fit.png"],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "guide.field  1.000" in done.stdout and "chi²" in done.stdout
    assert (tmp_path / "fit.png").read_bytes().startswith(b"\x89PNG")
    done = subprocess.run([PROGRAM, "fit", tmp_path / "ramsey.yaml", "--data", tmp_path / "counts.csv", "--free", "guide.field",
                           "--detector", "wall"], capture_output=True, text=True)
    assert done.returncode == 2 and "help: the column `detector` of the table, or --detector, names it" in done.stderr


def test_a_species_of_the_file_can_be_fitted(ramsey: rabiline.Experiment, fringes: Counts) -> None:
    own = rabiline.load(RAMSEY.replace("species: neutron", "species: {name: own, mass: 1.00866491606 u, charge: 0 e, spin: 1/2, gyromagnetic_ratio: -29.1646935 MHz/T}"))
    assert own.value("species.gyromagnetic_ratio") == pytest.approx(-1.83247174e8, rel=1e-6) and own.value("species.mass") == pytest.approx(1.67492750e-27, rel=1e-6)
    at = {"guide.field": "1.0003 mT", "C1.amplitude": "113 uT", "C2.amplitude": "113 uT", "source.speed.mean": "805 m/s"}
    found = fit_counts(own.set(at), fringes, ["species.gyromagnetic_ratio"], intervals=False)
    value, error = found["species.gyromagnetic_ratio"]
    assert abs(value - own.value("species.gyromagnetic_ratio")) < 4 * error < 1e5
    with pytest.raises(TypeError, match="`fit` has no option `particels`; it has detector, "):
        own.fit(fringes, ["guide.field"], particels=5)
    with pytest.raises(NoFit, match="`species.gyromagnetic_ratio` cannot be changed by itself in this file: "):
        fit_counts(ramsey, fringes, ["species.gyromagnetic_ratio"])


@pytest.mark.parametrize(("table", "reason"), [
    ("", "an empty table"), ("C1.frequency [kHz]\n29\n", "no column `counts`"), ("counts\n1\n", "no column of the scanned"),
    ("C1.frequency [kHz],counts\n29,1.5\n29.1,2\n", "line 2: counts must be whole numbers"),
    ("C1.frequency [kHz],counts\n29,1\n29,2\n", "line 3: a point that has been counted before"),
    ("C1.frequency [kHz],counts\n29,0\n30,0\n", "nothing was counted at any point"),
    ("C1.frequency [kHz],counts\n29,1\n29.1\n", "line 3: 1 value in 2 columns"),
    ("C1.frequency [kHz],counts\n29,x\n", "line 2: `x` is no number"),
    ("C1.frequency [kHz],counts\n29,1_000\n", "line 2: `1_000` is no number"),
    ("C1.frequency [kHz],counts\n29,\u0661\u0662\n", "line 2: `\u0661\u0662` is no number"),
    ("frequency [kHz],counts\n29,1\n30,1\n", "column `frequency \\[kHz\\]`: nothing in the file is called `frequency`\n  help: did you mean"),
    ("C1.frequency,counts\n29,1\n30,1\n", "it has no unit\n  help: write `C1.frequency \\[Hz\\]`"),
    ("C1.frequency [khz],counts\n29,1\n30,1\n", "write `kHz`"), ("C1.frequency [kHz];counts\n29;1\n", "a comma stands between columns"),
    ("C1.frequency [kHz],Count\n29,1\n", "no column `counts`, but `Count`"), ("C1.frequency [kHz],counts [1/s]\n29,1\n30,1\n", "`counts` has the unit `1/s`: write what was counted"),
    ("C1.frequency [kHz],counts,seconds [mm]\n29,1,1\n30,1,1\n", "line 1: `seconds` has the unit `mm`: "), ("C1.frequency [kHz],counts\n29,-1\n30,1\n", "line 2: `counts` is -1, which is out of range: counts are what was counted"),
    ("C1.frequency [kHz],C2.phase [deg],guide.field [mT],counts\n1,2,3,4\n", "two parameters are scanned at most")])
def test_a_table_that_cannot_be_used_is_told_with_its_line(ramsey: rabiline.Experiment, tmp_path: Path, table: str,
                                                           reason: str) -> None:
    (tmp_path / "a.csv").write_text(table)
    with pytest.raises(InputError, match=reason):
        ramsey.fit(tmp_path / "a.csv", ["guide.field"])
