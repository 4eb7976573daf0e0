"""Scans that run downwards or in no order are those that run upwards; flat curves of small fractions are seen."""
from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from rabiline import results
from rabiline.agreement import NotComparable, compare
from rabiline.curves import curves, half_maxima
from rabiline.image_plots import off_and_on
from rabiline.pictures import plot_of
from rabiline.report import summary
from rabiline.scan_plots import draw_scan
from synthetic import DORADO, Axis, binomial_errors, dip, frequencies, laws, write_results

UP = frequencies(41).values
ORDERS = {"up": np.arange(41), "down": np.arange(41)[::-1], "mixed": np.random.default_rng(3).permutation(41)}


def scanned(path: Path, order: np.ndarray, seed: int = 1) -> results.Results:
    """A dip, with the covariance of its points, over frequencies in this order."""
    y = np.random.default_rng(1).binomial(10000, 0.9 * dip(UP, steepness=4)) / 10000
    covariance = np.diag(binomial_errors(y, 10000)**2)[np.ix_(order, order)]
    return results.read(write_results(path, [Axis("H0.frequency", UP[order], "Hz")], y[order], law=[DORADO], bins=4, seed=seed,
                                      covariance=covariance[None]))


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, results.Results]:
    folder = tmp_path_factory.mktemp("orders")
    return {name: scanned(folder / f"{name}.h5", order, seed) for seed, (name, order) in enumerate(ORDERS.items())}


@pytest.mark.parametrize("name", ["down", "mixed"])
def test_a_dip_is_measured_whichever_way_the_scan_runs(files: dict[str, results.Results], name: str) -> None:
    (up,), (other,) = (curves(files[one]) for one in ("up", name))
    assert other.x.tolist() == UP.tolist() and other.points.tolist() == np.argsort(ORDERS[name]).tolist()
    assert half_maxima(other) == half_maxima(up)
    text = summary(files[name], ["screen"])
    assert "half maximum" in text and "H0.frequency: 266.6 kHz to 316.6 kHz, 41 points" in text


@pytest.mark.parametrize("name", ["down", "mixed"])
def test_pictures_are_those_of_the_rising_scan(files: dict[str, results.Results], name: str) -> None:
    drawn: list[Figure] = [plot_of(files[one], "scan") for one in ("up", name)]
    one, other = (figure.axes[0].lines[0].get_xydata() for figure in drawn)
    assert one == pytest.approx(other)
    shots = off_and_on(files[name], curves(files[name]))
    assert [shot.heading.split(":")[0] for shot in shots] == ["off resonance", "on resonance"]
    assert shots[0].point == int(np.argsort(ORDERS[name])[0])


def test_results_are_compared_point_by_point_whichever_way_their_scans_run(files: dict[str, results.Results]) -> None:
    for name in ("down", "mixed"):
        assert compare(files["up"], files[name])["screen"].value == 0
    with pytest.raises(NotComparable, match="the points of its scan over H0.frequency are not those of"):
        compare(files["up"], results.read(write_results(files["up"].path.with_name("other.h5"), [frequencies(40)], np.ones(40), law=[DORADO], bins=4)))


def test_a_grid_is_sorted_along_its_curves_only(tmp_path: Path) -> None:
    y = np.concatenate([dip(UP, steepness=4), np.ones(41)])
    file = results.read(write_results(tmp_path / "a.h5", [laws(DORADO, "quantum"), Axis("H0.frequency", UP[::-1], "Hz")], y,
                                      law=[DORADO] * 41 + ["quantum"] * 41, bins=4))
    first, second = curves(file)
    assert first.points.tolist() == list(range(41))[::-1] and (second.y == 1).all() and first.x.tolist() == UP.tolist()


@pytest.mark.parametrize(("fraction", "error", "top"), [(0.0019, 0.001, 0.00435), (0.3, 0.01, 0.465), (0.98, 0.001, 1.05), (0.0, 1e-4, 1.05)])
def test_a_flat_curve_of_small_fractions_is_seen_with_its_errors(tmp_path: Path, fraction: float, error: float, top: float) -> None:
    (curve,) = curves(results.read(write_results(tmp_path / "a.h5", [frequencies(21)], np.full(21, fraction), law=["quantum"], bins=4)))
    axes = draw_scan([replace(curve, errors=np.full(21, error))], [""], "", {}).axes[0]
    assert axes.get_ylim()[1] == pytest.approx(top) and axes.get_ylim()[0] < 0
    assert ("bars: 1 σ" in axes.get_ylabel()) == (error > 0.02 * top)
