"""The commands: pictures that are there, errors that are one line, exit codes."""
from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from PIL import Image
from rabiline import results
from rabiline.__main__ import main
from synthetic import DORADO, Axis, dip, fly, frequencies, laws, write_results, write_tracks

pytestmark = pytest.mark.slow

PNG = b"\x89PNG"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Small files of every kind."""
    folder = tmp_path_factory.mktemp("files")
    axis = frequencies(41)
    y = dip(axis.values, steepness=4)
    write_results(folder / "laws.h5", [laws("quantum", DORADO), axis], np.concatenate([np.ones(41), y]),
                  law=["quantum"] * 41 + [DORADO] * 41, bins=16)
    write_results(folder / "dorado.h5", [axis], y, law=[DORADO], bins=16)
    write_results(folder / "quantum.h5", [axis], np.ones(41), law=["quantum"], bins=16)
    write_results(folder / "point.h5", [], np.array([1.0]), law=["quantum"], bins=16)
    write_results(folder / "two.h5", [axis], np.stack([y, 1 - y]), law=[DORADO], detectors=("near", "far"), bins=16)
    write_results(folder / "only_laws.h5", [laws("quantum", DORADO)], np.array([1.0, 0.1]), law=["quantum", DORADO],
                  bins=16)
    amplitudes = Axis("H0.amplitude", np.linspace(1e-7, 9e-7, 9), "T")
    write_results(folder / "grid.h5", [amplitudes, axis], np.tile(y, 9), law=[DORADO], bins=4)
    write_results(folder / "grid_of_two.h5", [amplitudes, axis], np.tile([np.tile(y, 9)], (2, 1)) / 2, law=[DORADO],
                  detectors=("near", "far"), bins=4)
    write_results(folder / "cube.h5", [laws("quantum", DORADO), amplitudes, axis], np.tile(y, 18), law=["quantum"] * 9 * axis.values.size
                  + [DORADO] * 9 * axis.values.size, bins=4)
    write_results(folder / "other_seed.h5", [axis], y, law=[DORADO], bins=16, seed=7)
    write_results(folder / "shifted.h5", [axis], dip(axis.values, 292e3, steepness=4), law=[DORADO], bins=16, seed=7)
    write_tracks(folder / "straight.h5", [fly("quantum", 291.65e3)], law="quantum")
    y = np.linspace(0, 1, 50)
    tip = {"sx": np.sin(y), "sy": 0 * y, "sz": -np.cos(y)}
    write_tracks(folder / "turned.h5", [{n: y for n in "t x y z vx vy vz".split()} | tip])
    both = np.minimum(dip(axis.values, 275e3), dip(axis.values, 308e3)) / 2 + 0.5
    write_results(folder / "mixture.h5", [axis], both, law=[DORADO], bins=4)
    write_results(folder / "finer.h5", [frequencies(42)], np.ones(42), law=["quantum"], bins=4)
    (folder / "text.h5").write_text("counts: 7")
    return folder


@pytest.mark.parametrize("command", [
    "plot-scan laws.h5",
    "plot-scan dorado.h5 quantum.h5 --mark Larmor=291.65e3",
    "plot-scan dorado.h5 dorado.h5",
    "plot-scan two.h5",
    "plot-scan two.h5 --detector far",
    "plot-scan grid.h5 --mark Larmor=291.65e3",
    "plot-scan cube.h5",
    "plot cube.h5",
    "plot grid_of_two.h5",
    "plot-scan only_laws.h5",
    "plot-scan mixture.h5",
    "plot-levels dorado.h5 --mark Larmor=291.65e3",
    "plot-levels laws.h5",
    "plot-levels only_laws.h5",
    "plot-levels two.h5 --detector far",
    "plot-image dorado.h5",
    "plot-image quantum.h5",
    "plot-image laws.h5",
    "plot-image point.h5",
    "plot-image two.h5 --detector far --points 0,20,40",
    "plot-profiles only_laws.h5",
    "plot-profiles point.h5 only_laws.h5 --along x --title both",
    "plot-tracks straight.h5 turned.h5 --region B=0.30:0.55 --region H0=0.35:0.55",
    "plot-tracks straight.h5",
])
def test_every_picture_is_drawn(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str) -> None:
    monkeypatch.chdir(folder)
    picture = tmp_path / "picture.png"
    assert main([*command.split(), "-o", str(picture)]) == 0
    assert picture.read_bytes().startswith(PNG)


def test_the_summary_names_the_hypothesis_its_dip_and_the_ledger(folder: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["summary", str(folder / "laws.h5")]) == 0
    text = capsys.readouterr().out
    assert "dorado (hypothesis), torque, κ = 1: " in text
    assert "fit           dip at 291.6" in text and "FWHM 7.3" in text
    assert "quantum: 1 to 1 of emitted\n    if flat       no chi²: no point tells 10 or more particles apart\n" \
           "    no resonance" in text
    assert "weights from the covariance; misfit 0.0" in text
    assert "the ledger closes" in text


def test_control_characters_of_tables_do_not_reach_a_terminal(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    table = tmp_path / "counts.csv"
    table.write_text("f [kHz],counts\n1,8\x1b[31m29\n2,3\n")
    assert main(["fit-line", str(table)]) == 2
    told = capsys.readouterr().err
    assert "`8?[31m29` is no number" in told and "\x1b" not in told


def test_the_summary_repeats_what_the_run_warned_of(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    shutil.copy(folder / "laws.h5", tmp_path / "warned.h5")
    with h5py.File(tmp_path / "warned.h5", "a") as file:
        file["entry/simulation/warnings"] = np.array(["`H0` cannot be resonant\n  help: turn it round"], dtype="S")
    assert main(["summary", str(tmp_path / "warned.h5")]) == 0
    assert "\n  warning      `H0` cannot be resonant\n               help: turn it round\n" in capsys.readouterr().out
    assert main(["summary", str(folder / "laws.h5")]) == 0
    assert "warning" not in capsys.readouterr().out


def test_the_summary_of_one_detector_leaves_the_others_out(folder: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["summary", str(folder / "two.h5")]) == 0
    both = capsys.readouterr().out
    assert "detector near\n" in both and "fit           dip" in both
    assert "detector far\n" in both and "fit           peak" in both
    assert main(["summary", str(folder / "two.h5"), "--detector", "far"]) == 0
    far = capsys.readouterr().out
    assert "detector far\n" in far and "detector near\n" not in far


def test_scans_are_compared_by_chi_squared(folder: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["compare-scans", str(folder / "dorado.h5"), str(folder / "other_seed.h5")]) == 0
    told = capsys.readouterr()
    assert told.out == "screen: chi² 0.0 for 10 degrees of freedom, p = 1\n" and told.err == ""
    assert main(["compare-scans", str(folder / "dorado.h5"), str(folder / "shifted.h5")]) == 0
    assert capsys.readouterr().out.endswith(", p < 1e-6\n")


def test_a_comparison_of_one_seed_is_warned_of(folder: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["compare-scans", str(folder / "two.h5"), str(folder / "two.h5"), "--detector", "far"]) == 0
    told = capsys.readouterr()
    assert told.out.startswith("far: chi² 0.0") and "; of shared particles, which makes it no verdict" in told.out and "near" not in told.out
    assert told.err.startswith("rabiline: warning: both files have the seed 1938 and may share their particles;")


@pytest.mark.parametrize(("pair", "message"), [
    ("dorado.h5 laws.h5", "rabiline: laws.h5: its scan runs over law and H0.frequency, that of dorado.h5 over "
                          "H0.frequency"),
    ("dorado.h5 two.h5", "rabiline: two.h5: it has the detectors near, far, dorado.h5 has screen"),
    ("dorado.h5 finer.h5", "rabiline: finer.h5: the points of its scan over H0.frequency are not those of dorado.h5"),
    ("dorado.h5 quantum.h5 --detector far", "rabiline: dorado.h5: no detector `far` (there is screen)"),
])
def test_scans_of_different_things_are_not_compared(folder: Path, monkeypatch: pytest.MonkeyPatch,
                                                    capsys: pytest.CaptureFixture, pair: str, message: str) -> None:
    monkeypatch.chdir(folder)
    assert main(["compare-scans", *pair.split()]) == 2
    assert capsys.readouterr().err == message + "\n"


@pytest.mark.parametrize(("command", "message"), [
    ("plot-scan point.h5", "rabiline: point.h5: nothing is scanned in this file"),
    ("plot-scan straight.h5", "rabiline: straight.h5: no `scan`: not a file of `rabiline run`, or one without "
                              "a detector"),
    ("plot-scan dorado.h5 only_laws.h5", "rabiline: only_laws.h5: its scan runs over law, the first one over "
                                         "H0.frequency"),
    ("plot-scan two.h5 --detector middle", "rabiline: two.h5: no detector `middle` (there is near, far)"),
    ("plot-scan dorado.h5 --mark Larmor", 'rabiline: --mark "Larmor" is not LABEL=VALUE, such as "Larmor '
                                          'frequency=291.647 kHz"'),
    ("plot-scan dorado.h5 --panel-title Rabi", "rabiline: --panel-title names the panels of --beside"),
    ("plot-scan --beside dorado.h5 quantum.h5 --panel-title Rabi", "rabiline: 1 --panel-title for 2 files; give one "
                                                                   "for each file"),
    ("plot-scan grid.h5 dorado.h5", "rabiline: 10 curves are too many for one picture"),
    ("plot-scan grid_of_two.h5", "rabiline: 18 curves are too many for one picture; choose one detector with "
                                 "--detector"),
    ("fit-line dorado.h5 --per-field 29MHz", 'rabiline: --per-field 29MHz: a frequency per field is meant, such as "29.1646935 MHz/T"'),
    ("fit-line dorado.h5 --field 10", "rabiline: --field 10: its unit is missing, such as `10 T`"),
    ("plot-levels point.h5", "rabiline: point.h5: nothing is scanned in this file"),
    ("plot-profiles point.h5 dorado.h5", "rabiline: 42 profiles are too many for one picture: choose some by "
                                         "--points, such as 0,21"),
    ("plot-image dorado.h5 --points 0,41", "rabiline: --points 0,41: the scan points are 0 to 40"),
    ("plot-image dorado.h5 --points a", "rabiline: --points a is not a list of numbers, such as 0,50"),
    ("plot-tracks dorado.h5", "rabiline: dorado.h5: no tracks in it: not a file of `rabiline trace`"),
    ("plot-tracks straight.h5 --region B=0.5:0.3", 'rabiline: --region "B=0.5:0.3" is not NAME=BEGIN:END in metres, '
                                                   'such as "B=0.30:0.55"'),
])
def test_bad_input_is_one_line_and_exit_code_2(folder: Path, monkeypatch: pytest.MonkeyPatch,
                                               capsys: pytest.CaptureFixture, command: str, message: str) -> None:
    monkeypatch.chdir(folder)
    assert main([*command.split(), "-o", "never.png"]) == 2
    assert capsys.readouterr().err == message + "\n"
    assert not Path("never.png").exists()


def broken(folder: Path, *writes: tuple[str, int, float], of: str = "dorado.h5") -> str:
    """The name of a copy in which some numbers are others."""
    shutil.copy(folder / of, folder / "broken.h5")
    with h5py.File(folder / "broken.h5", "a") as file:
        for name, place, value in writes:
            numbers = file[f"entry/{name}"][()]
            numbers.flat[place] = value
            file[f"entry/{name}"][...] = numbers
    return "broken.h5"


def test_a_result_that_cannot_be_read_is_one_line_and_exit_code_3(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture) -> None:
    monkeypatch.chdir(folder)
    Path("cut.h5").write_bytes(Path("dorado.h5").read_bytes()[:3000])
    for name, reason in (("missing.h5", "no such file"), ("text.h5", "not an HDF5 file"), ("cut.h5", "cannot be opened: damaged or unfinished"),
                         (".", "is not a file")):
        for command in ("summary", "plot", "plot-scan", "export", "plot-tracks", "plot-motion"):
            assert main([command, name]) == 3, command
            assert capsys.readouterr().err == f"rabiline: {name}: {reason}\n"


@pytest.mark.parametrize(("name", "value"), [("scan/detected", np.nan), ("scan/detected_errors", np.inf), ("scan/H0_frequency", np.nan),
                                             ("screen/counts", -np.inf), ("screen_levels/levels", np.inf), ("fates/emitted", np.nan)])
def test_a_result_with_values_that_are_no_numbers_is_refused_in_one_line(folder: Path, monkeypatch: pytest.MonkeyPatch,
                                                                          capsys: pytest.CaptureFixture, name: str, value: float) -> None:
    monkeypatch.chdir(folder)
    group, _, dataset = name.partition("/")
    for command in ("summary", "plot"):
        assert main([command, broken(folder, (name, 3, value))]) == 3
        assert capsys.readouterr().err == f"rabiline: broken.h5: /entry/{group}: `{dataset}` has values that are infinite or no numbers\n"


def test_levels_of_what_was_not_detected_need_no_fractions(folder: Path, tmp_path: Path) -> None:
    name = broken(folder, ("screen_levels/levels", 3, np.nan))
    assert main(["plot-levels", str(folder / name), "-o", str(tmp_path / "a.png")]) == 0


@pytest.mark.parametrize(("command", "reason"), [
    ("plot-scan dorado.h5 -o a.png -o b.png", "--output is given twice"), ("plot-scan dorado.h5 --output a.png -o b.png", "--output is given twice"),
    ("plot-profiles dorado.h5 --along z --along z", "--along is given twice"), ("forecast a.yaml --free a --rate 1 --rate 1", "--rate is given twice"),
    ("plot-scan dorado.h5 --titl a", "unrecognized arguments: --titl (did you mean --title?)"),
    ("fit a.yaml --dat c.csv --free a", "unrecognized arguments: --dat (did you mean --data?)"),
])
def test_options_are_written_out_and_given_once(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, command: str,
                                                reason: str) -> None:
    monkeypatch.chdir(folder)
    with pytest.raises(SystemExit, match="2"):
        main(command.split())
    assert reason in capsys.readouterr().err


@pytest.mark.parametrize("command", ["fit clock.yaml --free C.field --data {}", "fit-line {}", "compare-laws laws.h5 --data {}",
                                     "plot-scan dorado.h5 --data {}", "plot-field {}", "summary {}", "plot {}"])
def test_what_is_no_file_is_not_waited_for(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture, command: str) -> None:
    if command.startswith("fit "):
        pytest.importorskip("rabiline._core", reason="built without pybind11")
    monkeypatch.chdir(folder)
    shutil.copy(Path(__file__).parents[3] / "beamline/caesium-clock.yaml", "clock.yaml")
    if not Path("pipe").exists():
        os.mkfifo("pipe")
    for name in ("pipe", "/dev/zero", "."):
        assert main(command.format(name).split()) in (2, 3)
        assert capsys.readouterr().err == f"rabiline: {name}: is not a file\n"


def test_a_picture_without_a_name_gets_one_from_its_file(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                                         capsys: pytest.CaptureFixture) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["plot-image", str(folder / "dorado.h5")]) == 0
    assert capsys.readouterr().out == "wrote dorado-image.png\n" and Path("dorado-image.png").stat().st_size > 1000


def test_images_get_the_size_that_is_asked_for_and_letters_that_fit(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    picture = tmp_path / "a.png"
    assert main(["plot-image", str(folder / "dorado.h5"), "--size", "200x120", "-o", str(picture)]) == 0
    with Image.open(picture) as image:
        across, up = (pixels / 200 * 25.4 for pixels in image.size)
    assert across <= 200.2 and up <= 120.2 and (across > 199 or up > 119)
    assert main(["plot-image", str(folder / "dorado.h5"), "--size", "60x40", "-o", str(picture)]) == 2
    assert "or more is needed in this shape" in capsys.readouterr().err


def test_a_scan_over_laws_alone_is_drawn_as_profiles(folder: Path) -> None:
    figure = results.read(folder / "only_laws.h5").plot()
    assert figure.axes[0].get_xlabel().startswith("z (") and len(figure.legends or [figure.axes[0].get_legend()]) == 1


def test_a_table_without_a_name_is_printed(folder: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["export", str(folder / "dorado.h5")]) == 0
    assert capsys.readouterr().out.splitlines()[2].startswith("H0.frequency [Hz],detected,")


@pytest.mark.parametrize("name, said", [("mine.yaml", "named like an experiment"), ("mine.xlsx", "named like a workbook"), ("counts.csv", "is no table of a result")])
def test_a_table_is_not_written_over_what_is_none(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture, name: str, said: str) -> None:
    there, table = tmp_path / name, tmp_path / "a.csv"
    there.write_text("f [kHz],counts\n29.1,12\n")
    assert main(["export", str(folder / "dorado.h5"), "-o", str(there)]) == 2
    assert said in capsys.readouterr().err
    assert there.read_text().startswith("f [kHz]")
    for _ in range(2):
        assert main(["export", str(folder / "dorado.h5"), "-o", str(table)]) == 0


def test_an_experiment_is_told_to_be_run_before_it_is_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                                            capsys: pytest.CaptureFixture) -> None:
    monkeypatch.chdir(tmp_path)
    Path("clock.yaml").write_text("rabiline: 1\n")
    assert main(["plot", "clock.yaml"]) == 3
    assert capsys.readouterr().err == "rabiline: clock.yaml: not an HDF5 file; `rabiline run clock.yaml` makes one of an experiment\n"


def test_a_mistyped_command_is_one_line_and_exit_code_2(capsys: pytest.CaptureFixture) -> None:
    with pytest.raises(SystemExit) as left:
        main(["plot-scam", "a.h5"])
    assert left.value.code == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize(("option", "reason"), [
    ("--size=86", "`86` is no size: write width x height in mm, such as 86x60"),
    ("--size=1x1", "both are in mm, from 26 to 1000"),
    ("--x-range=300", "write two numbers as the axis has them, such as 280:300"),
    ("--x-range=300:280", "the first number is the smaller one"),
])
def test_a_size_or_a_range_that_is_none_is_told_how_to_be_written(folder: Path, capsys: pytest.CaptureFixture, option: str, reason: str) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["plot", str(folder / "dorado.h5"), option])
    assert reason in capsys.readouterr().err


@pytest.mark.parametrize("option", ["--rate", "--seconds"])
@pytest.mark.parametrize("value", ["nan", "inf", "1e308", "-1", "0"])
def test_a_rate_or_a_time_that_cannot_be_is_refused(capsys: pytest.CaptureFixture, option: str, value: str) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["forecast", "a.yaml", "--free", "a", option, value])
    told = capsys.readouterr().err
    assert told.startswith(f"rabiline: argument {option}: `{value}` is no {'rate' if option == '--rate' else 'time'} above 0: write ") and told.count("\n") == 1


def test_negative_values_are_no_options(folder: Path, tmp_path: Path) -> None:
    assert main(["plot-image", str(folder / "dorado.h5"), "--x-range", "-1:1", "-o", str(tmp_path / "a.png")]) == 0


def test_a_mark_has_the_unit_of_its_axis(folder: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["plot-scan", str(folder / "dorado.h5"), "--mark", "B=5 mT", "-o", "never.png"]) == 2
    assert "mT is not a unit of the kind of Hz" in capsys.readouterr().err


@pytest.mark.parametrize(("table", "reason"), [("H0.frequency,counts\n290,3\n291,4\n", "has no unit: write `H0.frequency [Hz]`"),
                                               ("H0.frequency [MHz],counts\n290,3\n291,4\n", "is the unit right?")])
def test_counts_beside_a_scan_have_its_unit(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture, table: str, reason: str) -> None:
    (tmp_path / "c.csv").write_text(table)
    assert main(["plot-scan", str(folder / "dorado.h5"), "--data", str(tmp_path / "c.csv"), "-o", "never.png"]) == 2
    assert reason in capsys.readouterr().err


def test_a_picture_that_cannot_be_finished_leaves_the_old_one(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from matplotlib.figure import Figure

    def full(_: Figure, path: Path, **__: object) -> None:
        path.write_bytes(b"half")
        raise OSError(28, "No space left on device")

    (tmp_path / "a.png").write_bytes(b"precious")
    monkeypatch.setattr(Figure, "savefig", full)
    assert main(["plot", str(folder / "dorado.h5"), "-o", str(tmp_path / "a.png")]) == 3
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("a.png", b"precious")]


def test_a_command_that_is_stopped_says_so(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture) -> None:
    from rabiline import reports

    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(reports.results, "read", stopped)
    assert main(["summary", str(folder / "dorado.h5")]) == 130
    assert capsys.readouterr().err == "rabiline: stopped\n"


@pytest.mark.parametrize("late, stop", [("argparse", signal.SIGINT), ("h5py", signal.SIGTERM), ("matplotlib.figure", signal.SIGXCPU)])
def test_a_signal_during_an_import_is_one_line(folder: Path, tmp_path: Path, late: str, stop: int) -> None:
    module = tmp_path / Path(*late.split(".")).with_suffix(".py")
    module.parent.mkdir(exist_ok=True)
    (module.parent / "__init__.py").touch()
    module.write_text(f"import os\ntry:\n    os.kill(os.getpid(), {int(stop)})\n    sum(range(10**6))\nexcept BaseException:\n    raise ImportError")
    paths = os.pathsep.join([str(tmp_path), str(Path(results.__file__).parents[1])])
    done = subprocess.run([sys.executable, "-m", "rabiline", "plot", "dorado.h5"], cwd=folder, capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": paths})
    assert (done.returncode, done.stderr) == (128 + stop, "rabiline: stopped\n")


@pytest.mark.parametrize("name", ["picture.doc", "picture", "picture.jpg", "picture.h5"])
@pytest.mark.parametrize("command", ["plot-scan missing.h5", "fit missing.yaml --data missing.csv --free a", "draw missing.yaml",
                                     "compare-laws missing.h5"])
def test_a_name_that_is_no_picture_is_refused_before_any_work(folder: Path, capsys: pytest.CaptureFixture, command: str, name: str) -> None:
    assert main([*command.split(), "-o", name]) == 2
    assert capsys.readouterr().err == f"rabiline: {name}: a picture's name ends in .png, .pdf or .svg\n"


@pytest.mark.parametrize("dpi", ["9", "2401", "nan", "inf", "-1", "many"])
def test_dots_per_inch_have_a_range(folder: Path, capsys: pytest.CaptureFixture, dpi: str) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["plot", str(folder / "dorado.h5"), "--dpi", dpi])
    assert f"`{dpi}` is no number of dots per inch from 10 to 2400" in capsys.readouterr().err


def test_a_picture_that_cannot_be_written_is_exit_code_3(folder: Path, tmp_path: Path) -> None:
    assert main(["plot-scan", str(folder / "dorado.h5"), "-o", str(tmp_path / "nowhere" / "a.png")]) == 3
