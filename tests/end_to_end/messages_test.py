"""What the command line says of values that cannot be meant, and of runs that cannot do what is asked of them."""
from __future__ import annotations

import json
import os
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


@pytest.mark.parametrize(("line", "says"), [
    (["--from", "0 s", "--to", "1 m"], "--from: `0 s` is not a length"),
    (["--from", "0 m"], "--along: where the line ends is missing\n  help: add `--to '1 m'`"),
    (["--to", "1 m"], "--along: where the line begins is missing\n  help: add `--from '0 m'`"),
])
def test_a_line_is_told_what_it_lacks(line: list[str], says: str) -> None:
    done = rabiline("probe", EXPERIMENT, "--along", "y", *line)
    assert done.returncode == BAD_INPUT and says in done.stderr and done.stdout == ""


def test_the_last_number_of_a_particle_is_told(tmp_path: Path) -> None:
    done = rabiline("trace", EXPERIMENT, "--particle", "1e15", "-o", tmp_path / "t.h5")
    assert done.returncode == BAD_INPUT and "`--particle` must be from 0 to 1e14, but is `1e15`" in done.stderr


def test_help_is_told_how_it_is_asked_for() -> None:
    assert "did you mean `--help`?" in rabiline("help").stderr
    assert rabiline("run").stderr == "error: FILE is required\n  help: `rabiline run --help` tells what there is\n"


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


@pytest.mark.parametrize(("arguments", "told"), [
    (["fit", RAMSEY, "--data", "c.csv", "--fre", "guide.field"], "--fre (did you mean --free?)"),
    (["new", "Rasmey"], "`Rasmey` is none of ramsey, "), (["new", "Rasmey"], "(did you mean ramsey?)"),
    (["plot", "a.h5", "--data", "c.csv"], "--data is an option of plot-scan"),
    (["forecast", RAMSEY, "--free", "guide.field", "--rate", "4 kHz"], "`4 kHz` is no rate above 0: write a number per second"),
    (["forecast", RAMSEY, "--free", "guide.field", "--seconds", "ten"], "`ten` is no time above 0: write seconds"),
    (["forecast", RAMSEY, "--free", "guide.field", "--size", "86x60"], "unrecognized arguments: --size"),
    (["fit", "counts.csv", "--data", RAMSEY, "--free", "guide.field"],
     f"counts.csv is a table, and an experiment belongs here\n  help: `rabiline fit {RAMSEY} --data counts.csv` fits an experiment to it\n"),
    (["forecast", "counts.csv", "--free", "guide.field"], "help: `rabiline fit EXPERIMENT.yaml --data counts.csv` fits an experiment to it"),
    (["fit", RAMSEY, "--data", RAMSEY, "--free", "guide.field"], "ramsey.yaml: an experiment, and a table of counts belongs here (CSV)"),
    (["fit-line", RAMSEY], "is an experiment, and a form is fitted to a result of it")])
def test_the_package_tells_what_was_meant(arguments: list[str], told: str) -> None:
    done = rabiline(*arguments)
    assert done.returncode == BAD_INPUT and told in done.stderr and done.stderr.count("rabiline: ") == 1


@pytest.mark.parametrize("command", ["plot", "plot-image", "summary"])
def test_a_table_in_the_place_of_a_result_is_told_what_tables_are_for(tmp_path: Path, command: str) -> None:
    (tmp_path / "my counts.csv").write_text("first.frequency [kHz],counts\n289,5\n292,7\n")
    done = rabiline(command, "my counts.csv", cwd=tmp_path)
    assert done.returncode == NOT_WRITTEN and done.stderr == (
        "rabiline: my counts.csv: a table, not an HDF5 file\n  help: `rabiline plot-scan RESULT.h5 --data 'my counts.csv'` draws counts beside a curve, "
        "`rabiline fit EXPERIMENT.yaml --data 'my counts.csv'` and `rabiline fit-line 'my counts.csv'` fit them\n")


def test_a_value_of_what_is_free_is_set(tmp_path: Path) -> None:
    (tmp_path / "counts.csv").write_text("first.frequency [kHz],counts\n289,5\n292,7\n")
    done = rabiline("fit", RAMSEY, "--data", tmp_path / "counts.csv", "--free", "guide.field=1 mT", "--detector", "screen", "--particles", 10)
    assert done.returncode == BAD_INPUT and done.stderr == (
        "rabiline: `guide.field=1 mT` is free by its name alone: `guide.field`\n  help: --set guide.field='1 mT' says where it starts\n")


