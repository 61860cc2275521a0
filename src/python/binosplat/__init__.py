"""3D Gaussian Splatting models as pictures for one eye or both, drawn by OpenGL compute shaders.

A picture in four lines:

>>> import binosplat
>>> model = binosplat.load_model("garden.ply")
>>> picture = binosplat.Renderer(model).draw(binosplat.frame(model, 1280, 720), near=model.near)
>>> binosplat.save_png("garden.png", picture.colour)

Files, arrays, pictures and settings that cannot be used, and numbers that make no camera or rig, raise InputError, a
ValueError; OpenGLError and OutOfMemory are the other two kinds of Error. Arguments of a wrong type raise TypeError.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, Generic, Literal, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Calibration", "Camera", "Cameras", "Comparison", "Error", "Exposures", "InputError", "Model", "OpenGLError",
    "OutOfMemory", "Picture", "Renderer", "Report", "Rig", "compare", "exposed", "find_cameras", "find_exposures",
    "find_photo", "find_photos", "frame", "load_cameras", "load_exposures", "load_image", "load_model", "look_at",
    "quantised", "save_png",
]


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


class Error(Exception):
    """What binosplat itself says is wrong."""


class InputError(Error, ValueError):
    """A file, an array or a setting that cannot be used."""


class OpenGLError(Error, RuntimeError):
    """No usable OpenGL, or the GPU was reset."""


class OutOfMemory(Error, MemoryError):
    """No room on the GPU, or for a picture or an array."""


_binosplat: Any = import_module("._binosplat", __name__)  # the private part in C++, which raises the errors above
__version__: str = _binosplat.__version__

_Path = str | os.PathLike[str]
_Floats = NDArray[np.float32]
_Th = Literal["tau", "squared", "peripheral", "adagscale"]
_Transmittance = Literal["one", "last", "depth"]
_Order = Literal["depth", "distance"]
_Projection = Literal["affine", "tangent"]
_Tiles = Literal["aabb", "ellipse", "snug", "obb", "all"]
_Drawn = TypeVar("_Drawn", covariant=True)


class _View(Generic[_Drawn]):
    """What can be drawn; for type checkers it says what draw() returns of it."""


def _expect(value: Any, kind: Any, name: str) -> None:
    if not isinstance(value, kind):
        raise TypeError(f"expected {name}, not {type(value).__name__}")


def _refuse_masked(given: Any, name: str) -> None:
    if np.ma.is_masked(given):
        raise InputError(f"{name}: a masked array, and a mask has no place here: leave the masked rows out, or fill "
                         "them (filled())")


def _dense(array: NDArray[Any], kind: type) -> NDArray[Any]:
    """The array in one piece of memory, which is refused before it is asked for where there is not so much."""
    if array.size * (np.dtype(kind).itemsize + 4) > _binosplat.memory_bytes():
        raise OutOfMemory(f"an array of shape {array.shape} takes more memory than there is")
    try:
        with np.errstate(over="ignore"):
            return np.ascontiguousarray(array, kind)
    except MemoryError as error:
        raise OutOfMemory(str(error)) from None


def _array(given: Any, name: str) -> NDArray[Any]:
    """The array of floats that something is, gives, or lends by DLPack; a tensor that is being trained is detached."""
    _refuse_masked(given, name)
    values = given.detach() if hasattr(given, "detach") else given
    lends = hasattr(values, "__dlpack__") and not hasattr(values, "__array__")
    array = np.from_dlpack(values) if lends else np.asarray(values)
    if array.dtype.kind != "f":
        raise TypeError(f"{name}: expected an array of floats, not of {array.dtype}")
    return array


def _rows(given: Any, name: str, shape: tuple[int | None, ...], kind: type = np.float32) -> NDArray[Any]:
    """The values in one piece, of a shape in which None is any size."""
    array = _array(given, name)
    if len(shape) != array.ndim or any(size not in (None, n) for size, n in zip(shape, array.shape)):
        sizes = ", ".join("N" if size is None else str(size) for size in shape)
        raise InputError(f"{name}: an array of shape {array.shape}: expected ({sizes}{',' * (len(shape) == 1)})")
    return _dense(array, kind)


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Model:
    """A model in memory.

    Read one by load_model(), or make one of arrays: NumPy's, those of torch on the CPU, whatever has
    ``__array__`` or ``__dlpack__``. The arguments have the names and the order of gsplat's ``rasterization``.

    Parameters
    ----------
    means : (N, 3) floats
        Centres, world units.
    quats : (N, 4) floats
        Quaternions w, x, y, z of any length but 0.
    scales : (N, 3) floats
        Standard deviations, world units: exp() of what trainers store.
    opacities : (N,) floats
        0 to 1: the sigmoid of what trainers store.
    sh : (N, K, 3) floats
        Spherical harmonics, K = 1, 4, 9 or 16 coefficients; the colour at degree 0 is 0.5 + 0.2820948 sh[:, 0].
    name
        What messages call it.
    axes
        Where its x, y and z point: R or L, U or D, F or B. The default is that of COLMAP's world.
    antialiased
        Whether it was trained with gsplat's ``rasterize_mode="antialiased"`` or Mip-Splatting.

    Raises
    ------
    InputError
        For other shapes, and for a row that is no Gaussian, which it names.
    TypeError
        For arrays of other numbers than floats.

    Attributes
    ----------
    format
        Of its file, in words.
    count
        Gaussians; anchors of Scaffold-GS.
    degree
        Of the spherical harmonics, 0 to 3.
    left_out
        Gaussians of the file that are not finite.
    antialiased_by
        What says so: a comment of its file, a file of the training's run; empty: nothing does.
    order, projection
        What it was trained to be sorted by, and what a ray sees of a Gaussian; draw() takes others, too.
    """

    name: str
    format: str
    count: int
    degree: int
    left_out: int
    axes: str
    antialiased: bool
    antialiased_by: str
    order: _Order
    projection: _Projection
    _model: Any

    def __init__(self, means: ArrayLike, quats: ArrayLike, scales: ArrayLike, opacities: ArrayLike, sh: ArrayLike, *,
                 name: str = "arrays", axes: str = "RDF", antialiased: bool = False) -> None:
        centres = _rows(means, "means", (None, 3), np.float64)
        count = len(centres)
        columns = [_rows(quats, "quats", (count, 4)), _rows(scales, "scales", (count, 3)),
                   _rows(opacities, "opacities", (count,))]
        shape = _array(sh, "sh").shape
        if len(shape) != 3 or shape[1] not in (1, 4, 9, 16):
            raise InputError(f"sh: an array of shape {shape}: expected (N, 1, 3), (N, 4, 3), (N, 9, 3) or (N, 16, 3), "
                             "the coefficients of the spherical harmonics; of plain RGB they are "
                             "((rgb - 0.5) / 0.2820948)[:, None]")
        columns.append(_rows(sh, "sh", (count, shape[1], 3)))
        self._take(_binosplat.Model(centres, *columns, name, axes, antialiased))

    def _take(self, model: Any) -> None:
        vars(self).update(model.facts(), _model=model)

    @property
    def near(self) -> float:
        """The near plane, in world units, that suits cameras made up for it: 0.2, less where it is tiny."""
        return self._model.near

    @property
    def means(self) -> NDArray[np.float32] | NDArray[np.float64]:
        """As the argument of this name, of any model. A copy, as the other four; far away from zero of float64."""
        return self._copy("means")

    @property
    def quats(self) -> _Floats:
        return self._copy("quats")

    @property
    def scales(self) -> _Floats:
        return self._copy("scales")

    @property
    def opacities(self) -> _Floats:
        return self._copy("opacities")

    @property
    def sh(self) -> _Floats:
        return self._copy("sh")

    def _copy(self, name: str) -> NDArray[Any]:
        try:
            return self._model.column(name)
        except MemoryError as error:
            raise OutOfMemory(str(error)) from None

    def __repr__(self) -> str:
        return f"<binosplat.Model {self.name}: {self.count} Gaussians, degree {self.degree}>"


def load_model(path: _Path, *, lod: int | None = None, appearance: int | None = None, axes: str | None = None,
               antialiased: bool | None = None) -> Model:
    """Reads a model of any format that ``binosplat render`` takes.

    Parameters
    ----------
    path
        A file or its folder. What it is, its content decides.
    lod
        Level of detail of a streamed SOG, 0 the finest.
    appearance
        Of Scaffold-GS.
    axes
        Where the model's axes point, if the file is wrong about it.
    antialiased
        Whether it was trained with anti-aliasing, if the file is wrong about it.

    Raises
    ------
    InputError
        For what is no model; the text says what it looks like instead.
    """
    model = Model.__new__(Model)
    model._take(_binosplat.load_model(path, lod, appearance, axes, antialiased))
    return model


class Calibration:
    """A file of ``binosplat calibrate``, which says how much of a model frames may leave out.

    ``renderer.draw(camera, th="adagscale", calibration=calibration)`` draws by AdaGScale as the programs do.

    Parameters
    ----------
    path
    model
        The one that was calibrated.

    Raises
    ------
    InputError
        For what is no such file, and for another model.
    """

    def __init__(self, path: _Path, model: Model) -> None:
        _expect(model, Model, "a Model")
        self._policy = _binosplat.Calibration(path, model._model)


@dataclass(frozen=True)
class Report:
    """What drawing a frame took.

    Attributes
    ----------
    stages
        GPU time of each stage, ms: decode, project, bin, sort, blend, probe.
    gpu_ms
        Their sum.
    submit_ms
        CPU time of handing the frame to the driver.
    gpu_bytes
        In buffers, the model's included.
    visible
        Gaussians drawn, summed over depth orders (one for parallel eyes).
    pairs
        Gaussian-tile pairs over all views.
    tolerance
        That the frame was drawn with; 0 is exact.
    quality
        With a quality: dB that it came to.
    quality_is_estimate
        It was not measured on all of this frame.
    attempts
        Times that it was drawn until the quality held.
    redrawn
        Times that it was drawn again, since a buffer was too small.
    used_measured
        It used the transmittance that the frame before measured.
    is_cut
        With a quality or transmittance 'last': it could go by no earlier frame.
    """

    stages: dict[str, float]
    gpu_ms: float
    submit_ms: float
    gpu_bytes: int
    visible: int
    pairs: int
    tolerance: float
    quality: float
    quality_is_estimate: bool
    attempts: int
    redrawn: int
    used_measured: bool
    is_cut: bool


@dataclass(frozen=True, eq=False, repr=False)
class Picture:
    """What draw() makes of a view; rows from the top.

    Attributes
    ----------
    colour
        (height, width, 3): display-referred RGB over the background, white 1; what Gaussians overshoot is not
        clamped.
    transmittance
        (height, width): the share of the background's light that is left, 1 - alpha.
    depth
        (height, width): along the view's axis, world units, by draw(depth=); inf where alpha is at most 0.5.
    report
        What drawing the frame took.
    """

    colour: _Floats
    transmittance: _Floats
    depth: _Floats
    report: Report


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Camera(_View[Picture]):
    """A pinhole camera of the world: x right, y down, z forward, as COLMAP leaves it.

    Parameters
    ----------
    width, height
        Of the picture, px.
    fx, fy
        Focal lengths, px; fy is fx by default.
    cx, cy
        Principal point, px from the picture's left and upper edge; the middle by default.
    position : (3,) floats
        World units.
    rotation : (3, 3) floats
        Camera to world: its columns are the camera's axes x right, y down, z forward in the world.
    name
        What messages call it.

    Attributes
    ----------
    time
        s, of a path; None elsewhere.
    """

    name: str
    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    time: float | None
    position: NDArray[np.float64]
    rotation: NDArray[np.float64]

    def __init__(self, width: int, height: int, fx: float, *, fy: float | None = None, cx: float | None = None,
                 cy: float | None = None, position: ArrayLike = (0, 0, 0),
                 rotation: ArrayLike = ((1, 0, 0), (0, 1, 0), (0, 0, 1)), name: str = "") -> None:
        vars(self).update(vars(_binosplat.camera(width, height, fx, fy, cx, cy, position, rotation, name)))

    def resized(self, width: int, height: int) -> Camera:
        """The camera at another size in px, as ``--size`` does: the vertical field of view is kept."""
        return _binosplat.resized(self, width, height)

    def __repr__(self) -> str:
        x, y, z = self.position
        return f"<binosplat.Camera {self.name}: {self.width} x {self.height} px at {x:.4g}, {y:.4g}, {z:.4g}>"


def look_at(eye: ArrayLike, at: ArrayLike, width: int, height: int, *, up: ArrayLike = (0, -1, 0),
            fov: float = 60) -> Camera:
    """A camera at a point that looks at another.

    Parameters
    ----------
    eye, at : (3,) floats
        World units.
    width, height
        px.
    up : (3,) floats
        What is up in the picture.
    fov
        Vertical field of view, degrees.
    """
    return _binosplat.look_at(eye, at, width, height, up, fov)


def frame(model: Model, width: int, height: int, *, up: ArrayLike = (0, -1, 0), fov: float = 60) -> Camera:
    """A camera that shows all of a model from outside, as look_at() makes it; draw with ``near=model.near``."""
    _expect(model, Model, "a Model")
    return _binosplat.frame(model._model, width, height, up, fov)


class Cameras:
    """The cameras of a file, in its order: by number, or by name.

    Attributes
    ----------
    source
        The file or folder.
    """

    def __init__(self, source: str, cameras: list[Camera]) -> None:
        self.source = source
        self._cameras = cameras

    def __len__(self) -> int:
        return len(self._cameras)

    def __getitem__(self, which: int | str) -> Camera:
        """The camera of a number, or the first of a name. Raises InputError for a name, with some that there are."""
        if not isinstance(which, str):
            return self._cameras[which]
        for camera in self._cameras:
            if camera.name == which:
                return camera
        return _binosplat.fail_no_camera(which, self.source, self._cameras)

    def __iter__(self) -> Iterator[Camera]:
        return iter(self._cameras)

    def __repr__(self) -> str:
        return f"<binosplat.Cameras: {len(self)} of {self.source}>"


def load_cameras(path: _Path, model: _Path | None = None) -> Cameras:
    """Reads cameras.json, transforms.json, nerfstudio's camera_path.json, a COLMAP reconstruction, or the camera in a
    SHARP model's ply.

    Parameters
    ----------
    path
        The file or its folder.
    model
        A model that nerfstudio trained with them: they are moved into the world of its training, which
        dataparser_transforms.json beside it tells.
    """
    if path is None:
        raise InputError("load_cameras: the path is None, as find_cameras() says where it finds none")
    return Cameras(os.fspath(path), _binosplat.load_cameras(path, model))


def find_cameras(model: _Path) -> Path | None:
    """The file or folder with the cameras of a model, beside the model's path; None without."""
    return _binosplat.find_cameras(model)


