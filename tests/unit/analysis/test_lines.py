"""Closed forms: each finds itself again, with errors that bear out, and lines are told apart."""
from __future__ import annotations

import re
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib import pyplot as plt
from rabiline.__main__ import main
from rabiline.counts import read_counts
from rabiline.hdf5 import FileError
from rabiline.line_commands import derived, described
from rabiline.line_plots import draw_line
from rabiline.forms import FORMS, lorentz, rabi, ramsey, ramsey_over, sinc2
from rabiline.lines import LineFit, NoLine, Poisson, _minima, fit_line
from synthetic import frequencies, write_results

TRUE = {"lorentz": (40.0,), "gauss": (40.0,), "sinc2": (0.02,), "rabi": (12.0, 0.03), "ramsey": (120.0, 0.002, 0.02, 0.05)}
X = 29000 + np.linspace(-120, 120, 121)


@pytest.mark.parametrize("name", list(TRUE))
def test_each_form_finds_its_centre_and_its_own_parameters(name: str) -> None:
    clean = 0.2 + 0.6 * FORMS[name].f(X - 29003.0, *TRUE[name])
    y = clean + np.random.default_rng(5).normal(0, 0.004, X.size)
    found = fit_line(X, y, np.eye(X.size) * 0.004**2, name)
    assert abs(found["centre"][0] - 29003) < 4 * found["centre"][1] < 4
    for parameter, true in zip(FORMS[name].parameters, TRUE[name]):
        value, error = found[parameter]
        assert abs(value - true) < 4 * error + 1e-3 * true, parameter
    assert found.p > 1e-4


def test_errors_of_the_centre_are_its_scatter() -> None:
    generator = np.random.default_rng(1)
    clean = 0.1 + 0.8 * rabi(X - 29000.0, 12.0, 0.03)
    fits = [fit_line(X, clean + generator.normal(0, 0.01, X.size), np.eye(X.size) * 1e-4, "rabi",
                     start={"strength": 12, "time": 0.03}) for _ in range(60)]
    centres = np.array([found["centre"] for found in fits])
    assert np.std(centres[:, 0]) == pytest.approx(centres[:, 1].mean(), rel=0.3)


def test_errors_of_points_serve_as_well_as_their_covariance() -> None:
    y = 0.1 + 0.8 * lorentz(X - 29000.0, 40.0)
    whole, each, one = (fit_line(X, y, errors, "lorentz") for errors in (np.eye(X.size) * 1e-4, np.full(X.size, 0.01), 0.01))
    assert whole.values.tolist() == each.values.tolist() == one.values.tolist() and whole.errors.tolist() == each.errors.tolist() == one.errors.tolist()
    with pytest.raises(NoLine, match="x, y and errors do not belong together"):
        fit_line(X, y, np.ones(3), "lorentz")
    with pytest.raises(NoLine, match="all errors must be above 0"):
        fit_line(X, y, np.zeros(X.size), "lorentz")


def test_a_fitted_form_is_printed_with_its_errors_and_units() -> None:
    y = 0.1 + 0.8 * lorentz(X - 29003.0, 40.0) + np.random.default_rng(1).normal(0, 0.01, X.size)
    found = fit_line(X, y, 0.01, "lorentz", unit="Hz")
    assert re.fullmatch(r"<fit of lorentz: centre = 29\.00\d+ ± 0\.\d+ kHz, width = \d+\.\d+ ± 0\.\d+ Hz, contrast = 0\.\d+ ± 0\.\d+, "
                        r"baseline = 0\.\d+ ± 0\.\d+, chi² \d+\.\d for 117 degrees of freedom, p = \S+>", repr(found)), repr(found)
    assert str(found).splitlines() == described(found, "Hz")


def test_points_that_err_together_do_not_move_the_centre() -> None:
    clean = 0.1 + 0.8 * rabi(X - 29000.0, 12.0, 0.03)
    apart = fit_line(X, clean, np.eye(X.size) * 1e-4, "rabi")
    together = fit_line(X, clean, np.full((X.size, X.size), 1e-4), "rabi")
    assert together["centre"][1] < 1e-3 * apart["centre"][1] and together["baseline"][1] == pytest.approx(0.01, rel=1e-3)


