"""measure() and debug_view(): arrays by Gaussian and by pixel; models filtered by a mask, and saved."""

import re

import numpy as np
import pytest

import binosplat


def same(a, b):
    return a.shape == b.shape and np.array_equal(a, b, equal_nan=True)


def projected_radii(model, camera):
    """Three standard deviations of the longer axis in px, in float64 from the model's arrays (docs/method.md 2)."""
    v = (model.means - camera.position) @ camera.rotation
    limit = [(0.5 + 0.15) * size / camera.fx for size in (camera.width, camera.height)]
    slopes = np.clip(v[:, :2] / v[:, 2:], -np.array(limit), limit)
    w, x, y, z = model.quats.astype(float).T
    turn = np.array([[1 - 2 * (y*y + z*z), 2 * (x*y - w*z), 2 * (x*z + w*y)],
                     [2 * (x*y + w*z), 1 - 2 * (x*x + z*z), 2 * (y*z - w*x)],
                     [2 * (x*z - w*y), 2 * (y*z + w*x), 1 - 2 * (x*x + y*y)]]).transpose(2, 0, 1)
    axes = camera.rotation.T @ turn * model.scales[:, None, :]
    gain = camera.fx / v[:, 2, None, None]
    rows = gain * (axes[:, :2] - slopes[:, :, None] * axes[:, 2:])
    return 3 * np.sqrt(np.linalg.eigvalsh(rows @ rows.transpose(0, 2, 1) + 0.3 * np.eye(2))[:, 1])


def test_measures_add_up_to_picture(renderer, model, cameras):
    rig = binosplat.Rig(cameras["front"], ipd=0.2)
    found = renderer.measure([cameras["front"], cameras["side"], rig])
    assert found.shape == (4, model.count)
    pictures = [renderer.draw(cameras["front"]), renderer.draw(cameras["side"]), *renderer.draw(rig)]
    left_over = [picture.transmittance.sum(dtype=float) for picture in pictures]
    np.testing.assert_allclose(found["contribution"].sum(axis=1, dtype=float) + left_over, 72 * 48, atol=0.05)
    assert np.abs(np.diff(left_over)).min() > 1  # so that rows in another order are noticed
    assert list(found["tiles"].sum(axis=1)[:2]) == [pictures[0].report.pairs, pictures[1].report.pairs]
    assert found["tiles"][2:].sum() == pictures[2].report.pairs
    assert same(renderer.measure(cameras["side"])["contribution"], found["contribution"][1:2])
    visible = found["contribution"] > 0
    assert same(visible, found["transmittance"] > 0) and (found["transmittance"] <= 1).all()
    shown = found["tiles"][0] > 0
    assert 0 < visible[0].sum() <= shown.sum() < model.count

    expected = projected_radii(model, cameras["front"])
    np.testing.assert_allclose(found["radius"][0, shown], expected[shown], rtol=1e-4)
    assert (found["radius"][0, ~shown] == 0).all()
    other = projected_radii(model, cameras["side"])[shown]
    assert not np.allclose(found["radius"][0, shown], other, rtol=1e-3)  # injected fault: another view


def test_measure_follows_threshold(renderer, cameras):
    exact, fast = (renderer.measure(cameras["front"], **s) for s in ({}, {"tolerance": 5}))
    assert fast["tiles"].sum() == renderer.draw(cameras["front"], tolerance=5).report.pairs < exact["tiles"].sum()
    assert (fast["tiles"] - exact["tiles"] <= 0).all()  # signed