def find_photos(cameras: _Path) -> Path | None:
    """The folder of the photos that cameras were found from, beside the cameras' path; or None."""
    return _binosplat.find_photos(cameras)


def find_photo(folder: _Path, view: Camera | str) -> Path | None:
    """A view's photo in a folder, by the camera or its name, with or without a picture's ending; or None."""
    return _binosplat.find_photo(folder, view)


class Rig(_View[tuple[Picture, Picture]]):
    """Both eyes of a head camera.

    Parameters
    ----------
    head
        In the middle between the eyes.
    ipd
        Distance of the eyes, metres.
    units_per_metre
        World units that make a metre.
    convergence
        Distance without disparity, metres; infinite by default.
    cant
        Degrees by which each eye is turned outwards.
    """

    def __init__(self, head: Camera, *, ipd: float = 0.063, units_per_metre: float = 1.0,
                 convergence: float | None = None, cant: float = 0.0) -> None:
        self._parts: tuple[Any, ...] = (head, None, ipd, units_per_metre, convergence, cant)
        self.eyes  # which raises for values that make no rig

    @staticmethod
    def of_eyes(left: Camera, right: Camera) -> Rig:
        """The rig of two cameras that are given as a pair."""
        rig = Rig(left)
        rig._parts = (left, (left, right), *rig._parts[2:])
        return rig

    @property
    def eyes(self) -> tuple[Camera, Camera]:
        """The cameras of the left and of the right eye."""
        return _binosplat.eyes(self)


