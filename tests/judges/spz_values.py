"""spz_values.py JUDGE PROGRAM: compares the values that Niantic's library and binosplat read from spz files.

JUDGE is spz_judge.cpp, compiled with Niantic's library. PROGRAM is binosplat. Both convert the library's files of
every coordinate system, version and degree to ply, and then files of binosplat.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

import binosplat
import numpy as np

import reference


# Niantic's conversion to and from these four coordinate systems flips y instead of z, so their data depends on the
# system of its origin. binosplat converts by the names of the systems.
DISPUTED = ("9", "10", "15", "16")


def covariances(model):
    axes = reference.turns(model.quats.astype(float)) * model.scales.astype(float)[:, None, :]
    return axes @ np.swapaxes(axes, 1, 2)


def difference(ours, theirs):
    """Returns the largest difference of each kind of value. Covariances are relative to each one's largest entry."""
    a, b = covariances(ours), covariances(theirs)
    return {"position": np.abs(ours.means - theirs.means).max(),
            "covariance": (np.abs(a - b).max(axis=(1, 2)) / np.abs(b).max(axis=(1, 2))).max(),
            "opacity": np.abs(ours.opacities - theirs.opacities).max(),
            "sh": np.abs(ours.sh - theirs.sh).max()}


def words(values):
    return ", ".join(f"{kind} {value:.1e}" for kind, value in values.items())


def is_small(values):
    return max(values.values()) < 1e-4


def largest(found, new):
    return {kind: max(found.get(kind, 0), float(value)) for kind, value in new.items()}


def quietly(*words):
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def main(judge, program):
    with tempfile.TemporaryDirectory() as folder:
        quietly(judge, "write", folder)
        found, files = {}, {}
        for file in sorted(Path(folder).glob("*.spz")):
            quietly(program, "convert", file, "-o", f"{folder}/ours.ply")
            version, system, _ = file.stem.split("-")
            kind = version + (", the systems LFD, RFD, LBU and RBU" if system[6:] in DISPUTED else "")
            files[kind] = files.get(kind, 0) + 1
            found[kind] = largest(found.get(kind, {}), difference(
                binosplat.load_model(f"{folder}/ours.ply"), binosplat.load_model(file.with_suffix(".ply"))))
        for kind, values in found.items():
            disputed = "systems" in kind
            reference.tell(f"{kind}, {files[kind]} files: {words(values)}", is_small(values) != disputed)
        for scene in ("demo:room", "demo:city"):
            quietly(program, "convert", scene, "--count", "20000", "-o", f"{folder}/mine.spz")
            quietly(program, "convert", f"{folder}/mine.spz", "-o", f"{folder}/ours.ply")
            quietly(judge, "read", f"{folder}/mine.spz", f"{folder}/theirs.ply")
            values = difference(*(binosplat.load_model(f"{folder}/{who}.ply") for who in ("ours", "theirs")))
            reference.tell(f"our spz of {scene}: {words(values)}", is_small(values))


if __name__ == "__main__":
    main(*sys.argv[1:])
