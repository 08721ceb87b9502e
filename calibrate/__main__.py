"""calibrate TARGETS --out DIR: parameters of particles and bonds that give a material the wanted readings, with their intervals."""
import os
import sys

sys.path[0] = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(1, os.path.join(sys.path[0], "tools"))  # in the source tree the modules are in two folders, in an installation in one

from calibrate import interrupt  # noqa: E402 (after the path of the modules)

interrupt.listen()
PACKAGES = {"numpy": "python3-numpy", "scipy": "python3-scipy", "yaml": "python3-yaml", "h5py": "python3-h5py",
            "matplotlib": "python3-matplotlib"}

try:
    from calibrate.command import main
except ModuleNotFoundError as error:
    name = (error.name or "").split(".")[0]
    if name not in PACKAGES:
        raise
    sys.exit(f"gneiss: calibrate needs the Python module {name}: Debian package {PACKAGES[name]}")

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
