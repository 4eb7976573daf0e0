"""Every picture of every shipped experiment has its ink inside the canvas, and no text over another."""
from __future__ import annotations

import re
import warnings
from argparse import Namespace
from dataclasses import replace
from pathlib import Path
from typing import Callable

import numpy as np
import pytest
import runs
from matplotlib import pyplot as plt
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

pytest.importorskip("rabiline._core", reason="built without pybind11")
import rabiline  # noqa: E402
from rabiline import angle_plots, image_plots, motions, pictures, style, transit_plots  # noqa: E402
from rabiline.__main__ import main  # noqa: E402
from rabiline.apparatus import draw_apparatus  # noqa: E402
from rabiline.compare_plots import draw_difference  # noqa: E402
from rabiline.counts import Across, Counts  # noqa: E402
from rabiline.errors import InputError  # noqa: E402
from rabiline.field_plots import COLUMNS, ELECTRIC  # noqa: E402
from rabiline.fit_plots import draw_fit  # noqa: E402
from rabiline.fit_report import COARSE  # noqa: E402
from rabiline.line_commands import derived, described  # noqa: E402
from rabiline.forms import FORMS  # noqa: E402
from rabiline.line_plots import draw_line  # noqa: E402
from rabiline.lines import fit_line  # noqa: E402
from rabiline.picture_options import KeywordParser  # noqa: E402
from rabiline.results import Transit, read as read_results  # noqa: E402

pytestmark = pytest.mark.slow
BEAMLINES = Path(__file__).parents[2] / "beamline"
FRINGES = Path(__file__).parents[2] / "docs" / "example" / "ramsey-fringes.yaml"
NAMES = sorted(path.stem for path in BEAMLINES.glob("*.yaml"))
LONG = "An experiment whose title takes eighty letters, which is no more than a paper may need"
PARTICLES = 16  # at most: what is drawn, not what it means
MM = {"column": (100, 80), "small": (86, 60), "page": (170, 220)}
COLUMN, SMALL, PAGE = (tuple(length / 25.4 for length in size) for size in MM.values())  # inches
MINUS = re.compile(r"(?:^|[\s=(,±×])-[\d.]")  # of ASCII, where the ticks have a true one
SLACK = 1.0  # points that texts may share: the boxes of letters are larger than their ink


def settle(figure: Figure) -> None:
    """Lays it out once more."""
    with warnings.catch_warnings():
        warnings.filterwarnings("error", "constrained_layout not applied")
        if figure.get_layout_engine():
            figure.get_layout_engine().execute(figure)


def texts(figure: Figure) -> list[tuple[str, Bbox, bool]]:
    """Each text that is drawn, with its box in dots, and whether it stands straight: the box of a slanted one is more than
    its ink."""
    found = []
    draw = Text.draw

    def watched(text: Text, renderer: object) -> None:
        if text.get_visible() and text.get_text().strip():
            box = text.get_window_extent(renderer)
            found.append((text.get_text(), box, text.get_rotation() % 90 == 0))
        draw(text, renderer)

    engine = figure.get_layout_engine()
    figure.set_layout_engine("none")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Text, "draw", watched)
        figure.draw_without_rendering()
    if engine:
        figure.set_layout_engine(engine)
    return found


def faults(figure: Figure) -> list[str]:
    """Where a picture is saved it is laid out twice; where nothing is wrong after the first time, the second hardly moves anything."""
    try:
        settle(figure)
        if not faults_as_it_stands(figure):
            return []
        settle(figure)
    except UserWarning:
        is_small = any(abs(figure.get_size_inches()[0] - size[0]) < 0.01 for size in (COLUMN, SMALL))  # `save` refuses such a size
        return [] if is_small else ["no room for its layout"]
    return faults_as_it_stands(figure)


def faults_as_it_stands(figure: Figure) -> list[str]:
    found = texts(figure)
    width, height = figure.canvas.get_width_height()
    wrong = [f"outside: {text!r}" for text, box, _ in found
             if box.x0 < -SLACK or box.y0 < -SLACK or box.x1 > width + SLACK or box.y1 > height + SLACK]
    wrong += [f"minus: {text!r}" for text, *_ in found if MINUS.search(text)]
    for i, (text, box, straight) in enumerate(found):
        for other, its, its_straight in found[:i]:
            across, along = min(box.x1, its.x1) - max(box.x0, its.x0), min(box.y1, its.y1) - max(box.y0, its.y0)
            if straight and its_straight and min(across, along) > SLACK and not (text == other and box.bounds == its.bounds):
                wrong.append(f"overlap: {text!r} and {other!r}")
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            if axis.get_offset_text().get_text() and axis.get_visible():
                wrong.append(f"offset text: {axis.get_offset_text().get_text()!r}")
    return wrong


