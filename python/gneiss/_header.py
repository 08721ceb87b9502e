"""The public header as cffi reads it: `_header.py STATUS_H GNEISS_H` prints its declarations."""
import re
import sys
from pathlib import Path


def declarations(*headers: str) -> str:
    """The declarations of headers without comments, preprocessor lines and what is for C++ alone."""
    text = "".join(Path(header).read_text(encoding="utf-8") for header in headers)
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    text = re.sub(r"^#ifdef __cplusplus.*?#endif", "", text, flags=re.M | re.S)
    text = re.sub(r"^#.*$", "", text, flags=re.M).replace("GNEISS_API", "")
    return re.sub(r"\n\s*\n+", "\n", text)


if __name__ == "__main__":
    sys.stdout.write(declarations(*sys.argv[1:]))
