"""Tables of `rabiline probe`, read and drawn."""
from pathlib import Path

import numpy as np
import pytest
from rabiline.__main__ import main
from rabiline.field_plots import draw_field, read_field
from rabiline.regions import Region

HEADER = "x [m],y [m],z [m],Bx [T],By [T],Bz [T],|B| [T],div B [T/m],curl B [T/m]\n"


def write(path: Path, rows: int = 11, header: str = HEADER) -> Path:
    path.write_text(header + "".join(f"0,{0.1 * i},0,1e-3,0,{1e-3 * i},{1e-3 * np.hypot(1, i)},0,0\n" for i in range(rows)))
    return path


def test_a_line_knows_which_way_it_runs(tmp_path: Path) -> None:
    line = read_field(write(tmp_path / "b.csv"))
    assert line.along == "y"
    assert line.place[-1] == 1.0
    assert line.field[3].tolist() == [1e-3, 0, 3e-3]


def test_the_field_is_drawn(tmp_path: Path) -> None:
    picture = tmp_path / "b.png"
    assert main(["plot-field", str(write(tmp_path / "b.csv")), "-o", str(picture)]) == 0
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_an_electric_field_stands_below_the_magnetic_one(tmp_path: Path) -> None:
    table = write(tmp_path / "e.csv", header=HEADER.replace("\n", ",Ex [V/m],Ey [V/m],Ez [V/m]\n"))
    first, *rows = table.read_text().splitlines()
    table.write_text("\n".join([first, *(row + ",0,0,2e5" for row in rows)]))
    line = read_field(table)
    assert line.electric[4].tolist() == [0, 0, 2e5]
    assert [axes.get_ylabel() for axes in draw_field(line, "both").axes] == ["B (mT)", "E (kV/m)"]


def test_parts_stand_above_the_line_where_they_are_in_its_unit(tmp_path: Path) -> None:
    table = tmp_path / "b.csv"
    table.write_text(HEADER + "".join(f"0,{0.001 * i},0,1e-3,0,0,1e-3,0,0\n" for i in range(11)))
    figure = draw_field(read_field(table), "parts", [Region("B", 2e-3, 7e-3), Region("behind", 0.02, 0.03)])
    axes, = figure.axes
    assert axes.get_xlabel() == "y (mm)"
    assert [text.get_text() for text in axes.texts] == ["B"]
    assert axes.texts[0].xy[0] == pytest.approx(4.5)


@pytest.mark.parametrize("rows, header, said", [(11, "y,B\n", "no table of"), (1, HEADER, "fewer than two rows")])
def test_what_is_no_table_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture, rows: int, header: str, said: str) -> None:
    assert main(["plot-field", str(write(tmp_path / "b.csv", rows, header)), "-o", str(tmp_path / "b.png")]) == 2
    assert said in capsys.readouterr().err


def test_a_component_that_is_not_there_says_so_and_covers_nothing(tmp_path: Path) -> None:
    figure = draw_field(read_field(write(tmp_path / "b.csv")), "a title")
    lines = {line.get_label(): line for line in figure.axes[0].lines}
    assert set(lines) == {"$B_x$", "$B_y$ = 0", "$B_z$", "|B|"} and lines["$B_y$ = 0"].get_zorder() < lines["$B_x$"].get_zorder()
