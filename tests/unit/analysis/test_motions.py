"""The motions of a model: what is read of them, and what their pictures show."""
from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from rabiline import motions, results
from rabiline.__main__ import main
from rabiline.hdf5 import FileError
from rabiline.motion_plots import draw_findings, draw_motions

TIME = np.linspace(0, 2, 50)


def write_motion(parent: h5py.Group, name: str, bend: float) -> None:
    group = parent.create_group(name)
    group.attrs.update({"motion": name, "courses": ["speed", "angle"]})
    for key, values in {"time": TIME, "x": 0 * TIME, "y": 2 * TIME, "z": bend * TIME**2, "speed": 0 * TIME + 2,
                        "angle": bend * TIME, "velocity": np.zeros((50, 3))}.items():
        group[key] = values
        group[key].attrs.update({"units": "m", "long_name": f"{key} (m)"})
    group["meaning"] = f"meaning of {name}"


def write_model(path: Path, spins: list[float] | None = None) -> Path:
    """Two motions, and three findings: one that varies, one kept, one that the first point does not have."""
    with h5py.File(path, "w") as file:
        entry = file.create_group("entry")
        entry.update({"title": "A top", "model": "top", "motions": ["second", "first"]})
        found = entry.create_group("findings")
        found.update({"name": ["rate", "kept", "late"], "units": ["rad/s", "1", "1"], "meaning": ["a", "b", "c"]})
        points = len(spins) if spins else 1
        rates = 1 / np.arange(1, points + 1)
        late = np.where(np.arange(points) > 0, rates, np.nan)
        found["value"] = np.squeeze([rates, 0 * rates + 1e-14, late])
        found["expected"] = np.squeeze([1.1 * rates, 0 * rates, 0 * late])
        if spins:
            found.attrs["axes"] = ["model_spin"]
            found["model_spin"] = spins
            found["model_spin"].attrs.update({"units": "Hz", "parameter": "model.spin"})
        for point in range(points):
            parent = entry.create_group(f"point_{point}") if spins else entry
            write_motion(parent, "first", 0.5)
            write_motion(parent, "second", 0.0)
    return path


def test_motions_come_in_the_order_that_the_file_states(tmp_path: Path) -> None:
    file = motions.read(write_model(tmp_path / "m.h5"))
    (point,) = file.points
    assert [motion.name for motion in point] == ["second", "first"]
    assert [course.name for course in point[0].courses] == ["speed", "angle"]
    assert file.axis is None and file.findings[1].values == pytest.approx(1e-14)


def test_a_scan_has_motions_and_findings_at_each_point(tmp_path: Path) -> None:
    file = motions.read(write_model(tmp_path / "m.h5", [1.0, 10.0, 100.0]))
    assert file.axis is not None and (file.axis.parameter, file.axis.units) == ("model.spin", "Hz")
    assert len(file.points) == 3 and np.isnan(file.findings[2].values[0])


def test_a_picture_of_motions_shows_every_path_and_the_course_that_differs(tmp_path: Path) -> None:
    figure = draw_motions(motions.read(write_model(tmp_path / "m.h5")).points[0], "a title")
    space, apart, course = figure.axes
    assert [text.get_text() for text in apart.get_legend().texts] == ["second", "first"]
    assert (space.get_xlabel(), space.get_zlabel()) == ("x (m)", "z (m)")
    assert apart.get_yscale() == "log" and apart.lines[0].get_ydata()[-1] == pytest.approx(2.0)
    assert course.get_ylabel() == "angle (m)" and len(course.lines) == 2


def test_a_picture_of_findings_has_log_axes_over_decades_and_names_what_is_kept(tmp_path: Path) -> None:
    file = motions.read(write_model(tmp_path / "m.h5", [1.0, 10.0, 100.0]))
    figure = draw_findings(file, "a title")
    rate, late = figure.axes
    assert rate.get_xscale() == "log" and rate.get_ylabel() == "rate (rad/s)" and rate.get_xlabel() == "model.spin (Hz)"
    assert [line.get_label() for line in rate.lines] == ["found", "closed form"] and len(late.lines) == 1
    assert "kept" in figure._supxlabel.get_text()


def test_a_single_motion_has_no_distance_and_shows_what_varies(tmp_path: Path) -> None:
    alone = [motion for motion in motions.read(write_model(tmp_path / "m.h5")).points[0] if motion.name == "first"]
    space, course = draw_motions(alone, "a title").axes
    assert course.get_ylabel() == "angle (m)" and len(course.lines) == 1
    assert space.get_title() == "paths; the ring is the start"
    still = [replace(alone[0], courses=alone[0].courses[:1])]
    assert len(draw_motions(still, "a title").axes) == 1


