"""Models, cameras and rigs made from files and numbers, and errors."""

import copy
import json
import os
import pickle
import re

import numpy as np
import pytest

import binosplat


def test_model_describes_itself(model, scene):
    assert model.count == 300 and model.degree == 0 and model.left_out == 0
    assert model.axes == "RDF" and not model.antialiased and 0 < model.near_plane <= 0.2
    assert (model.order, model.projection) == ("depth", "affine")
    assert "300 Gaussians" in repr(model)
    assert binosplat.load_model(scene / "model.ply", axes="LUF").axes == "LUF"


def test_named_format_overrides_content(model, scene):
    assert binosplat.load_model(scene / "model.ply", format="ply").count == model.count
    with pytest.raises(binosplat.InputError, match="not an spz model"):
        binosplat.load_model(scene / "model.ply", format="spz")
    with pytest.raises(binosplat.InputError, match="format nerf: expected Scaffold-GS"):
        binosplat.load_model(scene / "model.ply", format="nerf")


def test_rejects_non_model_files(scene, tmp_path):
    (tmp_path / "cut.ply").write_bytes((scene / "model.ply").read_bytes()[:5000])
    for name in ("missing.ply", "cut.ply"):
        with pytest.raises(binosplat.InputError, match=re.escape(str(tmp_path / name))):
            binosplat.load_model(tmp_path / name)
    with pytest.raises(binosplat.InputError, match="cannot read /no/\ufffd.ply"):
        binosplat.load_model(os.fsdecode(b"/no/\xff.ply"))
    with pytest.raises(binosplat.InputError, match="has no levels of detail"):
        binosplat.load_model(scene / "model.ply", lod=1)
    with pytest.raises(binosplat.InputError, match="axes 'XYZ': expected three letters"):
        binosplat.load_model(scene / "model.ply", axes="XYZ")


def test_names_need_not_be_utf8(renderer, model, cameras, tmp_path):
    folder, name = tmp_path / os.fsdecode(b"\xe9t\xe9"), os.fsdecode(b"\xff.png")
    model.save(folder / os.fsdecode(b"\xe8.ply"))
    found = binosplat.load_model(os.fsencode(folder / os.fsdecode(b"\xe8.ply")))
    assert found.name == os.fsdecode(b"\xe8.ply") and found.filtered(np.arange(300) < 9).name == found.name
    (folder / "cameras.txt").write_text("1 PINHOLE 72 48 60 60 36 24\n")
    (folder / "points3D.txt").write_text("")
    (folder / "images.txt").write_bytes(b"1 1 0 0 0 0 0 0 1 \xff.png\n\n2 1 0 0 0 0 0 0 1 \xc3\xa9.png\n\n")
    binosplat.save_png(os.fsencode(folder / name), np.zeros((48, 72)))
    for path in (folder, os.fsencode(folder)):
        seen = binosplat.load_cameras(path)
        assert [camera.name for camera in seen] == ["\u00e9.png", name] and seen[name] is seen[1]
        assert names_of(seen.test) + names_of(seen.training) == names_of(seen)
        assert binosplat.find_photo(folder, seen[1]) == binosplat.find_photo(folder, name[:-4]) == folder / name
        assert binosplat.find_photo(folder, seen[0]) is None
        with pytest.raises(binosplat.InputError, match="no: .* has no camera of this name"):
            seen["no"]
    again = binosplat.Camera(72, 48, 60, name=seen[1].name).resized(72, 48)
    assert again.name == name and np.array_equal(renderer.draw(again).colour, renderer.draw(cameras["front"]).colour)


def test_empty_paths_are_input_errors():
    for find in (binosplat.find_cameras, binosplat.find_photos, binosplat.find_exposures, binosplat.load_model):
        with pytest.raises(binosplat.InputError):
            find("")


