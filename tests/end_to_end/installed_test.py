"""What `cmake --install` leaves works from any place: the program, the library, the shipped files, the analysis."""
from __future__ import annotations

import os
import subprocess
from pathlib import Path

import h5py
import pytest

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ["RABILINE_PROGRAM"]).parent
CHANGES = ["--set", "B.field=9 mT", "--scan", "H0.frequency=250 kHz:270 kHz:3", "--particles", "1000"]  # of docs/example


def call(*command: object, **options: object) -> str:
    done = subprocess.run([str(word) for word in command], text=True, capture_output=True, timeout=600, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Installed to one place, then moved to another."""
    folder = tmp_path_factory.mktemp("installed")
    call("cmake", "--install", BUILD, "--prefix", folder / "first")
    (folder / "first").rename(folder / "second")
    return folder / "second"


@pytest.fixture(scope="module")
def output_of_the_program(prefix: Path) -> Path:
    output = prefix.parent / "program.h5"
    call(prefix / "bin/rabiline", "run", prefix / "share/rabiline/beamline/suggested-experiment.yaml", *CHANGES, "-o", output)
    return output


def datasets(path: Path) -> dict[str, object]:
    """All but those of /entry/simulation, which tell of the machine and the time."""
    found = {}

    def keep(name: str, item: h5py.Group | h5py.Dataset) -> None:
        if isinstance(item, h5py.Dataset) and not name.startswith("entry/simulation"):
            value = item[()]
            found[name] = value.tobytes() if hasattr(value, "tobytes") else value

    with h5py.File(path) as file:
        file.visititems(keep)
    return found


def test_every_header_stands_in_a_folder_of_its_own(prefix: Path) -> None:
    assert [path.name for path in (prefix / "include").iterdir()] == ["rabiline"]
    headers = [path for path in (prefix / "include").rglob("*") if path.is_file()]
    assert prefix / "include/rabiline/rabiline.hpp" in headers
    assert not any('#include "' in path.read_text() for path in headers)


def test_no_installed_text_knows_where_it_was_built(prefix: Path) -> None:
    for path in (path for folder in ("include", "lib/cmake", "share") for path in (prefix / folder).rglob("*")):
        text = path.read_text() if path.is_file() else ""
        assert str(BUILD) not in text and str(ROOT) not in text and str(prefix.parent) not in text, path


def test_the_example_gives_the_bits_of_the_program(prefix: Path, output_of_the_program: Path) -> None:
    build, output = prefix.parent / "example", prefix.parent / "example.h5"
    call("cmake", "-S", ROOT / "docs/example", "-B", build, "-G", "Ninja", "-D", f"CMAKE_PREFIX_PATH={prefix}")
    call("cmake", "--build", build)
    said = call(build / "example", prefix / "share/rabiline/beamline/suggested-experiment.yaml", output)
    assert said.count("detected") == 3 and said.startswith("250 kHz: ")
    mine, its = datasets(output), datasets(output_of_the_program)
    assert mine.keys() == its.keys() and "entry/scan/detected" in mine
    assert [name for name in mine if mine[name] != its[name]] == []


def test_the_shipped_files_are_read_where_they_are_installed(prefix: Path) -> None:
    shipped = sorted((ROOT / "beamline").iterdir())
    assert [path.name for path in shipped] == sorted(path.name for path in (prefix / "share/rabiline/beamline").iterdir())
    for name in ("deflection-potassium", "rotating-cylinder"):  # one includes a geometry, one is a model
        call(prefix / "bin/rabiline", "check", prefix / f"share/rabiline/beamline/{name}.yaml")


def test_the_analysis_reads_what_the_program_wrote(prefix: Path, output_of_the_program: Path) -> None:
    told = call(prefix / "bin/rabiline", "summary", output_of_the_program)
    assert "H0.frequency" in told


def test_no_library_is_loaded_from_the_folder_one_works_in(prefix: Path, tmp_path: Path) -> None:
    for name in ("libfmt.so.9", "libyaml-cpp.so.0.7", "libhdf5_serial.so.103", "libgsl.so.27"):
        (tmp_path / name).write_text("of no use")
    for program in (BUILD / "rabiline", prefix / "bin/rabiline"):
        assert call(program, "--version", cwd=tmp_path).startswith("rabiline ")