def drawn(opened: object, name: str) -> dict[str, Figure]:
    """All pictures that there are of what is open; where there are two sizes one of them, and the other of the next file."""
    if isinstance(opened, motions.Motions):
        return {"motion": pictures.plot_of(opened, "motion", {"title": LONG})}
    kinds = [(kind, {}) for kind in ("scan", "levels", "image", "profiles", "angles", "transit")]
    eight, six = (",".join(map(str, np.unique(np.linspace(0, len(opened.laws) - 1, most).astype(int)))) for most in (8, 6))
    size = ({}, {"size": MM["small"]})[NAMES.index(name) % 2]
    if len(opened.laws) > 1:
        kinds += [("profiles", {"points": "0,1"}), ("profiles", {"points": eight, **size})]
    small = [("profiles", {"points": "0"}), *((kind, {}) for kind in ("scan", "levels", "image", "transit"))]
    kinds += [("tally", {"name": tally, "points": points}) for tally in opened.tallies for points in ("0", "all")[:len(opened.laws)]]
    kinds += [("tally", {"name": tally, "points": six, "axes": own.axes[0].name, **size}) for tally, own in opened.tallies.items()]
    tries = [[each] for each in kinds]
    tries += [[(kind, {**options, "size": size}) for size in (MM["small"], MM["column"])] for kind, options in small[NAMES.index(name) % 3::3]]
    figures = {}
    for sizes in tries:
        for kind, options in sizes:
            try:
                figures[f"{kind} {options}"] = pictures.plot_of(opened, kind, {"title": LONG, **options})
                break  # where a size has room, a larger one has
            except InputError:
                continue  # what this file does not have, or a size that is too small for it
    return figures


@pytest.mark.parametrize("name", NAMES)
def test_ink_stays_inside_and_texts_apart(name: str) -> None:
    experiment = rabiline.load(BEAMLINES / f"{name}.yaml")
    with style.here():
        if experiment.is_model:
            figures = drawn(experiment.run(), name)
        else:
            experiment = experiment.set(particles=min(PARTICLES, int(experiment.value("particles"))))
            figures = drawn(experiment.fly(), name)
            tracks = experiment.trace(3)
            assert all((np.diff(one.time) >= 0).all() for one in tracks.tracks), "a path goes back in time"
            figures["tracks"] = pictures.plot_of(tracks, "tracks", {"title": LONG})
            size = ("small", "page")[NAMES.index(name) % 2]
            figures[f"tracks, {size}"] = pictures.plot_of(tracks, "tracks", {"title": LONG, "size": MM[size]})
            figures["in space"] = pictures.plot_of(tracks, "tracks", {"title": LONG, "in_space": True})
            figures["draw"] = draw_apparatus(experiment.scan(), 3, LONG)
            with style.here((PAGE, SMALL)[NAMES.index(name) % 2]):
                figures["draw, small"] = draw_apparatus(experiment.scan(), 2, LONG)
        wrong = [f"{kind}: {fault}" for kind, figure in figures.items() for fault in faults(figure)]
    for figure in figures.values():
        plt.close(figure)
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("name", ["caesium-clock", "stern-gerlach", "hydrogen-source", "neutron-edm"])
def test_a_column_has_room_for_images_levels_and_an_apparatus(name: str) -> None:
    experiment = rabiline.load(BEAMLINES / f"{name}.yaml").set(particles=PARTICLES)
    result = experiment.fly()
    figures = [pictures.plot_of(result, kind, {"size": MM["small"]}) for kind in ("image", "levels")]
    with style.here(SMALL):
        figures.append(draw_apparatus(experiment, 5))
    for figure in figures:
        assert not faults(figure)
        assert min(text.get_fontsize() for text in figure.findobj(Text) if text.get_text().strip() and text.get_visible()) > 4.5
        plt.close(figure)


@pytest.mark.parametrize("size", [(140, 90), (86, 130), (120, 120)])
def test_angles_stand_beside_one_another_where_there_is_no_room_below(size: tuple[float, float]) -> None:
    result = rabiline.load(BEAMLINES / "spin-angles.yaml").set(particles=PARTICLES).fly()
    figure = pictures.plot_of(result, "angles", {"size": size})
    assert not faults(figure) and figure.axes[0].get_gridspec().ncols == (2 if size[0] > size[1] else 1)
    with pytest.raises(InputError, match="letters would become too small"):
        pictures.plot_of(result, "angles", {"size": (86, 60)})


