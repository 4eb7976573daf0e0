"""Pictures can be read: curves are told apart, labels are those of the file, axes have short numbers, titles are as written."""
from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from matplotlib import pyplot as plt
from rabiline import results, style
from rabiline.__main__ import main
from rabiline.curves import curves
from rabiline.forms import gauss
from rabiline.line_plots import draw_line
from rabiline.lines import fit_line
from rabiline.pictures import plot_of
from rabiline.scan_plots import Measured, Panel, draw_beside, draw_scan
from rabiline.transit_plots import draw_transit
from synthetic import DORADO, Axis, dip, frequencies, laws, write_results

LAWS = ("quantum", "classical", DORADO)


def of_laws(path: Path, *rows: np.ndarray) -> results.Results:
    return results.read(write_results(path, [laws(*LAWS[:len(rows)]), frequencies(rows[0].size)], np.concatenate(rows),
                                      law=np.repeat(LAWS[:len(rows)], rows[0].size).tolist(), bins=4))


def drawn(file: results.Results) -> plt.Figure:
    lines = curves(file)
    return draw_scan(lines, [line.label for line in lines], "a title", {})


def legend(figure: plt.Figure) -> list[str]:
    return [text.get_text() for text in figure.axes[0].get_legend().texts]


def symbols(figure: plt.Figure) -> list[object]:
    return [line for line in figure.axes[0].lines if line.get_marker() in "osD" and line.get_xdata().size > 2 and line.get_linestyle() != "None"]


def test_a_curve_that_is_another_one_says_so(tmp_path: Path) -> None:
    y = dip(frequencies(41).values)
    words = legend(drawn(of_laws(tmp_path / "a.h5", y, y)))
    assert words[1] == "classical\nthe same as quantum" and words[0].startswith("quantum\ncentre")


def test_curves_that_lie_on_each_other_have_their_symbols_in_turns(tmp_path: Path) -> None:
    y = np.full(41, 0.5)
    figure = drawn(of_laws(tmp_path / "a.h5", y, y + 1e-4, y - 1e-4))
    shown = np.array([line.get_markevery() for line in symbols(figure)])
    assert (shown.sum(axis=0) == 1).all() and shown.sum(axis=1).tolist() == [14, 14, 13]
    widths = [line.get_linewidth() for line in symbols(figure)]
    assert widths == sorted(widths, reverse=True) and len(set(widths)) == 3
    assert not any(line.get_linestyle() == "--" for line in figure.axes[0].lines) and widths[0] < 4


def test_where_a_curve_leaves_the_others_all_its_points_are_drawn(tmp_path: Path) -> None:
    y = 1 - 0.8 * (1 - dip(frequencies(101).values))
    figure = drawn(of_laws(tmp_path / "a.h5", np.ones(101), y))
    by_colour = {line.get_color(): line for line in symbols(figure)}
    shown = np.array(by_colour[style.LAWS["classical"][0]].get_markevery())
    assert shown[y < 0.95].all() and not shown[y == 1].all()


def test_few_points_that_lie_on_each_other_are_all_to_be_seen(tmp_path: Path) -> None:
    figure = drawn(of_laws(tmp_path / "a.h5", np.full(5, 0.5), np.full(5, 0.5)))
    wide, narrow = (line.get_markersize() for line in symbols(figure))
    assert wide > narrow + 1


def test_detectors_have_their_labels_in_pictures(tmp_path: Path) -> None:
    path = write_results(tmp_path / "a.h5", [frequencies(11)], np.stack([np.full(11, 0.6), np.full(11, 0.3)]), law=["quantum"], detectors=("up", "down"), bins=4)
    with h5py.File(path, "a") as file:
        title = file["entry/title"].asstr()[()]
        del file["entry/up/title"]
        file["entry/up/title"] = f"{title}: He-3 tube, left"
    file = results.read(path)
    assert legend(plot_of(file, "scan")) == ["He-3 tube, left: quantum", "down: quantum"]
    assert "He-3 tube, left" in plot_of(file, "image", {"detector": "up", "points": "0"})._suptitle.get_text().replace("\n", " ")
    assert plot_of(file, "scan", {"detector": "up"})._suptitle.get_text().endswith(": He-3 tube, left")