def test_two_lines_are_told_apart() -> None:
    y = 0.1 + 0.5 * FORMS["lorentz"].f(X - 28960.0, 15.0) + 0.3 * FORMS["lorentz"].f(X - 29030.0, 15.0)
    found = fit_line(X, y, np.eye(X.size) * 1e-6, "lorentz", lines=2)
    assert sorted((found["centre_1"][0], found["centre_2"][0])) == pytest.approx([28960, 29030], abs=0.05)


def test_weak_fields_and_two_fields_at_once_are_limits() -> None:
    d = np.linspace(-100, 100, 41)
    assert rabi(d, 1e-4, 0.02) / rabi(np.array([0.0]), 1e-4, 0.02) == pytest.approx(sinc2(d, 0.02), abs=1e-6)
    assert ramsey(np.array([0.0]), 125.0, 0.002, 0.02, 0.0) == pytest.approx(1)  # two pulses of a quarter turn
    slow = ramsey_over(np.array([1e-3]), np.array([1.0]))
    assert slow.f(d, 125.0, 2.0, 20.0) == pytest.approx(ramsey(d, 125.0, 0.002, 0.02, 0.0))


def test_a_weak_field_leaves_its_strength_and_contrast_unknown_and_the_centre_known() -> None:
    y = 900 + 1600 * ramsey(X - 29003.0, 0.5, 0.003, 0.02, 0.2) / ramsey(np.zeros(1), 0.5, 0.003, 0.02, 0.2)
    found = fit_line(X, np.random.default_rng(2).poisson(y), np.diag(y), "ramsey")
    assert abs(found["centre"][0] - 29003) < 4 * found["centre"][1] < 4 and abs(found["time"][0] - 0.02) < 4 * found["time"][1] < 4e-3
    words = {line.split()[0]: line for line in described(found, "Hz")}
    assert words["strength"].endswith("not known") and words["contrast"].endswith("not known") and "±" in words["time"]
    assert words["normal"].endswith("strength, pulse, time and spread are effective")  # which few beams have with a spread of a fifth
    narrow = replace(found, values=np.where(np.array(found.names) == "spread", 0.04, found.values))
    assert not any("normal times" in line for line in described(narrow, "Hz"))


def test_any_callable_is_fitted_from_its_start() -> None:
    found = fit_line(X, 3 + 2 * np.sin(X / 10), np.eye(X.size), lambda x, a, b: a + b * np.sin(x / 10), start={"a": 0, "b": 1})
    assert found["a"][0] == pytest.approx(3) and found["b"][0] == pytest.approx(2)


def test_what_is_no_form_is_refused() -> None:
    with pytest.raises(NoLine, match="there is no form"):
        fit_line(X, X, np.eye(X.size), "bell")
    with pytest.raises(NoLine, match="too few"):
        fit_line(X[:5], X[:5], np.eye(5), "ramsey")


def test_centres_become_fields_and_gyromagnetic_ratios_with_their_covariance() -> None:
    x = np.linspace(280e3, 304e3, 241)
    y = 1 - 0.5 * lorentz(x - 288e3, 1500.0) - 0.3 * lorentz(x - 295e3, 1500.0)
    fitted = fit_line(x, y, np.eye(x.size) * 1e-6, "lorentz", lines=2)
    distance, *fields = derived(fitted, "Hz", 29.1646935e6, None)
    assert distance.split()[:4] == ["centre_2", "-", "centre_1", "7.0000"] or "7.000" in distance
    assert sorted(float(field.split()[1]) for field in fields) == pytest.approx([9.8750, 10.1150], abs=2e-3)  # mT
    g = derived(fit_line(x, 1 - 0.5 * lorentz(x - 291.646935e3, 1500.0), np.eye(x.size) * 1e-6, "lorentz"), "Hz", None, 10e-3)
    assert float(g[1].split()[1]) == pytest.approx(3.826085, abs=2e-4) and "nuclear magnetons" in g[1]
    assert g[0].startswith("γ/2π ") and float(g[0].split()[1]) == pytest.approx(29.1646935e6, abs=2e3) and g[0].endswith("Hz/T")