def test_a_slender_picture_has_its_numbers_and_names_apart() -> None:
    result = rabiline.load(BEAMLINES / "caesium-clock.yaml").set(particles=PARTICLES).fly()
    assert not faults(pictures.plot_of(result, "scan", {"size": (40, 200)}))


def test_a_column_has_room_for_eight_profiles() -> None:
    experiment = rabiline.load(BEAMLINES / "frisch-segre-potassium.yaml").set(particles=PARTICLES)
    with style.here(SMALL):
        figure = pictures.plot_of(experiment.fly(), "profiles", {"title": LONG})  # no size that is refused
        assert not faults(figure) and figure.axes[0].get_window_extent().height > 0.3 * figure.dpi * SMALL[1]
    legend, = figure.legends
    assert legend.get_title().get_text() == "wire.current" and "0.5 A" in [text.get_text() for text in legend.get_texts()]
    looks = {(path.get_edgecolor(), str(path.get_linestyle())) for path in figure.axes[0].patches}
    assert len(looks) == 8
    plt.close(figure)


def test_paths_are_named_by_what_their_files_were_flown_with(tmp_path: Path) -> None:
    for name, field in (("a", "9 mT"), ("b", "10 mT")):
        runs.rabiline("trace", BEAMLINES / "suggested-experiment.yaml", "-n", 2, "--set", f"B.field={field}", "-o", tmp_path / f"{name}.h5")
    for size, in_space in ((None, False), (PAGE, False), (None, True)):
        with style.here(size):
            figure = pictures.plot_tracks(Namespace(files=[tmp_path / "a.h5", tmp_path / "b.h5"], region=[], title=LONG, in_space=in_space))
            assert not faults(figure)
        named = [text.get_text() for axes in figure.axes if axes.get_legend() for text in axes.get_legend().get_texts()]
        assert named[:2] == [f"dorado (hypothesis), torque, κ = 1, B.field = {field}" for field in ("9 mT", "10 mT")]
        plt.close(figure)


MANY = 1_000_000  # counts in a bin


@pytest.mark.parametrize("name", ["bloch-siegert", "deflection-potassium", "deflection-potassium-point", "rabi-licl"])
def test_images_of_many_counts_have_room_for_their_numbers(name: str) -> None:
    result = rabiline.load(BEAMLINES / f"{name}.yaml").set(particles=PARTICLES).fly()
    detector = result.detectors[result.scan.detectors[0]]
    points = range(min(2, len(result.laws)))
    more = {key: getattr(detector, key) * MANY / detector.counts[points].max() for key in
            ("counts", "errors", "counts_x", "errors_x", "counts_z", "errors_z")}
    shots = [image_plots.shot_of(result, point) for point in points]
    with style.here():
        figure = image_plots.draw_images(result, replace(detector, **more), shots)
        assert not faults(figure)
    assert figure.axes[-1].get_xlabel() == "counts per bin (10⁶)"
    plt.close(figure)


@pytest.fixture(scope="module")
def measured() -> tuple[rabiline.Experiment, Counts]:
    """Ramsey's fringes, and counts of them."""
    experiment = rabiline.load(FRINGES).set(particles=300)
    result = experiment.fly()
    x = result.scan.axes[0].values
    counts = np.random.default_rng(1).poisson(4000 * result.detected).astype(float)
    return experiment.scan(), Counts("counts", "C1.frequency", tuple(f"{value!r} Hz" for value in x.tolist()), x, "Hz", counts, None, None, None)


def faults_at_sizes(draw: Callable[[], Figure]) -> list[str]:
    """Of a picture as it comes, and as the column of a journal has it."""
    wrong = []
    for size in (None, COLUMN, SMALL):
        with style.here(size):
            figure = draw()
            wrong += [f"{size}: {fault}" for fault in faults(figure)]
            plt.close(figure)
    return wrong


def test_fits_with_many_long_names_stay_inside(measured: tuple[rabiline.Experiment, Counts]) -> None:
    experiment, counts = measured
    fit = experiment.fit(counts, ["guide.field", "C1.amplitude+C2.amplitude", "source.speed.mean"], intervals=False, explore=100)
    assert not faults_at_sizes(lambda: draw_fit(fit, LONG))
    names = ("first.amplitude+second.amplitude+third.amplitude+fourth.amplitude+fifth.amplitude+sixth.amplitude+seventh.amplitude",) * 4
    across = Across("C2.phase", tuple(("0 deg", "90 deg")[i % 2] for i in range(counts.x.size)), counts.x, "deg")
    rejected = replace(fit, names=names, chi_squared=1e3, template_errors=0.3 * fit.expected)
    assert any(COARSE[:40] in axes.get_title() for axes in draw_fit(rejected).axes)
    assert not faults_at_sizes(lambda: draw_fit(rejected, LONG))
    assert not faults_at_sizes(lambda: draw_fit(replace(rejected, counts=replace(counts, across=across)), LONG))


