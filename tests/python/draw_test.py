"""draw() gives the same bits as the program, for every setting."""

import re

import numpy as np
import pytest

import binosplat

BACKEND = ["--backend", "surfaceless"]


def same(a, b):
    return a.shape == b.shape and a.dtype == b.dtype and np.array_equal(a, b)


def test_picture_has_three_arrays(renderer, cameras):
    picture = renderer.draw(cameras["front"])
    assert picture.colour.shape == (48, 72, 3)
    assert picture.transmittance.shape == picture.depth.shape == (48, 72)
    for array in (picture.colour, picture.transmittance, picture.depth):
        assert array.dtype == np.float32 and array.flags.c_contiguous and array.flags.writeable
    seen = picture.transmittance < 0.5
    assert seen.any() and not seen.all()
    assert np.isinf(picture.depth[~seen]).all()
    assert (picture.depth[seen] > 2).all() and (picture.depth[seen] < 6).all()
    assert picture.report.pairs > 0 and picture.report.gpu_ms > 0
    assert "blend" in picture.report.stages and 0 < picture.report.submit_ms < 60000
    small = renderer.draw(cameras["front"], quality=35).report
    assert (small.exact_because, small.quality) == ("small", np.inf)


def test_median_depth_is_near_mean(renderer, cameras):
    mean, median = (renderer.draw(cameras["front"], depth=depth) for depth in ("mean", "median"))
    assert same(mean.colour, median.colour)
    seen = mean.transmittance < 0.5
    assert np.array_equal(np.isinf(median.depth), np.isinf(mean.depth))
    apart = np.abs(median.depth - mean.depth)[seen]
    assert 0 < np.median(apart) < 0.5


def test_background_is_blended_by_transmittance(renderer, cameras):
    black = renderer.draw(cameras["front"])
    red = renderer.draw(cameras["front"], background=(1, 0, 0))
    expected = black.colour + black.transmittance[..., None] * np.float32([1, 0, 0])
    np.testing.assert_allclose(red.colour, expected, atol=1e-6)
    assert not same(red.colour, black.colour)


SETTINGS = [
    ({}, []),
    ({"tolerance": 0.5}, ["--tolerance", "0.5"]),
    ({"tolerance": 20, "threshold": "adagscale"}, ["--tolerance", "20", "--threshold", "adagscale"]),
    ({"order": "distance", "projection": "tangent"}, ["--order", "distance", "--projection", "tangent"]),
    ({"tiles": "aabb"}, ["--tiles", "aabb"]),
    ({"near_plane": 4.5}, ["--near", "4.5"]),
]


@pytest.mark.parametrize("settings, options", SETTINGS)
def test_picture_equals_program(renderer, cameras, scene, program, tmp_path, settings, options):
    program("render", scene / "model.ply", "--view", "side", "--mono", "--exr", "float", "--exr-encoding",
            "display", "-o", tmp_path / "p.exr", *options, *BACKEND)
    expected = binosplat.load_image(tmp_path / "p.exr")
    assert same(renderer.draw(cameras["side"], **settings).colour, expected)
    # The line above cannot catch a setting without an effect, so each setting must also change the picture.
    other = {} if settings else {"tolerance": 0.5}
    assert not same(renderer.draw(cameras["side"], **other).colour, expected)


def test_rig_equals_program(renderer, cameras, scene, program, tmp_path):
    program("render", scene / "model.ply", "--view", "front", "--ipd", "0.2", "--convergence", "3", "--bits",
            "16", "-o", tmp_path, *BACKEND)
    expected = [binosplat.load_image(tmp_path / f"front_{side}.png") for side in ("left", "right")]

    def drawn(**rig):
        for picture in renderer.draw(binosplat.Rig(cameras["front"], **rig)):
            binosplat.save_png(tmp_path / "drawn.png", picture.colour, bits=16)
            yield binosplat.load_image(tmp_path / "drawn.png")

    assert all(map(same, drawn(ipd=0.2, convergence=3), expected))
    for other in ({"ipd": 0.2}, {"ipd": 0.1, "convergence": 3}):
        assert not any(map(same, drawn(**other), expected))
    assert not same(*expected)


def test_given_eyes_equal_single_draws(renderer, cameras):
    left, right = cameras["pair_left"], cameras["pair_right"]
    pair = renderer.draw(binosplat.Rig.of_eyes(left, right))
    assert same(pair[0].colour, renderer.draw(left).colour)
    assert same(pair[1].colour, renderer.draw(right).colour)
    assert not same(pair[0].colour, pair[1].colour)


def test_only_follow_uses_previous_frame(model, cameras):
    fast = {"tolerance": 2, "transmittance": "last"}
    with binosplat.Renderer(model, backend="surfaceless") as renderer:
        first = renderer.draw(cameras["front"], **fast, follow=True)
        assert not first.report.used_last
        following = renderer.draw(cameras["front"], **fast, follow=True)
        assert following.report.used_last
        assert not same(following.colour, first.colour)
        alone = renderer.draw(cameras["front"], tolerance=2)
        assert not alone.report.used_last
        assert same(renderer.draw(cameras["front"], tolerance=2).colour, alone.colour)


