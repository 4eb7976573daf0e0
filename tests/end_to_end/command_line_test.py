"""The program as a user meets it: bits, fates, exit codes, what the options change, memory.

RABILINE_PROGRAM names the program; Debian's /usr/bin/python3 -m pytest has what is needed.
"""
from __future__ import annotations

import resource
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from runs import (
    BAD_INPUT, CROWDED, DONE, EDGES, EXPERIMENT, LAWS, NOT_WRITTEN, PROGRAM, QUANTA, ROOT, assert_same_bits, crowded,
    crowded_reference, folder, provenance, rabiline, read, reference, run,
)

VERBS = ("run", "check", "describe", "trace", "resume", "rescan", "merge", "verify", "reproduce")


# ---- The same bits on every machine -----------------------------------------------------------------------------

MACHINES = [("--threads", 1), ("--threads", 2), ("--threads", 3), ("--threads", 7), ("--batch", 8), ("--batch", 64),
            ("--batch", 200), ("--batch", 512), ("--isa", "x86-64"), ("--isa", "avx2"), ("--isa", "avx512")]


@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: f"{machine[0][2:]}={machine[1]}")
def test_a_result_is_the_same_bits_on_every_machine(tmp_path: Path, reference: Path, crowded: Path,
                                                    crowded_reference: Path, machine: tuple) -> None:
    tried = rabiline("run", EXPERIMENT, "-o", tmp_path / "try.h5", "--particles", 1, *EDGES, *machine)
    if machine[0] == "--isa" and "this processor has no" in tried.stderr:
        pytest.skip(tried.stderr)
    assert_same_bits(reference, run(tmp_path / "out.h5", "--particles", 2003, *LAWS, *EDGES, *machine))
    assert_same_bits(crowded_reference, run(tmp_path / "crowded.h5", *machine, experiment=crowded))


def test_independent_points_have_the_same_bits_too(tmp_path: Path, crowded: Path, crowded_reference: Path) -> None:
    mode = ("--set", "scan.particles=independent")
    one = run(tmp_path / "1.h5", *mode, "--threads", 1, "--batch", 64, experiment=crowded)
    assert_same_bits(one, run(tmp_path / "3.h5", *mode, "--threads", 3, experiment=crowded))
    assert not np.array_equal(read(one, "screen/counts"), read(crowded_reference, "screen/counts"))


# ---- Every particle has a fate ----------------------------------------------------------------------------------

@pytest.mark.parametrize("which", ["reference", "crowded_reference"])
def test_the_fates_add_up_to_what_was_emitted_in_quanta(request: pytest.FixtureRequest, which: str) -> None:
    path = request.getfixturevalue(which)
    high, low = read(path, "fates/quanta_high"), read(path, "fates/quanta_low")
    emitted_high, emitted_low = read(path, "fates/emitted_quanta_high"), read(path, "fates/emitted_quanta_low")
    assert high.shape == low.shape and high.shape[1] == 9
    for point in range(9):
        summed = sum(int(h) * 2**64 + int(l) for h, l in zip(high[:, point], low[:, point]))
        assert summed == int(emitted_high[point]) * 2**64 + int(emitted_low[point])
        assert summed == int(read(path, "particles")) * QUANTA


def test_a_crowded_beam_meets_several_fates(crowded_reference: Path) -> None:
    kinds = {(fate.decode(), where.decode()): particles.max() for fate, where, particles in
             zip(*(read(crowded_reference, f"fates/{name}") for name in ("fate", "where", "particles")))}
    met = {line for line, most in kinds.items() if most > 0}
    assert {("detected", "screen"), ("stopped", "hole"), ("passed", "")} <= met


def test_detected_is_the_ledgers_share_and_the_images_sum(crowded_reference: Path) -> None:
    fate, particles = read(crowded_reference, "fates/fate"), read(crowded_reference, "fates/particles")
    caught = particles[list(fate).index(b"detected")]
    assert np.allclose(read(crowded_reference, "scan/detected").ravel() * 1003, caught, rtol=1e-13)
    assert np.allclose(read(crowded_reference, "screen/counts").sum((2, 3)).ravel(), caught, rtol=1e-13)


# ---- Exit codes -------------------------------------------------------------------------------------------------