def test_detectors_with_one_label_keep_their_names(tmp_path: Path) -> None:
    path = write_results(tmp_path / "a.h5", [frequencies(11)], np.stack([np.full(11, 0.6), np.full(11, 0.3)]), law=["quantum"], detectors=("up", "down"), bins=4)
    with h5py.File(path, "a") as file:
        for name in ("up", "down"):
            del file[f"entry/{name}/title"]
            file[f"entry/{name}/title"] = "tube"
    assert legend(plot_of(results.read(path), "scan")) == ["up: quantum", "down: quantum"]


def test_numbers_of_a_line_cover_nothing_that_is_drawn(tmp_path: Path) -> None:
    (curve,) = curves(results.read(write_results(tmp_path / "a.h5", [frequencies(41)], dip(frequencies(41).values), law=["quantum"], bins=4)))

    def beside(measured: Measured | None) -> list[str]:
        figure = draw_scan([curve], ["quantum"], "", {}, measured)
        written = [text.get_text() for text in figure.axes[0].texts if "centre" in text.get_text()]
        assert bool(written) != ("centre" in legend(figure)[0])
        return [text.get_horizontalalignment() for text in figure.axes[0].texts if "centre" in text.get_text()]

    half, middle = (curve.y.min() + curve.y.max()) / 2, curve.x.mean()

    def counted(x: np.ndarray) -> Measured:
        return Measured(x, np.full(x.size, half), np.full(x.size, 0.01), "counted")

    assert beside(None) == ["left"]  # on the right
    assert beside(counted(curve.x[curve.x > middle])) == ["right"]
    assert beside(counted(curve.x)) == []


def test_many_counts_per_second_have_a_power_of_ten(tmp_path: Path) -> None:
    (curve,) = curves(results.read(write_results(tmp_path / "a.h5", [frequencies(41)], dip(frequencies(41).values), law=["quantum"], bins=4)))
    figure = draw_scan([replace(curve, rate=(9e8, 0.0))], [""], "a title", {})
    figure.draw_without_rendering()
    (other,) = figure.axes[0].child_axes
    assert other.get_ylabel() == "counts per second (10⁸)" and other.get_ylim()[1] == pytest.approx(9 * figure.axes[0].get_ylim()[1])


def test_no_curve_leaves_half_of_its_picture_empty(tmp_path: Path) -> None:
    axis = frequencies(41)
    y = 1 - 0.25 * (1 - dip(axis.values))
    low, high = drawn(results.read(write_results(tmp_path / "a.h5", [axis], y, law=["quantum"], bins=4))).axes[0].get_ylim()
    assert low > 0.7 and high < 1.05


def test_the_colours_of_a_map_begin_at_nothing(tmp_path: Path) -> None:
    axis, sizes = frequencies(21), Axis("H0.amplitude", np.linspace(1e-7, 9e-7, 9), "T")
    y = np.tile(0.1 + 0.9 * dip(axis.values), 9)
    panel, bar = plot_of(results.read(write_results(tmp_path / "a.h5", [sizes, axis], y, law=["quantum"], bins=4)), "scan").axes
    assert panel.collections[0].get_clim()[0] == 0 and bar.get_ylim()[0] == 0


def test_a_map_over_a_falling_axis_is_that_of_a_rising_one(tmp_path: Path) -> None:
    axis, sizes = frequencies(21), np.array([1.0, 2.0, 3.0, 5.0, 4.0, 6.0, 7.0, 9.0, 8.0]) * 1e-7
    y = np.stack([dip(axis.values, 291e3 + 1e9 * size) for size in sizes])
    meshes = []
    for order in (np.arange(9), np.argsort(-sizes)):
        file = results.read(write_results(tmp_path / "a.h5", [Axis("H0.amplitude", sizes[order], "T"), axis], y[order].ravel(), law=["quantum"], bins=4))
        meshes.append(plot_of(file, "scan").axes[0].collections[0])
    np.testing.assert_allclose(meshes[0].get_array().reshape(9, 21), y[np.argsort(sizes)])
    np.testing.assert_allclose(meshes[0].get_array(), meshes[1].get_array())
    np.testing.assert_allclose(meshes[0].get_coordinates(), meshes[1].get_coordinates())