def test_selects_cameras_by_number_and_name(scene, cameras):
    assert len(cameras) == 4
    assert [camera.name for camera in cameras] == ["front", "side", "pair_left", "pair_right"]
    assert cameras[-1].name == "pair_right" and cameras[1].name == "side"
    side = cameras["side"]
    assert (side.width, side.height, side.fx, side.fy, side.cx, side.cy) == (72, 48, 60, 60, 36, 24)
    np.testing.assert_array_equal(side.position, [0.5, 0, 0])
    np.testing.assert_array_equal(side.rotation, np.eye(3))
    assert binosplat.find_cameras(scene / "model.ply") == scene / "cameras.json"
    with pytest.raises(IndexError):
        cameras[4]
    with pytest.raises(binosplat.InputError) as raised:
        cameras["back"]
    assert str(raised.value).startswith("back: ") and "has no camera of this name" in str(raised.value)
    assert "pair_left" in str(raised.value)


def test_rejects_files_without_cameras(tmp_path):
    for name, words in {"missing.json": "cannot read", "": "is a folder without cameras.json"}.items():
        with pytest.raises(binosplat.InputError, match=re.escape(words)):
            binosplat.load_cameras(tmp_path / name)
    nowhere = binosplat.find_cameras(tmp_path / "model.ply")
    assert nowhere is None
    with pytest.raises(binosplat.InputError, match="find_cameras"):
        binosplat.load_cameras(nowhere)


def test_camera_from_numbers_equals_file(renderer, cameras, tmp_path):
    turn = np.array([[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]])  # looks towards +x; columns are the camera's axes
    entry = {"img_name": "turned", "width": 40, "height": 30, "position": [-2, 0.1, 0], "rotation":
             turn.tolist(), "fx": 35, "fy": 36, "cx": 21, "cy": 14}
    (tmp_path / "cameras.json").write_text(json.dumps([entry]))
    listed = renderer.draw(binosplat.load_cameras(tmp_path)[0]).colour
    numbers = {"fy": 36, "cx": 21, "cy": 14, "position": [-2, 0.1, 0]}
    made = renderer.draw(binosplat.Camera(40, 30, 35, rotation=turn, **numbers)).colour
    assert listed.any() and np.array_equal(made, listed)
    transposed = renderer.draw(binosplat.Camera(40, 30, 35, rotation=turn.T, **numbers)).colour
    assert not np.array_equal(transposed, listed)


@pytest.mark.parametrize("numbers, words", [
    ({"width": 0}, "a picture of 0 x 48 px cannot be drawn"),
    ({"fx": -1}, "focal lengths of -1"),
    ({"cx": float("nan")}, "the principal point nan"),
    ({"position": (0, 0, float("inf"))}, "position 0, 0, inf: expected finite numbers"),
    ({"rotation": 2 * np.eye(3)}, "the columns must be orthogonal and of length 1"),
    ({"rotation": np.diag([1, 1, -1])}, "it mirrors"),
])
def test_rejects_invalid_camera_numbers(numbers, words):
    with pytest.raises(binosplat.InputError, match=re.escape(words)):
        binosplat.Camera(**{"width": 72, "height": 48, "fx": 60, **numbers})


def test_rejects_poses_of_other_shapes():
    for numbers in ({"position": (0, 0)}, {"rotation": np.eye(4)}, {"rotation": np.zeros(9)}):
        with pytest.raises(TypeError):
            binosplat.Camera(72, 48, 60, **numbers)


