"""What stands in the pictures of scans and levels, and with them in a summary."""
from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from matplotlib.figure import Figure
from rabiline import results, style
from rabiline.__main__ import main
from rabiline.counts import read_counts
from rabiline.curves import curves, half_maxima
from rabiline.errors import InputError
from rabiline.fit import fit
from rabiline.level_plots import draw_levels
from rabiline.forms import rabi
from rabiline.line_plots import draw_line
from rabiline.lines import fit_line
from rabiline.pictures import plot_of
from rabiline.profile_plots import draw_profiles, profile_of
from rabiline.scan_plots import Panel, about_errors, draw_beside, draw_scan
from synthetic import DORADO, Axis, dip, frequencies, laws, write_results


def drawn(path: Path) -> Figure:
    file = results.read(path)
    lines = curves(file)
    return draw_scan(lines, [line.label for line in lines], "a title", {})


def legend(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.axes[-1].get_legend().texts]


def written(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.axes[0].texts if text.get_text()]


def test_one_dip_has_its_numbers_beside_it(tmp_path: Path) -> None:
    axis = frequencies()
    figure = drawn(write_results(tmp_path / "a.h5", [axis], dip(axis.values), law=[DORADO], bins=4))
    (numbers,) = written(figure)
    assert numbers.startswith("centre 291.6") and "\nFWHM 7." in numbers and numbers.endswith("\nfitted")
    assert legend(figure) == ["dorado (hypothesis), torque, κ = 1"]


@pytest.mark.parametrize("particles", [10_000, 1_000_000])
def test_numbers_of_a_fit_that_chi_squared_rejects_are_not_drawn(tmp_path: Path, particles: int) -> None:
    """Rabi's line has side lobes, which a bell has not: its width is that of the curve."""
    axis = frequencies(201)
    y = 1 - rabi(axis.values - 291.6e3, 2.5e3, 0.2e-3)
    path = write_results(tmp_path / "a.h5", [axis], y, law=["quantum"], particles=particles, bins=4)
    (curve,) = curves(results.read(path))
    fitted = fit(curve)
    assert fitted.chi_squared.p < 1e-6
    (numbers,) = written(drawn(path))
    assert numbers.endswith("\nread off at half maximum")
    (seen,) = half_maxima(curve)
    width = float(numbers.split("FWHM ")[1].split()[0])
    assert width == pytest.approx(seen.width.value / 1e3, rel=1e-3) and width != pytest.approx(fitted.resonances[0].width.value / 1e3, rel=3e-3)