def test_a_forecast_takes_times_and_rates_with_their_units() -> None:
    usual = ("forecast", EXPERIMENT.parent / "caesium-clock.yaml", "--free", "C.field", "--particles", "1000")
    plain, per_minute, minutes = (rabiline(*usual, "--rate", rate, "--seconds", time).stdout
                                  for rate, time in (("4e4", "600"), ("2.4e6 /min", "600"), ("4e4 1/s", "10 min")))
    assert plain == per_minute == minutes and "C.field" in plain


@pytest.mark.parametrize("arguments", [["run", "never.yaml"], ["check", "never.yaml"], ["trace", "never.yaml", "-o", "t.h5"],
                                       ["probe", "never.yaml"], ["run", "."], ["resume", "never.h5"], ["verify", "never.h5"],
                                       ["reproduce", "never.h5"], ["rescan", "never.h5"], ["merge", "all.h5", "never.h5"]], ids=" ".join)
def test_a_file_that_is_not_there_exits_3_whatever_reads_it(tmp_path: Path, arguments: list[str]) -> None:
    done = rabiline(*arguments, cwd=tmp_path)
    assert done.returncode == NOT_WRITTEN and done.stderr.startswith("error: ") and done.stdout == "", done
    assert "never" in done.stderr or "folder" in done.stderr
    assert not list(tmp_path.iterdir())


def test_check_tells_programs_of_a_file_that_is_not_there(tmp_path: Path) -> None:
    done = rabiline("check", "never.yaml", "--json", cwd=tmp_path)
    assert done.returncode == NOT_WRITTEN and json.loads(done.stdout)["errors"][0]["file"] == "never.yaml"


@pytest.mark.parametrize("arguments", [["check", RAMSEY], ["describe"], ["--help"], ["--version"], ["summary", "--help"],
                                       ["probe", RAMSEY, "--along", "y", "--from", "0 m", "--to", "1 m"]])
def test_text_that_nobody_can_get_is_an_error(arguments: list) -> None:
    done = subprocess.run(["sh", "-c", 'exec "$@" >&-', "sh", PROGRAM, *map(str, arguments)], text=True, capture_output=True, timeout=300)
    assert done.returncode == NOT_WRITTEN and "could not be written to the standard output (it is closed)" in done.stderr


def test_a_result_is_whole_where_all_streams_are_closed(tmp_path: Path) -> None:
    command = ["sh", "-c", 'exec "$@" <&- >&- 2>&-', "sh", PROGRAM, "run", str(EXPERIMENT), "--particles", "10", "-o", "a.h5"]
    assert subprocess.run(command, cwd=tmp_path, timeout=300).returncode == DONE
    assert rabiline("verify", "a.h5", cwd=tmp_path).returncode == DONE


@pytest.mark.parametrize(("options", "says"), [
    (["--seed", "1", "--seed", "2"], "`--seed` is given twice"),
    (["-o", "a.h5", "--output", "b.h5"], "`--output` is given twice"),
    (["--batch", "12"], "--batch must be a multiple of 8 from 8 to 512, but is 12"),
    (["--max-time", "1 d"], "help: write it like `10 min`"),
    (["--shard", "1/"], "--shard is NUMBER/OF, such as 2/8, but `1/` stands here"),
    (["--transit", "all"], "error: --transit: all not in"),
    (["--max-memory", "1e-9MiB"], "`1e-9MiB` is not a size of memory"),
    (["--scan", ",=1,2"], "the name of a parameter is missing here"),
    (["--seed", "1e30"], "`seed` must be from 0 to 2^64 - 1 = 18446744073709551615, but is `1e30`"),
])
def test_what_is_wrong_with_an_option_is_told_with_its_value(tmp_path: Path, options: list[str], says: str) -> None:
    done = rabiline("run", EXPERIMENT, *options, cwd=tmp_path)
    assert done.returncode == BAD_INPUT and says in done.stderr, done.stderr


def test_a_checkpoint_is_resumed_by_the_name_of_its_result(tmp_path: Path) -> None:
    (tmp_path / "my run.h5.checkpoint").write_text("")
    done = rabiline("resume", "my run.h5.checkpoint", cwd=tmp_path)
    assert done.returncode == NOT_WRITTEN and "help: rabiline resume 'my run.h5'\n" in done.stderr


