"""The life around a run: signals, checkpoints, locks, shards, and files that know whether they are whole.

RABILINE_PROGRAM names the program; Debian's /usr/bin/python3 -m pytest has what is needed.
"""
from __future__ import annotations

import hashlib
import os
import pty
import random
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("RABILINE_PROGRAM", str(ROOT / "build" / "release" / "rabiline"))
EXPERIMENT = ROOT / "beamline" / "suggested-experiment.yaml"
OTHER = ROOT / "beamline" / "stern-gerlach.yaml"
MODEL = ROOT / "beamline" / "bound-charge.yaml"
DONE, BAD_INPUT, NOT_WRITTEN, STOPPED = 0, 2, 3, 4
THREE = ("--scan", "H0.frequency=270 kHz,288.1 kHz,295.6 kHz", "--threads", "1")
FEW = (*THREE, "--particles", "2000")
MORE = (*THREE, "--particles", "3000000")
LONG = (*THREE, "--particles", "100000000")


def rabiline(*arguments: object, **how: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([PROGRAM, *map(str, arguments)], text=True, capture_output=True, timeout=300, **how)


def run(output: Path, *arguments: object, experiment: Path = EXPERIMENT) -> Path:
    done = rabiline("run", experiment, "-o", output, *arguments)
    assert done.returncode == DONE, done.stderr
    return output


def long_run(output: Path, *arguments: object, flown: tuple = LONG, experiment: Path = EXPERIMENT) -> subprocess.Popen[str]:
    """A run that has flown for half a second, with most of it still to come."""
    process = subprocess.Popen([PROGRAM, "run", str(experiment), "-o", str(output), *flown, "--progress", "json",
                                *map(str, arguments)], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert '"done"' in process.stderr.readline()
    return process


def bits(path: Path) -> dict[str, bytes]:
    """All but where it comes from."""
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.update({name: item[()].tobytes()})
                        if isinstance(item, h5py.Dataset) and not name.startswith("entry/simulation") else None)
    assert "entry/scan/detected" in found
    return found


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run(tmp_path_factory.mktemp("lives") / "reference.h5", *FEW)


# ---- Signals ----------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("which", ["TERM", "INT", "HUP", "XCPU", "USR1", "USR2", "ALRM"])
def test_a_signal_stops_a_run_with_a_checkpoint_and_soon(tmp_path: Path, which: str) -> None:
    process = long_run(tmp_path / "a.h5")
    process.send_signal(getattr(signal, f"SIG{which}"))
    _, said = process.communicate(timeout=300)  # how soon is measured by tools/endure
    assert process.returncode == STOPPED and "rabiline resume" in said
    assert [path.name for path in tmp_path.iterdir()] == ["a.h5.checkpoint"]


def test_two_signals_close_together_lose_nothing(tmp_path: Path) -> None:
    draw = random.Random(1938)
    for trial in range(8):
        process = long_run(tmp_path / "a.h5")
        which = draw.choice([signal.SIGTERM, signal.SIGINT])
        process.send_signal(which)
        time.sleep(draw.uniform(0, 0.05))
        process.send_signal(which)
        process.communicate(timeout=300)
        assert process.returncode == STOPPED, trial
        (tmp_path / "a.h5.checkpoint").unlink()


def test_whoever_insists_is_obeyed(tmp_path: Path) -> None:
    process = long_run(tmp_path / "a.h5")
    os.kill(process.pid, signal.SIGSTOP)
    for _ in range(3):  # they arrive together, as one; so the process has to run in between
        process.send_signal(signal.SIGTERM)
        process.send_signal(signal.SIGINT)
    os.kill(process.pid, signal.SIGCONT)
    process.communicate(timeout=300)
    assert process.returncode in (STOPPED, -signal.SIGTERM, -signal.SIGINT)


def test_a_limit_of_time_stops_a_run_with_a_checkpoint(tmp_path: Path) -> None:
    begin = time.monotonic()
    done = rabiline("run", EXPERIMENT, "-o", tmp_path / "a.h5", *LONG, "--max-time", "0.7 s")
    assert done.returncode == STOPPED and 0.6 < time.monotonic() - begin < 30
    assert (tmp_path / "a.h5.checkpoint").exists()
    assert rabiline("resume", tmp_path / "a.h5", "--max-time", "1 ns").returncode == STOPPED
    refused = rabiline("run", EXPERIMENT, "-o", tmp_path / "a.h5", *LONG, "--max-time", "0.7 m")
    assert refused.returncode == BAD_INPUT and "--max-time:1:1" in refused.stderr


def catches(process: subprocess.Popen[str], which: signal.Signals) -> bool:
    assert process.poll() is None
    caught = next(line for line in Path(f"/proc/{process.pid}/status").read_text().splitlines() if line.startswith("SigCgt"))
    return bool(int(caught.split()[1], 16) >> (which - 1) & 1)


def test_a_model_and_a_trace_stop_too(tmp_path: Path) -> None:
    for arguments in (["run", MODEL, "--scan", "model.inclination=1 deg:40 deg:1000", "--set", "model.samples=100"], ["trace", EXPERIMENT, "-n", "10000"]):
        process = subprocess.Popen([PROGRAM, *map(str, arguments), "-o", str(tmp_path / "a.h5")], text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        while not catches(process, signal.SIGTERM):
            time.sleep(0.005)
        process.send_signal(signal.SIGTERM)
        _, said = process.communicate(timeout=300)
        assert process.returncode == STOPPED and "stopped; nothing was written" in said
        assert list(tmp_path.iterdir()) == []


def test_a_pipe_that_closes_changes_nothing(tmp_path: Path, reference: Path) -> None:
    process = subprocess.Popen([PROGRAM, "run", str(EXPERIMENT), "-o", str(tmp_path / "a.h5"), *MORE, "--progress", "json"],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    process.stdout.close()
    process.stderr.close()
    assert process.wait(timeout=600) == DONE
    assert (tmp_path / "a.h5").exists()


def test_a_terminal_that_closes_stops_with_a_checkpoint(tmp_path: Path) -> None:
    child, terminal = pty.fork()
    if child == 0:
        os.execv(PROGRAM, [PROGRAM, "run", str(EXPERIMENT), "-o", str(tmp_path / "a.h5"), *LONG])
    assert os.read(terminal, 1)  # of the progress line
    os.close(terminal)
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == STOPPED
    assert (tmp_path / "a.h5.checkpoint").exists()


@pytest.mark.parametrize("arguments", [["run", EXPERIMENT, *FEW], ["trace", EXPERIMENT], ["run", MODEL]], ids=["run", "trace", "model"])
def test_a_limit_on_file_sizes_exits_3(tmp_path: Path, arguments: list) -> None:
    done = rabiline(*arguments, "-o", tmp_path / "a.h5", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (6000, 6000)))
    assert done.returncode == NOT_WRITTEN and "File too large" in done.stderr
    assert [path for path in tmp_path.iterdir() if path.suffix == ".tmp"] == []


def test_lost_text_is_told_where_it_matters() -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run([PROGRAM, "describe"], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == NOT_WRITTEN and "No space left on device" in done.stderr


def test_threads_that_cannot_be_started_are_told(tmp_path: Path) -> None:
    done = rabiline("run", EXPERIMENT, *FEW[:2], *FEW[4:], "--threads", "1000", "-o", tmp_path / "a.h5",
                    preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30)))
    assert done.returncode == BAD_INPUT and ("threads cannot be started" in done.stderr or "memory" in done.stderr)


# ---- Checkpoints ------------------------------------------------------------------------------------------------

def stopped(output: Path, experiment: Path = EXPERIMENT) -> Path:
    """The checkpoint of a run that was stopped."""
    process = long_run(output, flown=MORE, experiment=experiment)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=300)
    assert process.returncode == STOPPED
    return Path(f"{output}.checkpoint")