def test_lines_are_numbered_by_rising_centre_whichever_is_deeper() -> None:
    for depths in ((0.6, 0.3), (0.3, 0.6)):
        y = 1 - sum(depth * FORMS["lorentz"].f(X - centre, 20.0) for depth, centre in zip(depths, (28900, 29100)))
        found = fit_line(X, y, np.eye(X.size) * 1e-6, "lorentz", lines=2)
        assert [found[f"centre_{i}"][0] for i in (1, 2)] == pytest.approx([28900, 29100], abs=0.1)
        assert [-found[f"contrast_{i}"][0] for i in (1, 2)] == pytest.approx(depths, abs=0.01) and found.others == ()
        assert all(error < 1 for error in found.errors[:2])


def test_times_over_a_field_have_a_unit() -> None:
    x = np.linspace(0.2, 0.3, 101)
    (line,) = (line for line in described(fit_line(x, 1 - 0.5 * FORMS["sinc2"].f(x - 0.25, 60.0), np.eye(x.size) * 1e-6, "sinc2"), "T") if line.startswith("time"))
    assert line.endswith(" 1/T")


def test_a_flat_curve_has_no_line_and_another_form_is_told() -> None:
    with pytest.raises(NoLine, match="the curve is flat"):
        fit_line(X, np.ones(X.size), np.eye(X.size) * 1e-6, "ramsey")
    with pytest.raises(NoLine, match="the curve is flat within its errors"):
        fit_line(X, 0.01 + 1e-6 * lorentz(X - 29000, 40.0), np.eye(X.size) * 1e-8, "rabi")
    box = np.where(np.abs(X - 29000) < 30, 0.0, 1.0)
    assert "the form does not describe the curve: believe the centre of a symmetric line" in described(fit_line(X, box, np.eye(X.size) * 1e-6, "gauss"), "Hz")[-1]
    bell = fit_line(X, 1 - FORMS["gauss"].f(X - 29000, 40.0), np.eye(X.size) * 1e-6, "gauss")
    assert described(bell, "Hz")[-1].startswith("chi²")