@pytest.mark.parametrize(("form", "lines"), [("rabi", 1), ("lorentz", 4), ("ramsey", 1)])
def test_forms_with_many_numbers_stay_inside(measured: tuple[rabiline.Experiment, Counts], form: str, lines: int) -> None:
    x, y = measured[1].x, measured[1].counts
    fitted = fit_line(x, y, np.diag(np.maximum(y, 1)), FORMS[form], lines=lines)
    words = [*described(fitted, "Hz"), *derived(fitted, "Hz", 29.1646935e6, None)]
    assert not faults_at_sizes(lambda: draw_line(x, y, np.sqrt(np.maximum(y, 1)), fitted, "C1.frequency", "Hz", LONG, words, "counts"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, measured: tuple[rabiline.Experiment, Counts]) -> Path:
    """With a file for each command that draws one."""
    made = tmp_path_factory.mktemp("pictures")
    fringes = measured[0].scan("C1.frequency", "28.6647 kHz:29.6647 kHz:21")
    for name, changes in {"one": {}, "other": {"seed": 5}, "strong": {"C1.amplitude": "160 uT", "title": LONG, "seed": 6}}.items():
        fringes.set(changes).fly().write(made / f"{name}.h5")
    rows = [f"{x},{n:.0f}" for x, n in zip(measured[1].x, measured[1].counts)]
    (made / "counts.csv").write_text("\n".join(["C1.frequency [Hz],counts", *rows]))
    suggested = rabiline.load(BEAMLINES / "suggested-experiment.yaml").set(particles=200).scan()
    suggested.scan("law", ["quantum", "dorado"]).scan("H0.frequency", "280 kHz:300 kHz:5").fly().write(made / "laws.h5")
    suggested.set({"H0.frequency": "291.65 kHz"}).scan("law", ["quantum", "dorado"]).fly().write(made / "image.h5")
    (made / "image.csv").write_text("z [mm],counts\n" + "".join(f"{z:.3f},20\n" for z in np.arange(-0.475, 0.5, 0.05)))
    strengths = suggested.set({"law": {"name": "dorado", "kappa": 0}, "particles": 2000})
    strengths.scan("law.kappa", "0:0.01:9").fly().write(made / "kappa.h5")
    places = np.linspace(0, 1, 51)
    field = [[0, y, 0, 1e-3 * y, -2e-3, 0, np.hypot(1e-3 * y, 2e-3), 100 * y, 0, -1e6] for y in places]
    (made / "field.csv").write_text("\n".join([",".join(COLUMNS + ELECTRIC), *(",".join(map(str, row)) for row in field)]))
    return made


@pytest.mark.parametrize("words", [
    "compare one.h5 other.h5", "compare one.h5 strong.h5", "compare-laws laws.h5 --rate 1e4", "compare-laws image.h5 --data image.csv --emitted 1000",
    "compare-laws laws.h5 --histogram detected --rate 1e4", "bound-kappa kappa.h5 --emitted 1000",
    "plot-field field.csv --region long_name_of_a_field=0.2:0.4 --region another=0.5:0.9", "plot-scan one.h5 strong.h5",
    "plot-scan one.h5 strong.h5 other.h5 --beside", "plot-scan one.h5 --data counts.csv", "plot-profiles one.h5 strong.h5 --points 0,10"])
def test_pictures_of_commands_stay_inside(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, words: str) -> None:
    """At a size that is too small for one, this is what is said."""
    monkeypatch.chdir(folder)
    wrong: list[str] = []
    monkeypatch.setattr(style, "save", lambda figure, *_: (wrong.extend(faults(figure)), plt.close(figure)))
    for size in ([], ["--size", "86x60"]):
        code = main([*words.split(), "--title", LONG, "-o", "drawn.png", *size])
        said = capsys.readouterr().err
        assert not wrong and (code == 0 or size and code == 2 and said.startswith("rabiline: --size: ")), (size, wrong, said)


def test_files_are_told_apart_by_the_numbers_in_which_they_differ(folder: Path) -> None:
    with style.here():
        for other, told in {"strong": ["quantum, C1.amplitude = 110 µT", "quantum, C1.amplitude = 160 µT"],
                            "other": ["quantum [one]", "quantum [other]"]}.items():  # whose seed is another one
            figure = pictures.plot_scan(options_of("plot-scan", folder / "one.h5", folder / f"{other}.h5"))
            assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()] == told
        figure = draw_difference(*(read_results(folder / f"{name}.h5") for name in ("one", "strong")), "det", None, "alike")
        assert [text.get_text() for text in figure.legends[0].get_texts()] == ["one, C1.amplitude = 110 µT", "strong, C1.amplitude = 160 µT"]
    plt.close("all")


