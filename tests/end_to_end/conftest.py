"""What tests of experiments share."""

import gc
import pathlib
import subprocess

import h5py
import pytest
from experiments import EXPERIMENTS, RABILINE


def pytest_configure(config):
    gc.set_threshold(100_000)  # a picture is made of many small objects: looking for garbage took a fifth of its time
    config.addinivalue_line("markers", "experiment(name, ...): tests what the headers of these shipped experiments promise")
    config.addinivalue_line("markers", "slow: takes long; ctest has it as a label too")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("experiments")

    def run_experiment(name, *arguments):
        output = folder / f"{pathlib.Path(name).name}.h5"
        subprocess.run([RABILINE, "run", EXPERIMENTS / f"{name}.yaml", "-o", output, "--progress", "none", "--threads", "1", *arguments],
                       check=True, stdout=subprocess.DEVNULL)
        return h5py.File(output)

    return run_experiment