def circling(name: str, turns: float, samples: int) -> motions.Motion:
    time = np.linspace(0, 1, samples)
    phase = 2 * np.pi * turns * time
    course = motions.Course("phase", "phase (rad)", "rad", phase)
    return motions.Motion(name, "", time, np.column_stack([np.cos(phase), np.sin(phase), 0 * time]), (course,))


def test_of_many_turns_the_first_and_the_last_are_drawn_round_and_no_distance() -> None:
    space, course = draw_motions([circling("standard", 100, 1001), circling("eq74", 110, 1001)], "a title").axes
    assert space.get_title() == "first 2 and last 2 turns; the ring is the start"
    first, last = (np.column_stack(line.get_data_3d()) for line in space.lines[:2])
    for part in (first, last):
        lengths = np.linalg.norm(np.diff(part, axis=0), axis=1)
        assert lengths.sum() / (2 * np.pi) == pytest.approx(2, abs=0.3)
        assert np.linalg.norm(part, axis=1) == pytest.approx(1, abs=0.01)  # an orbit, where chords reach in by 5 %
    assert first[0] == pytest.approx([1, 0, 0]) and last[-1] == pytest.approx([1, 0, 0], abs=1e-9)
    assert [text.get_text() for text in course.get_legend().texts] == ["standard", "eq74 (hypothesis)"]


def test_what_swings_many_times_has_no_dashes() -> None:
    def swinging(name: str, rate: float) -> motions.Motion:
        course = motions.Course("c", "c", "", np.sin(rate * np.arange(4001)))
        return replace(circling(name, 1, 4001), courses=(course,))

    flat, slow, fast = swinging("a", 0), swinging("b", 1e-3), swinging("c", 0.3)
    assert [line.get_linestyle() for line in draw_motions([flat, slow], "").axes[-1].lines] == ["-", "--"]
    assert [line.get_linestyle() for line in draw_motions([flat, fast], "").axes[-1].lines] == ["-", "-"]


def findings_over(axis: results.Axis, findings: list[motions.Finding]) -> motions.Motions:
    return motions.Motions(Path("m.h5"), "", "top", axis, (), tuple(findings))


def test_findings_without_room_are_named_and_inputs_go_first() -> None:
    x = np.linspace(1, 2, 5)
    many = [motions.Finding(name, "", "", x, 0 * x) for name in ("fast_top", *"abcdefg")]
    figure = draw_findings(findings_over(results.Axis("model.spin", "Hz", x, ()), many), "")
    assert [axes.get_ylabel() for axes in figure.axes] == list("abcdef")
    assert figure._supxlabel.get_text() == "not shown: g, fast_top"


def test_findings_over_names_are_points_on_both_sides_of_zero() -> None:
    axis = results.Axis("model.species", "", np.arange(3.0), ("proton", "electron", "muon"))
    values = np.array([-15.2e6, 28e9, -135e6])
    narrow = np.array([2.0001, 2.0002, 2.0003])
    figure = draw_findings(findings_over(axis, [
        motions.Finding("turn", "turns of v: right-handed; as known", "Hz", values, values, "approximate"),
        motions.Finding("ratio", "a ratio", "", narrow, 0 * narrow, "supposed")]), "")
    turn, ratio = figure.axes
    figure.canvas.draw()
    assert turn.get_yscale() == "symlog" and turn.get_ylabel() == "turn (GHz)" and turn.get_title() == "turns of v"
    assert [line.get_linestyle() for line in turn.lines[:2]] == ["None", "None"]
    assert [text.get_text() for text in turn.get_legend().texts] == ["found", "to first order"]
    assert ratio.get_title() == "a ratio (the paper supposes 0)"
    assert ratio.yaxis.get_offset_text().get_text() == ""
    assert "2.0002" in [text.get_text() for text in ratio.get_yticklabels()]


def test_findings_that_hardly_differ_are_shown_beyond_their_middle_on_a_plain_axis() -> None:
    values = 140e6 + np.array([-30.0, -1.0, 0.5, 30.0])
    figure = draw_findings(findings_over(results.Axis("model.field", "T", np.arange(4.0), ()),
                                         [motions.Finding("turn", "", "Hz", values, values)]), "")
    (axes,) = figure.axes
    assert axes.get_yscale() == "linear" and axes.get_ylabel() == "turn − 140 MHz (Hz)"
    assert axes.lines[0].get_ydata() == pytest.approx([-30, -1, 0.5, 30])


