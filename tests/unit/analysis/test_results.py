"""Reading the files of `rabiline run` and `rabiline trace`."""
from __future__ import annotations

import gzip
from pathlib import Path

import h5py
import numpy as np
import pytest
from rabiline import results, tracks
from rabiline.hdf5 import FileError, UnreadableFile
from synthetic import DORADO, Axis, dip, frequencies, laws, write_results, write_tracks


def test_a_run_without_a_scan_is_one_point(tmp_path: Path) -> None:
    read = results.read(write_results(tmp_path / "a.h5", [], np.array([0.5]), law=["quantum"], bins=8))
    assert read.scan.axes == () and read.scan.shape == (1,)
    assert read.scan.detected.tolist() == [[0.5]]
    assert read.detectors["screen"].counts.shape == (1, 8, 8)
    assert read.detectors["screen"].counts.sum() == 5000
    assert read.laws == ("quantum",) and read.particles.tolist() == [10000]
    assert read.program == "rabiline 0.1.0"


def test_a_file_of_format_version_1_reads_as_it_was_written(tmp_path: Path) -> None:
    written = tmp_path / "format_version_1.h5"
    written.write_bytes(gzip.decompress((Path(__file__).parent / "format_version_1.h5.gz").read_bytes()))
    read = results.read(written)
    assert [axis.parameter for axis in read.scan.axes] == ["law", "H0.frequency"] and read.scan.shape == (2, 3)
    assert read.scan.axes[0].labels[0] == "quantum" and read.scan.axes[0].labels[1].startswith("dorado")
    assert read.scan.detectors == ("screen",) and read.scan.covariance is not None
    assert set(read.particles) == {24} and read.simulation["seed"] == "7"
    assert read.detectors["screen"].counts.shape == (6, 2, 2)
    assert read.detectors["screen"].levels.labels[:2] == ("m = +1/2", "m = -1/2")
    assert read.fates


def test_a_file_of_format_version_2_has_moving_detectors_in_their_own_frame(tmp_path: Path) -> None:
    written = tmp_path / "format_version_2.h5"
    written.write_bytes(gzip.decompress((Path(__file__).parent / "format_version_2.h5.gz").read_bytes()))
    screen = results.read(written).detectors["screen"]
    assert screen.counts.shape == (9, 2, 2) and screen.z_edges == pytest.approx([-0.3e-3, 0, 0.3e-3])
    assert screen.offset_z == pytest.approx(np.repeat([-0.1e-3, 0, 0.1e-3], 3)) and not screen.offset_x.any()


def test_a_file_of_a_later_format_version_is_refused(tmp_path: Path) -> None:
    path = write_results(tmp_path / "a.h5", [], np.array([0.5]), law=["quantum"], bins=8)
    with h5py.File(path, "r+") as file:
        file.attrs["format_version"] = 4
    with pytest.raises(FileError, match="has format version 4; this program reads versions up to 3"):
        results.read(path)


def test_a_scan_has_its_axis_in_si_units(tmp_path: Path) -> None:
    axis = frequencies(11)
    read = results.read(write_results(tmp_path / "a.h5", [axis], dip(axis.values), law=[DORADO], bins=8))
    (found,) = read.scan.axes
    assert (found.parameter, found.units, found.labels) == ("H0.frequency", "Hz", ())
    np.testing.assert_array_equal(found.values, axis.values)
    np.testing.assert_allclose(read.scan.detected[0], dip(axis.values))
    detector = read.detectors["screen"]
    assert detector.counts.shape == (11, 8, 8) and detector.x_edges.size == 9
    np.testing.assert_array_equal(detector.counts.sum(axis=2), detector.counts_x)
    np.testing.assert_array_equal(detector.counts.sum(axis=1), detector.counts_z)
    assert detector.levels.labels == ("m = +1/2", "m = -1/2") and detector.levels.fractions.shape == (11, 2)


def test_a_grid_is_flat_with_its_last_axis_running_fastest(tmp_path: Path) -> None:
    axis = frequencies(5)
    detected = np.concatenate([np.ones(5), dip(axis.values)])
    path = write_results(tmp_path / "a.h5", [laws("quantum", DORADO), axis], detected,
                         law=["quantum"] * 5 + [DORADO] * 5, bins=4)
    read = results.read(path)
    assert read.scan.shape == (2, 5)
    assert read.scan.axes[0].labels == ("quantum", DORADO)
    np.testing.assert_allclose(read.scan.detected[0], detected)
    assert read.detectors["screen"].counts.shape == (10, 4, 4)
    assert read.laws[4:6] == ("quantum", DORADO)


