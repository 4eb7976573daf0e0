"""The program inside Python gives the bits, the messages and the files of the command."""
from __future__ import annotations

import cProfile
import copy
import csv
import os
import pickle
import pstats
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Callable

import h5py
import numpy as np
import pytest
from rescan_test import BEAMLINE, MAGNETS

pytest.importorskip("rabiline._core", reason="built without pybind11")
import rabiline  # noqa: E402
from rabiline.forecasting import forecast  # noqa: E402
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


def test_an_experiment_is_copied_with_its_changes_and_sent_to_other_processes(ramsey: rabiline.Experiment) -> None:
    for other in (pickle.loads(pickle.dumps(ramsey)), copy.deepcopy(ramsey)):
        assert other == ramsey and other.points == 14
        assert other.value("B.field") == ramsey.value("B.field")


def test_fields_are_told_at_places_that_are_numbers(ramsey: rabiline.Experiment) -> None:
    with pytest.raises(ValueError, match="infinite or none"):
        ramsey.field([[0, np.nan, 0]])


def test_a_run_has_the_bits_of_the_command(ramsey: rabiline.Experiment, of_the_command: object) -> None:
    flown = ramsey.run()
    assert {"scan", "detectors", "tallies", "to_xarray"} <= set(dir(flown)) and set(vars(flown)) == {"core"}
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
    with pytest.raises(rabiline.InputError, match="is not a size of memory"):
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


def test_points_of_other_numbers_of_particles_know_theirs() -> None:
    result = rabiline.load(BEAMLINES / "ramsey.yaml").scan().scan("particles", [10, 1000]).run()
    assert result.particles.tolist() == [10, 1000] and "particles    10 to 1000 per point" in result.summary()