def test_a_folder_in_the_place_of_a_checkpoint_is_not_to_be_removed(tmp_path: Path) -> None:
    (tmp_path / "a.h5.checkpoint").mkdir()
    done = rabiline("run", EXPERIMENT, "--particles", "10", "-o", "a.h5", cwd=tmp_path)
    assert done.returncode == NOT_WRITTEN and "a.h5.checkpoint is a folder" in done.stderr and "rm" not in done.stderr.split()


def test_one_point_is_told_as_one(tmp_path: Path) -> None:
    one = ("--scan", "H0.frequency=290 kHz", "--particles", "10")
    told = rabiline("check", EXPERIMENT, *one).stdout
    assert "scan       H0.frequency: 290 kHz, one point\n" in told and "particles  10\n" in told
    assert ": 10 particles, " in rabiline("run", EXPERIMENT, *one, "-o", "a.h5", cwd=tmp_path).stdout
    two = rabiline("run", EXPERIMENT, "--scan", "H0.frequency=290 kHz,291 kHz", "--particles", "10", "-o", "b.h5", cwd=tmp_path)
    assert ": 2 scan points, 10 particles each, " in two.stdout


WAVES = SPECTRUM.replace("kind: tabulated, file: spectrum.csv", "kind: single, value: 1000 m/s").replace("parts: [", """parts: [
  {name: F, kind: formula_field, at: 0 m, formula: {Bx: "0", By: "0", Bz: "b*sin(k*y)", constants: {b: 1 mT, k: 100 1/m},
   width: 1 cm, height: 1 cm, length: 1 m, step: 2 mm}}, """)


def test_the_picture_of_a_line_has_no_corners(tmp_path: Path) -> None:
    (tmp_path / "waves.yaml").write_text(WAVES)
    line = ("probe", "waves.yaml", "--along", "y", "--from", "0 m", "--to", "1 m")
    assert rabiline(*line, cwd=tmp_path).stdout.count("\n") == 102
    drawn = rabiline(*line, "-o", "field.svg", cwd=tmp_path)
    assert drawn.returncode == DONE, drawn.stderr
    assert max(path.count("\nL ") for path in (tmp_path / "field.svg").read_text().split("<path")) > 300


def test_a_table_may_have_quotes_around_its_cells(tmp_path: Path) -> None:
    (tmp_path / "spectrum.csv").write_text('"speed [m/s]","flux"\n"500",1\n600,1\n')
    (tmp_path / "beam.yaml").write_text(SPECTRUM)
    assert "550 m/s on average" in rabiline("check", "beam.yaml", cwd=tmp_path).stdout


def test_a_run_without_a_title_is_told_without_one(tmp_path: Path) -> None:
    (tmp_path / "spectrum.csv").write_text("speed [m/s],flux\n500,1\n600,1\n")
    (tmp_path / "beam.yaml").write_text(SPECTRUM)
    assert rabiline("check", "beam.yaml", cwd=tmp_path).stdout.startswith("law        quantum\n")
    assert rabiline("run", "beam.yaml", cwd=tmp_path).stdout.startswith("100 particles, ")


MAP = """rabiline: 1
species: neutron
law: quantum
source: {speed: {kind: single, value: 1000 m/s}, opening: {radius: 1 mm}, direction: parallel}
parts:
  - {name: F, kind: field_map, at: 0.5 m, map: map.csv}
  - {name: D, kind: detector, at: 1 m, width: 1 cm, height: 1 cm, bins: [1, 1]}
particles: 100
seed: 1
"""


def map_of(field: str) -> str:
    rows = (f"{x},{y},{z},0,0,{field}" for x in (-1, 0, 1, 2) for y in (-2, -1, 0, 1, 2) for z in (-1, 0, 1, 2))
    return '"x [cm]","y [cm]","z [cm]","Bx [T]","By [T]","Bz [T]"\n' + "\n".join(rows) + "\n"


def test_a_map_of_an_absurd_field_is_told(tmp_path: Path) -> None:
    (tmp_path / "beam.yaml").write_text(MAP)
    for field, told in (("1e-3", False), ("1e300", True)):
        (tmp_path / "map.csv").write_text(map_of(field))
        assert ("the field of `F` comes to 1e+300 T on the axis" in rabiline("check", "beam.yaml", cwd=tmp_path).stdout) == told


def test_a_damaged_map_is_named_once(tmp_path: Path) -> None:
    (tmp_path / "map.h5").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(100))
    (tmp_path / "beam.yaml").write_text(MAP.replace("map.csv", "map.h5"))
    assert "error: `map.h5`: HDF5 failed" in rabiline("check", "beam.yaml", cwd=tmp_path).stderr


