"""convert IN OUT: writes particles or a mesh in another format."""
import os
import sys

sys.path[0] = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))

PACKAGES = {"numpy": "python3-numpy", "h5py": "python3-h5py", "meshio": "python3-meshio", "yaml": "python3-yaml"}

try:
    from convert.command import main

    if __name__ == "__main__":
        sys.exit(main(sys.argv[1:]))
except ModuleNotFoundError as error:
    name = (error.name or "").split(".")[0]
    if name not in PACKAGES:
        raise
    print(f"gneiss: file error: convert needs the Python module {name}: Debian package {PACKAGES[name]}", file=sys.stderr)
    sys.exit(3)