@pytest.mark.parametrize(("arguments", "says"), [
    ([], "subcommand"),
    (["fly"], ""),
    (["run"], "FILE"),
    (["run", "bad.yaml"], "bad.yaml:3:18: error"),
    (["run", "broken.yaml"], "broken.yaml:1:"),
    (["run", EXPERIMENT, "--speed", "9"], "`rabiline run` has no option `--speed`"),
    (["run", EXPERIMENT, "--particlse", "9"], "did you mean `--particles`?"),
    (["run", EXPERIMENT, "-particles", "9"], "did you mean `--particles`?"), (["--vesion"], "did you mean `--version`?"),
    (["run", EXPERIMENT, "--set", "B.field", "9", "mT"], "write --set 'B.field=9 mT'"),
    (["run", EXPERIMENT, "-n", "1000"], "`rabiline run` has no option `-n`\n  help: did you mean `--particles`?"),
    (["plot", EXPERIMENT, "--siez", "9x9"], "did you mean --size?"),
    (["run", EXPERIMENT, "--isa", "sse9"], "x86-64, avx2 or avx512"),
    (["run", EXPERIMENT, "--batch", "12"], "multiple of 8"),
    (["run", EXPERIMENT, "--threads", "0"], "--threads"),
    (["run", EXPERIMENT, "--particles", "many"], "--particles"),
    (["run", EXPERIMENT, "--particles", "-5"], "particles"),
    (["run", EXPERIMENT, "--particles", "0"], "`particles` must be from 1 to 1e14"),
    (["run", EXPERIMENT, "--particles", "010"], "--particles"),
    (["run", EXPERIMENT, "--set", "variables.B1=9 mT"], "no variable `B1`"),
    (["run", EXPERIMENT, "--set", "B.fild=9 mT"], "did you mean"),
    (["run", EXPERIMENT, "--set", "B.field=9"], "B.field=9"),
    (["run", EXPERIMENT, "--scan", "law=quantum,newton"], "newton"),
    (["run", EXPERIMENT, "-o", "a.csv"], "then `rabiline export a.h5 > a.csv`"),
    (["run", EXPERIMENT, "-o", "a.png"], "then `rabiline plot a.h5 -o a.png`"),
    (["probe", EXPERIMENT, "-o", "field.png"], "--along"),
    (["probe", EXPERIMENT, "--along", "y", "--from", "1 m", "--to", "1 m"], "the line has no length"),
    (["check", "bad.yaml"], "bad.yaml:3:18: error"),
    (["describe", "dorada"], "did you mean `dorado`"),
    (["describe", "efficiency"], "`rabiline describe detector` explains it"),
    (["trace", EXPERIMENT], "--output"),
    (["trace", EXPERIMENT, "-n", "0", "-o", "t.h5"], "-n"),
    (["trace", EXPERIMENT, "--particle", "10000", "-o", "t.h5"], "no particle 10000"),
], ids=lambda value: " ".join(Path(str(part)).name for part in value) if isinstance(value, list) else "")
def test_bad_input_exits_2_and_leaves_nothing(tmp_path: Path, arguments: list, says: str) -> None:
    (tmp_path / "bad.yaml").write_text(CROWDED.replace("neutron", "neutrom"))
    (tmp_path / "broken.yaml").write_text("rabiline: [1")
    before = sorted(tmp_path.iterdir())
    done = rabiline(*arguments, cwd=tmp_path)
    assert done.returncode == BAD_INPUT
    assert says in done.stderr and done.stderr.endswith("\n") and done.stdout == ""
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("verb", ["run", "trace"])
@pytest.mark.parametrize("output", ["missing/out.h5", ".", "file/out.h5", "/proc/out.h5", "/dev/full"])
def test_what_cannot_be_written_exits_3_before_the_run_and_leaves_nothing(tmp_path: Path, verb: str,
                                                                          output: str) -> None:
    (tmp_path / "file").write_text("no folder")
    begin = time.monotonic()
    long = ["--particles", 10**11] if verb == "run" else []
    done = rabiline(verb, EXPERIMENT, *long, "-o", output, cwd=tmp_path)
    assert done.returncode == NOT_WRITTEN
    assert time.monotonic() - begin < 10
    assert output in done.stderr and done.stderr.count("\n") == 1 and done.stdout == ""
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_file_that_may_not_grow_exits_3_and_leaves_what_was_there(tmp_path: Path) -> None:
    output = tmp_path / "out.h5"
    precious = b"\x89HDF\r\n\x1a\n of another day"
    output.write_bytes(precious)
    done = subprocess.run([PROGRAM, "run", EXPERIMENT, "--particles", "10", *EDGES, "-o", output, "--threads", "1"], text=True,
                          capture_output=True, timeout=300,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (10000, 10000)))
    assert done.returncode == NOT_WRITTEN and "out.h5" in done.stderr
    assert list(tmp_path.iterdir()) == [output] and output.read_bytes() == precious