def test_look_at_centres_target(renderer, model):
    camera = binosplat.look_at((0, 0, 0), (0, 0, 4), 72, 48, fov=45)
    np.testing.assert_allclose(camera.rotation, np.eye(3), atol=1e-12)
    assert camera.fy == pytest.approx(24 / np.tan(np.radians(22.5)))
    assert (renderer.draw(binosplat.frame(model, 32, 24), near_plane=model.near_plane).transmittance < 0.5).any()
    seen = (model.means - binosplat.frame(model, 32, 24).position) @ binosplat.frame(model, 32, 24).rotation
    assert (abs(seen[:, :2] / seen[:, 2:]) < np.tan(np.radians(30)) * np.array([32 / 24, 1])).all(), "all of it"
    upside_down = binosplat.frame(model, 32, 24, up=(0, 1, 0))
    assert upside_down.rotation[1, 1] < 0 < binosplat.frame(model, 32, 24).rotation[1, 1]
    for arguments in (((0, 0, 0), (0, 0, 0)), ((0, 0, 0), (0, 1, 0))):
        with pytest.raises(binosplat.InputError):
            binosplat.look_at(*arguments, 72, 48)
    with pytest.raises(binosplat.InputError, match="fov 180"):
        binosplat.look_at((0, 0, 0), (0, 0, 1), 72, 48, fov=180)
    with pytest.raises(binosplat.InputError, match="0 x 24 px"):
        binosplat.frame(model, 0, 24)
    with pytest.raises(binosplat.InputError, match="^up 0, 0, 0: expected a direction"):
        binosplat.frame(model, 32, 24, up=(0, 0, 0))


def test_errors_name_python_arguments(renderer, model, cameras, tmp_path):
    front, nan = cameras["front"], float("nan")

    def rig(**numbers):
        return lambda: binosplat.Rig(front, **numbers)

    def draw(**settings):
        return lambda: renderer.draw(front, **settings)

    misuses = [
        rig(ipd=-1), rig(ipd=nan), rig(units_per_metre=0), rig(convergence=-2), rig(cant=60), rig(convergence=2, cant=3),
        lambda: binosplat.look_at((0, 0, 0), (0, 0, 0), 72, 48),
        lambda: binosplat.look_at((0, 0, 0), (0, 1, 0), 72, 48),
        lambda: binosplat.look_at((0, 0, nan), (0, 1, 0), 72, 48),
        lambda: binosplat.look_at((0, 0, 0), (0, 0, 1), 72, 48, fov=180),
        lambda: binosplat.frame(model, 72, 0), lambda: front.resized(-1, 3),
        lambda: cameras["behind"], lambda: binosplat.load_cameras(tmp_path), lambda: binosplat.load_model(tmp_path),
        lambda: binosplat.Calibration(tmp_path / "none.json", model),
        draw(near_plane=0), draw(quality=200), draw(tolerance=-1), draw(tolerance=1, quality=40),
        draw(threshold="squared"), draw(threshold="exact", quality=40), draw(transmittance="last"),
        draw(transmittance="depth"), draw(background=(2, 0, 0)),
        draw(tolerance=1, threshold="adagscale", transmittance="last"),
    ]
    for misuse in misuses:
        with pytest.raises(binosplat.InputError) as refused:
            misuse()
        assert "--" not in str(refused.value)


def test_resized_keeps_vertical_field_of_view(cameras):
    large = cameras["front"].resized(200, 96)
    assert (large.width, large.height, large.fx, large.fy, large.cx) == (200, 96, 120, 120, 100)
    with pytest.raises(binosplat.InputError):
        large.resized(-1, 3)


def test_rig_has_two_eyes(cameras):
    left, right = binosplat.Rig(cameras["front"], ipd=0.1, units_per_metre=2, convergence=3).eyes
    np.testing.assert_allclose([left.position[0], right.position[0]], [-0.1, 0.1])
    np.testing.assert_allclose([left.cx, right.cx], [35, 37])
    with pytest.raises(binosplat.InputError, match="^ipd -1: expected metres"):
        binosplat.Rig(cameras["front"], ipd=-1)
    for wrong in ({"ipd": "0.063"}, {"convergence": (3,)}, {"cant": None}):
        with pytest.raises(TypeError, match="a value of a Camera or a Rig has a wrong type"):
            binosplat.Rig(cameras["front"], **wrong)


