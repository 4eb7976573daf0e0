"""One call of the system after the other fails: an earlier result is then still there, or the new one is whole.

RABILINE_PROGRAM names the program; the calls fail by a library that is preloaded, failing_calls.c.
"""
from __future__ import annotations

import os
import random
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("RABILINE_PROGRAM", str(ROOT / "build" / "release" / "rabiline"))
EXPERIMENT = ROOT / "beamline" / "stern-gerlach.yaml"
MODEL = ROOT / "beamline" / "bound-charge.yaml"
ENDS = (0, 2, 3)

VERBS = {
    "run": ["run", EXPERIMENT, "--particles", "64", "--threads", "1"],
    "trace": ["trace", EXPERIMENT, "-n", "1"],
    "model": ["run", MODEL, "--set", "model.samples=100"],
}


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("failing") / "failing_calls.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", Path(__file__).with_name("failing_calls.c"), "-o", out, "-ldl"], check=True)
    return out


def ends(arguments: list, library: Path, call: str, number: int, folder: Path, **more: str) -> int:
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=300, cwd=folder,
                          env={**os.environ, "LD_PRELOAD": str(library), "FAIL_CALL": call, "FAIL_AT": str(number),
                               "TMPDIR": str(folder), **more})
    assert done.returncode in ENDS, (call, number, more, done)
    return done.returncode


@pytest.mark.slow
@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("call", ["write", "fsync", "rename", "close", "open"])
def test_whichever_call_fails_a_result_is_there(tmp_path: Path, library: Path, verb: str, call: str) -> None:
    output = tmp_path / "out.h5"
    arguments = [*VERBS[verb], "-o", output]
    subprocess.run([PROGRAM, *map(str, arguments)], check=True, capture_output=True)
    earlier = output.read_bytes()
    seen = tmp_path / "seen"
    for number in range(1, 30):
        for more in ({}, {"FAIL_ON": "1"}):
            output.write_bytes(earlier)
            ends(arguments, library, call, number, tmp_path, FAIL_SEEN=str(seen), **more)
            if output.read_bytes() != earlier:
                assert subprocess.run([PROGRAM, "verify", output], capture_output=True).returncode == 0, (number, more)
        if not seen.exists():
            break  # it is not called so often
        seen.unlink()
    assert number > 1


@pytest.mark.slow
def test_no_memory_is_told(tmp_path: Path, library: Path) -> None:
    """From main on; and not of what reads and writes HDF5, which crashes where its own malloc fails."""
    draw = random.Random(1938)
    for number in sorted(draw.randrange(200, 9000) for _ in range(200)):
        for more in ({}, {"FAIL_ON": "1"}):
            ends(["check", EXPERIMENT], library, "malloc", number, tmp_path, **more)
