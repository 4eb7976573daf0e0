"""The life around a run: signals, checkpoints and locks.

RABILINE_PROGRAM names the program; Debian's /usr/bin/python3 -m pytest has what is needed.
"""
from __future__ import annotations

import os
import pty
import random
import re
import resource
import signal
import subprocess
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


def wait_for(file: Path, process: subprocess.Popen[str]) -> None:
    while not file.exists():
        assert process.poll() is None
        time.sleep(0.01)


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


@pytest.fixture(scope="module")
def bits_of_more(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return bits(run(tmp_path_factory.mktemp("lives") / "more.h5", *MORE))


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
        time.sleep(0.2)  # it plans
        process.send_signal(signal.SIGTERM)
        _, said = process.communicate(timeout=300)
        assert process.returncode == STOPPED and re.search("stopped; nothing was written|stopped before the flight began", said)
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


def test_lost_text_is_told_and_an_error_where_it_matters(tmp_path: Path) -> None:
    for arguments, code, word in ((["describe"], NOT_WRITTEN, "error"), (["run", EXPERIMENT, *FEW, "-o", tmp_path / "a.h5"], 0, "warning")):
        with open("/dev/full", "w") as full:
            done = subprocess.run([PROGRAM, *arguments], stdout=full, stderr=subprocess.PIPE, text=True)
        assert done.returncode == code and f"{word}: what was to be printed" in done.stderr and "No space left on device" in done.stderr
    assert rabiline("verify", tmp_path / "a.h5").returncode == 0


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


def test_resume_needs_the_checkpoint_alone(tmp_path: Path, bits_of_more: dict[str, bytes]) -> None:
    experiment = tmp_path / "mine.yaml"
    experiment.write_text(EXPERIMENT.read_text())
    stopped(tmp_path / "a.h5", experiment=experiment)
    experiment.unlink()
    assert rabiline("resume", tmp_path / "a.h5").returncode == DONE
    assert bits(tmp_path / "a.h5") == bits_of_more


def test_a_run_goes_on_from_its_own_checkpoint_and_refuses_another(tmp_path: Path, bits_of_more: dict[str, bytes]) -> None:
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
    assert bits(output) == bits_of_more


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
    wait_for(tmp_path / "a.h5.checkpoint", process)
    process.kill()
    process.communicate()
    done = rabiline("resume", tmp_path / "a.h5", "--max-time", "0.3 s", "--threads", "2", "--progress", "none")
    assert done.returncode == STOPPED, done.stderr


def said_without_a_folder(tmp_path: Path, here: Path) -> str:
    """By a run that is started in `here`, and whose output's folder goes away."""
    folder = tmp_path / "folder"
    folder.mkdir()
    process = subprocess.Popen([PROGRAM, "run", str(EXPERIMENT), "-o", str(folder / "a.h5"), *MORE, "--progress", "json"],
                               text=True, stderr=subprocess.PIPE, cwd=here)
    assert '"done"' in process.stderr.readline()
    folder.rename(tmp_path / "elsewhere")
    _, said = process.communicate(timeout=600)
    assert process.returncode == NOT_WRITTEN
    return said


def test_sums_stay_where_the_result_cannot_be_written(tmp_path: Path, bits_of_more: dict[str, bytes]) -> None:
    here = tmp_path / "here"
    here.mkdir()
    said = said_without_a_folder(tmp_path, here)
    assert "nothing is lost" in said and f"{here / 'a.h5.checkpoint'}" in said
    done = rabiline("resume", "a.h5", cwd=here)
    assert done.returncode == DONE, done.stderr
    assert bits(here / "a.h5") == bits_of_more
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


def test_sums_stay_under_another_name_where_that_is_taken(tmp_path: Path) -> None:
    here = tmp_path / "here"
    here.mkdir()
    taken = {here / "a.h5": b"a result", here / "a.1.h5.checkpoint": b"what another run left"}
    for path, content in taken.items():
        path.write_bytes(content)
    said = said_without_a_folder(tmp_path, here)
    assert f"all that has flown is in {here / 'a.2.h5.checkpoint'}; write the result with" in said
    assert rabiline("resume", "a.2.h5", cwd=here).returncode == DONE
    assert all(path.read_bytes() == content for path, content in taken.items())


@pytest.mark.slow
def test_a_run_killed_at_random_moments_ends_with_the_same_bits(tmp_path: Path) -> None:
    draw = random.Random(1938)
    arguments = [*THREE, "--particles", "3000000", "--checkpoint-every", "0.02 s", "--progress", "none"]
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


def test_a_result_that_was_made_with_so_many_particles_is_flown_with_others(tmp_path: Path) -> None:
    made = run(tmp_path / "made.h5", "--particles", "60", "--seed", "3")
    for changes in (["--set", "particles=40", "--set", "seed=4"], ["--particles", "40", "--seed", "4"]):
        done = rabiline("run", made, *changes, "-o", tmp_path / "again.h5")
        assert done.returncode == DONE, done.stderr
        with h5py.File(tmp_path / "again.h5") as file:
            assert int(file["entry/particles"][()]) == 40
