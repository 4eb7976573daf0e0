"""What is told of a curve: stretch by stretch, of fringes, and of what may be side lobes."""
from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from rabiline import results
from rabiline.__main__ import main
from rabiline.curves import Curve, curves, half_maxima
from rabiline.fit import bell
from rabiline.forms import rabi, ramsey
from rabiline.pictures import plot_of
from rabiline.reading import LOBES, comb_of, reading_of, readings_of
from rabiline.report import summary, summary_numbers
from synthetic import Axis, write_results

EVERYWHERE = 1e-8  # variance of a point


def of(tmp_path: Path, x: np.ndarray, y: np.ndarray, parameter: str = "H0.frequency", units: str = "Hz") -> results.Results:
    covariance = EVERYWHERE * (np.eye(x.size) + 0.5)
    return results.read(write_results(tmp_path / "a.h5", [Axis(parameter, x, units)], y, law=["quantum"], covariance=covariance, bins=4))


def only(file: results.Results) -> Curve:
    (curve,) = curves(file)
    return curve


@pytest.mark.parametrize("reach", [180.0, 220.0, 260.0, 300.0, 700.0, 1000.0, 1500.0])
def test_the_width_of_a_fringe_does_not_hang_on_where_the_scan_ends(tmp_path: Path, reach: float) -> None:
    """Half way between the fringe and the minima beside it, whatever the baseline at the ends of the scan is."""
    x = np.linspace(-reach, reach, 301)
    y = 0.02 + 0.1 * ramsey(x, 6.0e3, 40e-6, 4e-3, 0.25)
    told = reading_of(only(of(tmp_path, x, y)))
    assert told.is_fringe and told.resonances[0].width.value == pytest.approx(114, abs=1)


def test_a_picture_and_a_summary_tell_one_width_of_fringes(tmp_path: Path) -> None:
    x = np.linspace(-1000, 1000, 301)
    file = of(tmp_path, x, 0.02 + 0.1 * ramsey(x, 6.0e3, 40e-6, 4e-3, 0.25))
    (legend,) = (text.get_text() for text in plot_of(file, "scan").axes[0].get_legend().texts)
    assert "FWHM 113.9 ± 3.2 Hz" in legend and "FWHM 113.9 ± 3.2 Hz" in summary(file, file.scan.detectors)
    assert "central fringe, half way to the extremes beside it" in legend


def test_fringes_over_the_whole_scan_are_counted_and_not_called_nothing(tmp_path: Path) -> None:
    x = np.linspace(-1000, 1000, 201)
    file = of(tmp_path, x, 0.5 + 0.4 * np.cos(2 * np.pi * x / 400 + 1))
    told = summary(file, file.scan.detectors)
    assert "fringes       5 maxima, 400 Hz apart: `fit-line --form ramsey` fits them" in told and "no resonance" not in told
    (line,) = summary_numbers(file, file.scan.detectors)["lines"]
    assert line["found"] == [] and line["fringes"] == {"maxima": 5, "distance": pytest.approx(400)}


def test_what_is_no_comb_has_no_fringes(tmp_path: Path) -> None:
    x = np.linspace(-1000, 1000, 201)
    noise = np.random.default_rng(4).normal(0, 1e-4, x.size)
    for number, y in enumerate((0.5 + noise, 0.5 + 1e-3 * x / 1000 + noise, 0.5 - 0.4 * np.exp(-(x / 100)**2) - 0.4 * np.exp(-((x - 300) / 50)**2))):
        folder = tmp_path / str(number)
        folder.mkdir()
        assert comb_of(only(of(folder, x, y))) is None


def test_stretches_of_a_scan_are_read_one_by_one_in_words_and_in_pictures(tmp_path: Path) -> None:
    """Three sweeps in one: the whole has no baseline, each of its stretches has."""
    x = np.concatenate([np.linspace(centre - 3e-3, centre + 3e-3, 41) for centre in (0.09, 0.21, 0.56)])
    y = 1 - sum(bell(x, depth, centre, 1.5e-3, 2) for depth, centre in ((0.15, 0.09), (0.25, 0.21), (0.2, 0.56)))
    file = of(tmp_path, x, y, "C.field", "T")
    told = summary(file, file.scan.detectors)
    centres = [reading.resonances[0].centre.value for _, reading in readings_of(only(file))]
    np.testing.assert_allclose(centres, [0.09, 0.21, 0.56], atol=1e-5)
    assert "no resonance" not in told and told.count("half maximum  dip at ") == 3 and "207 mT to 213 mT, 41 points" in told
    panels = [axes.get_title().split("\n")[0] for axes in plot_of(file, "scan").axes]
    assert all(f"dip at {title.removeprefix('centre ')}" in told for title in panels)
    (line,) = summary_numbers(file, file.scan.detectors)["lines"]
    assert [one["centre"]["value"] for one in line["found"]] == centres
    json.dumps(line)


def test_images_of_a_scan_with_gaps_are_those_of_its_deepest_line(tmp_path: Path) -> None:
    x = np.concatenate([np.linspace(centre - 3e-3, centre + 3e-3, 41) for centre in (0.09, 0.21, 0.56)])
    y = 1 - sum(bell(x, depth, centre, 1.5e-3, 2) for depth, centre in ((0.15, 0.09), (0.25, 0.21), (0.2, 0.56)))
    headings = " ".join(axes.get_title(loc="left") for axes in plot_of(of(tmp_path, x, y, "C.field", "T"), "image").axes)
    assert "C.field = 207 mT" in headings and "C.field = 210 mT" in headings


def test_side_lobes_of_a_strong_field_are_told_to_be_possible_ones(tmp_path: Path) -> None:
    x = np.linspace(-20e3, 20e3, 201)
    strong = reading_of(only(of(tmp_path, x, rabi(x, 3750, 0.2e-3))))  # a tip of 1.5 pi
    assert len(strong.resonances) == 3 and strong.may_be_lobes and strong.how.endswith(LOBES)
    usual = reading_of(only(of(tmp_path, x, rabi(x, 2500, 0.2e-3))))
    assert not usual.may_be_lobes


def test_a_profile_over_places_is_no_rabi_line(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    z = np.linspace(-2, 2, 41)
    (tmp_path / "a.csv").write_text("wire.offset.z [mm],counts\n" + "".join(f"{at},{n:.0f}\n" for at, n in zip(z, 20 + 900 * np.exp(-((z - 0.3) / 0.5)**2))))
    assert main(["fit-line", str(tmp_path / "a.csv")]) == 0
    said = capsys.readouterr().out
    assert said.startswith("form       gauss\ncentre     0.300") and "gauss is the form by default: --form has lorentz, sinc2 too" in said


def test_lines_of_one_height_are_no_lobes(tmp_path: Path) -> None:
    x = np.linspace(-20e3, 20e3, 201)
    y = sum(bell(x, 0.2, centre, 2e3, 2) for centre in (-8e3, 0.0, 8e3))
    told = reading_of(only(of(tmp_path, x, y)))
    assert len(told.resonances) == 3 and not told.may_be_lobes


def test_degrees_of_freedom_are_explained_where_points_share_particles(tmp_path: Path) -> None:
    x = np.linspace(-20e3, 20e3, 201)
    file = of(tmp_path, x, 0.5 * rabi(x, 2500, 0.2e-3))
    told = summary(file, file.scan.detectors)
    assert "    not flat      chi²" in told and " and not 200: the points share their particles" in told
    assert len(half_maxima(only(file))) == 1
