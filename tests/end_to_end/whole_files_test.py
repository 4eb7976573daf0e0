"""Results that know whether they are whole, what made them, and how to make them again.

RABILINE_PROGRAM names the program; Debian's /usr/bin/python3 -m pytest has what is needed.
"""
from __future__ import annotations

import hashlib
import os
import random
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from lives_test import BAD_INPUT, DONE, EXPERIMENT, FEW, MODEL, NOT_WRITTEN, ROOT, bits, rabiline, reference, run  # noqa: F401 (fixture)


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
    assert rabiline("reproduce", forged, cwd=tmp_path).returncode == NOT_WRITTEN and (tmp_path / "a-again.1.h5").exists()


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


MAPPED = """rabiline: 1
species: neutron
law: quantum
source: {speed: {kind: single, value: 1000 m/s}, opening: {radius: 2 mm}, direction: parallel, spin: {kind: polarised, axis: x, degree: 1}}
parts:
  - {name: g, kind: field_map, at: 0.3 m, map: {file: map.h5}}
  - {name: screen, kind: detector, at: 1.2 m, width: 40 mm, height: 40 mm, bins: [4, 4]}
particles: 8
seed: 1950
"""


def mapped(folder: Path) -> Path:
    """An experiment with a map whose units are texts of any length."""
    with h5py.File(folder / "map.h5", "w") as file:
        for axis in "xyz":
            file[axis] = np.arange(-2.0, 3.0)
            file[axis].attrs["units"] = "cm"
            file[f"B{axis}"] = np.ones((5, 5, 5))
            file[f"B{axis}"].attrs["units"] = "mT"
    (folder / "in.yaml").write_text(MAPPED)
    return folder / "in.yaml"


def test_a_map_in_another_unit_is_another_map(tmp_path: Path) -> None:
    assert rabiline("run", mapped(tmp_path), "-o", tmp_path / "out.h5", cwd=tmp_path).returncode == DONE
    assert rabiline("reproduce", "out.h5", cwd=tmp_path).returncode == DONE
    before = (tmp_path / "map.h5").read_bytes()
    (tmp_path / "map.h5").write_bytes(before.replace(b"mT", b"uT"))
    other = rabiline("reproduce", "out.h5", cwd=tmp_path)
    assert other.returncode != DONE and "the map is not the one" in other.stderr, other.stderr


def test_a_map_whose_numbers_are_the_same_is_the_same_map(tmp_path: Path) -> None:
    experiment, output = mapped(tmp_path), tmp_path / "out.h5"
    with h5py.File(tmp_path / "map.h5") as file:
        x, y, z = (file[name][()] for name in "xyz")
        rows = [f"{x[i]},{y[j]},{z[k]},{','.join(repr(float(file[name][i, j, k])) for name in ('Bx', 'By', 'Bz'))}"
                for i in range(x.size) for j in range(y.size) for k in range(z.size)]
        head = ",".join(f"{name} [{file[name].attrs['units']}]" for name in ("x", "y", "z", "Bx", "By", "Bz"))
    experiment.write_text(experiment.read_text().replace("map.h5", "map.csv"))
    (tmp_path / "map.csv").write_text("\n".join([head, *rows]) + "\n")
    assert rabiline("run", experiment, "-o", output, cwd=tmp_path).returncode == DONE
    for text in ("# measured\n" + "\n".join([head, *reversed(rows)]), "\r\n".join([head, *rows])):
        (tmp_path / "map.csv").write_bytes(text.encode())
        assert rabiline("reproduce", output, cwd=tmp_path).returncode == DONE
    (tmp_path / "map.csv").write_text("\n".join([head, rows[0] + "1", *rows[1:]]))
    assert "the map is not the one" in rabiline("reproduce", output, cwd=tmp_path).stderr


def test_a_damaged_map_is_refused_or_flown_and_ends_no_program(tmp_path: Path) -> None:
    experiment, draw, refused = mapped(tmp_path), random.Random(1950), 0
    whole = (tmp_path / "map.h5").read_bytes()
    heap = whole.index(b"GCOL")
    for _ in range(40):
        damaged = bytearray(whole)
        for _ in range(3):
            damaged[heap + draw.randrange(4, 64)] = draw.randrange(256)
        (tmp_path / "map.h5").write_bytes(damaged)
        done = subprocess.run(["timeout", "5", os.environ["RABILINE_PROGRAM"], "check", experiment], capture_output=True, text=True)
        assert done.returncode in (DONE, BAD_INPUT), (done.returncode, done.stderr)
        refused += done.returncode == BAD_INPUT
    assert refused > 20