def test_resume_writes_what_it_was_told_to(tmp_path: Path) -> None:
    old = tmp_path / "old.h5"
    stopped(old).rename(tmp_path / "kept.h5.checkpoint")
    run(old, *FEW)
    before = old.read_bytes()
    done = rabiline("resume", tmp_path / "kept.h5")
    assert done.returncode == DONE, done.stderr
    assert old.read_bytes() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["kept.h5", "old.h5"]


def test_resume_needs_the_checkpoint_alone(tmp_path: Path) -> None:
    experiment = tmp_path / "mine.yaml"
    experiment.write_text(EXPERIMENT.read_text())
    stopped(tmp_path / "a.h5", experiment=experiment)
    experiment.unlink()
    assert rabiline("resume", tmp_path / "a.h5").returncode == DONE
    run(tmp_path / "b.h5", *MORE)
    assert bits(tmp_path / "a.h5") == bits(tmp_path / "b.h5")


def test_a_run_goes_on_from_its_own_checkpoint_and_refuses_another(tmp_path: Path) -> None:
    output = tmp_path / "a.h5"
    checkpoint = stopped(output)
    kept = checkpoint.read_bytes()
    for other in (FEW, (*MORE, "--transit", "none"), (*MORE, "--shard", "1/2")):
        refused = rabiline("run", EXPERIMENT, "-o", output, *other)
        assert refused.returncode == BAD_INPUT
        assert f"{checkpoint} is a checkpoint of another run" in refused.stderr and f"rm {checkpoint}" in refused.stderr
        assert checkpoint.read_bytes() == kept and not output.exists()
    done = rabiline("run", EXPERIMENT, "-o", output, *MORE)
    assert done.returncode == DONE and f"continues from {checkpoint}" in done.stderr
    run(tmp_path / "b.h5", *MORE)
    assert bits(output) == bits(tmp_path / "b.h5")


