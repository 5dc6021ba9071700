"""`pip install .`: builds the CMake preset `python` for the Python that installs; all else stands in pyproject.toml."""

import pathlib
import re
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).parent.resolve()
VERSION = re.search(r"project\(stickslip VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


class BuildByCMake(build_ext):
    def build_extension(self, extension):
        build = f'. tools/environment.sh; cmake --preset python -D Python3_EXECUTABLE="{sys.executable}" && '
        build += 'cmake --build --preset python -j "$jobs"'  # as many compilers as there are cores and memory for
        subprocess.run(["bash", "-c", build], cwd=ROOT, check=True)
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        self.copy_file(str(ROOT / "build/python/python/stickslip" / target.name), str(target))


setup(version=VERSION, ext_modules=[Extension("stickslip._stickslip", sources=[])],
      cmdclass={"build_ext": BuildByCMake})