@pytest.mark.parametrize("written", ["mine", "mine.yml", "mnie.yaml"])
def test_a_file_whose_name_is_nearly_written_is_offered(tmp_path: Path, written: str) -> None:
    (tmp_path / "mine.yaml").write_text("rabiline: 1\n")
    (tmp_path / "mine.csv").write_text("1\n")
    refused = rabiline("check", tmp_path / written)
    assert refused.returncode == NOT_WRITTEN and f"help: did you mean `{tmp_path / 'mine.yaml'}`?" in refused.stderr, refused.stderr
    assert "did you mean" not in rabiline("check", tmp_path / "another.yaml").stderr


@pytest.mark.parametrize(("topic", "says"), [("tanh", "tanh (fringe): (1 - tanh(s))/2"), ("enge", "enge (fringe): "), ("sine", "sine (fringe): "),
                                             ("half_sine", "half_sine (profile): "), ("standing_wave", "standing_wave (profile): ")])
def test_kinds_of_fringes_and_profiles_are_described(topic: str, says: str) -> None:
    assert says in rabiline("describe", topic).stdout


def test_check_speaks_of_levels_where_there_are_any() -> None:
    for law, told in (("quantum", "2 levels, "), ("classical", "a vector, turned by the zones below")):
        assert f"spins at screen: {told}" in rabiline("check", EXPERIMENT, "--set", f"law={law}").stdout


@pytest.mark.parametrize("backend", ["nonsense", "module://nowhere"])
def test_a_backend_that_there_is_not_is_no_mistake_of_the_program(tmp_path: Path, backend: str) -> None:
    done = subprocess.run([PROGRAM, "draw", RAMSEY, "-o", "a.png"], cwd=tmp_path, env={**os.environ, "MPLBACKEND": backend}, text=True, capture_output=True)
    assert done.returncode == BAD_INPUT and not list(tmp_path.iterdir())
    assert done.stderr == f"rabiline: MPLBACKEND is `{backend}`, which matplotlib cannot load here\n  help: unset it, or set it to Agg\n"


def test_a_detector_that_there_is_not_is_refused_by_a_fit_of_a_line(tmp_path: Path) -> None:
    assert rabiline("run", RAMSEY, "--particles", 100, "-o", tmp_path / "a.h5", "--progress", "none").returncode == DONE
    (tmp_path / "counts.csv").write_text("first.frequency [kHz],counts\n289,5\n292,7\n")
    for file, says in (("a.h5", "a.h5: no detector `nope` (there is screen)\n"),
                       ("counts.csv", "counts.csv: it has no column `detector`, so --detector chooses nothing\n")):
        done = rabiline("fit-line", file, "--detector", "nope", cwd=tmp_path)
        assert (done.returncode, done.stderr) == (BAD_INPUT, f"rabiline: {says}")


TWO_PHOTONS = """rabiline: 1
species: K-39 atom
law: quantum
source: {speed: {kind: single, value: 200 m/s}, opening: {radius: 1 nm}, direction: parallel, spin: {kind: levels, levels: ["F=2 m=+2"]}}
parts:
  - {name: C, kind: uniform_field, at: 0 m, length: 0.5 m, field: 1 mT}
  - {name: R, kind: oscillating_field, at: 0.15 m, length: 0.1 m, amplitude: 15 uT, frequency: 3347.6 kHz, direction: [1, 0, 1], phase: locked,
     approximation: rotating_wave}
  - {name: D, kind: detector, at: 0.35 m, width: 10 mm, height: 10 mm, bins: [1, 1]}
particles: 4
seed: 1
scan: {parameter: R.frequency, from: 3346.7 kHz, to: 3348.8 kHz, points: 22}
"""


@pytest.mark.parametrize(("amplitude", "words"), [("15 uT", ""), ("60 uT", "may shift F=2 m=+2 - F=2 m=+1 by two photons by up to 17")])
def test_a_scan_over_a_line_of_two_photons_is_told_nothing_but_what_shifts_it(tmp_path: Path, amplitude: str, words: str) -> None:
    """It is off by 2 x 130 Hz at 60 uT, as an integration of the whole field says."""
    (tmp_path / "a.yaml").write_text(TWO_PHOTONS)
    done = rabiline("check", tmp_path / "a.yaml", "--set", f"R.amplitude={amplitude}")
    assert done.returncode == DONE and "F=2 m=+2 - F=2 m=+1 by two photons at" in done.stdout
    assert words in done.stdout if words else "warning" not in done.stdout
    assert "no scan point is near" not in done.stdout