def test_a_file_that_changes_afterwards_changes_nothing(ramsey: rabiline.Experiment, tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(ramsey.origin.text.replace("parts:", "geometry: bench.yaml\nparts:"))
    (tmp_path / "bench.yaml").write_text("rabiline: 1\nparts:\n  - {name: mark, kind: slit, at: 1 mm, width: 1 mm, height: 1 mm}\n")
    loaded = rabiline.load(path)
    path.write_text("rabiline: 1\n")
    (tmp_path / "bench.yaml").unlink()
    assert loaded.set({"mark.width": "2 mm"}).value("mark.width") == 2e-3 and loaded.scan().points == 1
    with pytest.raises(rabiline.InputError, match="the file needs `species`"):
        rabiline.load(path)


def test_texts_stay_whole_whatever_they_mean_in_yaml(ramsey: rabiline.Experiment) -> None:
    for title in ("run #3", "a: b", "@home", "a, b", "it's"):
        assert ramsey.set({"title": title}).title == title
    assert ramsey.scan().scan("title", ["a, b", "c"]).points == 2
    assert ramsey.set({"source.speed": "{kind: single, value: 600 m/s}"}).value("source.speed.value") == 600


def test_errors_keep_line_and_caret() -> None:
    text = (BEAMLINES / "ramsey.yaml").read_text().replace("species: neutron", "species: neutorn")
    with pytest.raises(rabiline.InputError) as caught:
        rabiline.load(text)
    assert "species: neutorn" in str(caught.value) and "^^^^^^^" in str(caught.value)
    assert caught.value.diagnostics[0]["help"].startswith("did you mean `neutron`?")
    with pytest.raises(rabiline.StorageError, match="no such file"):
        rabiline.load("nothing.yaml")
    with pytest.raises(rabiline.StorageError):
        rabiline.load(BEAMLINES / "rabi-flop.yaml").set(particles=10).run().write("/nowhere/a.h5")
    with pytest.raises(FileError, match="no such file"):
        rabiline.open("nothing.h5")


def test_errors_of_the_program_are_those_of_the_package(ramsey: rabiline.Experiment) -> None:
    from rabiline import errors
    with pytest.raises(errors.InputError) as caught:
        ramsey.set({"B.feld": 1})
    assert isinstance(caught.value, ValueError) and caught.value.diagnostics
    with pytest.raises(errors.StorageError, match="cannot be written"):
        ramsey.run().write("/nowhere/a.h5")
    with pytest.raises(rabiline.InputError, match="`path` is the path of a file, and is empty"):
        ramsey.run().write("")
    with pytest.raises(rabiline.InputError, match="`source` is the path of a file, and has a zero byte in it"):
        rabiline.load("a\0b")
    with pytest.raises(rabiline.StorageError, match="the file cannot be opened: File name too long"):  # so it is in a folder that is closed
        rabiline.load(300 * "a")


def test_from_one_to_ten_thousand_particles_are_traced(ramsey: rabiline.Experiment) -> None:
    for count in (0, 10001, 10**9):
        with pytest.raises(ValueError, match=f"^`count` is 1 to 10000, not {count}$"):
            ramsey.scan().trace(count)
    assert len(ramsey.scan().trace(1).tracks) == 1


def test_mistakes_in_what_is_set_or_scanned_are_shown_as_the_caller_wrote_them(ramsey: rabiline.Experiment) -> None:
    with pytest.raises(rabiline.InputError) as caught:
        ramsey.scan().set({"B.field": "9 mTT"})
    assert str(caught.value) == ("\nset:1:9: error: `9 mTT` has the unknown unit `mTT`, but `field` is a magnetic field\n"
                                 "  1 | B.field=9 mTT\n    |         ^^^^^\n  help: did you mean `mT`?\n")
    assert caught.value.diagnostics[0]["help"] == "did you mean `mT`?"
    with pytest.raises(rabiline.InputError) as caught:
        ramsey.scan().set({"B.feld": "9 mT", "law": "quantun"})
    assert "  1 | B.feld=9 mT\n    |   ^^^^\n" in str(caught.value) and "  1 | law=quantun\n    |     ^^^^^^^\n" in str(caught.value)
    with pytest.raises(rabiline.InputError, match=r"^\nscan:1:9: error: .*\n  1 \| B.field=1 mTT:2 mT:3\n    \|         \^\^\^\^\^\n"):
        ramsey.scan().scan("B.field", "1 mTT:2 mT:3")


@pytest.mark.parametrize(("call", "says"), [
    (lambda e: e.set([1]), 'changes are a mapping such as {"B.field": "9 mT"}, not list'),
    (lambda e: e.set({1: 2}), "the name of what is changed is a text, not int"),
    (lambda e: e.set({"B.field": None}), "`B.field` is a number in SI, a text with its unit, a list or a mapping, not NoneType"),
    (lambda e: e.scan(3), "`names` is a text, not int"),
    (lambda e: e.scan("B.field", 3), 'the values of a scan are a list, or a range such as "280 kHz:300 kHz:21", not int'),
    (lambda e: e.run(threads="2"), "`threads` is a whole number, not a text"), (lambda e: e.run(isa=3), "`isa` is a text, not int"),
    (lambda e: e.run(transit=None), "`transit` is a text, not NoneType"), (lambda e: e.run(max_memory=3), "`max_memory` is a text, not int"),
    (lambda e: e.run(progress=3), "`progress` is a function, True, False or None, not int"),
    (lambda e: e.fly(2.5), "`threads` is a whole number, not float"), (lambda e: e.trace("3"), "`count` is a whole number, not a text"),
    (lambda e: e.trace(3, 1.5), "`first` is a whole number, not float"), (lambda e: e.field([1, 2, 3]), "`places` is a list of places (x, y, z) in m"),
    (lambda e: e.field([("a", 0, 0)]), "`places` is a list of places (x, y, z) in m"),
    (lambda e: e.field([(0, 0, 0)], times=3), "`times` is a list of 1 times in s, one for each place"),
    (lambda e: e.value(3), "`name` is a text, not int"), (lambda e: e.unit(None), "`name` is a text, not NoneType"),
    (lambda e: e.fit(3, ["B.field"]), "a table is the path of a file or a pandas.DataFrame, not int"),
    (lambda e: e.fit("a.csv", "B.field"), "`free` is a list of names, such as ['B.field'], not a text"),
    (lambda e: e.set({"B.field": b"9 mT"}), "`B.field` is a number in SI, a text with its unit, a list or a mapping, not bytes"), (lambda e: forecast(e, ["B.field"], rate="x"), "`rate` is a number, not a text"),
    (lambda e: forecast(e, ["B.field"], rate=1e6, background="x"), "`background` is a number, not a text"),
    (lambda e: e.set(particles=10).run().write(3), "`path` is the path of a file, not int"), (lambda e: e.run(threads=True), "`threads` is a whole number, not bool"),
    (lambda e: e.set({"source.spin.axis": [1j, 0, 0]}), "`source.spin.axis` is a list or a mapping of numbers, texts, lists and mappings, which do not hold one another"),
])
def test_what_is_of_the_wrong_kind_is_told_in_one_line(ramsey: rabiline.Experiment, call: object, says: str) -> None:
    with pytest.raises(TypeError) as caught:
        call(ramsey)
    assert str(caught.value) == says


def test_numbers_of_paths_are_not_negative(ramsey: rabiline.Experiment) -> None:
    with pytest.raises(ValueError, match="^`count` is 1 to 10000, not -3$"):
        ramsey.trace(-3)
    assert len(ramsey.trace(np.int64(2)).tracks) == 2


def test_a_check_tells_the_plan_and_warnings(ramsey: rabiline.Experiment) -> None:
    assert "Larmor" in str(ramsey.check()) and ramsey.check().warnings == ()
    blind = rabiline.load(BEAMLINES / "ramsey.yaml").scan().set({"first.frequency": "291.647 Hz"})
    assert blind.check().warnings
    with pytest.warns(rabiline.ExperimentWarning):
        blind.run()


@pytest.mark.parametrize("fly", [lambda long: long.run(progress=False), lambda long: long.trace(10000)], ids=["run", "trace"])
def test_ctrl_c_stops_a_flight(fly: Callable[[rabiline.Experiment], object]) -> None:
    long = rabiline.load(BEAMLINES / "caesium-clock.yaml").set(particles=10**9)
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        fly(long)
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
    assert rows[0][:4] == ["first.frequency [Hz]", "detected", "detected_error", "screen: m = +1/2"]
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


def test_importing_it_loads_nothing_that_takes_long() -> None:
    code = "import rabiline, sys; rabiline.load; print(*sys.modules)"
    modules = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.split()
    assert not {"matplotlib", "lmfit", "scipy", "h5py"} & set(modules)


def test_a_call_of_one_particle_is_few_calls_inside(ramsey: rabiline.Experiment) -> None:
    one = ramsey.scan().set(particles=1)
    one.run()
    with cProfile.Profile() as profile:
        one.set({"B.field": 0.0095}).run().detected
    assert pstats.Stats(profile).total_calls < 400  # 154 of them took 4 ms, nearly all in `load` and `fly`


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


def test_a_picture_of_one_detector_of_several_says_how_others_are_shown(tmp_path: Path) -> None:
    proton = (BEAMLINES / "proton-in-a-field.yaml", "--particles", "100", "--progress", "none")
    subprocess.run([PROGRAM, "run", *proton, "--no-scan", "-o", tmp_path / "a.h5"], check=True, capture_output=True)
    done = subprocess.run([PROGRAM, "plot", tmp_path / "a.h5", "-o", tmp_path / "a.png"], check=True, capture_output=True, text=True)
    first, *others = rabiline.open(tmp_path / "a.h5").scan.detectors
    assert f"shown: {first}; " in done.stdout and "--detector NAME" in done.stdout and all(other in done.stdout for other in others)


def test_scripts_of_the_user_do_not_stand_in_for_modules_of_python(tmp_path: Path) -> None:
    """A `csv.py` that calls `rabiline plot` itself would start it without end."""
    for module in ("csv", "numbers", "random", "types"):
        (tmp_path / f"{module}.py").write_text("raise SystemExit('mine was run')\n")
    alone = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run([PROGRAM, "fit-line", "missing.csv"], cwd=tmp_path, env=alone, capture_output=True, text=True)
    assert "missing.csv" in done.stderr and "mine was run" not in done.stderr, done.stderr


def test_check_speaks_json_too(tmp_path: Path) -> None:
    import json
    (tmp_path / "a.yaml").write_text((BEAMLINES / "ramsey.yaml").read_text().replace("field: 10 mT}", "field: 10 mm}"))
    done = subprocess.run([PROGRAM, "check", "--json", tmp_path / "a.yaml"], capture_output=True, text=True)
    told = json.loads(done.stdout)
    assert done.returncode == 2 and told["errors"][0]["line"] > 0 and "magnetic field" in told["errors"][0]["message"]
    told = json.loads(subprocess.run([PROGRAM, "check", "--json", BEAMLINES / "ramsey.yaml"], capture_output=True,
                                     text=True).stdout)
    assert told["errors"] == [] and told["points"] == 401 and 0 < told["cost"]["seconds"] < 60 and told["cost"]["bytes"] > 0


def test_a_result_given_as_input_flies_its_own_experiment(ramsey: rabiline.Experiment, tmp_path: Path) -> None:
    ramsey.run().write(tmp_path / "a.h5")
    done = subprocess.run([PROGRAM, "run", tmp_path / "a.h5", "-o", tmp_path / "b.h5"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert np.array_equal(rabiline.open(tmp_path / "a.h5").detected, rabiline.open(tmp_path / "b.h5").detected)


def test_a_notebook_has_a_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    from IPython import display
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


def test_a_result_that_was_flown_is_copied_and_sent_to_other_processes(ramsey: rabiline.Experiment) -> None:
    flown = ramsey.run()
    for other in (pickle.loads(pickle.dumps(flown)), copy.deepcopy(flown)):
        assert (other.detected == flown.detected).all() and (other.scan.covariance == flown.scan.covariance).all()
        assert repr(other) == repr(flown)


@pytest.mark.parametrize("name, says", [("run", 'rabiline.load("experiment.yaml").run()'), ("read", 'rabiline.open("result.h5")'),
                                        ("plot", 'rabiline.open("result.h5").plot()')])
def test_what_is_no_function_of_the_module_is_told_where_it_is(name: str, says: str) -> None:
    with pytest.raises(AttributeError) as caught:
        getattr(rabiline, name)
    assert str(caught.value) == f"module `rabiline` has no `{name}`: call {says}"


def test_no_run_has_no_threads(ramsey: rabiline.Experiment) -> None:
    for call in (ramsey.run, ramsey.fly):
        with pytest.raises(ValueError, match="^`threads` is 1 to 1024, not 0$"):
            call(threads=0)


def test_messages_name_options_as_callers_write_them(ramsey: rabiline.Experiment, tmp_path: Path) -> None:
    flown = ramsey.set(particles=20).run()
    for options, says in (({"points": "9999", "kind": "image"}, "`points` 9999: the scan points are 0 to 13"), ({"size": (27, 27)}, "`size`: 27x27 leaves no room")):
        with pytest.raises(rabiline.InputError) as caught:
            flown.plot(**options)
        assert str(caught.value).startswith(says)
    counts = tmp_path / "counts.csv"
    counts.write_text("first.frequency [kHz],counts,detector\n290,5,up\n291,5,down\n", encoding="utf-8")
    with pytest.raises(FileError, match="choose one with detector=\"...\"$"):
        ramsey.scan().fit(counts, ["B.field"], detector="left")
    with pytest.raises(rabiline.InputError, match="^`detector` is empty: leave it out, or give a name$"):
        ramsey.scan().fit(counts, ["B.field"], detector="")
    for name in ("a.png", "a.csv"):
        with pytest.raises(rabiline.InputError, match=r"HDF5 is written; name it .h5, or draw with `.plot\(\)`"):
            ramsey.run().write(tmp_path / name)
    assert not (tmp_path / "a.png").exists()