def test_the_summary_has_no_numbers_of_a_fit_that_chi_squared_rejects(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    axis = frequencies(201)
    name = str(write_results(tmp_path / "a.h5", [axis], 1 - rabi(axis.values - 291.6e3, 2.5e3, 0.2e-3), law=["quantum"], bins=4))
    assert main(["summary", name]) == 0
    text = capsys.readouterr().out
    assert "half maximum  dip at 291.6" in text and "no fit        no line shape describes this: chi²" in text and "p < 1e-6\n" in text
    assert "fit           dip" not in text
    assert main(["summary", "--json", name]) == 0
    (line,) = json.loads(capsys.readouterr().out)["lines"]
    assert line["how"] == "read off at half maximum" and line["found"][0]["kind"] == "dip"


def test_side_lobes_alone_have_no_numbers(tmp_path: Path) -> None:
    axis = Axis("H0.frequency", np.linspace(296.8e3, 330e3, 301), "Hz")
    figure = drawn(write_results(tmp_path / "a.h5", [axis], 1 - rabi(axis.values - 291.6e3, 2.5e3, 0.2e-3), law=["quantum"], particles=1_000_000, bins=4))
    assert written(figure) == [] and legend(figure) == ["quantum"]


def test_two_dips_have_both_their_numbers_in_the_legend(tmp_path: Path) -> None:
    axis = Axis("H0.frequency", np.linspace(285e3, 355e3, 141), "Hz")
    both = (dip(axis.values) + dip(axis.values, 350e3)) / 2
    figure = drawn(write_results(tmp_path / "a.h5", [axis], both, law=[DORADO], bins=4))
    assert written(figure) == []
    (words,) = legend(figure)
    _, first, second, how = words.splitlines()
    assert first.startswith("centre 291.") and second.startswith("centre 350.") and how == "fitted"


def test_a_grid_of_three_axes_has_a_map_for_each_value_of_the_third(tmp_path: Path) -> None:
    axis, amplitudes = frequencies(21), Axis("H0.amplitude", np.linspace(1e-7, 9e-7, 9), "T")
    shifted = np.stack([dip(axis.values, 285e3 + 1e3 * i) for i in range(9)])
    for order in ((0, 1), (1, 0)):  # of the law and the amplitude
        axes = [[laws("quantum", DORADO), amplitudes][i] for i in order]
        y = np.stack([np.ones_like(shifted), shifted]).transpose(*order, 2)
        named = np.moveaxis(np.full((2, 9, 21), [[["quantum"]], [[DORADO]]]), (0, 1), order)
        file = results.read(write_results(tmp_path / "a.h5", [*axes, axis], y.ravel(), law=named.ravel().tolist(), bins=4))
        first, second, _ = plot_of(file, "scan").axes
        assert [one.get_title().replace("\n", " ") for one in (first, second)] == ["quantum", "dorado (hypothesis), torque, κ = 1"]
        np.testing.assert_allclose(second.collections[0].get_array().reshape(9, 21), shifted)
        assert np.ptp(first.collections[0].get_array()) == 0


def test_maps_over_three_numbers_are_named_by_the_one_with_the_fewest_values(tmp_path: Path) -> None:
    axis, sizes = frequencies(21), (Axis("B.field", np.array([9e-3, 10e-3]), "T"), Axis("H0.amplitude", np.linspace(1e-7, 9e-7, 9), "T"))
    for order in ((0, 1), (1, 0)):
        axes = [sizes[i] for i in order]
        file = results.read(write_results(tmp_path / "a.h5", [*axes, axis], np.tile(dip(axis.values), 18), law=["quantum"], bins=4))
        *panels, _ = plot_of(file, "scan").axes
        assert [one.get_title().replace("\n", " ") for one in panels] == ["quantum, B.field = 9 mT", "quantum, B.field = 10 mT"]


@pytest.mark.parametrize("points", [5, 6, 7, 8])
def test_a_short_scan_of_two_lines_is_drawn_without_their_fit(tmp_path: Path, points: int) -> None:
    y = np.ones(points)
    y[[1, points - 2]] = 0.2
    file = results.read(write_results(tmp_path / "a.h5", [frequencies(points)], y, law=["quantum"], bins=4))
    plot_of(file, "scan")


def test_a_title_is_written_as_it_stands(tmp_path: Path) -> None:
    file = results.read(write_results(tmp_path / "a.h5", [frequencies(11)], dip(frequencies(11).values), law=["quantum"], bins=4))
    figure = plot_of(file, "scan", {"title": "from $5 to $6_{a"})
    figure.draw_without_rendering()
    assert figure._suptitle.get_text() == "from $5 to $6_{a"


@pytest.mark.parametrize("kind", ["scan", "image", "profiles"])
def test_an_empty_title_is_none(tmp_path: Path, kind: str) -> None:
    file = results.read(write_results(tmp_path / "a.h5", [frequencies(5)], dip(frequencies(5).values), law=["quantum"], bins=4))
    figure = plot_of(file, kind, {"title": ""})
    assert figure._suptitle is None or not figure._suptitle.get_text()


def test_where_nothing_is_detected_a_scan_says_so(tmp_path: Path) -> None:
    file = results.read(write_results(tmp_path / "a.h5", [frequencies(5)], np.zeros(5), law=["quantum"], bins=4))
    assert plot_of(file, "scan").axes[0].get_ylabel().endswith("(nothing detected)")


def test_profiles_that_coincide_are_all_to_be_seen(tmp_path: Path) -> None:
    file = results.read(write_results(tmp_path / "a.h5", [laws("quantum", DORADO)], np.ones(2), law=["quantum", DORADO], bins=4))
    figure = draw_profiles([profile_of(file, "screen", i, "x", name) for i, name in enumerate(("quantum", "dorado"))], "x", "a title")
    wide, narrow = (patch.get_linewidth() for patch in figure.axes[0].patches)
    assert wide > narrow + 1


def test_the_legend_keeps_the_order_of_the_laws_where_the_drawing_does_not(tmp_path: Path) -> None:
    axis = frequencies(41)
    y = np.concatenate([dip(axis.values), np.ones(41), dip(axis.values, 280e3)])
    names = [DORADO, "classical", "quantum"]
    path = write_results(tmp_path / "a.h5", [laws(*names), axis], y, law=np.repeat(names, 41).tolist(), bins=4)
    assert [words.splitlines()[0] for words in legend(drawn(path))] == ["dorado (hypothesis), torque, κ = 1",
                                                                        "classical", "quantum"]


def test_bars_are_told_of_where_they_stand_out_of_their_symbols(tmp_path: Path) -> None:
    axis = frequencies(2)
    (curve,) = curves(results.read(write_results(tmp_path / "a.h5", [axis], np.ones(2), law=["quantum"], bins=4)))

    def told(*errors: float) -> str:
        return about_errors([replace(curve, errors=np.array(errors))], (0.0, 1.0))

    assert told(0.001, 0.001) == "errors smaller than symbols" == told(0.01, 0.011)
    assert told(0.05, 0.05) == "bars: 1 σ" == told(0.05, 0.001)


def test_files_side_by_side_share_their_limits_and_have_a_legend_each(tmp_path: Path) -> None:
    axis = frequencies(41)
    flat = results.read(write_results(tmp_path / "a.h5", [axis], np.ones(41), law=["quantum"] * 41, bins=4))
    dark = results.read(write_results(tmp_path / "b.h5", [axis], dip(axis.values), law=[DORADO] * 41, bins=4))
    figure = draw_beside([Panel(file.title, curves(file), [line.label for line in curves(file)])
                          for file in (flat, dark)], "", {"here": 291.6e3})
    left, right = figure.axes
    assert left.get_ylim() == right.get_ylim() and left.get_ylim()[0] < 0 < 1 < left.get_ylim()[1]
    assert [text.get_text() for text in left.get_legend().texts] == ["quantum"]
    (words,) = (text.get_text() for text in right.get_legend().texts)
    assert "dorado" in words and "centre 291." in words


@pytest.fixture
def aimed_and_not(tmp_path: Path) -> list[str]:
    """Names of a result of an aimed source and one of another."""
    axis = frequencies(41)
    paths = [write_results(tmp_path / f"{name}.h5", [axis], dip(axis.values), law=[DORADO], bins=4) for name in ("aimed", "other")]
    with h5py.File(paths[0], "a") as file:
        file["entry/aimed_fraction"] = np.full(41, 0.01)
    return list(map(str, paths))


@pytest.mark.parametrize(("verb", "instead"), [("plot-scan", "draw them with --beside"), ("plot-profiles --points 0", "draw each by itself")])
def test_fractions_of_all_and_of_what_is_aimed_are_not_drawn_over_one_axis(aimed_and_not: list[str], capsys: pytest.CaptureFixture, verb: str,
                                                                           instead: str) -> None:
    assert main([*verb.split()[:1], *aimed_and_not, *verb.split()[1:], "-o", "never.png"]) == 2
    assert capsys.readouterr().err == (f"rabiline: {aimed_and_not[1]}: has fractions of what leaves the source, {aimed_and_not[0]} of what is "
                                       f"aimed at the target: {instead}\n")


def test_each_panel_beside_others_has_its_own_measure(aimed_and_not: list[str], tmp_path: Path) -> None:
    panels = [Panel(path, curves(results.read(Path(path))), [""]) for path in aimed_and_not]
    measures = [axes.get_ylabel().split("\n")[0] for axes in draw_beside(panels, "", {}).axes]
    assert measures == ["detected / aimed at the target", "detected / emitted"]
    assert main(["plot-scan", "--beside", *aimed_and_not, "--dpi", "60", "-o", str(tmp_path / "a.png")]) == 0


def test_levels_are_drawn_where_something_was_detected_with_their_errors(tmp_path: Path) -> None:
    axis = frequencies(41)
    path = write_results(tmp_path / "a.h5", [axis], dip(axis.values), law=[DORADO], bins=4)
    up = np.linspace(0, 1, 41)
    fractions = np.column_stack([up, 1 - up])
    fractions[15:20] = np.nan
    with h5py.File(path, "a") as file:
        file["entry/screen_levels/levels"][...] = fractions
        file["entry/screen_levels/levels_errors"][...] = 0.01
    file = results.read(path)
    figure = draw_levels(curves(file), file.detectors["screen"], "a title", {})
    (axes,) = figure.axes
    assert legend(figure) == ["m = +1/2", "m = −1/2"] and figure._suptitle.get_text() == "a title"
    assert axes.get_title(loc="left") == "dorado (hypothesis), torque, κ = 1"
    for level, bars in enumerate(axes.containers):
        points, _, (stems,) = bars.lines
        known = np.isfinite(fractions[:, level])
        np.testing.assert_allclose(points.get_ydata(), fractions[known, level])
        np.testing.assert_allclose([np.ptp(stem[:, 1]) for stem in stems.get_segments()], 0.02)


def test_a_law_has_only_its_own_levels(tmp_path: Path) -> None:
    axis = frequencies(11)
    path = write_results(tmp_path / "a.h5", [laws("quantum", DORADO), axis], np.ones(22),
                         law=["quantum"] * 11 + [DORADO] * 11, bins=4)
    with h5py.File(path, "a") as file:
        group = file["entry/screen_levels"]
        for name in ("levels", "levels_errors", "level_index", "level_index_labels"):
            del group[name]
        values = np.full((2, 11, 4), 0.5)
        values[0, :, 2:] = values[1, :, :2] = np.nan
        group["levels"] = group["levels_errors"] = values
        group["level_index"] = np.arange(4.0)
        group["level_index_labels"] = np.array(["m = +1/2", "m = -1/2", "(1 + S_z)/2", "(1 - S_z)/2"], dtype="S")
    file = results.read(path)
    quantum, dorado = draw_levels(curves(file), file.detectors["screen"], "a title", {}).axes
    assert quantum.get_legend_handles_labels()[1] == ["m = +1/2", "m = −1/2"]
    assert dorado.get_legend_handles_labels()[1] == ["(1 + $S_z$)/2", "(1 − $S_z$)/2"]


def test_levels_of_a_large_grid_are_maps_over_both_axes(tmp_path: Path) -> None:
    axis, across = frequencies(11), Axis("H0.amplitude", np.linspace(1e-7, 9e-7, 9), "T")
    path = write_results(tmp_path / "a.h5", [across, axis], np.ones(99), law=["quantum"] * 99, bins=4)
    shares = np.linspace(0, 1, 99).reshape(9, 11)
    with h5py.File(path, "a") as file:
        file["entry/screen_levels/levels"][...] = np.stack([shares, 1 - shares], axis=-1)
    up, down, bar = plot_of(results.read(path), "levels").axes
    assert [axes.get_title() for axes in (up, down)] == ["m = +1/2, quantum", "m = −1/2, quantum"] and bar.get_ylabel() == "fraction of what screen detected"
    np.testing.assert_allclose(np.ravel(up.collections[0].get_array()), np.ravel(shares))
    np.testing.assert_allclose(np.ravel(down.collections[0].get_array()), np.ravel(1 - shares))
    (only, _) = plot_of(results.read(path), "levels", {"levels": "m=-1/2"}).axes
    np.testing.assert_allclose(np.ravel(only.collections[0].get_array()), np.ravel(1 - shares))


def test_sixteen_levels_differ_in_colour_symbol_or_line_and_m_has_one_colour(tmp_path: Path) -> None:
    axis, levels = frequencies(11), [(F, m) for F in (4, 3) for m in range(F, -F - 1, -1)]
    path = write_results(tmp_path / "a.h5", [axis], np.ones(11), law=["quantum"] * 11, bins=4)
    with h5py.File(path, "a") as file:
        group = file["entry/screen_levels"]
        for name in ("levels", "levels_errors", "level_index", "level_index_labels"):
            del group[name]
        group["levels"] = group["levels_errors"] = np.full((11, 16), 1 / 16)
        group["level_index"] = np.arange(16.0)
        group["level_index_labels"] = np.array([f"F={F} m={m:+d}" if m else f"F={F} m=0" for F, m in levels], dtype="S")
    file = results.read(path)
    panels = draw_levels(curves(file), file.detectors["screen"], "a title", {}).axes
    looks = [[(line.get_color(), line.get_marker(), line.get_linestyle(), line.get_markerfacecolor()) for line in axes.get_legend().get_lines()]
             for axes in panels]
    assert [len(set(of_panel)) for of_panel in looks] == [9, 7]
    assert looks[0][1:-1] == looks[1]


def test_ranges_are_those_of_the_image_and_not_of_its_counts(tmp_path: Path) -> None:
    axis = frequencies(11)
    file = results.read(write_results(tmp_path / "a.h5", [axis], np.ones(11), law=["quantum"] * 11, bins=4))
    usual = plot_of(file, "image", {"points": "0"}).axes
    image, above, beside = plot_of(file, "image", {"points": "0", "x_range": (-1, 0.5), "y_range": (-0.5, 1)}).axes[:3]
    assert image.get_xlim() == above.get_xlim() == (-1, 0.5) and image.get_ylim() == beside.get_ylim() == (-0.5, 1)
    assert above.get_ylim() == usual[1].get_ylim() and beside.get_xlim() == usual[2].get_xlim()


def test_a_size_without_room_for_curves_is_refused(tmp_path: Path) -> None:
    axis = frequencies(11)
    file = results.read(write_results(tmp_path / "a.h5", [axis], np.ones(11), law=["quantum"] * 11, bins=4))
    with pytest.raises(InputError, match="--size: 38x33 leaves no room for curves"):
        style.save(plot_of(file, "scan", {"size": (38, 33), "title": 8 * "ten words that take up the room "}), tmp_path / "a.png")
    assert not (tmp_path / "a.png").exists()


def test_names_of_marks_that_are_near_stand_in_rows(tmp_path: Path) -> None:
    axis = frequencies()
    lines = curves(results.read(write_results(tmp_path / "a.h5", [axis], dip(axis.values), law=[DORADO], bins=4)))
    marks = {"Larmor": 291.6e3, "Bloch-Siegert": 291.7e3, "far": float(axis.values[0])}
    figure = draw_scan(lines, ["a"], "a title", marks)
    figure.draw_without_rendering()
    names = {text.get_text(): text for text in figure.axes[0].texts if text.get_text() in marks}
    assert len(names) == 3
    boxes = [text.get_window_extent() for text in names.values()]
    assert not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])
    assert names["far"].xyann == names["Larmor"].xyann