class Renderer:
    """A model on a GPU, or in Mesa's software renderer.

    Parameters
    ----------
    model
    backend
        'auto' (a GPU, else Mesa), 'device', 'surfaceless' or 'osmesa'.
    device
        Number of the EGL device.
    precision
        'full', or 'half' for half the memory at 60 dB and more.

    Attributes
    ----------
    device
        What it draws with, in words.
    """

    def __init__(self, model: Model, *, backend: Literal["auto", "device", "surfaceless", "osmesa"] = "auto",
                 device: int | None = None, precision: Literal["full", "half"] = "full") -> None:
        _expect(model, Model, "a Model")
        self._renderer = _binosplat.Renderer(model._model, backend, device, precision)
        self.device: str = self._renderer.device

    def draw(self, view: _View[_Drawn], *, quality: float | None = None, tolerance: float | None = None,
             th: _Th | None = None, transmittance: _Transmittance = "one", order: _Order | None = None,
             projection: _Projection | None = None, tiles: _Tiles = "ellipse",
             decode: Literal["eyes", "cyclopean"] = "eyes", background: ArrayLike = (0, 0, 0), near: float = 0.2,
             depth: Literal["mean", "median"] = "mean", follow: bool = False,
             calibration: Calibration | None = None) -> _Drawn:
        """Draws a view. Without settings the picture is exact.

        May be called from any thread; pictures of one Renderer are drawn one after the other. Ctrl-C ends the wait.

        Parameters
        ----------
        view : Camera or Rig
        quality
            dB of PSNR that the picture should have against the exact one.
        tolerance
            In place of quality: what leaving a Gaussian out of a tile may cost, in the unit of th.
        th
            The rule that leaves Gaussians out: 'squared' (where quality, tolerance or calibration is given),
            'peripheral', 'adagscale', which is that with transmittance 'depth', or 'tau', which is exact.
        transmittance
            The light that a Gaussian is taken to get: 'one'; 'last', which the frame before measured, and which needs
            follow; or 'depth', the most that reaches its depth by the calibration's table.
        order
            What Gaussians are sorted by, 'depth' or 'distance'; as the model was trained by default.
        projection
            'affine' or 'tangent'; as the model was trained by default.
        tiles
            Which tiles get a Gaussian: 'ellipse', 'snug' or 'all', which are exact, 'aabb' or 'obb'.
        decode
            Of Scaffold-GS: 'eyes' or, with a Rig, 'cyclopean'.
        background : (3,) floats
            RGB behind the scene, 0 to 1.
        near
            Nothing nearer is drawn, world units.
        depth
            'mean' of what is seen, or 'median', by which half of it is.
        follow
            This is the next frame of a path, and uses what the one before measured. Else the picture depends on
            nothing drawn before.
        calibration
            Of this model, which gives the table by depth and, where neither quality nor tolerance is given, the
            tolerance. What is far from the calibrated cameras is drawn exactly.

        Returns
        -------
        Picture, or of a Rig a tuple of two, left and right
        """
        _expect(view, _View, "a Camera or a Rig")
        settings = self._settings(quality, tolerance, th, transmittance, order, projection, tiles, decode, background,
                                  near, depth, follow, calibration)
        return _pictures(*self._renderer.draw(view, settings))

    def draw_all(self, views: Iterable[_View[_Drawn]], *, quality: float | None = None,
                 tolerance: float | None = None, th: _Th | None = None, transmittance: _Transmittance = "one",
                 order: _Order | None = None, projection: _Projection | None = None, tiles: _Tiles = "ellipse",
                 decode: Literal["eyes", "cyclopean"] = "eyes", background: ArrayLike = (0, 0, 0), near: float = 0.2,
                 depth: Literal["mean", "median"] = "mean", follow: bool = False,
                 calibration: Calibration | None = None) -> Iterator[_Drawn]:
        """Draws one view after another, each while Python has the picture of the one before.

        Parameters
        ----------
        views : iterable of Camera or Rig
            Each is taken when its turn comes, and what is wrong with it raised then.
        quality, tolerance, th, transmittance, order, projection, tiles, decode, background, near, depth, follow, calibration
            As of draw(), and the same for all; with follow they are the frames of a path.

        Returns
        -------
        iterator of what draw() returns
        """
        settings = self._settings(quality, tolerance, th, transmittance, order, projection, tiles, decode, background,
                                  near, depth, follow, calibration)
        return _pictures_of_path(_binosplat.Path(self._renderer, settings), iter(views))

    def _settings(self, quality: float | None, tolerance: float | None, th: _Th | None, transmittance: _Transmittance,
                  *others: Any) -> Any:
        *others_but_last, calibration = others
        _expect(calibration, (Calibration, type(None)), "a Calibration")
        rule: str | None = th
        if th == "adagscale":
            if transmittance == "last":
                raise InputError("th adagscale goes by its table by depth: for transmittance last take peripheral")
            rule, transmittance = "peripheral", "depth"
        policy = calibration._policy if calibration else None
        return self._renderer.settings(quality, tolerance, rule, transmittance, *others_but_last, policy)

    def close(self) -> None:
        """Gives the GPU's memory back; it is also given back with the last reference, and by `with`."""
        self._renderer.close()

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