WRONG = [
    ({"quality": 4000}, "quality 4000: expected decibels from 10 to 100"),
    ({"quality": 40, "tolerance": 1}, "quality 40 with tolerance 1: both choose the tolerance"),
    ({"threshold": "squared"}, "threshold squared needs tolerance, quality or a calibration"),
    ({"order": "size"}, "order: 'size' is not one of depth, distance"),
    ({"depth": "mode"}, "depth: 'mode' is not one of mean, median"),
    ({"projection": "flat"}, "projection: 'flat' is not one of affine, tangent"),
    ({"tiles": "round"}, "tiles: 'round' is not one of aabb, ellipse"),
    ({"transmittance": "depth", "tolerance": 1}, "transmittance depth needs depth_table: take both from a calibration"),
    ({"transmittance": "last", "tolerance": 1}, "transmittance last needs follow=True"),
    ({"near_plane": 0}, "near_plane 0: expected world units above zero"),
    ({"background": (0, 0, 2)}, "background (0, 0, 2): expected numbers from 0 to 1"),
]


@pytest.mark.parametrize("settings, words", WRONG)
def test_rejects_invalid_settings(renderer, cameras, settings, words):
    with pytest.raises(binosplat.InputError, match=re.escape(words)):
        renderer.draw(cameras["front"], **settings)
    assert issubclass(binosplat.InputError, binosplat.Error) and issubclass(binosplat.InputError, ValueError)


def moved(x, scale=1.0):
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[0, 3] = x
    return matrix


def test_instances_are_drawn_at_their_poses(renderer, model, cameras):
    alone = renderer.draw(cameras["front"])
    with binosplat.Renderer([(model, np.eye(4))], backend="surfaceless") as several:
        assert same(several.draw(cameras["front"]).colour, alone.colour)
        several.place([(model, moved(0.5))])  # as seen by a camera at -0.5 from the model's origin
        shifted = several.draw(cameras["side"])
        np.testing.assert_allclose(shifted.colour, alone.colour, atol=2e-3)
        several.place([(model, np.eye(4)), (model, moved(1.0, 0.5), 0.5)])
        both = several.draw(cameras["front"])
        assert both.report.visible > alone.report.visible and not same(both.colour, alone.colour)
        for picture in several.draw_all([cameras["front"]] * 2):
            assert same(picture.colour, both.colour)
        several.place([])
        assert (several.draw(cameras["front"]).transmittance == 1).all()
        for wrong, words in (((model, np.eye(3)), "(4, 4)"), ((model, np.zeros((4, 4))), "instances[0]"),
                             ((model, np.diag([1, 2, 1, 1])), "rotation"), ((model, np.eye(4), 2.0), "opacity 2")):
            with pytest.raises(binosplat.InputError, match=re.escape(words)):
                several.place([wrong])
        with pytest.raises(TypeError):
            several.place([("model.ply", np.eye(4))])


def test_places_reach_views_that_are_yielded_later(model, cameras):
    front, places = cameras["front"], [moved(x) for x in (0, 0.5, 1)]
    with binosplat.Renderer(model, backend="surfaceless") as several:
        expected = []
        for place in places:
            several.place([(model, place)])
            expected.append(several.draw(front).colour)

        def views():
            for place in places:
                several.place([(model, place)])
                yield front

        drawn = [picture.colour for picture in several.draw_all(views())]
        assert all(map(same, drawn, expected)) and not same(drawn[0], drawn[1]) and not same(drawn[1], drawn[2])
        late = []
        for picture in several.draw_all([front] * 3):  # begins at the last place
            several.place([(model, places[0])])
            late.append(picture.colour)
        assert all(map(same, late, [expected[2], expected[2], expected[0]]))


def test_rejects_non_views(renderer):
    for view in (None, "front", 3):
        with pytest.raises(TypeError):
            renderer.draw(view)
    for no_model in (None, "model.ply"):
        with pytest.raises(TypeError):
            binosplat.Renderer(no_model)
        with pytest.raises(TypeError):
            binosplat.frame(no_model, 32, 24)


def test_recovers_from_out_of_memory(renderer, cameras):
    with pytest.raises(binosplat.OutOfMemory) as raised:
        renderer.draw(cameras["front"].resized(32000, 32000))
    assert isinstance(raised.value, MemoryError) and "MiB" in str(raised.value)
    assert renderer.draw(cameras["front"]).colour.any()