@pytest.mark.parametrize("axes", [[], [frequencies(5)], [laws("quantum", DORADO), frequencies(5)]])
def test_several_detectors_each_have_their_row(tmp_path: Path, axes: list[Axis]) -> None:
    points = int(np.prod([axis.values.size for axis in axes], dtype=int))
    detected = np.array([np.full(points, 0.75), np.full(points, 0.25)])
    covariance = np.stack([np.eye(points), 2 * np.eye(points)])
    path = write_results(tmp_path / "a.h5", axes, detected, law=[DORADO], detectors=("near", "far"),
                         covariance=covariance, bins=4)
    read = results.read(path)
    assert read.scan.detectors == tuple(read.detectors) == ("near", "far")
    np.testing.assert_array_equal(read.scan.detected, detected)
    np.testing.assert_array_equal(read.scan.covariance, covariance)
    np.testing.assert_array_equal(read.detectors["far"].counts.sum(axis=(1, 2)), np.full(points, 2500))


def test_a_detector_named_like_a_group_of_ours_is_found_under_its_other_name(tmp_path: Path) -> None:
    path = write_results(tmp_path / "a.h5", [], np.array([0.5]), law=["quantum"], bins=4)
    with h5py.File(path, "a") as file:
        for suffix in ("", "_x", "_z", "_levels"):
            file.move(f"entry/screen{suffix}", f"entry/scan_{suffix}")
        del file["entry/scan/detector_names"]
        file["entry/scan/detector_names"] = np.array(["scan"], dtype="S")
    assert results.read(path).detectors["scan"].counts.sum() == 5000


def test_the_fates_add_up_to_what_was_emitted(tmp_path: Path) -> None:
    axis = frequencies(11)
    read = results.read(write_results(tmp_path / "a.h5", [axis], dip(axis.values), law=[DORADO], bins=4))
    np.testing.assert_allclose(sum(line.particles for line in read.fates), read.emitted)
    assert [line.fate for line in read.fates] == ["detected", "passed"]


def test_tracks_come_in_the_order_of_their_numbers_with_all_their_vectors(tmp_path: Path) -> None:
    y = np.linspace(0, 1.2, 7)
    flight = {name: np.zeros(7) for name in "t x z vx vz sx sy".split()} | {"y": y, "vy": y + 1, "sz": -np.ones(7)}
    blind = flight | {"sx": np.full(7, np.nan)}
    read = tracks.read(write_tracks(tmp_path / "t.h5", [flight, blind] + [flight] * 10, law=DORADO))
    assert [track.particle for track in read.tracks] == list(range(12))
    assert read.law == DORADO
    first, second = read.tracks[:2]
    np.testing.assert_array_equal(first.position, np.column_stack([0 * y, y, 0 * y]))
    np.testing.assert_array_equal(first.velocity[:, 1], y + 1)
    assert first.has_spin and not second.has_spin
    assert (first.species, first.fate, first.where) == ("neutron", "detected", "screen")


def remove_the_errors(path: Path) -> None:
    with h5py.File(path, "a") as file:
        del file["entry/scan/detected_errors"]


def cut_the_errors(path: Path) -> None:
    remove_the_errors(path)
    with h5py.File(path, "a") as file:
        file["entry/scan/detected_errors"] = np.zeros(3)


def put_the_errors_elsewhere(path: Path) -> None:
    remove_the_errors(path)
    with h5py.File(path, "a") as file:
        file["entry/scan/detected_errors"] = h5py.ExternalLink("/etc/other.h5", "/errors")


def turn_the_errors_into_text(path: Path) -> None:
    remove_the_errors(path)
    with h5py.File(path, "a") as file:
        file["entry/scan/detected_errors"] = "none"


@pytest.mark.parametrize(("harm", "reason"), [
    (remove_the_errors, "/entry/scan: `detected_errors` is missing"),
    (cut_the_errors, "/entry/scan: `detected_errors` has the shape (3,) where (1, 5) belongs"),
    (put_the_errors_elsewhere, "/entry/scan: `detected_errors` lies in another file"),
    (turn_the_errors_into_text, "/entry/scan: `detected_errors` holds no numbers"),
    (lambda path: path.write_text("counts: 7"), "not an HDF5 file"),
    (lambda path: path.unlink(), "no such file"),
    (lambda path: path.write_bytes(path.read_bytes()[:3000]), "cannot be opened: damaged or unfinished"),
])
def test_a_wrong_file_is_named_with_the_reason(tmp_path: Path, harm: object, reason: str) -> None:
    path = write_results(tmp_path / "a.h5", [frequencies(5)], np.ones(5), law=["quantum"], bins=4)
    harm(path)
    with pytest.raises(FileError) as caught:
        results.read(path)
    assert str(caught.value) == f"{path}: {reason}"


