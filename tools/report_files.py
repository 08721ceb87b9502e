"""Reading and writing of the files of `report.py`. A folder may be foreign: only data that are
complete and in the file itself are read, and no link in the folder is followed on writing."""
import contextlib
import os
import stat
import tempfile

import h5py
import numpy as np

import report_digest

NAMED = 5          # data sets that a message names
OWN_FILTERS = 256  # filters below are of HDF5 itself
DAMAGE = (OSError, RuntimeError, KeyError, ValueError, TypeError, MemoryError)


class Unreadable(Exception):
    """The file is missing, damaged or not a results file; the text is for the user."""


class FileFault(Exception):
    """A file cannot be read or written for a reason of the system; the text is for the user."""


def printable(text):
    """Returns the text without control characters of terminals."""
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in str(text))


# --- reading -------------------------------------------------------------------------------------------

def check_access(path, error=None):
    """Refuses a file that the user may not read; `error`: what reading it raised."""
    if isinstance(error, PermissionError) or os.path.exists(path) and not os.access(path, os.R_OK):
        raise FileFault(f"{path}: cannot be read: Permission denied") from None


def fault_of_values(dataset):
    """Returns the reason why the values of a data set cannot be read; "" if they can."""
    created = dataset.id.get_create_plist()
    if dataset.is_virtual or created.get_external_count():
        return "stored in another file"
    if any(created.get_filter(k)[0] >= OWN_FILTERS for k in range(created.get_nfilters())):
        return "needs a filter of another program"
    if dataset.dtype.kind in "fiuS":
        if dataset.id.get_storage_size() < dataset.size * dataset.dtype.itemsize:
            return "part of it is not in the file"
        digest = report_digest.of_values(dataset)[0]
        if report_digest.is_sealed(dataset.file) and digest != report_digest.written(dataset, report_digest.OF_VALUES):
            return "changed"
    return ""


def faults_of(item):
    sealed = report_digest.is_sealed(item.file)
    try:
        if sealed and report_digest.of_attributes(item) != report_digest.written(item, report_digest.OF_ATTRIBUTES):
            return "attributes changed"
        return fault_of_values(item) if isinstance(item, h5py.Dataset) else ""
    except DAMAGE:
        return "damaged"


def faults_below(group, seen):
    """["history/time (damaged)", ...] of all that the group holds."""
    found = []
    for name in group:
        path = f"{group.name.rstrip('/')}/{name}".lstrip("/")
        if not isinstance(group.get(name, getlink=True), h5py.HardLink):
            found.append(f"{path} (a link to elsewhere)")
            continue
        try:
            item = group[name]
            address = h5py.h5o.get_info(item.id).addr
        except DAMAGE:
            found.append(f"{path} (damaged)")
            continue
        fault = faults_of(item)
        if fault:
            found.append(f"{path} ({fault})")
        if isinstance(item, h5py.Group) and address not in seen:
            seen.add(address)
            found += faults_below(item, seen)
    return found


def check(path, file, remedy):
    """Refuses a truncated file, because its remainder could be mistaken for the complete contents."""
    fault = faults_of(file)
    found = ([f"/ ({fault})"] if fault else []) + faults_below(file, set())
    if not found and report_digest.is_sealed(file) and \
            report_digest.of_names(file) != report_digest.written(file, report_digest.OF_NAMES):
        found = ["/ (a data set came or went)"]
    if found:
        more = f" and {len(found) - NAMED} more" if len(found) > NAMED else ""
        raise Unreadable(f"{path}: damaged or changed: {', '.join(found[:NAMED])}{more}; {remedy}")


@contextlib.contextmanager
def opened(path, kind, remedy):
    """Opens and checks the file; every error on the way becomes Unreadable or FileFault."""
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise Unreadable(f"{path}: expected a file, found something else")
        with h5py.File(path, "r") as file:
            check(path, file, remedy)
            yield file
    except FileNotFoundError:
        raise Unreadable(f"{path}: no such file (is this the output folder of a run?)") from None
    except DAMAGE as e:
        check_access(path, e)
        raise Unreadable(f"{path}: damaged or not {kind}: {' '.join(str(e).split())}") from None


def values(file, path):
    """Returns the values of a data set of the file itself; KeyError if there is none."""
    item = file
    for name in path.split("/"):
        if not isinstance(item, h5py.Group) or not isinstance(item.get(name, getlink=True), h5py.HardLink):
            raise KeyError(path)
        item = item[name]
    if not isinstance(item, h5py.Dataset) or fault_of_values(item):
        raise KeyError(path)
    return np.asarray(item[()])


# --- writing -------------------------------------------------------------------------------------------

def folder_within(folder, name):
    """Creates the folder unless it exists."""
    path = os.path.join(folder, name)
    if os.path.islink(path):
        raise OSError(f"{path}: expected a folder, found a symbolic link, which is not followed")
    os.makedirs(path, exist_ok=True)
    return path


def remove(path):
    """Removes a file or a link if it exists."""
    if os.path.lexists(path):
        os.remove(path)


def write(path, data):
    """Replaces the file of this name atomically by a new one."""
    data = data.encode() if isinstance(data, str) else data
    descriptor, temporary = tempfile.mkstemp(dir=os.path.dirname(path) or ".", prefix=".report-")
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
            mask = os.umask(0)
            os.umask(mask)
            os.fchmod(file.fileno(), 0o666 & ~mask)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise
