"""playcanvas_values.py CLI PROGRAM FILES: compares the values that splat-transform and binosplat read from files.

CLI is splat-transform's bin/cli.mjs, PROGRAM is binosplat, FILES is a folder of models of all formats. Each program
converts each model to a ply, and then files that binosplat wrote in every format and degree.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

import binosplat
import numpy as np

import reference
from spz_values import difference, is_small, words

ENDINGS = (".ply", ".spz", ".splat", ".ksplat", ".sog", "meta.json")

# Files that one of the programs cannot read, or reads differently, and why.
KNOWN = {
    "var-ascii-sh3.ply": "they take text for binary",
    "var-bigendian-sh3.ply": "they take big-endian numbers for little-endian",
    "var-crlf-extra-elements.ply": "they do not read lines that end in CR LF",
    "var-nerfstudio-rgb.ply": "they do not read colours of 0 to 255",
    "synthetic-v1-sh3.spz": "they do not read version 1",
    "adobe-v3-sh4.spz": "they do not read degree 4",
    "adobe-v4-sh4.spz": "they do not read degree 4",
    ".splat": "they decode a rotation's bytes by b / 255 * 2 - 1, its writer stored 128 q + 128",
}


def run(*words):
    return subprocess.run([str(w) for w in words], capture_output=True, text=True).returncode == 0


def differences(cli, program, file, folder):
    """Returns None if one of the programs has no model or another number of Gaussians."""
    # splat-transform copies spz coordinates into the ply, but in spz y is up (Niantic's specification).
    axes = ["--axes", "rdf"] if str(file).endswith(".spz") else []
    read = run("node", cli, file, f"{folder}/theirs.ply", "-w", "-q")
    if not run(program, "convert", file, "-o", f"{folder}/ours.ply", "--quiet", *axes):
        sys.exit(f"binosplat does not read {file}")
    try:
        ours, theirs = (binosplat.load_model(f"{folder}/{who}.ply") for who in ("ours", "theirs"))
    except binosplat.InputError:
        return None
    same_shape = read and ours.means.shape == theirs.means.shape and ours.sh.shape == theirs.sh.shape
    return difference(ours, theirs) if same_shape else None


def compare(name, cli, program, file, folder):
    why = next((why for ending, why in KNOWN.items() if str(file).endswith(ending)), None)
    values = differences(cli, program, file, folder)
    said = "not both read it" if values is None else words(values)
    reference.tell(f"{name}: {said}{': ' + why if why else ''}", why or (values and is_small(values)))


def write_hard(path, degree, count=700):
    """Writes a ply with values over wide ranges, in the encodings of trainers."""
    draw = np.random.default_rng(degree)
    rest = 3 * ((degree + 1) ** 2 - 1)
    names = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", *(f"f_rest_{k}" for k in range(rest)), "opacity",
             "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
    values = np.concatenate([
        draw.normal(size=(count, 3)) * np.exp(draw.uniform(-3, 5, (count, 1))), draw.uniform(-2, 2, (count, 3)),
        draw.normal(size=(count, rest)) * 0.2, draw.uniform(-4.5, 4.5, (count, 1)), draw.uniform(-9, 2, (count, 3)),
        draw.normal(size=(count, 4))], axis=1)
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {count}",
              *(f"property float {name}" for name in names), "end_header", ""]
    Path(path).write_bytes("\n".join(header).encode() + values.astype("<f4").tobytes())


def main(cli, program, files):
    with tempfile.TemporaryDirectory() as folder:
        for file in sorted(Path(files).rglob("*")):
            if file.name.endswith(ENDINGS):
                compare(file.relative_to(files), cli, program, file, folder)
        for degree in range(4):
            write_hard(f"{folder}/hard.ply", degree)
            for ending in ("ply", "compressed.ply", "splat", "spz", "sog"):
                written = f"{folder}/mine.{ending}"
                if not run(program, "convert", f"{folder}/hard.ply", "-o", written):
                    sys.exit(f"binosplat does not write {written}")
                compare(f"our {ending}, degree {degree}", cli, program, written, folder)


if __name__ == "__main__":
    main(*sys.argv[1:])