def test_motions_that_are_the_same_have_paths_alone() -> None:
    (space,) = draw_motions([circling("standard", 1, 101), circling("torque", 1, 101)], "").axes
    assert [text.get_text() for text in space.get_legend().texts] == ["standard", "torque (hypothesis)"]


def test_a_summary_says_what_is_expected_and_on_what_grounds(tmp_path: Path,
                                                             capsys: pytest.CaptureFixture[str]) -> None:
    path = write_model(tmp_path / "m.h5", [1.0, 10.0, 100.0])
    with h5py.File(path, "a") as file:
        file["entry/findings/expectation"] = ["approximate", "conserved", "supposed"]
    assert main(["summary", str(path)]) == 0
    told = capsys.readouterr().out
    assert "to first order 1.1 to 0.366666667 rad/s" in told
    assert "kept: 1e-14, conserved\n" in told and "the paper supposes 0\n" in told


def test_other_commands_say_what_the_file_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write_model(tmp_path / "m.h5")
    with pytest.raises(FileError, match="motions of a model"):
        results.read(path)
    for command in ("plot-image", "plot-scan"):
        assert main([command, str(path), "-o", str(tmp_path / "x.png")]) == 2
        assert "holds the motions of a model, not the result of a beamline: see plot-motion" in capsys.readouterr().err
    assert main(["plot-motion", str(path), "--point", "3", "-o", str(tmp_path / "x.png")]) == 2
    assert "--point 3: the scan points are 0 to 0" in capsys.readouterr().err
    assert main(["plot-motion", str(path), "-o", str(tmp_path / "x.png")]) == 0


def test_what_a_model_found_is_a_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write_model(tmp_path / "m.h5", spins=[1.0, 2.0, 3.0])
    file = motions.read(path)
    frame, data = file.to_dataframe(), file.to_xarray()
    finding, parameter = file.findings[0], file.axis.parameter
    np.testing.assert_array_equal(frame[finding.name], finding.values)
    np.testing.assert_array_equal(data[f"{finding.name}_expected"].sel({parameter: file.axis.values[1]}), finding.expected[1])
    assert main(["export", str(path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].startswith("# rabiline") and len(lines) == 6 and lines[2].startswith(parameter)
    file.plot(tmp_path / "m.png")
    assert (tmp_path / "m.png").stat().st_size > 1000 and file.summary().startswith(file.title)


def test_a_file_without_motions_is_refused(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "n.h5", "w") as file:
        file.create_group("entry")
    with pytest.raises(FileError, match="no motions in it"):
        motions.read(tmp_path / "n.h5")


def test_a_summary_names_motions_and_findings_with_what_is_expected(tmp_path: Path,
                                                                        capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["summary", str(write_model(tmp_path / "m.h5", [1.0, 10.0, 100.0]))]) == 0
    told = capsys.readouterr().out
    assert "model.spin (Hz): 1 to 100, 3 points" in told and "motion       first: meaning of first" in told
    assert "finding      rate: 1 to 0.333333333 rad/s, closed form 1.1 to 0.366666667 rad/s" in told
    assert "finding      late: 0.5 to 0.333333333, closed form 0" in told
    assert main(["summary", str(tmp_path / "m.h5"), "--detector", "screen"]) == 2


def test_a_summary_marks_what_is_of_the_hypothesis(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write_model(tmp_path / "m.h5")
    with h5py.File(path, "a") as file:
        del file["entry/findings/name"]
        file["entry/findings/name"] = ["larmor_rate", "kept", "standard_rate"]
    assert main(["summary", str(path)]) == 0
    told = capsys.readouterr().out
    assert "finding      larmor_rate (hypothesis): 1 rad/s" in told and "standard_rate:" in told


def test_headings_of_findings_have_no_backticks() -> None:
    finding = motions.Finding("axis_distance", "largest angle between the axes of `euler` and `paper`: more of it", "rad", np.array([1.0, 2.0]), np.zeros(2))
    scanned = results.Axis("model.spin", "Hz", np.array([1.0, 2.0]))
    figure = draw_findings(motions.Motions(Path("m.h5"), "a top", "top", scanned, (), (finding,)), "a")
    assert figure.axes[0].get_title().replace("\n", " ") == "largest angle between the axes of euler and paper"
