"""Every picture of every shipped experiment has its ink inside the canvas, and no text over another."""
from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

pytest.importorskip("rabiline._core", reason="built without pybind11")
import rabiline  # noqa: E402
from rabiline import motions, pictures, style  # noqa: E402
from rabiline.apparatus import draw_apparatus  # noqa: E402
from rabiline.errors import InputError  # noqa: E402

pytestmark = pytest.mark.slow
BEAMLINES = Path(__file__).parents[2] / "beamline"
NAMES = sorted(path.stem for path in BEAMLINES.glob("*.yaml"))
LONG = "An experiment whose title takes eighty letters, which is no more than a paper may need"
PARTICLES = 40  # at most: what is drawn, not what it means
COLUMN, SMALL, PAGE = (100 / 25.4, 80 / 25.4), (86 / 25.4, 60 / 25.4), (170 / 25.4, 220 / 25.4)  # inches
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
    """All pictures that there are of what is open."""
    if isinstance(opened, motions.Motions):
        return {"motion": pictures.plot_of(opened, "motion", {"title": LONG})}
    kinds = [(kind, {}) for kind in ("scan", "levels", "image", "profiles", "angles", "transit")]
    eight, six = (",".join(map(str, np.unique(np.linspace(0, len(opened.laws) - 1, most).astype(int)))) for most in (8, 6))
    kinds += [("profiles", {"points": "0,1"}), ("profiles", {"size": COLUMN, "points": "0"})]
    kinds += [("profiles", {"points": eight}), ("profiles", {"size": SMALL, "points": eight})]
    kinds += [(kind, {"size": size}) for kind in ("scan", "levels", "transit") for size in (COLUMN, SMALL)]
    kinds += [("tally", {"name": tally, "points": points}) for tally in opened.tallies for points in ("0", "all")]
    kinds += [("tally", {"name": name, "points": six, "axes": tally.axes[0].name, **size}) for name, tally in opened.tallies.items()
              for size in ({}, {"size": SMALL})]
    figures = {}
    for kind, options in kinds:
        try:
            figures[f"{kind} {options}"] = pictures.plot_of(opened, kind, {"title": LONG, **options})
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
            tracks = experiment.trace(5)
            figures["tracks"] = pictures.plot_of(tracks, "tracks", {"title": LONG})
            figures["tracks, small"] = pictures.plot_of(tracks, "tracks", {"title": LONG, "size": PAGE})
            figures["in space"] = pictures.plot_of(tracks, "tracks", {"title": LONG, "in_space": True})
            figures["draw"] = draw_apparatus(experiment.scan(), 10, LONG)
            with style.here(PAGE):
                figures["draw, small"] = draw_apparatus(experiment.scan(), 2, LONG)
        wrong = [f"{kind}: {fault}" for kind, figure in figures.items() for fault in faults(figure)]
    for figure in figures.values():
        plt.close(figure)
    assert not wrong, "\n".join(wrong)


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
