"""Models made from arrays, and arrays made from models."""

import re

import numpy as np
import pytest

import binosplat

NAMES = ["means", "quats", "scales", "opacities", "sh"]


def arrays_of(model):
    return {name: getattr(model, name) for name in NAMES}


def pixels(model, camera):
    with binosplat.Renderer(model, backend="surfaceless") as renderer:
        return renderer.draw(camera).colour


@pytest.fixture()
def arrays(model):
    return arrays_of(model)


class Tensor:
    """Like a CPU tensor of torch: it converts to an array only after detach()."""

    def __init__(self, values):
        self.values = values

    def detach(self):
        return Detached(self.values)

    def __array__(self, dtype=None):
        raise RuntimeError("Can't call numpy() on Tensor that requires grad")


class Detached:
    def __init__(self, values):
        self.values = values

    def __array__(self, dtype=None):
        return self.values


class Lender:
    """An object that supports only DLPack."""

    def __init__(self, values):
        self.values = values

    def __dlpack__(self, **options):
        return self.values.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.values.__dlpack_device__()


def test_arrays_match_file(model, arrays):
    shapes = {"means": (300, 3), "quats": (300, 4), "scales": (300, 3), "opacities": (300,), "sh": (300, 1, 3)}
    for name, array in arrays.items():
        assert array.shape == shapes[name] and array.dtype == np.float32, name
    assert 0.01 < np.median(arrays["scales"]) < 0.5 and (arrays["scales"] > 0).all()
    assert 0 <= arrays["opacities"].min() < 0.5 < arrays["opacities"].max() <= 1
    np.testing.assert_allclose(np.linalg.norm(arrays["quats"], axis=1), 1, atol=1e-6)
    arrays["means"][:] = 0  # must change a copy only
    assert model.means.any()


@pytest.mark.parametrize("how", [
    np.asarray, np.float64, np.asfortranarray, Tensor, Lender,
    lambda x: np.repeat(x, 2, axis=0)[::2],  # not contiguous
    lambda x: x[::-1].copy()[::-1],  # negative strides
    lambda x: x.tolist(),
    lambda x: x.astype(">f4"),
])
def test_picture_from_arrays_equals_file(model, arrays, cameras, how):
    made = binosplat.Model(*[how(array) for array in arrays.values()], name="made")
    assert (made.name, made.format, made.count, made.degree) == ("made", "arrays", 300, 0)
    assert np.array_equal(pixels(made, cameras["front"]), pixels(model, cameras["front"]))
    for name in NAMES:  # all values are exact; below, other values give another picture
        assert np.array_equal(getattr(made, name), arrays[name])
    other = dict(arrays, means=arrays["means"] + np.float32(0.01))
    assert not np.array_equal(pixels(binosplat.Model(**other), cameras["front"]), pixels(model, cameras["front"]))


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_accepts_every_harmonics_degree(arrays, cameras, degree):
    sh = np.zeros((300, (degree + 1)**2, 3), np.float32)
    sh[:, 0] = arrays["sh"][:, 0]
    made = binosplat.Model(**dict(arrays, sh=sh))
    assert made.degree == degree and made.sh.shape == sh.shape
    flat = binosplat.Model(**arrays)
    assert np.array_equal(pixels(made, cameras["front"]), pixels(flat, cameras["front"]))
    sh[:, -1] += 0.5
    assert not np.array_equal(pixels(binosplat.Model(**dict(arrays, sh=sh)), cameras["front"]),
                              pixels(flat, cameras["front"]))


def test_normalises_quaternions_and_applies_axes(arrays, cameras):
    once, twice = (binosplat.Model(**dict(arrays, quats=arrays["quats"] * k)) for k in (2, 4))
    assert np.array_equal(pixels(twice, cameras["front"]), pixels(once, cameras["front"]))
    turned = binosplat.Model(**arrays, axes="LUF", antialiased=True)
    assert turned.axes == "LUF" and turned.antialiased
    assert not np.array_equal(pixels(turned, cameras["front"]), pixels(once, cameras["front"]))


def injected(array, value, at=7):
    array = array.copy()
    array[at] = value
    return array