# ---- What the options change, and that it is recorded -----------------------------------------------------------

def test_particles_and_seed_change_what_they_should(tmp_path: Path) -> None:
    few = run(tmp_path / "few.h5", "--particles", 500, *EDGES)
    assert read(few, "particles") == 500 and (read(few, "fates/emitted") == 500).all()
    assert read(few, "simulation/seed") == 1938
    other = run(tmp_path / "other.h5", "--particles", 500, *EDGES, "--seed", 12345678901234567890)
    assert read(other, "simulation/seed") == 12345678901234567890
    assert not np.array_equal(read(few, "screen/counts"), read(other, "screen/counts"))
    assert provenance(other) == ["run", str(EXPERIMENT), "-o", str(other), "--progress", "none", "--threads", "1",
                                 "--particles", "500", *EDGES, "--seed", "12345678901234567890"]
    assert read(other, "simulation/input_0/data").decode() == EXPERIMENT.read_text()
    assert read(other, "simulation/input_0/file_name").decode() == str(EXPERIMENT)


def test_set_does_what_the_file_would_do(tmp_path: Path) -> None:
    written = tmp_path / "written.yaml"
    written.write_text(EXPERIMENT.read_text().replace("length: 0.25 m, field: 10 mT", "length: 0.25 m, field: 9 mT")
                       .replace("particles: 10000", "particles: 700"))
    set_ = ("--set", "B.field=9 mT", "--set", "particles=700")
    assert_same_bits(run(tmp_path / "written.h5", *EDGES, experiment=written), run(tmp_path / "set.h5", *EDGES, *set_))
    assert provenance(tmp_path / "set.h5")[-4:] == list(set_)


def test_a_scan_is_a_range_a_list_or_the_laws(tmp_path: Path) -> None:
    range_ = run(tmp_path / "range.h5", "--particles", 100, "--scan", "H0.frequency=280 kHz:300 kHz:5")
    assert np.allclose(read(range_, "scan/H0_frequency"), np.linspace(280e3, 300e3, 5), rtol=1e-15)
    list_ = run(tmp_path / "list.h5", "--particles", 100, "--scan", "H0.frequency=280 kHz,285000 Hz,290 kHz")
    assert read(list_, "scan/H0_frequency").tolist() == [280e3, 285e3, 290e3]
    assert np.array_equal(read(list_, "screen/counts"), read(range_, "screen/counts")[:3])
    assert provenance(list_)[-1] == "H0.frequency=280 kHz,285000 Hz,290 kHz"


def test_two_scans_make_a_grid_whose_rows_are_single_scans(tmp_path: Path) -> None:
    grid = run(tmp_path / "grid.h5", "--particles", 300, *EDGES, "--scan", "H0.amplitude=0.2 uT,0.4 uT")
    with h5py.File(grid) as file:
        scan = file["entry/scan"]
        axes = list(scan.attrs["axes"])
        assert sorted(axes) == ["H0_amplitude", "H0_frequency"]
        assert scan["detected"].shape == tuple(len(scan[axis]) for axis in axes)
        rows = np.moveaxis(file["entry/screen/counts"][()], axes.index("H0_amplitude"), 0)
    for row, amplitude in zip(rows, ("0.2 uT", "0.4 uT")):
        single = run(tmp_path / "single.h5", "--particles", 300, *EDGES, "--set", f"H0.amplitude={amplitude}")
        assert np.array_equal(read(single, "screen/counts"), row)


