"""Runs of several processes under mpirun: the bits of one, and one voice.

RABILINE_PROGRAM names the program, built with MPI.
"""
from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

import h5py
import pytest
from lives_test import BAD_INPUT, DONE, EXPERIMENT, LONG, MODEL, MORE, PROGRAM, STOPPED, THREE, bits, rabiline, run, wait_for

# As root in a container, and with more ranks than cores.
os.environ.update({"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
                   "OMPI_MCA_btl_vader_single_copy_mechanism": "none"})


def mpirun(ranks: int, *arguments: object) -> list[str]:
    return ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks), PROGRAM, *map(str, arguments)]


def together(ranks: int, *arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(mpirun(ranks, *arguments), text=True, capture_output=True, timeout=600)


def started(ranks: int, output: Path, *arguments: object) -> tuple[subprocess.Popen[str], list[int]]:
    """A run that has flown for half a second, and its processes in the order of ranks."""
    job = subprocess.Popen(mpirun(ranks, "run", EXPERIMENT, "-o", output, *arguments, "--progress", "json"), text=True,
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert any('"done"' in line for line in iter(job.stderr.readline, ""))  # else it has ended
    found = {}
    for place in Path("/proc").glob("[0-9]*"):
        try:
            if int((place / "stat").read_text().rsplit(") ", 1)[1].split()[1]) != job.pid:
                continue
            own = dict(line.split("=", 1) for line in (place / "environ").read_text().split("\0") if "=" in line)
            found[int(own["OMPI_COMM_WORLD_RANK"])] = int(place.name)
        except (OSError, KeyError):
            continue
    assert sorted(found) == list(range(ranks))
    return job, [found[rank] for rank in range(ranks)]


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run(tmp_path_factory.mktemp("ranks") / "reference.h5", *MORE)


@pytest.mark.parametrize("ranks, threads", [(2, 1), (4, 3)])
def test_ranks_fly_a_run_together_to_the_same_bits(tmp_path: Path, reference: Path, ranks: int, threads: int) -> None:
    done = together(ranks, "run", EXPERIMENT, "-o", tmp_path / "a.h5", *MORE[:2], *MORE[4:], "--threads", threads)
    assert done.returncode == DONE, done.stderr
    assert done.stdout.count("wrote") == 1
    assert bits(tmp_path / "a.h5") == bits(reference)
    assert [path.name for path in tmp_path.iterdir()] == ["a.h5"]
    assert "with the same bits" in together(2, "reproduce", tmp_path / "a.h5").stdout


def test_ranks_fly_slabs_of_scan_points_one_behind_the_other(tmp_path: Path) -> None:
    many = ("run", EXPERIMENT, "--no-scan", "--set", "law=classical", "--set", "screen.bins=[2, 2]", "--particles", 24,
            "--scan", "H0.frequency=270 kHz:310 kHz:8100", "--max-memory", "160MiB", "--progress", "none")
    assert rabiline(*many, "-o", tmp_path / "alone.h5").returncode == DONE
    done = together(3, *many, "-o", tmp_path / "a.h5")
    assert done.returncode == DONE, done.stderr
    with h5py.File(tmp_path / "a.h5") as file:
        assert file["entry/simulation/slabs"][0] == 2
    assert bits(tmp_path / "a.h5") == bits(tmp_path / "alone.h5")


def test_they_end_together_at_a_precision(tmp_path: Path) -> None:
    experiment = tmp_path / "mine.yaml"
    experiment.write_text(EXPERIMENT.read_text() + "\nuntil: {detected_error: 2 %}\n")
    options = (*THREE, "--particles", "200000")
    done = together(3, "run", experiment, "-o", tmp_path / "a.h5", *options)
    assert done.returncode == DONE, done.stderr
    assert bits(tmp_path / "a.h5") == bits(run(tmp_path / "b.h5", *options, experiment=experiment))


@pytest.mark.parametrize("rank", [0, 2])
def test_a_signal_to_one_stops_all_with_a_checkpoint_for_any_number(tmp_path: Path, rank: int, reference: Path) -> None:
    output = tmp_path / "a.h5"
    job, processes = started(3, output, *MORE)
    os.kill(processes[rank], signal.SIGUSR2)
    _, said = job.communicate(timeout=300)
    assert job.returncode == STOPPED and said.count("rabiline resume") == 1, said
    assert [path.name for path in tmp_path.iterdir()] == ["a.h5.checkpoint"]
    stopped = together(2, "resume", output, "--max-time", "0.05 s")
    assert stopped.returncode in (STOPPED, DONE), stopped.stderr
    if stopped.returncode == STOPPED:
        assert rabiline("run", EXPERIMENT, "-o", output, *MORE).returncode == DONE
    assert bits(output) == bits(reference)


def test_a_rank_that_dies_takes_nothing_but_what_flew_since_the_last_checkpoint(tmp_path: Path, reference: Path) -> None:
    output = tmp_path / "a.h5"
    job, processes = started(2, output, *MORE, "--checkpoint-every", "0.05 s")
    wait_for(tmp_path / "a.h5.checkpoint", job)
    os.kill(processes[1], signal.SIGKILL)
    job.communicate(timeout=300)
    assert job.returncode != DONE and not output.exists()
    done = together(2, "run", EXPERIMENT, "-o", output, *MORE)
    assert done.returncode == DONE and "continues from" in done.stderr, done.stderr
    assert bits(output) == bits(reference)


def test_what_is_wrong_is_said_once_and_soon(tmp_path: Path) -> None:
    refused = together(3, "run", EXPERIMENT, "-o", tmp_path / "a.h5", "--set", "H0.frequency=291 km")
    assert refused.returncode == BAD_INPUT and refused.stderr.count("is a length") == 1, refused.stderr
    assert together(3, "run", MODEL, "--set", "model.samples=100", "-o", tmp_path / "m.h5").stdout.count("wrote") == 1


def test_what_one_process_does_is_left_to_the_first(tmp_path: Path) -> None:
    done = together(2, "trace", EXPERIMENT, "-n", 1, "-o", tmp_path / "t.h5")
    assert done.returncode == DONE and done.stdout.count("wrote") == 1, done.stderr
    assert together(2, "verify", tmp_path / "t.h5").stdout.count("t.h5") == 1


def test_a_rank_that_fails_ends_the_job_with_its_reason(tmp_path: Path) -> None:
    """Threads that only one of them cannot start."""
    script = f'[ "$OMPI_COMM_WORLD_RANK" = 1 ] && ulimit -v 4000000; exec {PROGRAM} "$@"'
    done = subprocess.run(["mpirun", "--oversubscribe", "--bind-to", "none", "-n", "2", "sh", "-c", script, "sh", "run", str(EXPERIMENT), "-o",
                           str(tmp_path / "a.h5"), *LONG[:2], *LONG[4:], "--threads", "600"], text=True, capture_output=True, timeout=600)
    assert done.returncode == BAD_INPUT, done
    assert "rank 1 of 2" in done.stderr and ("threads cannot be started" in done.stderr or "memory" in done.stderr)
    assert not (tmp_path / "a.h5").exists()