def test_invisible_gaussians_can_be_removed(renderer, model, cameras, tmp_path):
    picture = renderer.draw(cameras["front"])
    found = renderer.measure(cameras["front"])
    visible = found["contribution"] > 0
    smaller = model.filtered(visible[0])
    assert smaller.count == visible.sum() and smaller.left_out == model.left_out
    assert same(smaller.means, model.means[visible[0]])
    with binosplat.Renderer(smaller, backend="surfaceless") as other:
        assert same(other.draw(cameras["front"]).colour, picture.colour)
    most = found["contribution"][0].argmax()  # injected fault: a mask that also removes a visible Gaussian
    with binosplat.Renderer(model.filtered(np.arange(model.count) != most), backend="surfaceless") as other:
        assert not same(other.draw(cameras["front"]).colour, picture.colour)

    for ending in ("ply", "spz", "sog"):
        smaller.save(tmp_path / f"small.{ending}")
        read = binosplat.load_model(tmp_path / f"small.{ending}")
        with binosplat.Renderer(read, backend="surfaceless") as other:
            drawn = other.draw(cameras["front"]).colour
        assert read.count == smaller.count and binosplat.compare(drawn, picture.colour).psnr > 35
        assert ending != "ply" or same(drawn, picture.colour)
    with pytest.raises(binosplat.InputError, match=re.escape(".ply, .sog or .spz")):
        smaller.save(tmp_path / "small.splat")
    assert len(list(tmp_path.iterdir())) == 3


def test_rejects_invalid_masks(model):
    for mask, error, words in ((np.ones(model.count), TypeError, "mask: expected an array of bool"),
                               (np.ones(5, bool), binosplat.InputError, "mask: an array of shape (5,): expected (300,)"),
                               (np.zeros(model.count, bool), binosplat.InputError, "mask: it keeps no Gaussian")):
        with pytest.raises(error, match=re.escape(words)):
            model.filtered(mask)


def test_debug_views_are_numbers(renderer, cameras, program, scene, tmp_path):
    picture = renderer.draw(cameras["front"])
    depth = renderer.debug_view(cameras["front"], "depth")
    assert same(depth, np.where(np.isinf(picture.depth), np.nan, picture.depth))
    alphas, visible = (renderer.debug_view(cameras["front"], show) for show in ("alphas", "visible"))
    assert (visible <= alphas).all() and visible.max() > 1 and same(visible > 0, picture.transmittance < 1)
    # The sum over pixels of their tiles' pairs, by another way: every tile of 16 x 16 px has one number.
    pairs = renderer.debug_view(cameras["front"], "pairs")
    assert pairs[::16, ::16].sum() == picture.report.pairs
    fast = renderer.draw(cameras["front"], tolerance=2)
    error = 255 * np.abs(fast.colour - picture.colour).max(axis=2)
    difference = renderer.debug_view(cameras["front"], "difference", tolerance=2)
    np.testing.assert_allclose(difference, error, atol=1e-4)
    assert error.max() > 0.5 and not np.allclose(difference, error.T[::-1].reshape(error.shape), atol=0.1)
    left, right = renderer.debug_view(binosplat.Rig(cameras["front"], ipd=0.2), "disagreement", tolerance=2)
    assert left.shape == (48, 72) and not same(left, right)
    for wrong, words in (("picture", "show: 'picture' is not one of difference"), ("disagreement", "needs both eyes")):
        with pytest.raises(binosplat.InputError, match=words):
            renderer.debug_view(cameras["front"], wrong)


def test_rejects_views_and_settings(renderer, model, cameras):
    for settings in ({"quality": 40}, {"follow": True}):
        with pytest.raises(binosplat.InputError, match="measure: expected no quality and no follow"):
            renderer.measure(cameras["front"], **settings)
    for views in ("front", [cameras["front"], None]):
        with pytest.raises(TypeError, match="a Camera or a Rig"):
            renderer.measure(views)
    with pytest.raises(TypeError, match="expected a Camera, not Rig"):
        binosplat.Rig(binosplat.Rig(cameras["front"]))
    with pytest.raises(TypeError, match="expected a Camera, not int"):
        binosplat.Rig.of_eyes(cameras["front"], 3)
    for background in (255, (1, 1), "red", ("1", "0", "0")):
        words = "background: expected three numbers from 0 to 1, for red, green and blue, not"
        with pytest.raises(TypeError, match=words):
            renderer.draw(cameras["front"], background=background)
        with pytest.raises(TypeError, match=words):
            binosplat.compare(np.zeros((12, 12)), np.zeros((12, 12)), background=background)
    moved = np.eye(4)
    moved[0, 3] = 1
    with binosplat.Renderer([(model, moved)], backend="surfaceless") as several:
        for call in (several.measure, lambda view: several.debug_view(view, "pairs")):
            with pytest.raises(binosplat.InputError, match="expected one model at its own place"):
                call(cameras["front"])
