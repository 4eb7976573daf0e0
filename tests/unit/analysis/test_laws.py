"""Laws compared by command: templates from files, tables and results as data, words, pictures, errors."""
from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from rabiline import observed, results
from rabiline.__main__ import main
from rabiline.covariance import ChiSquared
from rabiline.kappa import Bound, profile
from rabiline.kappa_plots import draw_profile
from rabiline.likelihood import separation
from rabiline.templates import LEAST, gather, models, spread_over_bins, templates
from rabiline.verdict import Fit, Pair, Verdict, verdict
from synthetic import DORADO, Axis, dip, frequencies, laws, write_results

pytestmark = pytest.mark.slow

POINTS = 11
STRENGTHS = np.linspace(0, 2, 21)


def mark_independent(path: Path, rate: float | None = None) -> Path:
    with h5py.File(path, "a") as file:
        file["entry/simulation/particles"] = "independent"
        if rate is not None:
            file["entry/rate"] = rate
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Small files of every kind."""
    folder = tmp_path_factory.mktemp("laws")
    axis = frequencies(POINTS)
    y = 1 - 0.6 * (1 - dip(axis.values, width=16e3, steepness=2))
    ones, two = np.full(POINTS, 0.9), ["quantum"] * POINTS + [DORADO] * POINTS
    for name, detected, seed in (("laws", np.concatenate([ones, 0.9 * y]), 1938), ("same", np.tile(ones, 2), 1938)):
        mark_independent(write_results(folder / f"{name}.h5", [laws("quantum", DORADO), axis], detected, law=two,
                                       bins=16, seed=seed))
    write_results(folder / "shared.h5", [laws("quantum", DORADO), axis], np.concatenate([ones, y]), law=two, bins=16)
    write_results(folder / "only_laws.h5", [laws("quantum", "classical", DORADO)], np.array([0.9, 0.9, 0.4]),
                  law=["quantum", "classical", DORADO], bins=16)
    mark_independent(write_results(folder / "two.h5", [laws("quantum", DORADO)], np.array([[0.5, 0.3], [0.2, 0.4]]),
                                   law=["quantum", DORADO], detectors=("near", "far"), bins=8), rate=1e5)
    for name, detected in (("quantum", ones), ("dorado", 0.9 * y), ("neither", 1.8 - 0.9 * y - ones / 2)):
        mark_independent(write_results(folder / f"{name}.h5", [axis], detected, law=["quantum"], particles=2000,
                                       bins=16, seed=7))
        counts = np.random.default_rng(3).poisson(500 * detected)
        lines = [f"{x / 1e3:.6g},{n}" for x, n in zip(axis.values, counts)]
        (folder / f"{name}.csv").write_text("# a comment\nH0.frequency (kHz),counts\n" + "\n".join(lines))
    write_results(folder / "quantum_shared.h5", [axis], ones, law=["quantum"], bins=16)
    caught = 0.9 * (1 - 0.8 * np.sin(np.pi * STRENGTHS / 2) ** 2)
    names = [f"dorado (torque, kappa = {value:g})" for value in STRENGTHS]
    write_results(folder / "kappa.h5", [Axis("law.kappa", STRENGTHS)], caught, law=names, bins=8)
    mark_independent(write_results(folder / "noisy.h5", [Axis("law.kappa", STRENGTHS)], caught, law=names, bins=8))
    (folder / "one.csv").write_text("counts,emitted\n897,1000\n")
    (folder / "many.csv").write_text("counts,emitted\n89700,100000\n")
    (folder / "image.csv").write_text("x (mm),z (mm),counts\n0.0625,0.0625,3\n")
    return folder


def run(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, command: str) -> tuple[str, str]:
    monkeypatch.chdir(folder)
    assert main(command.split()) == 0
    told = capsys.readouterr()
    return told.out, told.err


def test_cells_cover_each_bin_once_and_hold_enough(folder: Path) -> None:
    made = templates(results.read(folder / "laws.h5"), "law")
    screen = made.screens[0]
    assert made.names == ("quantum", DORADO) and made.points == POINTS and made.independent
    assert (np.unique(screen.cells) == np.arange(screen.cells.max() + 1)).all()
    counts = np.max([gather(screen, law) for law in screen.counts], axis=0) * made.emitted[0]
    assert counts.min() >= LEAST * (1 - 1e-9)
    values = np.arange(screen.cells.max() + 1.0)
    assert gather(screen, spread_over_bins(screen, values)) == pytest.approx(values)


@pytest.mark.parametrize("histogram", ["image", "x", "z", "detected"])
def test_models_keep_what_each_detector_caught(folder: Path, histogram: str) -> None:
    made = templates(results.read(folder / "laws.h5"), "law", histogram)
    for law, model in enumerate(models(made, 500.0, [3.0])):
        assert model.signal.sum() == pytest.approx(500 * made.screens[0].totals[law].sum(), rel=1e-3)
        assert model.background.sum() == pytest.approx(3 * POINTS)
        assert model.signal.min() > 0 and model.k.min() > 0


def test_the_order_of_the_axes_does_not_matter(folder: Path, tmp_path: Path) -> None:
    y = np.concatenate([np.full(POINTS, 0.9), 0.9 * dip(frequencies(POINTS).values)])
    swapped = y.reshape(2, POINTS).T.ravel()
    one = write_results(tmp_path / "one.h5", [laws("quantum", DORADO), frequencies(POINTS)], y, bins=8,
                        law=["quantum"] * POINTS + [DORADO] * POINTS)
    other = write_results(tmp_path / "other.h5", [frequencies(POINTS), laws("quantum", DORADO)], swapped, bins=8,
                          law=["quantum", DORADO] * POINTS)
    found = [models(templates(results.read(path), "law"), 100.0) for path in (one, other)]
    q = [separation(*pair).q for pair in found]
    assert q[0] == pytest.approx(q[1])


def test_the_words_say_how_many_particles_and_where(folder: Path, monkeypatch: pytest.MonkeyPatch,
                                                    capsys: pytest.CaptureFixture) -> None:
    out, err = run(folder, monkeypatch, capsys, "compare-laws laws.h5")
    assert "quantum against dorado (hypothesis), torque, κ = 1\n" in out and not err
    assert "5 sigma in half of the measurements takes\n      quantum true: " in out
    assert "at each of 11 points" in out and "half of it is in H0.frequency 291.6 kHz to 296.6 kHz (2 of 11" in out


def test_a_rate_gives_the_time_and_a_background_makes_it_longer(folder: Path, monkeypatch: pytest.MonkeyPatch,
                                                                capsys: pytest.CaptureFixture) -> None:
    out, _ = run(folder, monkeypatch, capsys, "compare-laws laws.h5 --histogram detected --rate 10")
    noisy, _ = run(folder, monkeypatch, capsys, "compare-laws laws.h5 --histogram detected --rate 10 --background 50")

    def particles(text: str) -> float:
        return float(text.split("quantum true: ")[2].split(" particles")[0])

    assert " of beam" in out and particles(noisy) > 2 * particles(out)


def test_detectors_come_one_by_one_and_together(folder: Path, monkeypatch: pytest.MonkeyPatch,
                                                capsys: pytest.CaptureFixture) -> None:
    out, _ = run(folder, monkeypatch, capsys, "compare-laws two.h5")
    assert "detector near\n" in out and "detector far\n" in out and "all detectors together\n" in out
    assert "of beam" in out  # the file states a rate
    out, _ = run(folder, monkeypatch, capsys, "compare-laws two.h5 --detector far")
    assert "near" not in out and "together" not in out


def test_equal_predictions_are_called_that(folder: Path, monkeypatch: pytest.MonkeyPatch,
                                           capsys: pytest.CaptureFixture) -> None:
    out, _ = run(folder, monkeypatch, capsys, "compare-laws same.h5 --data quantum.csv --emitted 500")
    assert "no number of particles tells them apart here" in out
    assert "so cannot tell quantum and dorado (hypothesis), torque, κ = 1 apart: they predict the same" in out


@pytest.mark.parametrize(("data", "words"), [
    ("quantum.csv --emitted 500", "so the data favour quantum: it fits"),
    ("dorado.csv --emitted 500", "so the data favour dorado (hypothesis), torque, κ = 1: it fits"),
    ("neither.csv --emitted 500", "so neither fits"),
    ("quantum.csv", "flux fitted"),
    ("dorado.csv --free-flux", "so the data favour dorado (hypothesis)"),
    ("quantum.h5", "so the data favour quantum"),
    ("dorado.h5", "so the data favour dorado (hypothesis)"),
])
def test_data_favour_the_law_they_come_from(folder: Path, monkeypatch: pytest.MonkeyPatch,
                                            capsys: pytest.CaptureFixture, data: str, words: str) -> None:
    out, err = run(folder, monkeypatch, capsys, f"compare-laws laws.h5 --data {data}")
    assert words in out and not err


def test_a_pair_is_chosen_with_the_reference(folder: Path, monkeypatch: pytest.MonkeyPatch,
                                             capsys: pytest.CaptureFixture) -> None:
    out, _ = run(folder, monkeypatch, capsys, "compare-laws only_laws.h5 --reference classical --data one.csv")
    assert out.count(" against ") - out.count("as much against ") == 2 and "classical against quantum\n" in out
    assert "so cannot tell quantum and classical apart: they predict the same here" in out


def test_results_that_share_particles_are_warned_of(folder: Path, monkeypatch: pytest.MonkeyPatch,
                                                    capsys: pytest.CaptureFixture) -> None:
    _, err = run(folder, monkeypatch, capsys, "compare-laws shared.h5 --data quantum_shared.h5")
    assert "the seed 1938 and may share" in err and "the scan points of quantum_shared.h5 share" in err
    assert "the scan points of shared.h5 share" in err


@pytest.mark.parametrize("command", [
    "compare-laws laws.h5", "compare-laws laws.h5 --histogram x --data quantum.h5", "compare-laws only_laws.h5",
    "compare-laws laws.h5 --histogram detected --data dorado.csv", "compare-laws two.h5 --histogram z",
    "compare-laws only_laws.h5 --histogram detected --data one.csv", "compare-laws same.h5",
    "bound-kappa kappa.h5 --data one.csv", "bound-kappa kappa.h5 --emitted 1000",
])
def test_every_picture_is_drawn(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                capsys: pytest.CaptureFixture, command: str) -> None:
    run(folder, monkeypatch, capsys, f"{command} -o {tmp_path / 'picture.png'}")
    assert (tmp_path / "picture.png").read_bytes().startswith(b"\x89PNG")


def test_kappa_is_bounded_next_to_zero_and_the_return_is_told(folder: Path, monkeypatch: pytest.MonkeyPatch,
                                                              capsys: pytest.CaptureFixture) -> None:
    out, _ = run(folder, monkeypatch, capsys, "bound-kappa kappa.h5 --data one.csv")
    assert "law          dorado (hypothesis): torque; κ from 0 to 2, 21 points" in out
    bound = float(out.split("bound        0 ≤ κ ≤ ")[1].split()[0])
    # 0.9 (1 - 0.8 sin²(π κ/2)) 1000 is 897 - 1.96 √897 at κ = 0.18
    assert "counts       one.csv; 897 in all, flux " in out
    assert 0.12 < bound < 0.25 and "also " in out and "2 (end of the scan) is accepted" in out


def test_the_picture_of_a_bound_names_the_law_and_the_counts(folder: Path) -> None:
    made = templates(results.read(folder / "kappa.h5"), "law.kappa")
    found = Bound(profile(STRENGTHS, (STRENGTHS / 0.5) ** 2), "one.csv", 897.0, True, 0.5, 300)
    words = draw_profile(made, found, None)._suptitle.get_text().splitlines()
    assert words[1:] == ["dorado (hypothesis): torque", "counts: one.csv"]


@pytest.mark.parametrize(("command", "message"), [
    ("compare-laws quantum.h5", "quantum.h5: its scan runs over H0.frequency, not over law; make one with `rabiline "
                                "run FILE --scan law=quantum,dorado`"),
    ("compare-laws laws.h5 --reference classical", f"laws.h5: no law `classical` (there is quantum, {DORADO})"),
    ("compare-laws laws.h5 --background 3",
     "--background needs --rate, the particles that leave the source per second"),
    ("compare-laws laws.h5 --rate 3 --background 3 --data quantum.csv",
     "counts without a beam are stated, and not for how long: --seconds, the time at each scan point of the data"),
    ("compare-laws laws.h5 --detector far", "laws.h5: no detector `far` (there is screen)"),
    ("compare-laws laws.h5 --data quantum.csv --histogram x",
     "quantum.csv: its columns are those of --histogram detected, not x"),
    ("compare-laws laws.h5 --data image.csv", "image.csv: no column `H0.frequency`, over which laws.h5 scans"),
    ("compare-laws only_laws.h5 --data quantum.h5",
     "quantum.h5: its scan runs over H0.frequency, and data for only_laws.h5 over nothing, under one law"),
    ("compare-laws two.h5 --data one.csv", "one.csv: no column `detector`, and two.h5 has several: choose one with "
                                           "--detector"),
    ("bound-kappa laws.h5 --emitted 3",
     "laws.h5: its scan runs over law and H0.frequency, not over law.kappa; make one with "
     "`rabiline run FILE --scan law.kappa=0:0.02:41`"),
    ("bound-kappa noisy.h5 --data many.csv",
     "noisy.h5: each κ was simulated with particles of its own, and by that alone -2 ln L scatters by 1.4 from one κ "
     "to the next; run it without scan.particles=independent, or with more particles"),
    ("bound-kappa kappa.h5", "without --data: --emitted, the particles at each scan point for which to tell the bound"),
])
def test_bad_input_is_one_line_and_exit_code_2(folder: Path, monkeypatch: pytest.MonkeyPatch,
                                               capsys: pytest.CaptureFixture, command: str, message: str) -> None:
    monkeypatch.chdir(folder)
    assert main(command.split()) == 2
    assert capsys.readouterr().err == f"rabiline: {message}\n"


@pytest.mark.parametrize(("data", "message"), [(".", ".: is not a file"), ("missing.csv", "missing.csv: no such file")])
def test_a_table_that_cannot_be_read_is_one_line_and_exit_code_3(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture,
                                                                 data: str, message: str) -> None:
    monkeypatch.chdir(folder)
    assert main(["compare-laws", "laws.h5", "--data", data]) == 3
    assert capsys.readouterr().err == f"rabiline: {message}\n"


def test_an_ending_that_is_no_picture_is_exit_code_2(folder: Path, tmp_path: Path,
                                                     capsys: pytest.CaptureFixture) -> None:
    assert main(["compare-laws", str(folder / "laws.h5"), "-o", str(tmp_path / "picture.doc")]) == 2
    assert "picture.doc: a picture's name ends in .png, .pdf or .svg\n" in capsys.readouterr().err


def test_a_number_that_is_none_is_one_line(capsys: pytest.CaptureFixture) -> None:
    with pytest.raises(SystemExit) as left:
        main(["compare-laws", "laws.h5", "--rate", "-3"])
    assert left.value.code == 2
    assert capsys.readouterr().err == "rabiline: argument --rate: `-3` is no rate above 0: write a number per second, such as 4e4, or `4e4 /s`, `2.4e6 /min` (see --help)\n"


@pytest.mark.parametrize(("table", "message"), [
    ("", "an empty table"),
    ("x,n\n1,2\n", "line 1: no column `counts` (columns: "),
    ("H0.frequency (kHz),counts,wind\n", "what is the column `wind`?"),
    ("H0.frequency (furlong),counts\n", "line 1, column `H0.frequency`: "),
    ("H0.frequency (kHz),counts\n266.6\n", "line 2: 1 value in 2 columns"),
    ("counts\n266.6,3,4\n", "line 2: 3 values in 1 column"),
    ("H0.frequency (kHz),counts\n266.6,many\n", "line 2: `many` is no number (counts)"),
    ("H0.frequency (kHz),counts\n266.6,-1\n", "line 2: counts = -1 is out of range"),
    ("H0.frequency (kHz),counts\n266.6,1.5\n", "counts must be whole numbers"),
    ("H0.frequency (kHz),counts\n270,1\n", "line 2: H0.frequency = 270 kHz is no scan point of the result; the "
                                           "nearest is 271.6 kHz"),
    ("H0.frequency (kHz),counts\n266.6,1\n266.6,1\n", "line 3: counts for this bin stand in an earlier line too"),
    ("H0.frequency (kHz),x (mm),counts\n266.6,0.1,1\n",
     "line 2: x from -25 µm to 225 µm is no bin of the result; the nearest is 0 m to 250 µm"),
    ("H0.frequency (kHz),counts\n", "no counts in it"),
])
def test_a_bad_table_says_where(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture, table: str,
                                message: str) -> None:
    (tmp_path / "bad.csv").write_text(table)
    assert main(["compare-laws", str(folder / "laws.h5"), "--data", str(tmp_path / "bad.csv")]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1 and f"bad.csv: {message}" in told


def test_points_that_were_not_measured_do_not_count(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                                    capsys: pytest.CaptureFixture) -> None:
    lines = (folder / "dorado.csv").read_text().splitlines()
    (tmp_path / "few.csv").write_text("\n".join(lines[:5]))
    out, _ = run(folder, monkeypatch, capsys, f"compare-laws laws.h5 --data {tmp_path / 'few.csv'} --emitted 500")
    assert "counts in 3 cells" in out and "so cannot tell" in out


def _verdict(p: tuple[float, float], ratio_p: tuple[float, float], same: bool = False) -> str:
    fits = tuple(Fit(10.0 * i, value, 0, ChiSquared(1, 1, value)) for i, value in enumerate(p))
    return Verdict(("A", "B"), fits, (Pair(0, 1, 1.0, ((1, 1), (-1, 1)), ratio_p, same),), 2000).words


def test_the_conclusion_follows_from_the_numbers() -> None:
    assert _verdict((0.4, 0.0005), (0.5, 1e-9)).startswith("the data favour A")
    assert _verdict((0.4, 0.3), (0.5, 1e-9)).startswith("the data favour A")
    assert _verdict((0.3, 0.4), (1e-9, 0.5)).startswith("the data favour B")
    assert _verdict((0.0005, 0.0005), (0.5, 1e-9)).startswith("neither fits")
    assert _verdict((0.4, 0.4), (1e-5, 1e-5)).startswith("neither fits: the likelihood ratio lies between")
    assert _verdict((0.4, 0.4), (0.3, 0.2)) == "cannot tell A and B apart: the counts are too few for that"
    assert _verdict((0.4, 0.4), (1, 1), same=True).endswith("they predict the same here, to the last bit")


def test_no_side_is_taken(folder: Path) -> None:
    """Exchanging the laws exchanges the conclusions."""
    made = models(templates(results.read(folder / "laws.h5"), "law"), 300.0)
    n = np.random.default_rng(9).poisson(made[0].expected).astype(float)
    one, other = verdict(["A", "B"], made, n), verdict(["B", "A"], made[::-1], n)
    assert "favour A" in one.words and "favour A" in other.words
    assert one.pairs[0].ratio == pytest.approx(-other.pairs[0].ratio)
    assert one.fits[0].deviance == other.fits[1].deviance


def test_scans_may_run_in_any_order(tmp_path: Path) -> None:
    """Neither of the laws nor of the data."""
    axis, orders = frequencies(21), (np.arange(21), np.random.default_rng(4).permutation(21))
    rows = np.stack([np.full(21, 0.5), 0.5 * dip(axis.values)])
    mixed = [Axis(axis.parameter, axis.values[order], "Hz") for order in orders]
    made = [templates(results.read(write_results(tmp_path / f"laws_{i}.h5", [laws("quantum", DORADO), mixed[i]], rows[:, order].ravel(),
                                                 law=["quantum"] * 21 + [DORADO] * 21, bins=4)), "law") for i, order in enumerate(orders)]
    np.testing.assert_array_equal(made[1].axis.values, axis.values)
    np.testing.assert_array_equal(made[0].screens[0].counts, made[1].screens[0].counts)
    data = [write_results(tmp_path / f"data_{i}.h5", [mixed[i]], rows[1, order], law=[DORADO], bins=4, seed=7) for i, order in enumerate(orders)]
    seen = [observed.read(path, made[0]).counts[0] for path in data]
    np.testing.assert_array_equal(seen[0], seen[1])
