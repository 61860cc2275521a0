"""Fixtures: a small scene in a temporary folder (a model and its cameras), and the program to compare with."""

import json
import os
import subprocess

import numpy as np
import pytest

import binosplat


def write_ply(path, count=300, seed=1):
    """Writes Gaussians of degree 0, about 4 units in front of the cameras, as INRIA's trainer stores them."""
    random = np.random.default_rng(seed)
    names = ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity"]
    names += ["scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
    rows = random.uniform(-3, 3, (count, len(names))).astype(np.float32)
    rows[:, :3] = rows[:, :3] * (0.8, 0.5, 0.4) + (0, 0, 4)
    rows[:, 10:13] = -2.5 + 0.3 * rows[:, 10:13]
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n"
    header += "".join(f"property float {name}\n" for name in names) + "end_header\n"
    path.write_bytes(header.encode() + rows.tobytes())


def camera_json(name, x):
    """Returns the entry in cameras.json of a camera at (x, 0, 0) that looks along z."""
    return {"img_name": name, "width": 72, "height": 48, "position": [x, 0, 0],
            "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "fx": 60, "fy": 60}


@pytest.fixture(scope="session")
def scene(tmp_path_factory):
    """A folder with model.ply and cameras.json: two single cameras and the eyes of a stereo pair."""
    folder = tmp_path_factory.mktemp("scene")
    write_ply(folder / "model.ply")
    cameras = [camera_json("front", 0), camera_json("side", 0.5), camera_json("pair_left", -0.1),
               camera_json("pair_right", 0.1)]
    (folder / "cameras.json").write_text(json.dumps(cameras))
    return folder


@pytest.fixture(scope="session")
def model(scene):
    return binosplat.load_model(scene / "model.ply")


@pytest.fixture(scope="session")
def cameras(scene):
    return binosplat.load_cameras(scene)


@pytest.fixture(scope="session")
def renderer(model):
    return binosplat.Renderer(model, backend="surfaceless")


@pytest.fixture(scope="session")
def program():
    """Returns a function that runs the program and returns its output."""

    def run(*arguments):
        command = [os.environ["BINOSPLAT_PROGRAM"], *map(str, arguments)]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout

    return run
