"""Files that are read and written: what is wrong with them is a line that names them, and nothing is left half written."""
from __future__ import annotations

import errno
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rabiline
from rabiline import asked, hdf5, results, starters, writing
from rabiline.__main__ import main
from rabiline.errors import InputError, StorageError
from rabiline.hdf5 import FileError, UnreadableFile
from synthetic import DORADO, dip, frequencies, write_results


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Path:
    axis = frequencies(21)
    return write_results(tmp_path_factory.mktemp("files") / "a.h5", [axis], dip(axis.values, steepness=4), law=[DORADO], bins=4)


@pytest.mark.parametrize(("content", "reason"), [(b"\x89HDF\r\n\x1a\n\xff\xfe", "this is no table of `rabiline probe --along`"),
                                                 (b"f [Hz],counts\n1,3\n" + 200_000 * b"7", "this is no table of `rabiline probe --along`")])
def test_a_field_is_not_read_from_what_is_no_table(tmp_path: Path, capsys: pytest.CaptureFixture, content: bytes, reason: str) -> None:
    (tmp_path / "a.csv").write_bytes(content)
    assert main(["plot-field", str(tmp_path / "a.csv"), "-o", str(tmp_path / "a.png")]) == 2
    assert capsys.readouterr().err == f"rabiline: {tmp_path / 'a.csv'}: {reason}\n"


def test_a_cell_that_is_too_long_is_told_its_line(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "a.csv").write_text("f [Hz],counts\n1,3\n2," + 200_000 * "7")
    assert main(["fit-line", str(tmp_path / "a.csv")]) == 2
    assert capsys.readouterr().err == f"rabiline: {tmp_path / 'a.csv'}: line 3: field larger than field limit (131072)\n"


