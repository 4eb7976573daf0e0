"""Tables of counts: from files and from frames."""
from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from rabiline.counts import read_counts
from rabiline.hdf5 import FileError

pandas = pytest.importorskip("pandas")


def test_a_frame_is_read_as_its_table(tmp_path: Path) -> None:
    frame = pandas.DataFrame({"f [kHz]": [29.1, 29.2, 0.1 + 0.2], "counts": [812, 790, 5], "seconds": [1.0, 2.0, 3.0]})
    frame.to_csv(tmp_path / "a.csv", index=False)
    given, read = read_counts(frame), read_counts(tmp_path / "a.csv")
    assert given.places == read.places == ("29.1 kHz", "29.2 kHz", "0.30000000000000004 kHz") and given.unit == read.unit == "kHz"
    assert given.counts.tolist() == [812, 790, 5] and given.seconds.tolist() == [1, 2, 3]


def test_the_scanned_parameter_may_be_the_index_and_units_may_stand_in_attrs() -> None:
    frame = pandas.DataFrame({"counts": [812.0, 790.0]}, index=pandas.Index([29.1, 29.2], name="f [kHz]"))
    assert read_counts(frame).places == ("29.1 kHz", "29.2 kHz")
    frame = pandas.DataFrame({"f": [29.1, 29.2], "counts": [812, 790]})
    frame.attrs["units"] = {"f": "kHz"}
    assert read_counts(frame).unit == "kHz"


def test_what_is_wrong_in_a_frame_is_told_as_in_a_table() -> None:
    with pytest.raises(FileError, match="^DataFrame: line 3: `nan` is out of range \\(counts\\)$"):
        read_counts(pandas.DataFrame({"f [kHz]": [1, 2], "counts": [3, None]}))
    with pytest.raises(TypeError, match="^a table is the path of a file or a pandas.DataFrame, not list$"):
        read_counts([1, 2])


def test_a_column_that_is_none_of_the_table_is_asked_about() -> None:
    with pytest.raises(FileError, match="^DataFrame: line 1: what is the column `time`\\? Write `seconds`"):
        read_counts(pandas.DataFrame({"RF.frequency [kHz]": [1, 2], "counts": [3, 4], "time [s]": [1, 1]}))


def test_pandas_is_imported_only_by_who_has_a_frame(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("f [kHz],counts\n1,2\n2,3\n")
    code = f"from rabiline.counts import read_counts; read_counts({str(tmp_path / 'a.csv')!r}); import sys; print('pandas' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "False\n"


def test_the_line_that_tells_a_spreadsheet_of_its_commas_is_no_row(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("sep=,\nf [kHz],counts\n29.1,812\n29.2,790\n")
    assert read_counts(tmp_path / "a.csv").counts.tolist() == [812, 790]