def test_counts_at_places_in_equal_ratios_are_drawn_on_a_logarithmic_axis_with_their_form(tmp_path: Path) -> None:
    table = tmp_path / "counts.csv"
    x = np.geomspace(1, 1000, 25)
    table.write_text("C.amplitude [uT],counts\n" + "\n".join(f"{at:.10g},{1000 + round(4000 / (1 + (at - 30)**2 / 100))}" for at in x))
    counts = read_counts(table)
    fitted = fit_line(1e-6 * counts.x, counts.counts, np.sqrt(counts.counts), "lorentz", unit="T")
    axes = draw_line(1e-6 * counts.x, counts.counts, np.sqrt(counts.counts), fitted, counts.parameter, "T", "", [], "counts").axes[0]
    assert axes.get_xscale() == "log" and axes.get_xlabel() == "C.amplitude (mT)"
    fine = axes.lines[-1].get_xdata()
    assert np.count_nonzero(fine < 0.03) > 300


def test_a_line_over_equal_ratios_has_the_middle_between_its_edges_in_the_unit_that_was_written(tmp_path: Path) -> None:
    """The top lies elsewhere: no centre is claimed."""
    axis = Axis("six.pole_field", np.geomspace(0.01, 2.0, 24), "T")
    y = 0.1 + 0.1 * np.exp(-np.log(axis.values / 0.17)**2)
    (curve,) = curves(results.read(write_results(tmp_path / "a.h5", [axis], y, law=["quantum"], particles=10**6, bins=4)))
    curve = replace(curve, axis=replace(curve.axis, written=("T", 1.0)))
    (words,) = written(draw_scan([curve], [""], "a title", {}))
    assert words.startswith("middle between the edges 0.2") and " T\nFWHM 0.3" in words and " mT" not in words