def test_three_scans_are_three_dimensions_of_every_result(tmp_path: Path) -> None:
    axes = ("--scan", "law=quantum,dorado", "--scan", "B.field,B_prime.field=10 mT,10.01 mT", "--scan", "H0.enabled=true,false")
    grid = run(tmp_path / "grid.h5", "--no-scan", "--particles", "1e2", *axes)
    with h5py.File(grid) as file:
        scan = file["entry/scan"]
        assert list(scan.attrs["axes"]) == ["law", "B_field", "H0_enabled"]
        assert scan["B_field"].attrs["parameter"] == "B.field, B_prime.field"
        assert scan["detected"].shape == (2, 2, 2)
        counts = file["entry/screen/counts"][()]
    single = run(tmp_path / "single.h5", "--no-scan", "--particles", 100, "--set", "H0.enabled=false", "--set", "B.field=10.01 mT",
                 "--set", "B_prime.field=10.01 mT")
    assert np.array_equal(read(single, "screen/counts").reshape(counts.shape[-2:]), counts[1, 1, 1])


def test_a_scan_without_effect_is_told(tmp_path: Path) -> None:
    done = rabiline("run", EXPERIMENT, "-o", tmp_path / "out.h5", "--progress", "none", "--particles", 10, "--no-scan",
                    "--set", "law=quantum", "--scan", "H0.phase=0 deg,90 deg")
    assert done.returncode == DONE and "the scan of `H0.phase` had no effect" in done.stderr


def test_a_run_that_detects_nothing_says_so(tmp_path: Path) -> None:
    few = ("run", EXPERIMENT, "-o", tmp_path / "out.h5", "--progress", "none", "--particles", 10, "--no-scan")
    assert "nothing was detected" in rabiline(*few, "--set", "screen.offset.x=40 mm").stderr
    assert "nothing was detected" not in rabiline(*few, "--set", "law=quantum").stderr


def test_standard_theory_and_its_classical_limit_agree_at_every_frequency(tmp_path: Path) -> None:
    path = run(tmp_path / "laws.h5", "--particles", 2000, *LAWS)
    labels = [label.decode().split()[0] for label in read(path, "scan/law_labels")]
    assert labels == ["quantum", "classical", "dorado"]
    for name in ("scan/detected", "scan/detected_errors", "screen/counts", "screen/counts_errors"):
        quantum, classical, dorado = read(path, name)
        assert len(quantum) == 101
        assert np.array_equal(quantum, classical), name
    detected = read(path, "scan/detected")
    assert (detected[0] == 1).all()
    assert detected[2].min() < 0.01 and detected[2, 0] > 0.9 and detected[2, -1] > 0.9


# ---- Memory -----------------------------------------------------------------------------------------------------

# A small process in between: a child's peak starts from that of the process that started it.
LAUNCHER = """import resource, subprocess, sys
done = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode
print(done, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"""


def peak_mebibytes(output: Path, *arguments: object) -> float:
    command = [PROGRAM, "run", EXPERIMENT, "-o", output, "--threads", 2, *arguments]
    said = subprocess.run([sys.executable, "-S", "-c", LAUNCHER, *map(str, command)], text=True, capture_output=True,
                          check=True, timeout=300).stdout
    exit_code, kibibytes = map(int, said.split())
    assert exit_code == DONE
    return kibibytes / 1024


@pytest.mark.slow
def test_memory_does_not_grow_with_the_number_of_particles(tmp_path: Path) -> None:
    assert peak_mebibytes(tmp_path / "out.h5") < 200
    few, many = (peak_mebibytes(tmp_path / "out.h5", "--particles", particles, *EDGES)
                 for particles in (10**4, 4 * 10**5))
    assert many < 1.05 * few


# ---- The other verbs --------------------------------------------------------------------------------------------

@pytest.mark.parametrize("verb", ("", *VERBS))
def test_every_verb_has_a_help_text(verb: str) -> None:
    done = rabiline(*verb.split(), "--help")
    assert done.returncode == DONE and done.stderr == ""
    assert "Usage: rabiline" in done.stdout and "--help" in done.stdout
    assert all(other in done.stdout for other in VERBS) or verb


def test_the_version_is_told() -> None:
    assert rabiline("--version").stdout.startswith("rabiline ")