def options_of(verb: str, *files: Path) -> Namespace:
    parser = KeywordParser()
    pictures.arguments(verb, parser)
    return parser.parse_args([str(file) for file in files])


def test_where_nothing_is_detected_angles_are_drawn_or_another_picture_is_named() -> None:
    angles = rabiline.load(BEAMLINES / "spin-angles.yaml").set(particles=PARTICLES).fly().plot()
    assert angles.axes[0].get_ylabel() == "polar angle θ (deg)"
    plt.close(angles)
    with pytest.raises(InputError, match="nothing was detected in it, .*\n  help: plot-tracks draws the paths that `rabiline trace` writes"):
        rabiline.load(BEAMLINES / "trajectories.yaml").set(particles=PARTICLES).fly().plot()


def test_residuals_that_are_rounding_are_shown_as_none() -> None:
    result = rabiline.load(BEAMLINES / "spin-angles.yaml").set(particles=PARTICLES).fly()
    angles = [replace(one, values=one.offset + one.rate * one.times + 1e-13) for one in angle_plots.angles_of(result, None, 0)]
    figure = angle_plots.draw_angles(result, angles, [None, None], 0)
    assert figure.axes[1].get_ylabel() == "beyond the fit (nrad)" and figure.axes[1].get_ylim()[1] > 1
    plt.close(figure)


def test_numbers_stand_between_two_powers_of_ten() -> None:
    for low, high, told in ((0.0176, 0.882, ["0.02", "0.05", "0.1", "0.2", "0.5"]), (1, 1000, ["1", "10", "100", "1000"]),
                            (2e-7, 9e-6, ["2×10⁻⁷", "5×10⁻⁷", "10⁻⁶", "2×10⁻⁶", "5×10⁻⁶"])):
        figure, axes = plt.subplots()
        style.logarithmic(axes.xaxis)
        axes.set_xlim(low, high)
        figure.draw_without_rendering()
        shown = {label.get_position()[0]: label.get_text() for which in (False, True) for label in axes.get_xticklabels(minor=which)}
        assert [text for place, text in sorted(shown.items()) if text and 0.999 * low <= place <= 1.001 * high] == told
        plt.close(figure)


def test_levels_are_named_with_true_signs() -> None:
    assert [style.level(name) for name in ("Li-6 in LiCl m = +0", "F=3/2 m=-1/2", "m = +0 to m = -1", "(1 - S_z)/2", "m = +1/2", "m = -0.5")] == \
        ["Li-6 in LiCl m = 0", "F=3/2 m=−1/2", "m = 0 to m = −1", "(1 − S_z)/2", "m = +1/2", "m = −0.5"]


def test_the_legend_of_laws_does_not_drive_panels_apart(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn_here: list[Figure] = []
    monkeypatch.chdir(folder)
    monkeypatch.setattr(style, "save", lambda figure, *_: (settle(figure), drawn_here.append(figure)))
    assert main("compare-laws image.h5 --emitted 1000 -o drawn.png".split()) == 0
    figure, = drawn_here
    panels = [axes for axes in figure.axes if axes.get_ylabel() == "counts in a bin / emitted" and axes.get_label() != "<colorbar>"]
    assert len(panels) == 2 and sum(axes.get_position().width for axes in panels) > 0.75
    plt.close(figure)


def test_a_path_in_space_has_z_up_whatever_the_field_is() -> None:
    with style.here():
        figure = pictures.plot_of(rabiline.load(BEAMLINES / "sona-unit.yaml").trace(1), "tracks", {"in_space": True})
    assert figure.axes[0].get_zlabel().startswith("z (")
    plt.close(figure)


def test_a_single_cell_is_one() -> None:
    transit = Transit("a title", ("m = +0 to m = +1",), np.array([1e-3, 2e-3]), np.ones((1, 1)), 0.1 * np.ones((1, 1)), 1.0)
    with style.here():
        axes = transit_plots.draw_transit(transit, 10.0, LONG).axes[0]
    assert axes.get_title().startswith("1 cell: ") and axes.get_legend().get_texts()[0].get_text() == "0 → +1"
    plt.close("all")
