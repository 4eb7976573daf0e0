"""Scans of more points than fit into memory: their results go into the file slab by slab."""
from __future__ import annotations

import resource
import signal
import subprocess
import time
from pathlib import Path

import h5py
import pytest
from runs import BAD_INPUT, BEAM_OF_POINTS, DONE, NOT_WRITTEN, PROGRAM, STOPPED, rabiline

# Two detectors, a monitor of several planes with a tally, a ledger by level: everything that a point can have.
BEAMLINE = BEAM_OF_POINTS + """  rate: 1e6 /s
parts:
  - {name: A, kind: gradient_magnet, at: 0.1 m, length: 0.1 m, field: 1 T, gradient: 8 T/m}
  - {name: C, kind: uniform_field, at: 0.25 m, length: 0.20 m, field: 1 mT}
  - {name: RF, kind: rotating_field, at: 0.30 m, length: 0.05 m, amplitude: 1 uT, frequency: 9.3265 MHz, sense: co, phase: random}
  - {name: B, kind: gradient_magnet, at: 0.5 m, length: 0.1 m, field: 1 T, gradient: 20 T/m}
  - {name: M, kind: monitor, at: 0.70 m, length: 0.05 m, planes: 3, width: 4 mm, height: 4 mm,
     tallies: [{name: across, axes: [{quantity: x, from: -2 mm, to: 2 mm, bins: 3}]}]}
  - {name: left, kind: detector, at: 0.8 m, width: 1 mm, height: 0.6 mm, bins: [3, 2], offset: {x: -0.6 mm}}
  - {name: right, kind: detector, at: 0.85 m, width: 4 mm, height: 0.6 mm, bins: [2, 1]}
particles: 300
seed: 1938
"""
FILTERS = """
rabiline: 1
title: A flipper
species: neutron
law: quantum
source: {speed: {kind: single, value: 1000 m/s}, opening: {width: 10 mm, height: 20 mm}, direction: parallel}
parts:
  - {name: polariser, kind: spin_filter, at: 0.10 m, axis: z, up: 0.98, down: 0.02}
  - {name: flipper, kind: rotating_field, at: 0.50 m, length: 0.20 m, amplitude: 85 uT, frequency: 29.165 kHz, sense: co, phase: random}
  - {name: guide, kind: uniform_field, at: 0.15 m, length: 1.20 m, field: 1 mT}
  - {name: analyser, kind: spin_filter, at: 1.40 m, axis: z, up: 0.98, down: 0.02}
  - {name: counter, kind: detector, at: 2.00 m, width: 100 mm, height: 100 mm, bins: [8, 8]}
particles: 200
seed: 1938
"""
GRID = ("--scan", "RF.frequency=9.32 MHz:9.33 MHz:350", "--scan", "RF.amplitude=1 uT:3 uT:4", "--scan", "C.field=1 mT:1.00001 mT:3")
IN_SLABS = ("--progress", "none", "--threads", "1")
LINE = ("--scan", "flipper.frequency=20 kHz:40 kHz:8240", "--max-memory", "40MiB", *IN_SLABS)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "rabi.yaml").write_text(BEAMLINE)
    (tmp_path / "filters.yaml").write_text(FILTERS)
    return tmp_path


def contents(path: Path) -> dict[str, tuple]:
    """All but where it comes from: values, shapes, types, how they are packed, attributes."""
    found = {}

    def add(name: str, item: h5py.Group | h5py.Dataset) -> None:
        attributes = {key: str(value) for key, value in item.attrs.items()}
        found[name] = ((item.shape, item.dtype.str, item.chunks, item[()].tobytes()) if isinstance(item, h5py.Dataset) else (), attributes)

    with h5py.File(path) as file:
        file["entry"].visititems(lambda name, item: None if name.startswith("simulation") else add(name, item))
    return found


def slabs(path: Path) -> int:
    with h5py.File(path) as file:
        return int(file["entry/simulation/slabs"][0])


def test_every_dataset_of_a_grid_has_its_bits_in_slabs(folder: Path) -> None:
    for name, *more in (("whole.h5",), ("slabs.h5", "--max-memory", "300MiB")):
        done = rabiline("run", "rabi.yaml", *GRID, "--transit", "totals", "--progress", "none", "-o", name, *more, cwd=folder)
        assert done.returncode == DONE, done.stderr
    whole, in_slabs = contents(folder / "whole.h5"), contents(folder / "slabs.h5")
    assert slabs(folder / "whole.h5") == 1 and slabs(folder / "slabs.h5") > 1
    assert whole.keys() == in_slabs.keys()
    assert [name for name in whole if whole[name] != in_slabs[name]] == []
    for again in (("rescan", "slabs.h5", *GRID, "--max-memory", "300MiB", "-o", "again.h5"), ("rescan", "whole.h5", *GRID, "-o", "once.h5")):
        done = rabiline(*again, cwd=folder)
        assert done.returncode == DONE, done.stderr
    once, several = contents(folder / "once.h5"), contents(folder / "again.h5")
    assert [name for name in once if once[name] != several.get(name)] == []
    for name in ("slabs.h5", "again.h5"):
        assert rabiline("verify", name, cwd=folder).returncode == DONE