def test_a_second_run_to_the_same_output_is_refused(tmp_path: Path) -> None:
    process = long_run(tmp_path / "a.h5")
    (tmp_path / "link.h5").symlink_to("a.h5")
    for arguments in (["run", EXPERIMENT, *FEW, "-o", tmp_path / "a.h5"], ["run", OTHER, "-o", tmp_path / "link.h5"]):
        refused = rabiline(*arguments)
        assert refused.returncode == NOT_WRITTEN
        assert f"is being written by process {process.pid}" in refused.stderr
    process.terminate()
    process.communicate(timeout=300)
    assert process.returncode == STOPPED


def test_checkpoints_are_written_as_often_as_was_asked(tmp_path: Path) -> None:
    process = long_run(tmp_path / "a.h5", "--checkpoint-every", "0.1 s")
    while not (tmp_path / "a.h5.checkpoint").exists():
        assert process.poll() is None
        time.sleep(0.01)
    process.kill()
    process.communicate()
    done = rabiline("resume", tmp_path / "a.h5", "--max-time", "0.3 s", "--threads", "2", "--progress", "none")
    assert done.returncode == STOPPED, done.stderr


def test_sums_stay_where_the_result_cannot_be_written(tmp_path: Path, reference: Path) -> None:
    folder, here = tmp_path / "folder", tmp_path / "here"
    folder.mkdir()
    here.mkdir()
    process = subprocess.Popen([PROGRAM, "run", str(EXPERIMENT), "-o", str(folder / "a.h5"), *MORE, "--progress", "json"],
                               text=True, stderr=subprocess.PIPE, cwd=here)
    assert '"done"' in process.stderr.readline()
    folder.rename(tmp_path / "elsewhere")
    _, said = process.communicate(timeout=600)
    assert process.returncode == NOT_WRITTEN and "nothing is lost" in said
    assert f"{here / 'a.h5.checkpoint'}" in said
    done = rabiline("resume", "a.h5", cwd=here)
    assert done.returncode == DONE, done.stderr
    run(tmp_path / "b.h5", *MORE)
    assert bits(here / "a.h5") == bits(tmp_path / "b.h5")
    assert [path.name for path in here.iterdir()] == ["a.h5"]


def test_an_earlier_result_is_kept_where_that_was_asked(tmp_path: Path, reference: Path) -> None:
    output = tmp_path / "a.h5"
    output.write_bytes(reference.read_bytes())
    run(output, *FEW, "--seed", "7", "--keep")
    assert (tmp_path / "a.1.h5").read_bytes() == reference.read_bytes()
    assert bits(output) != bits(reference)


def test_an_input_is_no_place_for_checkpoints(tmp_path: Path) -> None:
    experiment = tmp_path / "a.h5.checkpoint"
    experiment.write_text(EXPERIMENT.read_text())
    refused = rabiline("run", experiment, "-o", tmp_path / "a.h5")
    assert refused.returncode == BAD_INPUT and "is where checkpoints" in refused.stderr
    assert experiment.exists()