def _pictures(arrays: list[tuple[_Floats, _Floats, _Floats]], report: dict[str, Any]) -> Any:
    """A view's picture, or those of both eyes."""
    of_frame = Report(**report)
    pictures = tuple(Picture(*of_view, of_frame) for of_view in arrays)
    return pictures if len(pictures) == 2 else pictures[0]


def _pictures_of_path(path: Any, views: Iterator[Any]) -> Iterator[Any]:
    begun = False
    for view in views:
        _expect(view, _View, "a Camera or a Rig")
        if begun:
            yield _pictures(*path.next(view))
        else:
            path.begin(view)
        begun = True
    if begun:
        yield _pictures(*path.next(None))


@dataclass(frozen=True)
class Comparison:
    """By how much two pictures differ.

    Attributes
    ----------
    psnr
        dB; inf for equal pictures, nan where one holds a NaN or an infinity.
    ssim
        At most 1, that of equal pictures; nan for pictures below 11 x 11 px or with such a value.
    flip
        Mean of FLIP's map, 0 to 1; nan likewise.
    largest_error
        Of a channel, absolute, of white 1.
    at
        Row, column and channel of the largest error, or of the first NaN or infinity.
    """

    psnr: float
    ssim: float
    flip: float
    largest_error: float
    at: tuple[int, int, int]