def test_names_of_the_file_that_are_damaged_are_no_mistake_of_the_program(tmp_path: Path) -> None:
    path = write_results(tmp_path / "a.h5", [frequencies(5)], np.ones(5), law=["quantum"], bins=4)
    heap = path.read_bytes().index(b"HEAP")  # of the names in the first group: behind the signature 4 bytes, the size, the free list
    damaged = bytearray(path.read_bytes())
    damaged[heap + 16:heap + 24] = (0x7777).to_bytes(8, "little")
    path.write_bytes(damaged)
    with pytest.raises(FileError, match="cannot be used"):
        results.read(path)


def forge(path: Path, name: str, value: object) -> None:
    with h5py.File(path, "a") as file:
        shape = file[f"entry/{name}"].shape
        del file[f"entry/{name}"]
        file[f"entry/{name}"] = np.broadcast_to(value, shape)


@pytest.mark.parametrize(("name", "value", "reason"), [
    ("particles", -5, "`particles` has values that are not above zero"), ("fates/emitted", 0.0, "`emitted` has values that are not above zero"),
    ("fates/particles", -1.0, "`particles` has values below zero"), ("scan/detected", -5.0, "`detected` has values below zero"),
    ("scan/detected", 1e308, "`detected` has values above one"), ("scan/detected_errors", -0.1, "`detected_errors` has values below zero"),
    ("screen/counts", -1.0, "`counts` has values below zero"), ("screen_x/counts_errors", -1.0, "`counts_errors` has values below zero"),
    ("screen/z_edges", [0, 1, 2, 2, 3], "`z_edges` has edges that do not ascend"), ("screen_levels/levels", 7.0, "`levels` has values above one"),
    ("scan/detected_covariance", -1.0, "`detected_covariance` has variances below zero"),
    ("scan/detected_covariance", np.triu(np.ones((5, 5))), "`detected_covariance` is not symmetric"),
    ("scan/detected_covariance", 2 - np.eye(5), "`detected_covariance` has eigenvalues below zero"),
    ("scan/detected_covariance", 1 - np.eye(5), "`detected_covariance` has eigenvalues below zero"),
])
def test_a_number_that_cannot_be_is_refused_with_its_place(tmp_path: Path, name: str, value: object, reason: str) -> None:
    path = write_results(tmp_path / "a.h5", [frequencies(5)], np.full(5, 0.5), law=["quantum"], bins=4, covariance=np.eye(5)[None])
    forge(path, name, value)
    with pytest.raises(UnreadableFile) as caught:
        results.read(path)
    assert str(caught.value) == f"{path}: {'/'.join(['/entry', *name.split('/')[:-1]])}: {reason}"


@pytest.mark.parametrize("covariance", [np.zeros((5, 5)), np.ones((5, 5)), np.ones((5, 5)) - 1e-8 * np.eye(5), np.diag([0, 0, 1, 1e-20, 1])])
def test_a_covariance_may_have_no_variance_and_be_off_by_rounding(tmp_path: Path, covariance: np.ndarray) -> None:
    path = write_results(tmp_path / "a.h5", [frequencies(5)], np.full(5, 0.5), law=["quantum"], bins=4, covariance=covariance[None])
    np.testing.assert_array_equal(results.read(path).scan.covariance, covariance[None])


def test_a_part_ends_behind_its_beginning(tmp_path: Path) -> None:
    flight = {name: np.zeros(3) for name in "t x y z vx vy vz sx sy sz".split()}
    path = write_tracks(tmp_path / "t.h5", [flight])
    with h5py.File(path, "a") as file:
        for name, value in {"name": b"B", "kind": b"magnet", "label": b"B", "begin": 0.3, "end": 0.2, "has_field": 1, "drives": 0}.items():
            file[f"entry/parts/{name}"] = np.array([value])
    with pytest.raises(UnreadableFile, match="/entry/parts: a part ends before it begins"):
        tracks.read(path)


def test_tracks_are_not_taken_for_results_nor_results_for_tracks(tmp_path: Path) -> None:
    run = write_results(tmp_path / "a.h5", [], np.array([0.5]), law=["quantum"], bins=4)
    with pytest.raises(FileError, match="not a file of `rabiline trace`"):
        tracks.read(run)
    with pytest.raises(FileError, match="not a file of `rabiline run`"):
        results.read(write_tracks(tmp_path / "t.h5", []))
