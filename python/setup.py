"""`pip install ./python` in the source tree: builds the library and the program with meson, unless GNEISS_BUILD names a folder in which
they were built, and packs them with the module."""
import os
import re
import shutil
import subprocess
import sys
from glob import glob
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py
from wheel.bdist_wheel import bdist_wheel

HERE = Path(__file__).parent.absolute()
TREE = HERE.parent
BUILD = Path(os.environ.get("GNEISS_BUILD", TREE / "build")).absolute()
VERSION = re.search(r"version: '([^']+)'", (TREE / "meson.build").read_text(encoding="utf-8"))[1]


class Build(build_py):
    def run(self):
        super().run()
        if "GNEISS_BUILD" not in os.environ:
            if not (BUILD / "build.ninja").exists():
                subprocess.run(["meson", "setup", str(BUILD), str(TREE), "--buildtype=release"], check=True)
            subprocess.run(["ninja", "-C", str(BUILD), "gneiss", f"libgneiss.so.{VERSION}"], check=True)
        target = Path(self.build_lib) / "gneiss"
        shutil.copy(BUILD / f"libgneiss.so.{VERSION}", target / "libgneiss.so")
        with open(target / "declarations.txt", "w", encoding="utf-8") as file:
            headers = [str(TREE / "include" / "gneiss" / name) for name in ("status.h", "gneiss.h")]
            subprocess.run([sys.executable, str(HERE / "gneiss" / "_header.py"), *headers], stdout=file, check=True)


class Wheel(bdist_wheel):
    def get_tag(self):
        return "py3", "none", super().get_tag()[2]


class Binary(Distribution):
    def has_ext_modules(self):
        return True


def in_tree(*parts):
    return sorted(os.path.relpath(path, HERE) for path in glob(str(TREE.joinpath(*parts))))


setup(version=VERSION, packages=["gneiss"], package_data={"gneiss": ["py.typed"]}, distclass=Binary,
      cmdclass={"build_py": Build, "bdist_wheel": Wheel},
      data_files=[("bin", [os.path.relpath(BUILD / "gneiss", HERE)]), ("share/gneiss", in_tree("tools", "report*.py") + in_tree("tools", "view*")),
                  ("share/gneiss/calibrate", in_tree("calibrate", "*.py")), ("share/gneiss/data", in_tree("data", "maps.csv"))])