_whites = {"<f4": 1, "<f8": 1, "|u1": 255, "<u2": 65535}  # by NumPy's names of types


def _picture(given: Any, name: str) -> _Floats:
    """The picture that an array is, with white 1. Floats that count to 255 are refused: those that are twice as bright
    as white in the mean, or whole numbers only."""
    _refuse_masked(given, name)
    array = np.asarray(given)
    if array.dtype.str not in _whites:
        raise TypeError(f"{name}: pictures are arrays of float32, float64, uint8 or uint16, not {array.dtype}")
    sides = array.shape[:2]
    if (array.ndim not in (2, 3) or array.shape[2:] not in ((), (1,), (3,), (4,)) or
            max(*sides, sides[0] * sides[1]) >= 2**31):
        raise InputError(f"{name}: an array of shape {array.shape} is no picture: expected (height, width) or (height, "
                         "width, channels) with 1, 3 or 4 channels")
    picture = _dense(array, np.float32)
    white = _whites[array.dtype.str]
    if white != 1:
        picture /= np.float32(white)
    elif picture.size and np.isfinite(picture).all():
        mean, largest = picture.mean(dtype=np.float64), picture.max()
        if mean > 2 or (largest > 1 and (picture == np.floor(picture)).all()):
            raise InputError(f"{name}: floats have white 1, but these go up to {largest:.6g} with a mean of {mean:.3g}"
                             ": divide them by their white, or pass uint8 or uint16; a picture that is so bright can be "
                             "clipped to 0 to 1 before")
    return picture