def test_check_tells_the_plan_and_the_derived_numbers() -> None:
    done = rabiline("check", EXPERIMENT)
    assert done.returncode == DONE and done.stderr == ""
    for words in ("The experiment suggested to test the theory", "dorado", "H0.frequency: 266.6 kHz to 316.6 kHz",
                  "101 points", "neutron: spin 1/2", "Larmor 291.6 kHz", "1/T = 5 kHz, FWHM of the line 4.429 kHz", "cost"):
        assert words in done.stdout
    for part in ("B_prime", "screen"):
        assert f"{part}:" in done.stdout


def test_check_tells_why_scan_points_are_read_one_by_one() -> None:
    told = rabiline("check", ROOT / "beamline" / "bloch-siegert.yaml", "--set", "RF.phase=random").stdout
    assert "scan points are read one by one: it depends on phases of the fields, which differ from particle to particle" in told


def test_check_tells_the_resonance_between_two_magnets_and_the_tube_of_an_oven(tmp_path: Path) -> None:
    text = rabiline("check", EXPERIMENT.parent / "rabi-licl.yaml").stdout
    assert "Larmor" in text and "tip angle" in text and "FWHM of the line" in text
    tube = tmp_path / "tube.yaml"
    tube.write_text(EXPERIMENT.read_text().replace("direction: parallel",
                                                   "direction: {kind: channel, length: 5 mm, radius: 0.5 mm}"))
    # R. J. Cole: W = 0.190941 for a length of ten radii.
    assert "transmits W = 0.1909" in rabiline("check", tube).stdout


def test_check_tells_every_error_at_once(tmp_path: Path) -> None:
    bad = tmp_path / "bad.yaml"
    bad.write_text(EXPERIMENT.read_text().replace("neutron", "neutrom").replace("0.3 uT", "0.3"))
    done = rabiline("check", bad)
    assert done.returncode == BAD_INPUT and done.stdout == ""
    assert done.stderr.count("error:") == 2 and done.stderr.count("^") >= 2
    assert "did you mean" in done.stderr


def test_a_result_that_is_read_is_never_written_over(tmp_path: Path) -> None:
    assert rabiline("run", EXPERIMENT, "--particles", "10", *EDGES, "-o", "a.h5", cwd=tmp_path).returncode == DONE
    (tmp_path / "link.h5").symlink_to("a.h5")
    before = (tmp_path / "a.h5").read_bytes()
    for arguments in (["run", "a.h5", "-o", "a.h5"], ["run", "a.h5", "-o", "link.h5"], ["trace", "a.h5", "-o", "a.h5"]):
        done = rabiline(*arguments, cwd=tmp_path)
        assert done.returncode == BAD_INPUT and "what the experiment is read from" in done.stderr
    assert rabiline("run", "a.h5", "--particles", "5", cwd=tmp_path).returncode == DONE
    assert (tmp_path / "a-run.h5").exists() and (tmp_path / "a.h5").read_bytes() == before


def test_describe_explains_everything_that_it_lists() -> None:
    overview = rabiline("describe").stdout
    parts, laws = (overview.split(f"{heading}\n")[1].split("\n\n")[0] for heading in ("Parts", "Laws of motion"))
    listed = [line.split()[0] for line in (parts + "\n" + laws).splitlines()]
    topics = overview.rstrip().splitlines()[-1].split()
    assert {"polarizer", "detector", "quantum", "dorado"} <= set(listed) and "species" in topics
    for topic in listed + topics:
        done = rabiline("describe", topic)
        assert done.returncode == DONE and len(done.stdout) > 50 and done.stderr == ""


@pytest.mark.parametrize(("key", "has"), [("fringe", "tanh"), ("sweep", "begin"), ("pulses", "period"), ("formula", "constants"),
                                          ("gap", "width"), ("bore", "radius"), ("offset", "displacement")])
def test_describe_explains_the_keys_that_hold_others(key: str, has: str) -> None:
    done = rabiline("describe", key)
    assert done.returncode == 0 and has in done.stdout and f"\n  {key}: " in done.stdout


def test_the_examples_of_describe_are_read_as_they_stand(tmp_path: Path) -> None:
    for kind in ("polarizer", "uniform_field", "slit", "detector"):
        example = rabiline("describe", kind).stdout.split("Example\n")[1].splitlines()[0]
        text = EXPERIMENT.read_text().replace("parts:\n", f"parts:\n{example.replace('0.25 m,', '0.60 m,', 1)}\n", 1)
        (tmp_path / "example.yaml").write_text(text)
        done = rabiline("check", tmp_path / "example.yaml")
        assert done.returncode == DONE, done.stderr


