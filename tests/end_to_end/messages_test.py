"""What the command line says of values that cannot be meant, and of runs that cannot do what is asked of them."""
from __future__ import annotations

import resource
import subprocess
from pathlib import Path

import h5py
import pytest
from runs import BAD_INPUT, DONE, EXPERIMENT, NOT_WRITTEN, PROGRAM, ROOT, rabiline

RAMSEY = ROOT / "beamline" / "ramsey.yaml"
SPECTRUM = """rabiline: 1
species: neutron
law: quantum
source: {speed: {kind: tabulated, file: spectrum.csv}, opening: {radius: 1 mm}, direction: parallel}
parts: [{name: D, kind: detector, at: 1 m, width: 1 cm, height: 1 cm, bins: [1, 1]}]
particles: 100
seed: 1
"""


@pytest.mark.parametrize("kilobytes", [64, 160])
@pytest.mark.parametrize("verb", [("check",), ("run", "--no-scan", "--particles", "10", "-o", "small.h5")])
@pytest.mark.parametrize("name", ["ramsey", "caesium-clock", "hydrogen-source"])
def test_a_small_stack_is_enough(tmp_path: Path, name: str, verb: tuple[str, ...], kilobytes: int) -> None:
    size, file = kilobytes << 10, ROOT / "beamline" / f"{name}.yaml"
    done = subprocess.run([PROGRAM, verb[0], str(file), *verb[1:]], cwd=tmp_path, text=True, capture_output=True, timeout=300,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_STACK, (size, size)))
    assert done.returncode == DONE, done.stderr


@pytest.mark.parametrize("option", ["--threads", "--shard", "--max-time", "--checkpoint-every", "--max-memory", "--isa", "--seed",
                                    "--particles", "--batch", "-o"])
@pytest.mark.parametrize("joined", [False, True])
def test_an_option_without_a_value_is_refused(tmp_path: Path, option: str, joined: bool) -> None:
    given = [f"{option}="] if joined and option.startswith("--") else [option, ""]
    done = rabiline("run", EXPERIMENT, *given, cwd=tmp_path)
    assert done.returncode == BAD_INPUT and f"`{option}` is set to nothing" in done.stderr
    assert not list(tmp_path.iterdir())


def test_a_line_without_an_axis_is_refused() -> None:
    done = rabiline("probe", EXPERIMENT, "--along", "")
    assert done.returncode == BAD_INPUT and "`--along` is set to nothing" in done.stderr and done.stdout == ""


def test_a_blank_seed_is_blamed_on_the_option() -> None:
    done = rabiline("check", EXPERIMENT, "--seed", " ")
    assert done.returncode == BAD_INPUT and "--seed:1:1: error: `--seed` is set to nothing" in done.stderr


def test_a_time_of_zero_is_not_given_back_with_a_unit() -> None:
    done = rabiline("run", EXPERIMENT, "--max-time", "0")
    assert done.returncode == BAD_INPUT and "`0 s`" not in done.stderr and "write a time such as" in done.stderr


@pytest.mark.parametrize("scale", [1e-308, 1.0, 1e155, 1e308])
def test_the_scale_of_a_spectrum_does_not_matter(tmp_path: Path, scale: float) -> None:
    (tmp_path / "spectrum.csv").write_text(f"speed [m/s],flux\n500,{scale}\n600,{scale}\n")
    (tmp_path / "beam.yaml").write_text(SPECTRUM)
    assert "550 m/s on average" in rabiline("check", "beam.yaml", cwd=tmp_path).stdout
    assert rabiline("run", "beam.yaml", cwd=tmp_path).returncode == DONE
    with h5py.File(tmp_path / "beam.h5") as file:
        assert file["entry/scan/detected"][()].sum() == 1


def test_a_precision_that_no_number_of_particles_reaches_is_called_so(tmp_path: Path) -> None:
    done = rabiline("run", RAMSEY, "--no-scan", "--particles", "1000", "--set", "until.detected_error=1e-30", "-o", "a.h5",
                    cwd=tmp_path)
    assert done.returncode == DONE and "that cannot be reached" in done.stderr and "1e+14 are the most" in done.stderr


def test_check_tells_what_run_refuses_for_its_memory() -> None:
    big = ("--set", "screen.bins=[3000, 3000]", "--scan", "first.frequency=290 kHz,291 kHz", "--max-memory", "20MiB")
    refused = rabiline("run", RAMSEY, *big)
    assert refused.returncode == BAD_INPUT
    checked = rabiline("check", RAMSEY, *big)
    assert checked.returncode == DONE and "refused    by `rabiline run`: the histograms of 2 scan points need" in checked.stdout
    assert "refused" not in rabiline("check", RAMSEY).stdout


def test_counts_that_no_spin_can_change_are_noted_once(tmp_path: Path) -> None:
    noted = "no part in front of `screen` sorts spins"
    checked = rabiline("check", RAMSEY, "--strict")
    assert checked.returncode == DONE and checked.stdout.count(noted) == 1
    flown = rabiline("run", RAMSEY, "--strict", "--particles", "10", "-o", "a.h5", cwd=tmp_path)
    assert flown.returncode == DONE and flown.stdout.count(noted) == 1 and flown.stderr == ""
    assert noted not in rabiline("check", EXPERIMENT).stdout


def test_a_rescan_tells_why_nothing_was_kept(tmp_path: Path) -> None:
    assert rabiline("run", EXPERIMENT, "--particles", "10", "--transit", "totals", "-o", "a.h5", cwd=tmp_path).returncode == DONE
    done = rabiline("rescan", "a.h5", cwd=tmp_path)
    assert done.returncode == NOT_WRITTEN and "none follows from this flight: the scan changes more" in done.stderr


def test_the_first_steps_of_help_need_no_other_files() -> None:
    said = rabiline("--help").stdout
    assert "rabiline new ramsey" in said and "beamline/" not in said