def test_converts_nerfstudio_cameras(tmp_path):
    rows = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]
    frame = {"file_path": "a", "transform_matrix": [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3]]}
    (tmp_path / "transforms.json").write_text(
        json.dumps({"w": 64, "h": 48, "fl_x": 50, "frames": [frame]})
    )
    (tmp_path / "dataparser_transforms.json").write_text(json.dumps({"transform": rows, "scale": 0.5}))
    file = tmp_path / "transforms.json"
    assert list(binosplat.load_cameras(file)[0].position) == [1, 2, 3]
    assert list(binosplat.load_cameras(file, tmp_path / "splat.ply")[0].position) == [0.5, 1, 1.5]


def test_cameras_and_rigs_can_be_pickled(renderer, cameras):
    turn = np.array([[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]])
    camera = binosplat.Camera(40, 30, 35, fy=36, cx=21, cy=14, position=(-2, 0.1, 0), rotation=turn, name="a")
    rig = binosplat.Rig(cameras["front"], ipd=0.2, units_per_metre=2, convergence=3)
    of_eyes = binosplat.Rig.of_eyes(cameras["pair_left"], cameras["pair_right"])

    def pictures(view):
        drawn = renderer.draw(view)
        return [picture.colour for picture in (drawn if isinstance(drawn, tuple) else (drawn,))]

    for view in (camera, rig, of_eyes):
        for other in (pickle.loads(pickle.dumps(view)), copy.deepcopy(view)):
            assert all(map(np.array_equal, pictures(other), pictures(view)))
    other = pickle.loads(pickle.dumps(camera))
    assert (repr(other), other.time, other.fy) == (repr(camera), camera.time, 36)
    assert not np.array_equal(pictures(other)[0], pictures(cameras["front"].resized(40, 30))[0])
    again = pickle.loads(pickle.dumps(cameras))
    assert again.source == cameras.source and [c.name for c in again] == [c.name for c in cameras]


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_models_cannot_be_pickled(renderer, model, tmp_path, protocol):
    (tmp_path / "exposure.json").write_text('{"a": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]}')
    for thing in (model, renderer, binosplat.load_exposures(tmp_path / "exposure.json")):
        for attempt in (lambda: pickle.dumps(thing, protocol), lambda: copy.deepcopy(thing)):
            with pytest.raises(TypeError, match="cannot pickle or copy a "):
                attempt()
    assert copy.copy(model).count == model.count


def test_rejects_unknown_keywords(renderer, model, cameras):
    front = cameras["front"]
    for call, words in ((lambda: renderer.draw(front, qualty=40), "draw() got an unexpected keyword argument 'qualty'"),
                        (lambda: binosplat.Model(means=0, quat=0), "got an unexpected keyword argument 'quat'")):
        with pytest.raises(TypeError, match=re.escape(words)):
            call()


def test_cameras_are_immutable(renderer, cameras):
    front = cameras["front"]
    before = renderer.draw(front).colour
    for change in (lambda: setattr(front, "width", 80), lambda: front.position.fill(1), lambda: front.rotation.fill(0)):
        with pytest.raises((AttributeError, ValueError)):
            change()
    place = np.zeros(3)
    made = binosplat.Camera(72, 48, 60, position=place)
    place += 5
    assert not made.position.any() and np.array_equal(renderer.draw(front).colour, before)


def names_of(cameras):
    return "".join(camera.name for camera in cameras)


@pytest.mark.parametrize("order, test, training", [
    ("dkabcefghij", "dk", "abcefghij"),  # as INRIA's trainer writes it: test views, then training views
    ("abcdefghijk", "ai", "bcdefghjk"),  # every eighth by name
    ("kjihgfedcba", "ia", "kjhgfedcb"),
])
def test_test_views_match_commands(tmp_path, order, test, training):
    axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    (tmp_path / "cameras.json").write_text(json.dumps(
        [{"img_name": name, "width": 8, "height": 8, "position": [k, 0, 0], "rotation": axes, "fx": 8, "fy": 8}
         for k, name in enumerate(order)]))
    cameras = binosplat.load_cameras(tmp_path)
    assert names_of(cameras.test) == test
    assert names_of(cameras.training) == training
