"""Pictures from Python take the options of the command line."""
from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("rabiline._core", reason="built without pybind11")
import rabiline  # noqa: E402
from rabiline.apparatus import draw_apparatus  # noqa: E402
from rabiline.stated import what_differs  # noqa: E402


@pytest.fixture(scope="module")
def ramsey() -> rabiline.Experiment:
    return rabiline.load(Path(__file__).parents[2] / "beamline" / "ramsey.yaml").scan().scan("first.frequency", "285 kHz:298 kHz:14")


@pytest.mark.parametrize(("options", "error", "says"), [
    ({"size": "0x0"}, rabiline.InputError, "`size`: `0x0` is no size"), ({"size": (0, 0)}, rabiline.InputError, "no size"),
    ({"size": 3}, TypeError, "a pair of numbers"), ({"x_range": "29:"}, rabiline.InputError, "`x_range`: `29:` is no range"),
    ({"x_range": 3}, rabiline.InputError, "is no range"), ({"dpi": 1e9}, rabiline.InputError, "dots per inch"),
    ({"dpi": "300"}, TypeError, "`dpi` is a number, not a text"), ({"detector": [b"x"]}, TypeError, "a text is meant"), ({"colour": "red"}, rabiline.InputError, "no option `colour`")])
def test_options_of_pictures_are_read_as_on_the_command_line(ramsey: rabiline.Experiment, options: dict, error: type, says: str) -> None:
    result = ramsey.set(particles=20).run()
    with pytest.raises(error, match=says):
        result.plot(kind="scan", **options)


def test_a_picture_takes_texts_and_numbers(ramsey: rabiline.Experiment) -> None:
    result = ramsey.set(particles=20).run()
    assert result.plot(kind="scan", size=(100, 80)).get_size_inches() * 25.4 == pytest.approx([100, 80])
    figure = result.plot(kind="scan", size="100x80", x_range="286:290", mark=["here=288 kHz"], title=3)
    assert figure.get_size_inches() * 25.4 == pytest.approx([100, 80]) and figure.axes[0].get_xlim() == (286, 290)
    assert figure._suptitle.get_text().startswith("3")


def test_a_frame_of_counts_stands_beside_a_curve(ramsey: rabiline.Experiment) -> None:
    pandas = pytest.importorskip("pandas")
    measured = pandas.DataFrame({"first.frequency [kHz]": [286.0, 290.0, 295.0], "counts": [500, 400, 450]})
    result = ramsey.set(particles=20).run()
    labels = result.plot(kind="scan", data=measured, detector="screen").axes[0].get_legend_handles_labels()[1]
    assert any(label.startswith("counted") for label in labels)
    with pytest.raises(rabiline.InputError, match="plot-image has no option `data`"):
        result.plot(kind="image", data=measured)


def test_a_detector_beside_the_beam_is_drawn(ramsey: rabiline.Experiment) -> None:
    beside = draw_apparatus(ramsey.set({"screen.offset": {"x": "40 mm"}}).scan(), 2)
    assert beside.axes[-1].get_ylim()[1] > 40 and beside.axes[-2].get_ylim()[1] < 20  # mm, from above and from the side


def test_counts_over_two_parameters_are_not_drawn_beside_one_curve(ramsey: rabiline.Experiment) -> None:
    pandas = pytest.importorskip("pandas")
    measured = pandas.DataFrame({"first.frequency [kHz]": [286.0, 290.0, 295.0] * 2, "second.phase [deg]": [0, 0, 0, 90, 90, 90], "counts": [500, 400, 450] * 2})
    with pytest.raises(rabiline.InputError, match="the rows of one value of `second.phase`"):
        ramsey.set(particles=20).run().plot(kind="scan", data=measured, detector="screen")


def test_ranges_of_an_image_leave_its_colour_bar_alone(ramsey: rabiline.Experiment) -> None:
    result = ramsey.set(particles=20).run()
    whole, part = (result.plot(kind="image", **ranges) for ranges in ({}, {"x_range": "-0.5:0.5", "y_range": "-0.3:0.3"}))
    bars = [[(axes.get_xlim(), axes.get_ylim()) for axes in figure.axes if axes.get_xlabel().startswith("counts per")] for figure in (whole, part)]
    assert bars[0] and bars[0] == bars[1]
    assert part.axes[0].get_xlim() == (-0.5, 0.5)


def test_a_result_of_a_beam_has_no_picture_of_paths_motions_or_fields(ramsey: rabiline.Experiment) -> None:
    result = ramsey.set(particles=20).run()
    for kind in ("tracks", "motion", "field"):
        with pytest.raises(rabiline.InputError, match=f"no picture `{kind}` of this"):
            result.plot(kind=kind)


def test_a_size_with_no_room_for_two_numbers_beside_a_panel_is_refused(tmp_path: Path) -> None:
    clock = rabiline.load(Path(__file__).parents[2] / "beamline" / "caesium-clock.yaml").scan()
    with pytest.raises(rabiline.InputError, match="60x45 leaves no room"):
        clock.draw(tmp_path / "a.png", paths=2, size="60x45")
    clock.draw(tmp_path / "a.png", paths=2, size="86x60")


def test_species_are_told_apart_by_their_names_alone() -> None:
    rows = [{"law": "quantum", "species": name, "species.name": name} for name in ("K-39 atom", "Na-23 atom")]
    assert what_differs(rows) == ("", ["K-39 atom", "Na-23 atom"])


@pytest.mark.parametrize(("names", "values"), [(None, "9 mT:10 mT:3"), (None, ["9 mT"]), ("B.field", {"from": 1})])
def test_a_scan_without_its_parameter_or_list_is_none(ramsey: rabiline.Experiment, names: str | None, values: object) -> None:
    with pytest.raises(TypeError):
        ramsey.scan(names, values)
