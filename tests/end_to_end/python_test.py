"""The program inside Python gives the bits, the messages and the files of the command."""
from __future__ import annotations

import csv
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from rescan_test import BEAMLINE, MAGNETS

pytest.importorskip("rabiline._core", reason="built without pybind11")
import rabiline  # noqa: E402
from rabiline.hdf5 import FileError  # noqa: E402

PROGRAM = os.environ["RABILINE_PROGRAM"]
BEAMLINES = Path(__file__).parents[2] / "beamline"
SCAN = "first.frequency", "285 kHz:298 kHz:14"


@pytest.fixture(scope="module")
def ramsey() -> rabiline.Experiment:
    return rabiline.load(BEAMLINES / "ramsey.yaml").scan().scan(*SCAN).set(particles=500)


@pytest.fixture(scope="module")
def of_the_command(tmp_path_factory: pytest.TempPathFactory) -> rabiline.open:
    path = tmp_path_factory.mktemp("command") / "ramsey.h5"
    subprocess.run([PROGRAM, "run", BEAMLINES / "ramsey.yaml", "--no-scan", "--scan", "=".join(SCAN), "--particles", "500",
                    "-o", path], check=True, stdout=subprocess.DEVNULL)
    return rabiline.open(path)


def test_a_run_has_the_bits_of_the_command(ramsey: rabiline.Experiment, of_the_command: object) -> None:
    flown = ramsey.run()
    assert (flown.detected == of_the_command.detected).all() and flown.detected.shape == (14,)
    assert (flown.scan.covariance == of_the_command.scan.covariance).all()
    assert (flown.detectors["screen"].counts == of_the_command.detectors["screen"].counts).all()
    assert [fate.fate for fate in flown.fates] == [fate.fate for fate in of_the_command.fates]


def test_what_is_written_is_the_file_of_the_command(ramsey: rabiline.Experiment, of_the_command: object,
                                                    tmp_path: Path) -> None:
    ramsey.run(threads=1).write(tmp_path / "a.h5")
    again = rabiline.open(tmp_path / "a.h5")
    assert (again.detected == of_the_command.detected).all() and again.title == of_the_command.title