def load_image(path: _Path) -> _Floats:
    """Reads a PNG, JPEG or OpenEXR.

    Returns
    -------
    numpy.ndarray of float32
        Display-referred, white 1: (height, width) of grey, (height, width, 3) of RGB, (height, width, 4) with
        straight alpha.
    """
    return _binosplat.load_image(path)


def save_png(path: _Path, picture: ArrayLike, bits: Literal[8, 16] = 8) -> None:
    """Writes a PNG; it is there whole or not at all.

    Parameters
    ----------
    path
        Ends in .png.
    picture
        (height, width) or (height, width, 1, 3 or 4): float with white 1, uint8 or uint16.
    bits
        8 or 16.
    """
    if not os.fspath(path).lower().endswith(".png"):
        raise InputError(f"{os.fspath(path)}: save_png writes PNG, so the name must end in .png")
    if bits not in (8, 16):
        raise InputError(f"bits {bits}: expected 8 or 16")
    _binosplat.save_png(path, _picture(picture, "picture"), bits)


def quantised(picture: ArrayLike) -> _Floats:
    """The picture as 8 bits keep it: round(255 clip(v, 0, 1)) / 255."""
    return _binosplat.quantised(_picture(picture, "picture"))


def compare(a: ArrayLike, b: ArrayLike, ppd: float = 67, background: ArrayLike | None = None) -> Comparison:
    """What ``binosplat compare`` says of two pictures of one size.

    Values are clamped to 0 to 1 and not rounded (see quantised); grey counts as colour beside colour.

    Parameters
    ----------
    a, b
        (height, width) or (height, width, 1, 3 or 4): float with white 1, uint8 or uint16.
    ppd
        Pixels per degree that the viewer has, 1 to 1000, for FLIP.
    background : (3,) floats
        RGB before which pictures with alpha are compared. By default alpha counts where both have some that is
        not 1, and is before black where one has.
    """
    return Comparison(*_binosplat.compare(_picture(a, "a"), _picture(b, "b"), ppd, background))