@pytest.mark.parametrize("low, shown", [(1e-4, ["0.0001", "0.001", "0.01", "0.1", "1"]), (1e-7, ["10⁻⁷", "10⁻⁵", "10⁻³", "10⁻¹"])])
def test_a_logarithmic_axis_has_plain_numbers_if_they_are_short(low: float, shown: list[str]) -> None:
    figure, axes = plt.subplots()
    style.logarithmic(axes.xaxis)
    axes.plot([low, 1.0], [0, 1])
    figure.draw_without_rendering()
    assert set(shown) <= {text.get_text() for text in axes.get_xticklabels()}
    plt.close(figure)


def test_options_in_a_caption_keep_their_hyphens() -> None:
    x = np.linspace(-5.0, 5.0, 41)
    y = 0.5 * gauss(x, 2.0)
    figure = draw_line(x, y, np.full(41, 1e-3), fit_line(x, y, np.diag(np.full(41, 1e-6)), "gauss"), "a", "Hz", "a title", ["see --form sinc2", "centre     -2.5 Hz"], "counts")
    assert figure.axes[0].get_title() == "see --form sinc2,   centre −2.5 Hz"
    plt.close(figure)


def test_dollars_are_no_formulas_anywhere(tmp_path: Path) -> None:
    file = results.read(write_results(tmp_path / "a.h5", [frequencies(11)], dip(frequencies(11).values), law=["quantum"], bins=4))
    for figure in (plot_of(file, "image", {"title": "from $5 to $6_{a"}), plot_of(file, "scan", {"mark": ["$5 or $6_{=291 kHz"]}),
                   draw_beside([Panel("$5 or $6_{", curves(file), ["quantum"])], "", {})):
        figure.draw_without_rendering()
        plt.close(figure)


def test_letters_that_are_missing_are_told_once(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    name = str(write_results(tmp_path / "a.h5", [frequencies(11)], dip(frequencies(11).values), law=["quantum"], bins=4))
    assert main(["plot-scan", name, "-o", str(tmp_path / "a.png"), "--title", "束 of neutrons"]) == 0
    assert capsys.readouterr().err == f"rabiline: warning: {tmp_path / 'a.png'}: the letters of pictures lack 束, of which boxes are left\n"


@pytest.mark.parametrize("kind", ["scan", "image", "levels", "profiles"])
def test_a_title_without_end_is_cut(tmp_path: Path, kind: str) -> None:
    file = results.read(write_results(tmp_path / "a.h5", [frequencies(5)], dip(frequencies(5).values), law=["quantum"], bins=4))
    figure = plot_of(file, kind, {"title": 600 * "word "})
    style.save(figure, tmp_path / "a.png")
    assert figure._suptitle.get_text().endswith("…") and len(figure._suptitle.get_text()) <= style.LONGEST


def test_two_results_are_compared_in_a_picture_too(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    axis = frequencies(41)
    names = [str(write_results(tmp_path / f"{name}.h5", [axis], dip(axis.values), law=["quantum"], seed=seed, bins=4)) for name, seed in (("a", 1), ("b", 2))]
    assert main(["compare-scans", *names, "-o", str(tmp_path / "ab.png")]) == 0
    assert "screen: chi² 0.0" in capsys.readouterr().out and (tmp_path / "ab.png").stat().st_size > 5000


@pytest.mark.parametrize("cells, noted", [(4, True), (100, False)])
def test_few_cells_of_flight_times_are_told_to_be_no_finer(cells: int, noted: bool) -> None:
    edges = np.linspace(1e-3, 2e-3, cells + 1)
    caught = np.ones((2, cells))
    figure = draw_transit(results.Transit("a title", ("+1/2 to +1/2", "+1/2 to -1/2"), edges, caught, np.sqrt(caught), 1.0), 1000.0, "a title")
    assert figure.axes[0].get_title().startswith("4 cells: for the scan that is fine enough") == noted
    steps = figure.axes[0].patches[0].get_data().edges
    assert steps.size == cells + 1 or not noted
    plt.close(figure)