def test_a_scan_within_a_stated_memory_has_the_same_bits_in_slabs(tmp_path: Path) -> None:
    (tmp_path / "rabi.yaml").write_text(BEAMLINE)
    (tmp_path / "magnets.yaml").write_text(MAGNETS)
    long = rabiline.load(tmp_path / "rabi.yaml").scan().set(particles=200).scan("RF.frequency", "9.32 MHz:9.33 MHz:4200")
    whole, slabs = long.run(transit="totals"), long.run(transit="totals", max_memory="20MiB")
    assert (whole.detected == slabs.detected).all() and (whole.errors == slabs.errors).all()
    slabs.write(tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5") as file:
        assert file["entry/simulation/slabs"][0] == 2 and file["entry/simulation/max_memory"][0] == 20 * 2**20
    with pytest.raises(rabiline.InputError, match="is no size of memory"):
        long.run(max_memory="2 GB")


def test_numbers_are_in_si_and_texts_have_their_units(ramsey: rabiline.Experiment) -> None:
    assert ramsey.value("B.field") == 0.01 and ramsey.unit("B.field") == "T"
    assert (ramsey.value("source.speed.mean"), ramsey.unit("source.speed.mean")) == (1000, "m/s")
    as_number, as_text = (ramsey.set({"B.field": value}).run() for value in (0.009, "9 mT"))
    assert (as_number.detected == as_text.detected).all()
    scanned = [ramsey.scan().scan(*scan).run().scan.axes[0].values
               for scan in (("B.field", [0.009, 0.01]), ("B.field", "9 mT,10 mT"), ("B.field=9 mT,10 mT",))]
    assert all((values == scanned[0]).all() for values in scanned)
    with pytest.raises(KeyError, match="B.feld"):
        ramsey.value("B.feld")


def test_nothing_changes_what_was_loaded(ramsey: rabiline.Experiment) -> None:
    before = ramsey.run().detected
    ramsey.set({"B.field": "9 mT"}).run()
    assert (ramsey.run().detected == before).all() and ramsey.points == 14 and ramsey.scan().points == 1


def test_errors_keep_line_and_caret() -> None:
    text = (BEAMLINES / "ramsey.yaml").read_text().replace("species: neutron", "species: neutorn")
    with pytest.raises(rabiline.InputError) as caught:
        rabiline.load(text)
    assert "species: neutorn" in str(caught.value) and "^^^^^^^" in str(caught.value)
    assert caught.value.diagnostics[0]["help"].startswith("did you mean `neutron`?")
    with pytest.raises(rabiline.InputError, match="no such file"):
        rabiline.load("nothing.yaml")
    with pytest.raises(rabiline.StorageError):
        rabiline.load(BEAMLINES / "rabi-flop.yaml").set(particles=10).run().write("/nowhere/a.h5")
    with pytest.raises(FileError, match="no such file"):
        rabiline.open("nothing.h5")


def test_a_check_tells_the_plan_and_warnings(ramsey: rabiline.Experiment) -> None:
    assert "Larmor" in str(ramsey.check()) and ramsey.check().warnings == ()
    blind = rabiline.load(BEAMLINES / "ramsey.yaml").scan().set({"first.frequency": "291.647 Hz"})
    assert blind.check().warnings
    with pytest.warns(rabiline.ExperimentWarning):
        blind.run()


def test_ctrl_c_stops_a_run() -> None:
    long = rabiline.load(BEAMLINES / "caesium-clock.yaml").set(particles=10**9)
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        long.run(progress=False)
    assert time.monotonic() - begin < 20


def test_progress_rises_and_other_threads_go_on() -> None:
    told: list[float] = []
    counted = 0
    done = threading.Event()

    def count() -> None:
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    other = threading.Thread(target=count)
    other.start()
    rabiline.load(BEAMLINES / "caesium-clock.yaml").set(particles=200000).run(progress=lambda part, left: told.append(part))
    done.set()
    other.join()
    assert told == sorted(told) and told[-1] == 1 and counted > 20


def test_models_and_tracks_come_as_they_are_read_from_files(tmp_path: Path) -> None:
    solved = rabiline.load(BEAMLINES / "rotating-cylinder.yaml").run()
    assert solved.findings and solved.points[0][0].position.shape[1] == 3
    tracks = rabiline.load(BEAMLINES / "ramsey.yaml").trace(3)
    assert [track.particle for track in tracks.tracks] == [0, 1, 2]


def test_the_table_has_units_and_reads_back(ramsey: rabiline.Experiment, tmp_path: Path) -> None:
    flown = ramsey.run()
    flown.to_csv(tmp_path / "a.csv")
    rows = list(csv.reader(line for line in (tmp_path / "a.csv").read_text().splitlines() if not line.startswith("#")))
    assert rows[0] == ["first.frequency [Hz]", "detected", "detected_error"]
    assert [float(row[1]) for row in rows[1:]] == flown.detected.tolist()


def test_frames_of_other_libraries_have_the_axes(ramsey: rabiline.Experiment) -> None:
    pytest.importorskip("xarray")
    flown = ramsey.scan("B.field", "9 mT,10 mT").run()
    frame, data = flown.to_dataframe(), flown.to_xarray()
    assert frame.attrs["units"] == {"first.frequency": "Hz", "B.field": "T"} and len(frame) == 28
    assert data.detected.dims == ("detector", "first.frequency", "B.field")
    assert data.detected.sel(detector="screen").sel({"B.field": 0.01}).values.tolist() == flown.detected[:, 1].tolist()
    assert data["counts_screen"].sum(["x_screen", "z_screen"]).shape == (14, 2)


def test_a_result_draws_itself(ramsey: rabiline.Experiment, tmp_path: Path) -> None:
    flown = ramsey.run()
    for number, options in enumerate(({}, {"kind": "image"}, {"kind": "levels", "title": "T"})):
        flown.plot(tmp_path / f"{number}.png", **options)
        assert (tmp_path / f"{number}.png").read_bytes().startswith(b"\x89PNG")
    assert "Ramsey" in flown.summary()


def test_importing_it_is_quick_and_loads_nothing_else() -> None:
    code = "import time; t = time.process_time(); import rabiline, sys; rabiline.load; print(time.process_time() - t, *sys.modules)"
    seconds, *modules = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.split()
    assert float(seconds) < 0.2
    assert not {"matplotlib", "lmfit", "scipy", "h5py"} & set(modules)


def test_a_call_of_one_particle_costs_milliseconds(ramsey: rabiline.Experiment) -> None:
    one = ramsey.scan().set(particles=1)
    one.run()

    def seconds(field: float) -> float:
        begin = time.perf_counter()
        one.set({"B.field": field}).run().detected
        return time.perf_counter() - begin

    assert min(seconds(field) for field in np.linspace(0.009, 0.01, 20)) < 0.005


@pytest.mark.parametrize(("arguments", "said"), [
    (("summary",), "Ramsey"), (("summary", "--json"), '"detected"'), (("export", "-o", "{tmp}/a.csv"), ""),
    (("plot", "-o", "{tmp}/a.png"), ""), (("plot-image", "-o", "{tmp}/b.png"), "")])
def test_one_command_line_has_all(ramsey: rabiline.Experiment, tmp_path: Path, arguments: tuple[str, ...], said: str) -> None:
    ramsey.run().write(tmp_path / "a.h5")
    verb, *rest = [word.format(tmp=tmp_path) for word in arguments]
    done = subprocess.run([PROGRAM, verb, tmp_path / "a.h5", *rest], capture_output=True, text=True)
    assert done.returncode == 0 and said in done.stdout, done.stderr
    assert all((tmp_path / word).exists() for word in rest if word.startswith("/"))


def test_both_command_lines_know_the_same_commands_of_the_package() -> None:
    from rabiline.__main__ import VERBS
    listed = subprocess.run([PROGRAM, "--help"], check=True, capture_output=True, text=True).stdout
    assert set(VERBS) == {line.split()[0] for line in listed.partition("Python:")[2].splitlines() if line.startswith("  ")}


def test_check_speaks_json_too(tmp_path: Path) -> None:
    import json
    (tmp_path / "a.yaml").write_text((BEAMLINES / "ramsey.yaml").read_text().replace("field: 10 mT}", "field: 10 mm}"))
    done = subprocess.run([PROGRAM, "check", "--json", tmp_path / "a.yaml"], capture_output=True, text=True)
    told = json.loads(done.stdout)
    assert done.returncode == 2 and told["errors"][0]["line"] > 0 and "magnetic field" in told["errors"][0]["message"]
    told = json.loads(subprocess.run([PROGRAM, "check", "--json", BEAMLINES / "ramsey.yaml"], capture_output=True,
                                     text=True).stdout)
    assert told["errors"] == [] and told["points"] == 401


def test_a_result_given_as_input_flies_its_own_experiment(ramsey: rabiline.Experiment, tmp_path: Path) -> None:
    ramsey.run().write(tmp_path / "a.h5")
    done = subprocess.run([PROGRAM, "run", tmp_path / "a.h5", "-o", tmp_path / "b.h5"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert np.array_equal(rabiline.open(tmp_path / "a.h5").detected, rabiline.open(tmp_path / "b.h5").detected)


def test_a_notebook_has_a_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    display = pytest.importorskip("IPython.display")
    shown = []
    monkeypatch.setitem(sys.modules, "ipykernel", sys)
    monkeypatch.setattr(display.ProgressBar, "display", lambda bar: shown.append(bar))
    monkeypatch.setattr(display.ProgressBar, "update", lambda bar: None)
    from rabiline.experiment import _Bar
    bar = _Bar(False)
    for done, left in ((0.1, 30.0), (0.5, 15.0), (1.0, 0.0)):
        bar(done, left)
    assert len(shown) == 1 and shown[0].progress == 100
    quick = _Bar(False)
    quick(0.5, 0.5)
    quick(1.0, 0.0)
    assert len(shown) == 1