class Exposures:
    """What a training made of each picture before it saw the photo.

    Attributes
    ----------
    source
        The file.
    """

    def __init__(self, path: _Path) -> None:
        self.source = os.fspath(path)
        self._exposures = _binosplat.Exposures(path)

    def __len__(self) -> int:
        return self._exposures.count

    def of(self, view: str) -> _Floats:
        """Three rows of four numbers, for exposed(); those that change nothing for a view without one."""
        columns = self._exposures.of(view)
        return np.column_stack([columns[:3], columns[3]])


def load_exposures(path: _Path) -> Exposures:
    """Reads the exposure.json of INRIA's training (train_test_exp): by the names of views, with or without a picture's
    ending. Raises InputError for what is none."""
    return Exposures(path)


def find_exposures(model: _Path) -> Path | None:
    """The exposure.json of a model's training, beside the model's path; None without."""
    return _binosplat.find_exposures(model)


def exposed(picture: ArrayLike, exposure: ArrayLike) -> _Floats:
    """A picture as a training made it before it was compared with the photo.

    Parameters
    ----------
    picture
        (height, width, 3): float with white 1, uint8 or uint16.
    exposure : (3, 4) floats
        As in exposure.json: a colour is a row before the first three columns, and the last column is added.

    Returns
    -------
    numpy.ndarray of float32
        Not clamped; quantised() and compare() clamp.
    """
    image, rows = _picture(picture, "picture"), np.asarray(exposure, np.float32)
    if image.shape[2:] != (3,):
        channels = image.shape[2] if image.ndim == 3 else 1
        raise InputError(f"picture: an exposure is of RGB, and this has {channels} channels")
    if rows.shape != (3, 4) or not np.isfinite(rows).all():
        raise InputError("exposure: expected three rows of four finite numbers")
    red, green, blue = (image[..., k, None] * rows[k, :3] for k in range(3))
    return red + green + blue + rows[:, 3]