@pytest.mark.parametrize("words", [["plot", ""], ["new", "clock", "-o", ""], ["fit", "a.yaml", "--data", "", "--free", "B.field"], ["summary", ""]])
def test_the_name_of_a_file_is_not_empty(capsys: pytest.CaptureFixture, words: list[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(words)
    assert "the name of a file is empty (see --help)" in capsys.readouterr().err


@pytest.mark.parametrize("words", [["plot-scan", "a.h5", "--detector", ""], ["fit", "a.yaml", "--data", "a.csv", "--free", "B.field", "--particles", ""],
                                   ["fit", "a.yaml", "--data", "a.csv", "--free", "B.field", "--detector="]])
def test_an_option_that_is_empty_is_refused(capsys: pytest.CaptureFixture, words: list[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(words)
    assert capsys.readouterr().err.endswith(": it is empty (see --help)\n")


def test_too_little_memory_is_a_line(result: Path) -> None:
    package = str(Path(results.__file__).parents[1])
    done = subprocess.run(["bash", "-c", f"ulimit -v 100000; exec {sys.executable} -m rabiline summary {result}"], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": package, "OMP_NUM_THREADS": "1"})
    assert (done.returncode, done.stderr) == (2, "rabiline: not enough memory\n")


@pytest.mark.parametrize("command", ["summary {1}", "compare {0} {1}", "export {1}", "plot {1}", "fit-line {1}"])
def test_a_result_with_numbers_that_cannot_be_is_one_line_and_exit_code_3(tmp_path: Path, capsys: pytest.CaptureFixture, command: str) -> None:
    axis = frequencies(21)
    whole, forged = (write_results(tmp_path / name, [axis], dip(axis.values, steepness=4), law=[DORADO], covariance=sign * np.eye(21)[None], bins=4)
                     for name, sign in (("a.h5", 1), ("b.h5", -1)))
    assert main(command.format(whole, forged).split()) == 3
    assert capsys.readouterr().err == f"rabiline: {forged}: /entry/scan: `detected_covariance` has variances below zero\n"


@pytest.mark.parametrize("command", ["export {} -o {}/table.csv", "plot-scan {} -o {}/picture.png"])
def test_a_missing_folder_is_told_how_to_be_made(result: Path, tmp_path: Path, capsys: pytest.CaptureFixture, command: str) -> None:
    folder = tmp_path / "no where"
    words = [word.replace("FOLDER", str(folder)) for word in command.format(result, "FOLDER").split()]
    assert main(words) == 3
    assert capsys.readouterr().err == (f"rabiline: {words[-1]}: cannot be written (the folder {folder} does not exist); create it with: "
                                       f"mkdir -p '{folder}'\n")


def test_a_folder_is_not_written_to(result: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["export", str(result), "-o", str(tmp_path)]) == 3
    assert f"{tmp_path}: cannot be written (it is a folder); name a file in it" in capsys.readouterr().err
    assert main(["export", str(result), "-o", str(tmp_path / (300 * "a"))]) == 3
    assert "cannot be written (File name too long); choose a shorter name" in capsys.readouterr().err


def test_a_full_disk_names_the_file_that_was_to_be_written(result: Path, tmp_path: Path) -> None:
    for error, advice in ((errno.ENOSPC, "free some space"), (errno.EACCES, "choose another place")):
        with pytest.raises(StorageError) as caught, writing.whole(tmp_path / "a.csv") as new:
            new.write_text("half")
            raise OSError(error, os.strerror(error), str(new))
        assert str(caught.value).startswith(f"{tmp_path / 'a.csv'}: cannot be written ({os.strerror(error)}); {advice}")
    assert not list(tmp_path.iterdir())
    printed = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    assert writing.explained(printed).startswith("the output cannot be written (No space left on device); free some space")


def test_a_write_protected_file_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.csv").write_text("mine")
    monkeypatch.setattr(os, "access", lambda *_: False)  # as for anybody but root
    with pytest.raises(StorageError, match=r"a\.csv: cannot be written \(Permission denied\)"), writing.whole(tmp_path / "a.csv"):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]


def test_a_starter_comes_with_all_its_files_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture) -> None:
    write = Path.write_text

    def full(path: Path, text: str, **more: str) -> int:
        if starters.SCHEMA in path.name:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        return write(path, text, **more)

    monkeypatch.setattr(Path, "write_text", full)
    assert main(["new", "clock", "-o", str(tmp_path / "x.yaml")]) == 3
    assert capsys.readouterr().err.startswith(f"rabiline: {tmp_path / starters.SCHEMA}: cannot be written (No space left on device)")
    assert not list(tmp_path.iterdir())


def test_what_cannot_be_read_is_named_without_numbers_of_errors(tmp_path: Path) -> None:
    assert writing.explained(FileNotFoundError(errno.ENOENT, "x", "a.csv")) == "a.csv: there is no such file"
    assert writing.explained(PermissionError(errno.EACCES, "Permission denied", "b/a.csv")) == "b/a.csv: cannot be read (Permission denied)"


def test_the_run_that_is_advised_has_the_folder_of_its_file(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "a.yaml").write_text("rabiline: 1\n")
    assert main(["plot", str(tmp_path / "a.yaml")]) == 3
    assert f"`rabiline run {tmp_path / 'a.yaml'}` makes one of an experiment" in capsys.readouterr().err


def test_all_errors_of_the_package_are_its_two(tmp_path: Path, result: Path) -> None:
    from rabiline import agreement, curves, kappa, lines, templates
    for one in (FileError, UnreadableFile, agreement.NotComparable, curves.NoResonance, kappa.NoBound, lines.NoLine,
                templates.NoTemplates):
        assert issubclass(one, rabiline.InputError)
    assert issubclass(UnreadableFile, rabiline.StorageError) and rabiline.InputError is InputError and rabiline.StorageError is StorageError
    with pytest.raises(rabiline.StorageError, match="no such file"):
        rabiline.open(tmp_path / "nothing.h5")
    opened = rabiline.open(result)
    with pytest.raises(rabiline.InputError, match="a picture's name ends in"):
        opened.plot(tmp_path / "a.doc")
    with pytest.raises(rabiline.StorageError, match="does not exist"):
        opened.to_csv(tmp_path / "nowhere" / "a.csv")


def test_names_are_listed_and_results_are_short(result: Path) -> None:
    assert set(rabiline.__all__) < set(dir(rabiline)) and "import_module" not in dir(rabiline)
    assert repr(rabiline.open(result)) == "<result of The experiment suggested to test the theory>"


def test_a_path_is_no_empty_text_and_has_neither_a_zero_byte_nor_a_million_letters(result: Path) -> None:
    for name, reason in (("", "is empty"), ("a\0b", "has a zero byte in it"), ("a" * 10**6, "longer than any"), ("\ud800", "has half of a character in it")):
        for call in (rabiline.open, rabiline.open(result).to_csv, rabiline.open(result).plot):
            with pytest.raises(InputError, match=f"is the path of a file, and {reason}"):
                call(name)


def test_a_detector_without_a_name_is_none_of_the_result(result: Path) -> None:
    with pytest.raises(InputError, match=r"no detector `` \(there is screen\)"):
        rabiline.open(result).plot(kind="scan", detector="")


def test_whole_numbers_have_their_ends() -> None:
    assert asked.whole_number("count", np.int64(5), 1, 10) == 5
    with pytest.raises(ValueError, match="`count` is 1 to 10, not 11"):
        asked.whole_number("count", 11, 1, 10)
    with pytest.raises(ValueError, match="`first` is 0 or above, not -1"):
        asked.whole_number("first", -1)
    with pytest.raises(TypeError, match="`threads` is a whole number, not bool"):
        asked.threads(True)
    with pytest.raises(TypeError, match="`rate` is a number, not bool"):
        asked.number("rate", True)


def test_places_are_real_numbers() -> None:
    assert asked.places([[1, 2, 3]]) == [(1.0, 2.0, 3.0)]
    for value in ([[1j, 0, 0]], np.ones((1, 3), dtype=complex)):
        with pytest.raises(TypeError, match="`places` is a list of places"):
            asked.places(value)


def test_half_of_a_character_is_told() -> None:
    for call in (lambda: rabiline.load("rabiline: 1\ntitle: \ud800\n"), lambda: asked.text("`title`", "a \ud800")):
        with pytest.raises(InputError, match=r"has half of a character in it, '\\ud800', which no file can hold"):
            call()


def test_a_text_of_a_file_neither_steers_a_terminal_nor_turns_its_lines_round() -> None:
    assert hdf5._decoded("a\x1b[31m\x9b \u202eb\u2066") == "a?[31m? ?b?" and hdf5._decoded("µ – π\n\t²") == "µ – π\n\t²"


def test_a_table_has_the_title_in_one_line_whatever_breaks_it(tmp_path: Path, result: Path) -> None:
    file = replace(results.read(result), title="first\nsecond\rlaw,detected\u2028x\x1b[2J")
    file.to_csv(tmp_path / "a.csv")
    assert (tmp_path / "a.csv").read_bytes().decode().splitlines()[0] == "# first second law,detected x [2J"
    named = {**file.detectors, "D\n1": next(iter(file.detectors.values()))}
    replace(file, detectors=named, scan=replace(file.scan, detectors=("D\n1",))).to_csv(tmp_path / "b.csv")
    assert len((tmp_path / "b.csv").read_text().splitlines()) == len((tmp_path / "a.csv").read_text().splitlines())


def test_no_message_steers_a_terminal(tmp_path: Path) -> None:
    evil = "\x1b]0;x\x07\u202e\x9b\r"
    for problem in (InputError(evil), StorageError(evil), FileError(tmp_path / evil, evil), UnreadableFile(tmp_path / evil, evil)):
        assert not set("\x1b\x07\u202e\x9b\r") & set(str(problem)) and "?]0;x??" in str(problem)
    assert str(InputError("µ: one line\n\tand another")) == "µ: one line\n\tand another"
