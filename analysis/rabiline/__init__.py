"""Reads, fits and plots the HDF5 files that rabiline writes. Run it as `python3 -m rabiline --help`."""
