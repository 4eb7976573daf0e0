"""Shards of a run, flown apart and merged."""
from __future__ import annotations

import os
from pathlib import Path

import pytest
from lives_test import BAD_INPUT, DONE, EXPERIMENT, FEW, NOT_WRITTEN, ROOT, STOPPED, bits, rabiline, reference, run


def shards_of(folder: Path, count: int) -> list[Path]:
    return [run(folder / f"s{i}.h5", *FEW, "--shard", f"{i}/{count}") for i in range(1, count + 1)]


def test_merged_shards_are_the_run_in_one_piece(tmp_path: Path, reference: Path) -> None:
    for count in (1, 2, 5):
        done = rabiline("merge", tmp_path / f"all{count}.h5", *reversed(shards_of(tmp_path, count)))
        assert done.returncode == DONE, done.stderr
        assert bits(tmp_path / f"all{count}.h5") == bits(reference)
        assert rabiline("reproduce", tmp_path / f"all{count}.h5").returncode == DONE


def test_shards_that_do_not_belong_together_are_refused_by_name(tmp_path: Path, reference: Path) -> None:
    first, second, third = shards_of(tmp_path, 3)
    other = run(tmp_path / "other.h5", *FEW, "--seed", "7", "--shard", "2/3")
    for parts, says in (([first, third], "missing: 2"), ([first, second, second, third], f"{second} and {second} are both shard 2/3"),
                        ([first, other, third], f"{other}: is a shard of another run"), ([first, reference], f"{reference}: is neither"),
                        ([], "PARTS")):
        refused = rabiline("merge", tmp_path / "all.h5", *parts)
        assert refused.returncode in (BAD_INPUT, NOT_WRITTEN) and says in refused.stderr, refused.stderr
    assert not (tmp_path / "all.h5").exists()


def test_a_shard_is_not_written_over_whatever_it_is_called(tmp_path: Path) -> None:
    parts = shards_of(tmp_path, 2)
    before = parts[0].read_bytes()
    (tmp_path / "linked.h5").symlink_to("s1.h5")
    for output in (f"{tmp_path}/./s1.h5", tmp_path / "linked.h5"):
        refused = rabiline("merge", output, *parts)
        assert refused.returncode == BAD_INPUT and "is what is merged" in refused.stderr, refused.stderr
    assert parts[0].read_bytes() == before


@pytest.mark.parametrize("shard", ["0/3", "4/3", "3", "1/0", "a/b", "1/3/4", "-1/3"])
def test_a_shard_that_is_none_is_refused(tmp_path: Path, shard: str) -> None:
    refused = rabiline("run", EXPERIMENT, *FEW, f"--shard={shard}", "-o", tmp_path / "a.h5")
    assert refused.returncode == BAD_INPUT and "shard" in refused.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_launcher_needs_shards(tmp_path: Path) -> None:
    several = {**os.environ, "OMPI_COMM_WORLD_SIZE": "4"}
    refused = rabiline("run", EXPERIMENT, *FEW, "-o", tmp_path / "a.h5", env=several)
    assert refused.returncode == BAD_INPUT and "--shard" in refused.stderr
    assert rabiline("run", EXPERIMENT, *FEW, "--shard", "2/4", "-o", tmp_path / "a.h5", env=several).returncode == DONE
    alone = {**os.environ, "OMPI_COMM_WORLD_SIZE": "1"}
    assert rabiline("run", EXPERIMENT, *FEW, "-o", tmp_path / "a.h5", env=alone).returncode == DONE


def test_a_checkpoint_of_another_run_is_not_lost_beside_what_writes_none(tmp_path: Path) -> None:
    """Of a merge, a model, paths and a rescan."""
    first, second = shards_of(tmp_path, 2)
    kept = run(tmp_path / "kept.h5", *FEW)
    output = tmp_path / "out.h5"
    stopped = rabiline("run", EXPERIMENT, "--particles", "1e9", "--max-time", "0.1 s", "-o", output)
    assert stopped.returncode == STOPPED
    checkpoint = Path(f"{output}.checkpoint").read_bytes()
    for command in (["merge", output, first, second], ["run", ROOT / "beamline" / "bound-charge.yaml", "-o", output],
                    ["trace", EXPERIMENT, "-n", "1", "-o", output], ["rescan", kept, "--set", "H0.frequency=290 kHz", "-o", output]):
        refused = rabiline(*command)
        assert refused.returncode == BAD_INPUT and "is a checkpoint of another run, which would be lost" in refused.stderr, refused.stderr
        assert Path(f"{output}.checkpoint").read_bytes() == checkpoint and not output.exists()
        refused = rabiline(*(f"{word}.checkpoint" if word == output else word for word in command))
        assert refused.returncode == BAD_INPUT and "is named like the checkpoint of a run, which would be lost" in refused.stderr, refused.stderr
        assert Path(f"{output}.checkpoint").read_bytes() == checkpoint


@pytest.mark.parametrize("letters", [242, 247, 252, 253, 8000])
def test_a_name_that_is_too_long_for_its_checkpoint_is_told(tmp_path: Path, letters: int) -> None:
    name = tmp_path / ("b" * letters + ".h5")
    for command in (["run", EXPERIMENT, *FEW, "-o", name], ["resume", name]):
        refused = rabiline(*command)
        assert refused.returncode == NOT_WRITTEN and "File name too long" in refused.stderr, refused.stderr
    assert list(tmp_path.iterdir()) == []
