"""spz_values.py JUDGE PROGRAM: what Niantic's library and binosplat read in the same spz files, value by value.

JUDGE is spz_judge.cpp, compiled with that library; PROGRAM is binosplat. Files in all 17 coordinate systems, of every
version and degree, are turned into plys by both; then files of binosplat's are.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

import binosplat
import numpy as np

import twin


# Their conversion between the two families of systems flips y where it should flip z, so that what these four hold
# depends on where the data came from; binosplat goes by their names.
DISPUTED = ("9", "10", "15", "16")


def covariances(model):
    axes = twin.turns(model.quats.astype(float)) * model.scales.astype(float)[:, None, :]
    return axes @ np.swapaxes(axes, 1, 2)


def difference(ours, theirs):
    """The largest difference of each kind of value; of covariances as a share of a Gaussian's largest number."""
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
            twin.tell(f"{kind}, {files[kind]} files: {words(values)}", is_small(values) != disputed)
        for scene in ("demo:room", "demo:city"):
            quietly(program, "convert", scene, "--count", "20000", "-o", f"{folder}/mine.spz")
            quietly(program, "convert", f"{folder}/mine.spz", "-o", f"{folder}/ours.ply")
            quietly(judge, "read", f"{folder}/mine.spz", f"{folder}/theirs.ply")
            values = difference(*(binosplat.load_model(f"{folder}/{who}.ply") for who in ("ours", "theirs")))
            twin.tell(f"our spz of {scene}: {words(values)}", is_small(values))


if __name__ == "__main__":
    main(*sys.argv[1:])