def test_path_frames_equal_single_draws(renderer, cameras):
    rig = binosplat.Rig(cameras["front"], ipd=0.1)
    views = [cameras["front"], rig, cameras["side"], cameras["front"]]
    drawn = list(renderer.draw_all(iter(views), background=(0, 1, 0)))
    assert len(drawn) == 4
    for view, pictures in zip(views, drawn):
        expected = renderer.draw(view, background=(0, 1, 0))
        pairs = [(pictures, expected)] if view is not rig else zip(pictures, expected)
        for a, b in pairs:
            assert same(a.colour, b.colour) and same(a.depth, b.depth) and same(a.transmittance, b.transmittance)
    assert not same(drawn[0].colour, drawn[2].colour)
    assert list(renderer.draw_all([])) == []


def test_path_may_be_interleaved_and_abandoned(renderer, cameras):
    expected = renderer.draw(cameras["side"])
    path = renderer.draw_all(cameras[name] for name in ["front", "side", "front"])
    next(path)
    assert same(renderer.draw(cameras["side"]).colour, expected.colour)
    assert same(next(path).colour, expected.colour)
    del path
    assert same(renderer.draw(cameras["side"]).colour, expected.colour)


def test_path_reports_errors_at_their_frame(renderer, cameras, scene):
    with pytest.raises(binosplat.InputError, match="near_plane -1"):
        renderer.draw_all([], near_plane=-1)
    path = renderer.draw_all([cameras["front"], "no camera"])
    with pytest.raises(TypeError, match="a Camera or a Rig, not str"):
        next(path)
    with binosplat.Renderer(binosplat.load_model(scene / "model.ply"), backend="surfaceless") as closing:
        path = closing.draw_all([cameras["front"]] * 3)
        next(path)
        closing.close()
        with pytest.raises(binosplat.InputError, match="this Renderer is closed"):
            next(path)


def test_only_following_path_uses_previous_frames(renderer, cameras):
    views = [cameras["front"]] * 3
    settings = {"tolerance": 0.5, "transmittance": "last", "follow": True}
    assert [p.report.used_last for p in renderer.draw_all(views, **settings)] == [False, True, True]
    with pytest.raises(binosplat.InputError, match="needs follow=True"):
        renderer.draw_all(views, tolerance=0.5, transmittance="last")
    alone = [p.report.used_last for p in renderer.draw_all(views, tolerance=0.5)]
    assert alone == [False, False, False]


def test_adagscale_finds_its_k(program, tmp_path):
    program("convert", "demo:room", "-o", tmp_path / "room.ply")
    model = binosplat.load_model(tmp_path / "room.ply")
    camera = binosplat.frame(model, 1280, 720)
    with binosplat.Renderer(model, backend="surfaceless") as renderer:
        picture, exact = renderer.draw(camera, threshold="adagscale"), renderer.draw(camera)
    assert picture.report.threshold == "adagscale" and exact.report.threshold == "exact"
    assert picture.report.pairs <= 0.9 * exact.report.pairs
    assert np.mean((binosplat.quantised(picture.colour) - binosplat.quantised(exact.colour)) ** 2) <= 1e-4  # 40 dB


def test_calibration_equals_program(model, cameras, scene, program, tmp_path):
    file = tmp_path / "calibration.json"
    program("calibrate", scene / "model.ply", "--quality", "36", "-o", file)
    calibration = binosplat.Calibration(file, model)
    with binosplat.Renderer(model, backend="surfaceless") as renderer:
        picture = renderer.draw(cameras["front"], threshold="adagscale", calibration=calibration)
        far = binosplat.look_at((0, 0, -400), (0, 0, 0), 36, 24)
        assert not picture.report.is_exact
        assert renderer.draw(far, threshold="adagscale", calibration=calibration).report.is_exact
        exact = renderer.draw(cameras["front"])
        own = renderer.draw(cameras["front"], threshold="adagscale", tolerance=0.5, calibration=calibration)
        with pytest.raises(binosplat.InputError, match="needs tolerance, quality or a calibration"):
            renderer.draw(cameras["front"], threshold="squared")
        with pytest.raises(binosplat.InputError, match="transmittance depth needs depth_table"):
            renderer.draw(cameras["front"], threshold="adagscale", tolerance=1, transmittance="depth")
        with pytest.raises(binosplat.InputError, match="no entry for threshold adagscale with transmittance last"):
            renderer.draw(cameras["front"], threshold="adagscale", transmittance="last", calibration=calibration)
        with pytest.raises(TypeError, match="a Calibration"):
            renderer.draw(cameras["front"], threshold="adagscale", calibration=file)
    assert not same(picture.colour, exact.colour)
    assert own.report.tolerance == 0.5
    program("render", scene / "model.ply", "--mono", "--view", "front", "--threshold", "adagscale", "--calibration",
            file, "-o", tmp_path / "picture.png")
    drawn = binosplat.load_image(tmp_path / "picture.png")
    assert same(binosplat.quantised(picture.colour), drawn)
    assert not same(binosplat.quantised(exact.colour), drawn)
    opacities = model.opacities.copy()
    opacities[0] *= 0.5
    other = binosplat.Model(model.means, model.quats, model.scales, opacities, model.sh)
    with pytest.raises(binosplat.InputError, match="another model"):
        binosplat.Calibration(file, other)