def test_trace_writes_the_paths_of_the_particles_asked_for(tmp_path: Path) -> None:
    all_, one = tmp_path / "all.h5", tmp_path / "one.h5"
    done = rabiline("trace", EXPERIMENT, "-n", 3, "-o", all_)
    assert done.returncode == DONE and done.stderr == ""
    assert [line.split(":")[0] for line in done.stdout.splitlines()] == ["particle 0", "particle 1", "particle 2",
                                                                        f"wrote {all_}"]
    assert rabiline("trace", EXPERIMENT, "--particle", 2, "-o", one, "--isa", "x86-64").returncode == DONE
    with h5py.File(all_) as three, h5py.File(one) as single:
        for name in ("t", "x", "y", "z", "vx", "vy", "vz", "sx", "sy", "sz"):
            assert np.array_equal(three[f"entry/particle_2/{name}"], single[f"entry/particle_2/{name}"])
        assert (np.diff(three["entry/particle_0/t"]) >= 0).all() and three["entry/particle_0/y"][0] == 0
    assert rabiline("trace", EXPERIMENT, "-n", 30, "-o", one).stdout == f"30 particles: passed\nwrote {one}\n"  # of many no lines of their own


def test_viewers_read_what_the_program_wrote(tmp_path: Path, reference: Path, crowded_reference: Path) -> None:
    tracks = tmp_path / "tracks.h5"
    assert rabiline("trace", EXPERIMENT, "-n", 1, "-o", tracks).returncode == DONE
    for arguments in ([reference], [crowded_reference], ["--tracks", tracks]):
        viewed = subprocess.run([sys.executable, Path(__file__).with_name("nexus_test.py"), *arguments], text=True,
                                capture_output=True, timeout=300)
        assert viewed.returncode == 0, viewed.stdout + viewed.stderr


def test_a_run_ends_when_the_centre_of_its_line_is_known_and_says_so_where_there_is_none(folder: Path) -> None:
    line = ("--scan", "H0.frequency=286 kHz:297 kHz:23", "--set", "scan.particles=independent",
            "--set", "until={centre_error: 100 Hz}")
    output = run(folder / "line.h5", *line, "--particles", 64000)
    assert 1000 <= read(output, "fates/particles").sum() / 23 < 64000
    missed = rabiline("run", EXPERIMENT, "-o", folder / "flat.h5", "--progress", "none", *line, "--set", "law=quantum",
                      "--particles", 2000)
    assert missed.returncode == DONE
    assert "there is no line in `detected` that chance could not have made" in missed.stderr


def test_no_command_writes_over_what_it_reads(reference: Path, tmp_path: Path) -> None:
    result = tmp_path / "a.h5"
    result.write_bytes(reference.read_bytes())
    link = tmp_path / "a.csv"
    link.symlink_to(result)
    for output in (result, link, tmp_path / "other.h5"):
        tried = rabiline("export", result, "-o", output)
        assert tried.returncode == BAD_INPUT and "--output" in tried.stderr
    drawn = tmp_path / "drawn.png"
    drawn.write_text(EXPERIMENT.read_text())
    assert rabiline("draw", drawn, "-o", drawn).returncode == BAD_INPUT
    assert result.read_bytes() == reference.read_bytes() and drawn.read_text() == EXPERIMENT.read_text()


@pytest.mark.parametrize("command", [["run", EXPERIMENT, "--no-scan", "--particles", "10"], ["trace", EXPERIMENT, "-n", "1"]])
def test_results_replace_results_and_nothing_else(tmp_path: Path, command: list) -> None:
    notes, result = tmp_path / "mine.yaml", tmp_path / "a.h5"
    notes.write_text("rabiline: 1\n")
    refused = rabiline(*command, "-o", notes)
    assert refused.returncode == NOT_WRITTEN
    assert "it is there already and is not an HDF5 file, and is not written over" in refused.stderr
    assert notes.read_text() == "rabiline: 1\n"
    for _ in range(2):
        assert rabiline(*command, "-o", result).returncode == DONE
