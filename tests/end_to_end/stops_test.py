"""Runs that are stopped, and resumed to the same bits."""
from __future__ import annotations

import signal
import subprocess
import time
from pathlib import Path

import pytest
from runs import BEAM_OF_POINTS, DONE, EDGES, EXPERIMENT, PROGRAM, STOPPED, assert_same_bits, folder, rabiline, reference, run  # noqa: F401 (fixtures)

RAMSEY = EXPERIMENT.with_name("ramsey.yaml")
LONG = ("--particles", 2_400_001, *EDGES)


def start_and_wait_for_progress(*arguments: object, cwd: Path | None = None) -> subprocess.Popen[str]:
    """A run that has flown for half a second, with most of it still to come."""
    process = subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=cwd, text=True, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE)
    assert '"done"' in process.stderr.readline()
    return process


def slow_run(output: Path) -> subprocess.Popen[str]:
    return start_and_wait_for_progress("run", EXPERIMENT, "-o", output, *LONG, "--threads", 1, "--batch", 8,
                                       "--progress", "json")


def stop(process: subprocess.Popen[str], how: signal.Signals) -> str:
    """What it said after the signal; it exits 4 and soon."""
    process.send_signal(how)
    _, errors = process.communicate(timeout=300)
    assert process.returncode == STOPPED, errors
    return errors


@pytest.fixture(scope="module")
def long_reference(folder: Path) -> Path:
    return run(folder / "long.h5", *LONG)


@pytest.mark.slow
def test_a_run_stopped_twice_and_resumed_gives_the_same_bits(tmp_path: Path, long_reference: Path) -> None:
    output = tmp_path / "out.h5"
    checkpoint = tmp_path / "out.h5.checkpoint"
    said = stop(slow_run(output), signal.SIGTERM)
    assert f"rabiline resume {output}" in said
    assert list(tmp_path.iterdir()) == [checkpoint]
    stop(start_and_wait_for_progress("resume", output, "--threads", 1, "--batch", 8, "--progress", "json"), signal.SIGINT)
    assert list(tmp_path.iterdir()) == [checkpoint]
    resumed = rabiline("resume", output)
    assert resumed.returncode == DONE, resumed.stderr
    assert list(tmp_path.iterdir()) == [output]
    assert_same_bits(long_reference, output)


def test_a_stopped_run_leaves_an_earlier_file_and_a_killed_one_too(tmp_path: Path, reference: Path) -> None:
    output = tmp_path / "out.h5"
    output.write_bytes(reference.read_bytes())
    stop(slow_run(output), signal.SIGTERM)
    assert output.read_bytes() == reference.read_bytes()
    (tmp_path / "out.h5.checkpoint").unlink()
    process = slow_run(output)
    process.kill()
    process.communicate(timeout=300)
    assert process.returncode == -signal.SIGKILL
    assert output.read_bytes() == reference.read_bytes()
    assert {path.name for path in tmp_path.iterdir()} <= {"out.h5", ".out.h5.lock"}


@pytest.mark.slow
def test_resume_works_from_another_folder(tmp_path: Path, long_reference: Path) -> None:
    work = tmp_path / "work"
    work.mkdir()
    (work / "mine.yaml").write_text(EXPERIMENT.read_text())
    process = start_and_wait_for_progress("run", "mine.yaml", "-o", "out.h5", *LONG, "--threads", 1, "--batch", 8,
                                          "--progress", "json", cwd=work)
    stop(process, signal.SIGTERM)
    resumed = rabiline("resume", "work/out.h5", cwd=tmp_path)
    assert resumed.returncode == DONE, resumed.stderr
    assert sorted(path.name for path in work.iterdir()) == ["mine.yaml", "out.h5"]
    assert_same_bits(long_reference, work / "out.h5")


MANY_POINTS = BEAM_OF_POINTS + """parts:
  - {name: RF, kind: rotating_field, at: 0.30 m, length: 0.05 m, amplitude: 1 uT, frequency: 9.3265 MHz, sense: co, phase: random}
  - {name: C, kind: uniform_field, at: 0.25 m, length: 0.20 m, field: 1 mT}
  - {name: screen, kind: detector, at: 0.8 m, width: 10 mm, height: 10 mm, bins: [1, 1]}
particles: 300
seed: 1938
scan: {parameter: RF.frequency, from: 9 MHz, to: 10 MHz, points: 200000}
"""


def test_a_signal_while_a_long_scan_is_worked_out_keeps_what_has_flown(tmp_path: Path) -> None:
    scan = ("--particles", 200, "--scan", "first.frequency=281.647 kHz:301.647 kHz:6001", "--threads", 1)
    output, checkpoint = tmp_path / "out.h5", tmp_path / "out.h5.checkpoint"
    process = subprocess.Popen([PROGRAM, "run", str(RAMSEY), "-o", output, *map(str, scan)], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    while not checkpoint.exists() and process.poll() is None:
        time.sleep(0.01)
    begun = time.monotonic()
    assert f"rabiline resume {output}" in stop(process, signal.SIGTERM)
    assert time.monotonic() - begun < 1 and not output.exists()
    resumed = rabiline("resume", output)
    assert resumed.returncode == DONE, resumed.stderr
    assert list(tmp_path.iterdir()) == [output]
    assert_same_bits(run(tmp_path / "again.h5", *scan, experiment=RAMSEY), output)


def test_a_signal_before_the_flight_ends_it_at_once(tmp_path: Path) -> None:
    (tmp_path / "in.yaml").write_text(MANY_POINTS)
    process = subprocess.Popen([PROGRAM, "run", tmp_path / "in.yaml", "-o", tmp_path / "out.h5"], text=True, stderr=subprocess.PIPE)
    time.sleep(0.3)
    assert "stopped before the flight began" in stop(process, signal.SIGTERM)
    assert {path.name for path in tmp_path.iterdir()} <= {"in.yaml", ".out.h5.lock"}


def test_a_signal_while_python_starts_ends_a_command_in_a_line(reference: Path) -> None:
    ends = set()
    for step in range(24):
        how = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)[step % 3]
        process = subprocess.Popen([PROGRAM, "summary", reference], text=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        time.sleep(0.005 * step)
        process.send_signal(how)
        _, errors = process.communicate(timeout=300)
        told = {0: "", -how: "", 128 + how: "rabiline: stopped\n"}  # done already, or no program yet
        assert errors == told.get(process.returncode), (step, process.returncode)
        ends.add(process.returncode)
    assert ends & {130, 143, 129}