def test_check_says_that_it_plans_a_long_scan(folder: Path) -> None:
    done = rabiline("check", "filters.yaml", "--scan", "flipper.frequency=20 kHz:40 kHz:50001", cwd=folder)
    assert done.returncode == DONE and done.stderr == "planning 50001 scan points\n"


# Under `classical` no point follows from the flight of another.
ONE_BY_ONE = ("--set", "law=classical", "--scan", "RF.amplitude=1 uT:3 uT:2", "--scan", "RF.frequency=9.32 MHz:9.33 MHz:2080")
FLOWN = (*ONE_BY_ONE, "--particles", "24")
FLOWN_IN_SLABS = (*FLOWN, "--max-memory", "500MiB", "--progress", "none")
FEW_SUMS = (*ONE_BY_ONE, "--particles", "600", "--set", "M.enabled=false", "--set", "left.enabled=false", "--max-memory", "100MiB", "--progress", "none")


@pytest.mark.parametrize("particles", ["shared", "independent"])
def test_points_that_fly_in_slabs_have_the_bits_of_one_piece(folder: Path, particles: str) -> None:
    for name, *more in (("whole.h5", *FLOWN, "--max-memory", "8GiB"), ("slabs.h5", *FLOWN_IN_SLABS)):
        done = rabiline("run", "rabi.yaml", *more, "--set", f"scan.particles={particles}", "-o", name, cwd=folder)
        assert done.returncode == DONE, done.stderr
    assert slabs(folder / "whole.h5") == 1 and slabs(folder / "slabs.h5") == 2
    whole, in_slabs = contents(folder / "whole.h5"), contents(folder / "slabs.h5")
    assert whole.keys() == in_slabs.keys()
    assert [name for name in whole if whole[name] != in_slabs[name]] == []


def test_slabs_that_fly_in_shards_or_after_stops_have_the_same_bits(folder: Path) -> None:
    assert "scan points fly in 2 slabs" in rabiline("check", "rabi.yaml", *FEW_SUMS[:-2], cwd=folder).stdout
    assert rabiline("run", "rabi.yaml", *FEW_SUMS, "-o", "a.h5", cwd=folder).returncode == DONE
    whole = contents(folder / "a.h5")
    for number in (1, 2):
        done = rabiline("run", "rabi.yaml", *FEW_SUMS, "--shard", f"{number}/2", "-o", f"{number}.shard", cwd=folder)
        assert done.returncode == DONE, done.stderr
    merged = rabiline("merge", "merged.h5", *(f"{number}.shard" for number in (2, 1)), cwd=folder)
    assert merged.returncode == DONE and contents(folder / "merged.h5") == whole, merged.stderr
    # Stopped again and again, by the clock or by force, as far as that comes in time.
    stops = 0
    for how in (signal.SIGTERM, signal.SIGKILL, signal.SIGTERM):
        path = folder / "b.h5.checkpoint"
        if (folder / "b.h5").exists():  # a signal came too late
            break
        before = path.stat().st_mtime_ns if path.exists() else 0
        command = ("resume", "b.h5") if path.exists() else ("run", "rabi.yaml", *FEW_SUMS, "-o", "b.h5")
        process = subprocess.Popen([PROGRAM, *command, "--checkpoint-every", "0.05 s", "--threads", "1"], cwd=folder,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while process.poll() is None:
            if path.exists() and path.stat().st_mtime_ns != before:
                process.send_signal(how)
                stops += 1
                break
            time.sleep(0.002)
        process.wait(timeout=300)
        for left in folder.glob(".rabiline-*.tmp"):
            left.unlink()
    assert stops > 0
    if not (folder / "b.h5").exists():
        resumed = rabiline("resume", "b.h5", cwd=folder)
        assert resumed.returncode == DONE, resumed.stderr
    assert contents(folder / "b.h5") == whole


def test_a_scan_that_no_memory_holds_is_refused_at_once(folder: Path) -> None:
    begin = time.monotonic()
    refused = rabiline("run", "rabi.yaml", "--set", "law=classical", "--set", "left.bins=[200, 200]",
                       "--scan", "RF.frequency=9.32 MHz:9.33 MHz:100000", "-o", "a.h5", cwd=folder)
    assert refused.returncode == BAD_INPUT and "the histograms of 100000 scan points need" in refused.stderr, refused.stderr
    assert time.monotonic() - begin < 60  # less than a plan of all points takes


def peak_of(*arguments: object, cwd: Path) -> float:
    """Of a run, as it was shortly before its end [MiB]."""
    process = subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=cwd, stdout=subprocess.DEVNULL)
    peak = 0
    while process.poll() is None:
        status = Path(f"/proc/{process.pid}/status").read_text()
        peak = max([peak, *(int(line.split()[1]) for line in status.splitlines() if line.startswith("VmHWM:"))])
        time.sleep(0.01)
    assert process.returncode == DONE
    return peak / 1024


