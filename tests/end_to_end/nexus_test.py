"""Checks that viewers plot a file of rabiline by default: nexus_test.py RESULTS.h5 | --tracks TRACKS.h5

Run with Debian's /usr/bin/python3, which has h5py; tools/install-packages --tests says where silx is.
"""

import sys

import h5py
import numpy
from silx.io.nxdata import NXdata, get_default

ROOT_ATTRIBUTES = ("default", "creator", "creator_version", "file_name", "file_time", "HDF5_Version")


def nx_class(item):
    return item.attrs.get("NX_class", "")


def groups_of_class(file, wanted):
    """Every group of that class."""
    found = []
    file.visititems(lambda _, item: found.append(item) if nx_class(item) == wanted else None)
    return found


def check_root(file):
    assert nx_class(file) == "NXroot"
    for name in ROOT_ATTRIBUTES:
        assert isinstance(file.attrs[name], str) and file.attrs[name], f"/@{name} is missing"
    assert file.attrs["format_version"] == 3
    entry = file["entry"]
    assert nx_class(entry) == "NXentry"
    assert entry["title"][()] and entry["program_name"][()] == b"rabiline" and entry["program_name"].attrs["version"]


def check_data(group):
    """silx accepts the group, and each axis and the signal say what they are, in which unit."""
    data = NXdata(group)
    assert data.is_valid, f"{group.name}: {data.issues}"
    assert data.title, f"{group.name} has no title"
    for name in [data.signal_dataset_name] + [axis for axis in data.axes_dataset_names if axis]:
        dataset = group[name]
        assert dataset.attrs["units"] and dataset.attrs["long_name"], f"{dataset.name}: no units or long_name"
        assert dataset.ndim == 0 or dataset.size == 0 or dataset.fletcher32, f"{dataset.name}: no checksum"
    for axis in data.axes_dataset_names:
        if axis:
            assert data.signal.shape[int(group.attrs[axis + "_indices"])] == group[axis].size


def check_datasets(file):
    """Every array is compressed and carries a checksum."""

    def check(name, item):
        if isinstance(item, h5py.Dataset) and item.shape and item.size:
            assert item.fletcher32 and item.compression == "gzip" and item.shuffle, f"{name}: not protected"

    file.visititems(check)


def check_results(file):
    default = get_default(file)
    assert default is not None and default.is_valid
    assert default.group.name == "/entry/scan"
    assert default.signal_dataset_name == "detected"
    assert default.errors is not None and default.errors.shape == default.signal.shape
    assert numpy.isfinite(default.errors[()]).all()

    entry = file["entry"]
    axes = [name for name in default.axes_dataset_names if name and name != "detector_index"]
    points = int(numpy.prod([entry["scan"][name].size for name in axes], dtype=int))
    for detector in groups_of_class(file, "NXdetector"):
        counts = detector["data"]
        assert counts.shape[: counts.ndim - 2] == tuple(entry["scan"][name].size for name in axes)
        assert detector["data_errors"].shape == counts.shape
        assert detector["distance"].attrs["units"] == "m" and detector["local_name"][()]
    for name in axes:
        assert entry["scan"][name].attrs["parameter"].replace(".", "_") == name

    fates = entry["fates"]
    assert fates.attrs["quanta_per_particle"] == 2**40
    assert fates["quanta_low"].shape == (len(fates["fate"]), points) == (len(fates["where"]), points)
    assert len(entry["law"]) == len(entry["species"]) == points

    simulation = entry["simulation"]
    assert nx_class(simulation) == "NXprocess" and simulation["seed"].dtype == numpy.uint64
    assert groups_of_class(file, "NXnote"), "the input is not in the file"


def check_tracks(file):
    default = get_default(file)
    assert default is not None and default.is_valid
    assert default.signal_dataset_name == "x" and default.axes_dataset_names == ["y"]
    for track in groups_of_class(file, "NXdata"):
        for name in ("t", "z", "vx", "vy", "vz", "sx", "sy", "sz", "weight"):
            assert track[name].shape == track["x"].shape and track[name].attrs["units"]
        for name in ("particle", "species", "fate", "where"):
            assert name in track.attrs


def main(arguments):
    with h5py.File(arguments[-1], "r") as file:
        check_root(file)
        groups = groups_of_class(file, "NXdata")
        assert groups
        for group in groups:
            check_data(group)
        check_datasets(file)
        (check_tracks if "--tracks" in arguments else check_results)(file)
    print(f"{arguments[-1]}: {len(groups)} plots are valid")


if __name__ == "__main__":
    main(sys.argv[1:])
