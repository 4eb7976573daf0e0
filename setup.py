"""The package with the program in it, which CMake builds."""
import os
import re
import subprocess
import sys
from glob import glob
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext


class Build(build_ext):
    """Leaves the work to CMake; $RABILINE_BUILD is a folder of its own where there is one already."""

    def build_extension(self, extension: Extension) -> None:
        target = Path(self.get_ext_fullpath(extension.name)).resolve()
        build = os.environ.get("RABILINE_BUILD", "build/pip")
        if not Path(build, "CMakeCache.txt").exists():
            subprocess.run(["cmake", "-S", ".", "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DRABILINE_TESTS=OFF",
                            f"-DPython_EXECUTABLE={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", build, "--target", "rabiline_python"], check=True)
        target.parent.mkdir(parents=True, exist_ok=True)
        built, = Path(build, "python/rabiline").glob("_core*.so")
        self.copy_file(str(built), str(target))


setup(
    version=re.search(r"project\(rabiline VERSION (\S+)", Path("CMakeLists.txt").read_text())[1],
    packages=["rabiline"],
    package_dir={"": "analysis"},
    ext_modules=[Extension("rabiline._core", [])],
    cmdclass={"build_ext": Build},
    data_files=[(f"share/rabiline/{folder}", sorted(glob(f"{folder}/*"))) for folder in ("beamline", "geometries")],
)