def test_more_points_take_hardly_more_memory(folder: Path) -> None:
    few, many = (peak_of("run", "filters.yaml", *IN_SLABS, "--max-memory", "200MiB", "--set", "counter.bins=[16, 16]",
                         "--scan", f"flipper.frequency=20 kHz:40 kHz:{points}", "-o", "a.h5", cwd=folder) for points in (12300, 24600))
    with h5py.File(folder / "a.h5") as file:
        stored = sum(item.size * item.dtype.itemsize for name in ("counter", "counter_x", "counter_z", "fates", "scan")
                     for item in file[f"entry/{name}"].values() if isinstance(item, h5py.Dataset)) / 2**20
    assert slabs(folder / "a.h5") > 5 and stored > 100
    assert many - few < 0.3 * stored, (few, many, stored)


def being_written(folder: Path) -> subprocess.Popen[str] | None:
    """A run some of whose slabs are in the file that nobody sees yet; none where it was over before that was seen."""
    process = subprocess.Popen([PROGRAM, "run", "filters.yaml", *LINE, "-o", "a.h5"], cwd=folder, text=True, stderr=subprocess.PIPE)
    while process.poll() is None:
        for path in folder.glob(".rabiline-*.tmp"):
            try:
                if path.stat().st_size > 10_000:
                    return process
            except FileNotFoundError:  # it was there only to see whether the folder can be written to
                pass
        time.sleep(0.002)
    return None


def ended_while_written(folder: Path, how: signal.Signals, code: int) -> str:
    """What a run said that a signal ended while slabs were written; one that a busy machine let end by itself is flown again."""
    for _ in range(10):
        process = being_written(folder)
        if process:
            process.send_signal(how)
            _, said = process.communicate(timeout=300)
            if process.returncode != DONE:
                assert process.returncode == code, said
                return said
        (folder / "a.h5").unlink()
    raise AssertionError("every run was over before the signal came")


def test_a_run_that_ends_while_slabs_are_written_leaves_no_half_file(folder: Path) -> None:
    done = rabiline("run", "filters.yaml", *LINE[:4], "-o", "b.h5", cwd=folder)
    assert done.returncode == DONE and "writing  33.3 %\nwriting  66.7 %\n" in done.stderr, done.stderr
    assert slabs(folder / "b.h5") == 3
    ended_while_written(folder, signal.SIGKILL, -signal.SIGKILL)
    assert not (folder / "a.h5").exists()
    for path in folder.glob(".rabiline-*.tmp"):
        path.unlink()
    said = ended_while_written(folder, signal.SIGTERM, STOPPED)
    assert "rabiline resume a.h5" in said, said
    assert {path.name for path in folder.iterdir()} == {"rabi.yaml", "filters.yaml", "b.h5", "a.h5.checkpoint"}
    resumed = rabiline("resume", "a.h5", cwd=folder)
    assert resumed.returncode == DONE, resumed.stderr
    assert contents(folder / "a.h5") == contents(folder / "b.h5")


def test_a_disk_that_is_full_between_slabs_is_told_and_nothing_is_lost(folder: Path) -> None:
    assert rabiline("run", "filters.yaml", *LINE, "-o", "b.h5", cwd=folder).returncode == DONE
    for most in (60_000, (folder / "b.h5").stat().st_size - 50):
        full = subprocess.run([PROGRAM, "run", "filters.yaml", *LINE, "-o", "a.h5"], cwd=folder, text=True, capture_output=True,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)))
        assert full.returncode == NOT_WRITTEN, (most, full)
        assert "a.h5: cannot be written (File too large)" in full.stderr and "nothing is lost" in full.stderr
        assert {path.name for path in folder.iterdir()} == {"rabi.yaml", "filters.yaml", "b.h5", "a.h5.checkpoint"}
        resumed = rabiline("resume", "a.h5", cwd=folder)
        assert resumed.returncode == DONE, resumed.stderr
        assert contents(folder / "a.h5") == contents(folder / "b.h5")
        (folder / "a.h5").unlink()
