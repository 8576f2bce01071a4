"""Whether two files of snapshots hold the same: same_snapshots.py ONE OTHER. Says nothing against
them where Python has no h5py."""

import sys

try:
    import h5py
except ImportError:
    sys.exit(0)


def everything(path):
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.update({name: item[()].tobytes()})
                        if isinstance(item, h5py.Dataset) else None)
    return found


sys.exit(everything(sys.argv[1]) != everything(sys.argv[2]))
