"""What tests of experiments share."""

import pathlib
import subprocess

import h5py
import pytest
from experiments import EXPERIMENTS, RABILINE


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("experiments")

    def run_experiment(name, *arguments):
        output = folder / f"{pathlib.Path(name).name}.h5"
        subprocess.run([RABILINE, "run", EXPERIMENTS / f"{name}.yaml", "-o", output, "--progress", "none", *arguments],
                       check=True, stdout=subprocess.DEVNULL)
        return h5py.File(output)

    return run_experiment