@pytest.mark.parametrize("name, change, words", [
    ("means", lambda x: x[:, :2], "means: an array of shape (300, 2): expected (N, 3)"),
    ("means", lambda x: x[:299], "quats: an array of shape (300, 4): expected (299, 4)"),
    ("scales", lambda x: x[:, 0], "scales: an array of shape (300,): expected (300, 3)"),
    ("opacities", lambda x: x[:, None], "opacities: an array of shape (300, 1): expected (300,)"),
    ("sh", lambda x: x[:, 0], "sh: an array of shape (300, 3): expected (N, 1, 3), (N, 4, 3)"),
    ("sh", lambda x: np.repeat(x, 5, axis=1), "sh: an array of shape (300, 5, 3): expected (N, 1, 3)"),
    ("means", lambda x: injected(np.float64(x), -np.inf), "means[7]: expected finite numbers"),
    ("scales", lambda x: injected(x, -1), "scales[7]: below 0: expected standard deviations"),
])
def test_rejects_invalid_gaussians(arrays, name, change, words):
    with pytest.raises(binosplat.InputError, match=re.escape(words)):
        binosplat.Model(**dict(arrays, **{name: change(arrays[name])}))


def test_rejects_non_float_arrays(arrays):
    for wrong in (None, "means", np.zeros((300, 3), int), np.zeros((300, 3), complex), [["a"] * 3] * 300):
        with pytest.raises(TypeError, match="means: expected an array of floats"):
            binosplat.Model(**dict(arrays, means=wrong))
    empty = {name: array[:0] for name, array in arrays.items()}
    with pytest.raises(binosplat.InputError, match="means: no Gaussians"):
        binosplat.Model(**empty)
    with pytest.raises(binosplat.InputError, match="axes 'XYZ'"):
        binosplat.Model(**arrays, axes="XYZ")


def test_float64_means_keep_precision(model, arrays):
    far = np.array([455000.25, 5411000.5, 312.125])

    def camera(at):
        return binosplat.Camera(72, 48, 60.0, position=at)

    def psnr(means):
        made = binosplat.Model(**dict(arrays, means=means))
        return binosplat.compare(pixels(made, camera(far)), pixels(model, camera(np.zeros(3)))).psnr

    wide = arrays["means"].astype(float) + far
    assert psnr(wide) > 60
    assert psnr(wide.astype(np.float32)) < 40  # injected fault: positions rounded to float32
    made = binosplat.Model(**dict(arrays, means=wide))
    assert made.means.dtype == np.float64 and np.abs(made.means - wide).max() < 1e-5


@pytest.mark.parametrize("name", NAMES)
def test_rejects_masked_values(model, arrays, name):
    masked = np.ma.masked_array(arrays[name], mask=False)
    assert binosplat.Model(**dict(arrays, **{name: masked})).count == 300
    masked[7] = np.ma.masked
    with pytest.raises(binosplat.InputError, match=f"{name}: masked arrays"):
        binosplat.Model(**dict(arrays, **{name: masked}))
    with pytest.raises(binosplat.InputError, match="mask: masked arrays"):
        model.filtered(np.ma.masked_array(np.ones(300, bool), mask=np.arange(300) < 9))
    picture = np.ma.masked_greater(np.zeros((4, 4, 3), np.float32) + np.eye(4)[:, :, None], 0.5)
    for call in (lambda: binosplat.compare(picture, picture), lambda: binosplat.quantised(picture)):
        with pytest.raises(binosplat.InputError, match="masked arrays"):
            call()


def test_reports_out_of_memory(arrays):
    many = {name: np.broadcast_to(array[:1], (2**33, *array.shape[1:])) for name, array in arrays.items()}
    with pytest.raises(binosplat.OutOfMemory):
        binosplat.Model(**many)


def test_rejects_uninitialised_objects(model, renderer):
    unmade = [(binosplat.Picture, "colour"), (binosplat.Picture, "report"), (binosplat.Comparison, "psnr"),
              (binosplat.Model, "means"), (binosplat.Camera, "name"), (binosplat.Rig, "eyes"),
              (binosplat.Cameras, "source"), (binosplat.Renderer, "device")]
    for kind, name in unmade:
        with pytest.raises(AttributeError):
            getattr(kind.__new__(kind), name)
    for view in (binosplat.Camera.__new__(binosplat.Camera), binosplat.Rig.__new__(binosplat.Rig)):
        with pytest.raises(AttributeError):
            renderer.draw(view)
    with pytest.raises(AttributeError):
        binosplat.Renderer(binosplat.Model.__new__(binosplat.Model))
