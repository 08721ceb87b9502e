"""Digests of an HDF5 file of gneiss (src/io/h5_digest.c defines them) show which of its values have changed since they were written."""
import h5py
import numpy as np

OF_VALUES, OF_ATTRIBUTES, OF_NAMES = "digest", "digest_of_attributes", "digest_of_names"
GOLDEN, ODD = 0x9E3779B97F4A7C15, (0xBF58476D1CE4E5B9, 0x94D049BB133111EB)
WORD = (1 << 64) - 1


def mix(z):
    """Mixes the bits of one integer or of each in an array."""
    if isinstance(z, int):
        z = ((z ^ (z >> 30)) * ODD[0]) & WORD
        z = ((z ^ (z >> 27)) * ODD[1]) & WORD
        return z ^ (z >> 31)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(ODD[0])
    z = (z ^ (z >> np.uint64(27))) * np.uint64(ODD[1])
    return z ^ (z >> np.uint64(31))


def digest(data, seed=0):
    """Digest of bytes."""
    words = np.frombuffer(data + bytes(-len(data) % 8), "<u8")
    with np.errstate(over="ignore"):
        places = np.arange(1, len(words) + 1, dtype=np.uint64) * np.uint64(GOLDEN)
        total = int(np.sum(mix(words + places), dtype=np.uint64)) if len(words) else 0
    return mix(total ^ mix(seed ^ len(data)))


def of_text(text):
    return digest(text.encode())


def code(dtype):
    return f"{dtype.kind}{dtype.itemsize}"


def of_values(dataset):
    """(digest of name, type, shape and values, the values)."""
    values = np.empty(dataset.shape, dataset.dtype)
    if values.size:
        dataset.id.read(h5py.h5s.ALL, h5py.h5s.ALL, values)
    head = " ".join([dataset.name.lstrip("/"), code(dataset.dtype), *map(str, dataset.shape)])
    return digest(values.tobytes(), of_text(head)), values


def of_attributes(item):
    total = of_text(item.name.lstrip("/") or ".")
    for name in item.attrs:
        if name in (OF_ATTRIBUTES, OF_NAMES):
            continue
        attribute = item.attrs.get_id(name)
        values = np.empty(attribute.shape, attribute.dtype)
        if values.size:
            attribute.read(values)
        total += mix(digest(values.tobytes(), of_text(f"{name} {code(attribute.dtype)} {values.size}")))
    return mix(total & WORD)


def written(item, name):
    """Returns None if the data set has no digest."""
    return int(item.attrs[name]) & WORD if name in item.attrs else None


def objects(file):
    """Groups and data sets, the root first."""
    found = [file]
    file.visititems(lambda name, item: found.append(item))
    return found


def of_names(file):
    return sum(mix(of_attributes(item) ^ int(isinstance(item, h5py.Dataset))) for item in objects(file)) & WORD


def is_sealed(file):
    return OF_ATTRIBUTES in file.attrs


def changed(file):
    """Names of data sets and objects with values or attributes that differ from those written; "/" too if an object
    was added or removed. Empty for a file of an earlier version, which has no digests."""
    if not is_sealed(file):
        return []
    names = [item.name for item in objects(file)
             if of_attributes(item) != written(item, OF_ATTRIBUTES)
             or isinstance(item, h5py.Dataset) and of_values(item)[0] != written(item, OF_VALUES)]
    return names or ([] if of_names(file) == written(file, OF_NAMES) else ["/"])


def put(item, name, value):
    item.attrs.create(name, value - (1 << 64) if value >> 63 else value, dtype="<i8")


def seal(file):
    """Writes the digests of the present contents."""
    for item in objects(file):
        if isinstance(item, h5py.Dataset):
            put(item, OF_VALUES, of_values(item)[0])
        put(item, OF_ATTRIBUTES, of_attributes(item))
    put(file, OF_NAMES, of_names(file))