def test_counts_over_kilohertz_are_fitted_in_hertz(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    counts = 1000 - 800 * FORMS["gauss"].f(X - 29003.0, 40.0)
    rows = "".join(f"{x / 1e3:.4f},{round(n)}\n" for x, n in zip(X, counts))
    (tmp_path / "a.csv").write_text("RF.frequency [kHz],counts\n" + rows)
    assert main(["fit-line", str(tmp_path / "a.csv"), "--form", "gauss", "--per-field", "29.1646935 MHz/T"]) == 0
    said = capsys.readouterr().out
    assert "centre     29.003" in said and "field      994.4" in said and " µT" in said


def test_the_central_fringe_is_found_or_told_among_its_neighbours() -> None:
    x = np.linspace(28664.7, 29664.7, 41)
    for seed in range(3):
        for times in (1, 100):
            clean = times * (19000 - 17000 * FORMS["ramsey"].f(x - 29170.0, 1100.0, 1.25e-4, 2.5e-3, 0.05))
            y = np.random.default_rng(seed).poisson(clean).astype(float)
            found = fit_line(x, y, np.diag(y), "ramsey")
            centres = [found["centre"][0], *(centre for (centre,), _ in found.others)] if times == 1 else [found["centre"][0]]
            assert min(abs(centre - 29170) for centre in centres) < 10, (seed, times)
    assert "or another fringe" in "".join(described(replace(found, others=(((29358.9,), 30.0),)), "Hz"))


@pytest.mark.parametrize("spread", [0.02, 0.1, 0.25])
@pytest.mark.parametrize("tip", [0.12, 0.25])
@pytest.mark.parametrize("contrast", [0.3, -0.3])
def test_clean_fringes_are_found_wherever_they_are(spread: float, tip: float, contrast: float) -> None:
    """Of few and of many fringes, by pulses of an eighth and of a quarter turn."""
    time, pulse = 4e-3, 0.8e-3
    period = 1 / (time + 4 / np.pi * pulse)
    x, centre = np.linspace(-3 * period, 3 * period, 91), 0.45 * period
    y = 0.4 + contrast * ramsey(x - centre, tip / pulse, pulse, time, spread)
    found = fit_line(x, y, np.eye(x.size) * 4e-6, "ramsey")
    assert found.values[0] == pytest.approx(centre, abs=1e-3 * period)


@pytest.mark.parametrize(("pulses", "fringes", "off"), [(1 / 20, 4, 0.23), (1 / 60, 10, 0.23), (1 / 60, 10, -0.31), (1 / 60, 30, 0.23), (1 / 60, 30, -0.31)])
def test_fringes_of_nearly_one_speed_end_at_none_of_their_neighbours(pulses: float, fringes: int, off: float) -> None:
    """They fall off by so little from one to the next that a start beside the centre has to go on to it."""
    time, extent = 0.02, fringes / 0.02
    x = np.linspace(-extent / 2, extent / 2, max(41, 8 * fringes + 1))
    y = 0.1 + 0.8 * ramsey(x - off * extent, 1 / (4 * pulses * time), pulses * time, time, 0.01)
    found = fit_line(x, y, np.eye(x.size) * 1e-6, "ramsey")
    assert found["centre"][0] == pytest.approx(off * extent, abs=0.05 / time)


@pytest.mark.parametrize(("start", "reason"), [
    ({"centre": 1e308}, "`centre` starts at 1e\\+308, far outside the scan"), ({"strength": np.nan}, "`strength` starts at nan, and must be above 0"),
    ({"time": -1.0}, "`time` starts at -1, and must be above 0"), ({"width": 1.0}, "has no start for `width` \\(it has centre, strength, time\\)")])
def test_a_start_that_cannot_be_is_named(start: dict[str, float], reason: str) -> None:
    with pytest.raises(NoLine, match=reason):
        fit_line(X, rabi(X - 29000, 12.0, 0.03), np.eye(X.size), "rabi", start=start)


def test_a_curve_with_values_that_are_no_numbers_is_refused() -> None:
    with pytest.raises(NoLine, match="infinite or no numbers"):
        fit_line(X, np.where(X > 29000, np.nan, 1.0), np.eye(X.size))


def test_starts_that_lead_nowhere_warn_of_nothing() -> None:
    y = 0.1 + 0.8 * rabi(X - 29000.0, 12.0, 0.03)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name in ("strength", "time"):
            for value in (1e-300, 1e300):
                fit_line(X, y, np.eye(X.size) * 1e-4, "rabi", start={name: value})


def test_the_fitted_form_is_drawn_between_the_points_too() -> None:
    few = X[::6]
    fitted = fit_line(few, 0.1 + 0.8 * lorentz(few - 29003.0, 20.0), np.eye(few.size) * 1e-4, "lorentz")
    drawn = draw_line(few, fitted.expected, np.full(few.size, 0.01), fitted, "f", "Hz", "", ["words"], "counts").axes[0].get_lines()[-1]
    top = drawn.get_ydata().max()
    assert drawn.get_xdata().size > 400 and top == pytest.approx(0.9, abs=1e-3) and top > fitted.expected.max() + 0.01
    assert fitted.curve(few) == pytest.approx(fitted.expected)
    plt.close("all")


@pytest.mark.parametrize(("table", "reason"), [
    ("C.frequency [Hz] counts\n1 2\n2 3\n", "line 1: a comma stands between columns, not a blank"),
    ("1,2\n2,3\n", "line 1: the names of the columns are missing\n  help: write a line above it such as `C.frequency [kHz],counts`"),
    ("C.frequency [Hz],counts\n1,5,2\n", "line 2: 3 values in 2 columns\n  help: a comma stands between columns, and numbers have a point"),
    ("C.frequency [Hz],counts\n1,\n2,3\n", "line 2: a number of the column `counts` is missing"),
    ("C.frequency [Hz],counts,seconds [weeks]\n1,2,1\n2,3,1\n", "line 1: `seconds` has the unit `weeks`: unknown unit weeks\n  help: write `seconds [s]`"),
    ("f [kHz],counts,counts\n1,1,1\n2,4,4\n", "line 1: the column `counts` is there twice"),
    ("# mine\nf [kHz],counts\n", "line 2: nothing stands below the names of the columns"),
    ("f [kHz],counts,emitted\n1,1,5\n2,14,10\n", "line 3: more counts than particles were emitted"),
    ("f [kHz],counts\n1,1e308\n2,3\n", "line 2: `1e308` is out of range (counts)"), ("f [kHz],counts\n1,1\n2,inf\n", "line 3: `inf` is out of range (counts)"),
    ("f [kHz],counts\n1e308,1\n2,3\n", "line 2: `1e308` is out of range (f)"), ("f [kHz],counts,seconds\n1,1,2\n2,3,nan\n", "line 3: `nan` is out of range (seconds)"),
])
def test_a_table_of_counts_that_cannot_be_is_told_its_line(tmp_path: Path, table: str, reason: str) -> None:
    (tmp_path / "a.csv").write_text(table)
    with pytest.raises(FileError) as caught:
        read_counts(tmp_path / "a.csv")
    assert str(caught.value) == f"{tmp_path / 'a.csv'}: {reason}"


def test_more_counts_than_were_emitted_may_be_background_where_a_time_is_stated(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("f [kHz],counts,emitted,seconds\n1,1,5,1\n2,14,10,1\n")
    assert read_counts(tmp_path / "a.csv").counts.tolist() == [1, 14]


def test_times_may_have_their_unit_in_the_header(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("f [kHz],counts,seconds [ms]\n1,1,500\n2,14,250\n")
    assert read_counts(tmp_path / "a.csv").seconds == pytest.approx([0.5, 0.25])


def weak_table(path: Path, form: str = "rabi") -> Path:
    """Counts without noise over kilohertz about 29.165 kHz: of a field of 50 Hz for 100 µs, or of two such."""
    x = np.linspace(24e3, 34e3, 161)
    shape = rabi(x - 29165.0, 50.0, 1e-4) if form == "rabi" else ramsey(x - 29165.0, 1100.0, 1.25e-4, 1e-3, 0.05)
    counts = np.rint(1000 + 4000 * shape / shape.max())
    path.write_text("RF.frequency [Hz],counts\n" + "".join(f"{at},{n:.0f}\n" for at, n in zip(x, counts)))
    return path


def test_a_clean_line_of_a_weak_field_has_its_centre_in_the_form_by_default(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["fit-line", str(weak_table(tmp_path / "a.csv"))]) == 0
    said = capsys.readouterr().out
    assert said.startswith("form       rabi\ncentre     2916") and "the field is weak: its strength and the contrast cannot be told apart; --form sinc2" in said
    assert "rabi is the form by default" in said and "does not describe" not in said


@pytest.mark.parametrize("strength", [1.0, 10.0, 40.0])
def test_weaker_and_weaker_fields_converge(strength: float) -> None:
    x = np.linspace(24e3, 34e3, 81)
    found = fit_line(x, 0.01 + 1e-4 * rabi(x - 29165.0, strength, 1e-4) / rabi(np.zeros(1), strength, 1e-4), np.eye(x.size) * 1e-12, "rabi")
    assert found["centre"][0] == pytest.approx(29165, abs=1) and found["time"][0] == pytest.approx(1e-4, rel=0.1)


def test_a_start_that_leads_beyond_all_numbers_does_not_converge() -> None:
    with pytest.raises(NoLine, match="does not converge"):
        fit_line(X, lorentz(X - 29000, 20.0), np.eye(X.size), lambda x, a: np.full(x.size, np.inf), start={"a": 1.0})


def test_no_fit_is_worse_than_its_best_start() -> None:
    def refined(centres: list[float], _: object) -> LineFit:
        if centres == [1.0]:
            raise NoLine("lost")
        return fit_line(X, lorentz(X - 29000, 20.0), np.eye(X.size) * 1e-6, "gauss")

    with pytest.raises(NoLine, match="lost"):
        _minima(refined, [(38.0, [1.0], ()), (90.0, [2.0], ())], lambda fit: [], 9.0)


def test_fringes_in_the_form_by_default_are_pointed_to_ramsey(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    table = str(weak_table(tmp_path / "a.csv", "ramsey"))
    assert main(["fit-line", table]) == 0
    said = capsys.readouterr().out
    assert "believe none of these numbers" in said and "help: the form ramsey describes the curve far better" in said
    assert main(["fit-line", table, "--form", "lorentz"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("form       lorentz\n") and "by default" not in said


def test_a_start_has_a_unit_or_is_in_si(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    table = str(weak_table(tmp_path / "a.csv"))
    for start in ("centre=29 kHz", "centre=29000", "time=90 us"):
        assert main(["fit-line", table, "--start", start]) == 0
        assert "centre     2916" in capsys.readouterr().out
    for start, reason in (("centre=29 ms", "ms is not a unit of the kind of Hz"), ("centre=x", "could not convert"), ("centre", "it has no number")):
        assert main(["fit-line", table, "--start", start]) == 2
        assert f"--start {start}: it is NAME=VALUE, such as centre=29 kHz ({reason}" in capsys.readouterr().err


def test_the_picture_names_the_form() -> None:
    found = fit_line(X, 1 - FORMS["gauss"].f(X - 29000, 40.0), np.eye(X.size) * 1e-6, "gauss")
    figure = draw_line(X, found.expected, np.ones(X.size), found, "f", "Hz", "", described(found, "Hz"), "counts")
    assert figure.axes[0].get_title().startswith("form gauss")
    plt.close("all")


@pytest.mark.parametrize("name, unit", [("H0.frequency", "Hz"), ("C.field", "T"), ("coil.current", "A")])
def test_a_column_without_its_unit_is_refused_as_by_a_fit_of_the_experiment(tmp_path: Path, capsys: pytest.CaptureFixture, name: str, unit: str) -> None:
    path = tmp_path / "counts.csv"
    path.write_text(f"{name},counts\n" + "".join(f"{x},{100 + 100 * (x == 5)}\n" for x in range(11)), encoding="utf-8")
    assert main(["fit-line", str(path)]) == 2
    assert capsys.readouterr().err == f"rabiline: {path}: the column `{name}`: it has no unit\n  help: write `{name} [{unit}]`\n"


@pytest.mark.parametrize("unit", ["hz", "T"])
def test_a_frequency_in_another_unit_is_refused(unit: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "counts.csv"
    path.write_text(f"RF.frequency [{unit}],counts\n1,2\n2,3\n")
    assert main(["fit-line", str(path)]) == 2
    assert f"`RF.frequency`: `{unit}` is no unit of a frequency" in capsys.readouterr().err


def test_a_result_is_no_table_of_counts(tmp_path: Path) -> None:
    path = write_results(tmp_path / "a.h5", [frequencies(5)], np.ones(5), law=["quantum"], bins=4)
    with pytest.raises(FileError, match="a table of counts belongs here \\(CSV\\), and this is an HDF5 file$"):
        read_counts(path)


def test_a_curve_of_nothing_says_so() -> None:
    with pytest.raises(NoLine, match="nothing was detected"):
        fit_line(X, np.zeros(X.size), np.eye(X.size) * 1e-6, "gauss")


def test_few_counts_are_fitted_as_poisson_has_them() -> None:
    """With errors of root n a baseline of three counts comes out lower by three of its errors."""
    generator, pulls = np.random.default_rng(9), []
    for _ in range(30):
        found = fit_line(X, generator.poisson(3 + 20 * lorentz(X - 29003.0, 40.0)).astype(float), Poisson(), "lorentz")
        pulls.append([(found[name][0] - true) / found[name][1] for name, true in (("centre", 29003), ("width", 40), ("contrast", 20), ("baseline", 3))])
    assert (np.abs(np.mean(pulls, axis=0)) < 3.5 / np.sqrt(30)).all() and (np.std(pulls, axis=0) < 1.5).all()
    assert "without correlations" not in str(found)


def test_the_centre_of_a_faint_dip_is_as_far_off_as_it_says() -> None:
    """At six counts, or eighteen, a point: the likelihood of the centre is no parabola, and one point that is low by chance makes a line by itself. Two
    may be peaks that there are by chance."""
    generator, pulls, x = np.random.default_rng(3), [], np.linspace(28.0, 30.0, 41)
    exposure = np.where(np.arange(41) % 3 == 0, 3.0, 1.0)
    for _ in range(40):
        counts = generator.poisson(6 * exposure * (1 - 0.6 * lorentz(x - 29.05, 0.3)))
        centre, error = fit_line(x, counts / exposure, Poisson(exposure), "lorentz")["centre"]
        pulls.append((centre - 29.05) / error)
    assert np.sum(np.abs(pulls) > 4) <= 2 and np.std(np.sort(pulls)[2:-2]) < 1.5, pulls


@pytest.mark.parametrize("column", ["seconds", "emitted"])
def test_counts_are_divided_by_what_was_not_alike_at_all_points(tmp_path: Path, capsys: pytest.CaptureFixture, column: str) -> None:
    each = np.where(X < 29000, 1e4, 4e4)
    counts = np.rint(each * (0.02 + 0.3 * lorentz(X - 29003.0, 40.0)))
    (tmp_path / "a.csv").write_text(f"C.frequency [Hz],counts,{column}\n" + "".join(f"{x},{n:.0f},{t}\n" for x, n, t in zip(X, counts, each)))
    assert main(["fit-line", str(tmp_path / "a.csv"), "--form", "lorentz"]) == 0
    said = capsys.readouterr().out
    told = {line.split()[0]: line for line in said.splitlines() if not line.startswith(" ")}
    assert re.search(r"2900[23]\.\d+ ± 0\.\d+ Hz", told["centre"]) and "0.30" in told["contrast"] and "0.020" in told["baseline"]
    assert f"are in counts / {'s' if column == 'seconds' else 'emitted'}" in said


def test_lines_that_blend_are_where_they_say() -> None:
    """Two dips of .5 and .3 that are 16 apart and 20 wide: errors of a parabola at the first minimum that is found are up to ten too small."""
    x, random, pulls = np.linspace(-100, 100, 41), np.random.default_rng(3), []
    for _ in range(8):
        counts = random.poisson(3000 * (0.9 - 0.5 * lorentz(x + 8, 20) - 0.3 * lorentz(x - 8, 20))).astype(float)
        found = fit_line(x, counts, Poisson(), "lorentz", lines=2)
        assert found.p > 1e-3
        pulls.append([(found[name][0] - true) / found[name][1] for name, true in {"centre_1": -8, "centre_2": 8, "width": 20}.items()])
    assert np.abs(pulls).max() < 3.5 and np.sqrt(np.mean(np.square(pulls))) < 1.4


def test_where_one_line_is_two_are_not_known() -> None:
    """The best of all curves with two lines has one of them anywhere, and at times beyond the scan, with errors of nothing."""
    x = np.linspace(-100, 100, 41)
    for seed in (0, 6, 8):
        counts = np.random.default_rng(seed).poisson(3000 * (0.9 - 0.7 * sinc2(x, 0.018))).astype(float)
        try:
            found = fit_line(x, counts, Poisson(), "sinc2", lines=2)
        except NoLine as problem:
            assert seed == 8 and "does not show 2 lines" in str(problem)
            continue
        assert min(abs(found[name][0]) / found[name][1] for name in ("centre_1", "centre_2")) < 1
        assert found["centre_1"][1] > 8, seed  # the error of one line alone is .2