@pytest.mark.slow
def test_a_run_killed_at_random_moments_ends_with_the_same_bits(tmp_path: Path) -> None:
    draw = random.Random(1938)
    arguments = [*THREE, "--particles", "20000000", "--checkpoint-every", "0.02 s", "--progress", "none"]
    kills = 0
    while True:
        process = subprocess.Popen([PROGRAM, "run", str(EXPERIMENT), "-o", str(tmp_path / "a.h5"), *arguments],
                                   stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        try:
            assert process.wait(timeout=draw.uniform(0.02, 0.6)) == DONE
            break
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            kills += 1
    assert kills > 3
    assert bits(tmp_path / "a.h5") == bits(run(tmp_path / "b.h5", *arguments[:-4], "--progress", "none"))


# ---- Files that know whether they are whole ---------------------------------------------------------------------

def test_whatever_changes_a_file_is_noticed_by_every_reader(tmp_path: Path, reference: Path) -> None:
    assert "whole" in rabiline("verify", reference).stdout
    whole = reference.read_bytes()
    draw = random.Random(1938)
    changed = tmp_path / "changed.h5"
    analysis = [sys.executable, "-m", "rabiline", "summary", str(changed)]
    for trial in range(60):
        flipped = bytearray(whole)
        flipped[draw.randrange(len(whole))] ^= 1 << draw.randrange(8)
        changed.write_bytes(flipped)
        verbs = [["verify", changed], ["trace", changed, "-o", tmp_path / "t.h5"], ["rescan", changed, "--set", "H0.amplitude=0.4 uT"],
                 ["reproduce", changed], ["merge", tmp_path / "m.h5", changed]]
        refused = rabiline(*verbs[trial % len(verbs)], cwd=tmp_path)
        assert refused.returncode in (BAD_INPUT, NOT_WRITTEN) and "changed.h5" in refused.stderr, (trial, refused)
        if trial % 10 == 0:
            read = subprocess.run(analysis, text=True, capture_output=True, env={**os.environ, "PYTHONPATH": str(ROOT / "analysis")})
            assert read.returncode == NOT_WRITTEN and "Traceback" not in read.stderr, read.stderr
    with h5py.File(changed, "w") as file:
        file.attrs["format_version"] = 3
        file.create_group("entry")
    read = subprocess.run(analysis, text=True, capture_output=True, env={**os.environ, "PYTHONPATH": str(ROOT / "analysis")})
    assert read.returncode == NOT_WRITTEN and "no seal" in read.stderr


def before_cost(checked: subprocess.CompletedProcess) -> str:
    """What `check` tells, up to the time that it has measured."""
    assert "\ncost " in checked.stdout
    return checked.stdout.split("\ncost ")[0]


def test_a_result_is_flown_again_from_what_it_holds(tmp_path: Path) -> None:
    experiment = tmp_path / "mine.yaml"
    experiment.write_text(EXPERIMENT.read_text())
    result = run(tmp_path / "a.h5", *FEW, "--set", "H0.amplitude=0.4 uT", experiment=experiment)
    experiment.unlink()
    same = rabiline("reproduce", result, "--threads", "2")
    assert same.returncode == DONE and "with the same bits" in same.stdout
    solved = run(tmp_path / "model.h5", "--set", "model.samples=100", experiment=MODEL)
    assert "with the same bits" in rabiline("reproduce", solved).stdout
    tracks = rabiline("trace", result, "--particle", "3", "-o", tmp_path / "t.h5")
    assert tracks.returncode == DONE and "particle 3:" in tracks.stdout
    alone = ("check", EXPERIMENT, *FEW[:2], *FEW[4:], "--set", "H0.amplitude=0.4 uT")
    assert before_cost(rabiline("check", result)) == before_cost(rabiline(*alone))


def test_a_forged_result_is_told_what_differs(tmp_path: Path) -> None:
    forged = run(tmp_path / "a.h5", *FEW)
    forged.write_bytes(forged.read_bytes()[:-109])  # without its last line
    with h5py.File(forged, "r+") as file:
        file["entry/scan/detected"][1] += 0.01
    seal = f"\nrabiline: SHA-256 of all before this line: {hashlib.sha256(forged.read_bytes()).hexdigest()}\n"
    forged.write_bytes(forged.read_bytes() + seal.encode())
    told = rabiline("reproduce", forged, cwd=tmp_path)
    assert told.returncode == NOT_WRITTEN and "comes out otherwise here\n  differing: /entry/scan/detected\n  help" in told.stderr, told.stderr


def test_every_parameter_is_in_the_file_as_it_was_flown(tmp_path: Path) -> None:
    output = run(tmp_path / "a.h5", "--particles", "64", "--scan", "H0.frequency=270 kHz,288.1 kHz", "--scan", "law=dorado,classical,quantum",
                 "--set", "H0.amplitude=0.4 uT")
    with h5py.File(output) as file:
        group = file["entry/parameters"]
        found = {name.decode(): (value, unit.decode(), word.decode())
                 for name, value, unit, word in zip(*(group[key][()] for key in ("name", "value", "unit", "word")))}
        assert found["H0.amplitude"][:2] == (pytest.approx(0.4e-6, rel=1e-15), "T")
        assert found["source.speed.mean"][:2] == (1000, "m/s") and found["screen.bins.x"][0] == 80 and found["particles"][0] == 64
        assert found["species.mass"][0] == pytest.approx(1.67492750056e-27) and found["H0.sense"][2] == "co"
        assert "H0.frequency" not in found and "law.name" not in found
        scanned = group["scanned"]
        assert scanned["H0.frequency"].attrs["units"] == b"Hz" or scanned["H0.frequency"].attrs["units"] == "Hz"
        assert sorted(set(scanned["H0.frequency"][()])) == [270e3, 288.1e3]
        assert set(scanned["law.name"].asstr()[()]) == {"dorado", "classical", "quantum"}
        closures = scanned["law.closure"].asstr()[()]
        assert set(closures[scanned["law.name"].asstr()[()] != "dorado"]) == {""}


def test_numbers_that_overflow_are_a_fate_with_an_example(tmp_path: Path) -> None:
    """A map whose field is too large for the square of a number."""
    rows = [f"{x},{y},{z},{1e200 if x > 0 else 1e-6},0,0" for x in (-0.03, -0.01, 0.01, 0.03)
            for y in (0.0, 0.05, 0.1, 0.15) for z in (-0.03, -0.01, 0.01, 0.03)]
    (tmp_path / "map.csv").write_text("x [m],y [m],z [m],Bx [T],By [T],Bz [T]\n" + "\n".join(rows) + "\n")
    (tmp_path / "e.yaml").write_text("""rabiline: 1
title: too strong
species: neutron
law: {name: classical}
source:
  speed: {kind: gaussian, mean: 1000 m/s, sigma: 10 m/s}
  opening: {width: 1 mm, height: 1 mm}
  direction: parallel
parts:
  - {name: map, kind: field_map, at: 0.1 m, map: map.csv, outside: zero}
  - {name: screen, kind: detector, at: 1 m, width: 4 mm, height: 4 mm, bins: [4, 4]}
particles: 200
seed: 1
""")
    output = run(tmp_path / "a.h5", experiment=tmp_path / "e.yaml")
    with h5py.File(output) as file:
        fates = dict(zip(file["entry/fates/fate"].asstr()[()], file["entry/fates/particles"][:, 0]))
        warnings = " ".join(file["entry/simulation/warnings"].asstr()[()])
    assert fates["overflowed"] > 0 and "--particle" in warnings
    number = warnings.split("--particle ")[1].split("`")[0]
    traced = rabiline("trace", output, "--particle", number, "-o", tmp_path / "t.h5")
    assert "overflowed" in traced.stdout, traced


def test_what_a_title_holds_does_not_steer_a_terminal(tmp_path: Path) -> None:
    experiment = tmp_path / "mine.yaml"
    experiment.write_text(EXPERIMENT.read_text().replace("title: ", 'title: "\\x1b]0;x\\x07\\u009b31m" #', 1))
    done = rabiline("run", experiment, *FEW, "-o", tmp_path / "a.h5")
    assert done.returncode == DONE and "?]0;x??31m" in done.stdout
    assert not any(ord(c) < 32 and c != "\n" or 0x7f <= ord(c) < 0xa0 for c in done.stdout)
