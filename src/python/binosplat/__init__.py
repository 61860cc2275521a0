"""Draws 3D Gaussian Splatting models for one eye or both with OpenGL compute shaders.

A picture in four lines:

>>> import binosplat
>>> model = binosplat.load_model("garden.ply")
>>> picture = binosplat.Renderer(model).draw(binosplat.frame(model, 1280, 720), near_plane=model.near_plane)
>>> binosplat.save_png("garden.png", picture.colour)

Unusable files, arrays, pictures, settings, cameras and rigs raise InputError, a ValueError. The other two kinds of
Error are OpenGLError and OutOfMemory. Arguments of a wrong type raise TypeError.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Literal, TypedDict, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from typing_extensions import Unpack

__all__ = [
    "Calibration", "Camera", "Cameras", "Comparison", "Error", "Exposures", "InputError", "Model", "OpenGLError",
    "OutOfMemory", "Picture", "Renderer", "Report", "Rig", "compare", "exposed", "find_cameras", "find_exposures",
    "find_photo", "find_photos", "frame", "load_cameras", "load_exposures", "load_image", "load_model", "look_at",
    "quantised", "save_png",
]


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


class Error(Exception):
    """Base class of all errors of binosplat."""


class InputError(Error, ValueError):
    """An unusable file, array or setting."""


class OpenGLError(Error, RuntimeError):
    """No usable OpenGL, or the GPU was reset."""


class OutOfMemory(Error, MemoryError):
    """Not enough memory on the GPU, or for a picture or an array."""


_binosplat: Any = import_module("._binosplat", __name__)  # the private part in C++; raises the errors above
__version__: str = _binosplat.__version__

_Path = str | os.PathLike[str]
_Floats = NDArray[np.float32]
_Order = Literal["depth", "distance"]
_Projection = Literal["affine", "tangent"]
_Drawn = TypeVar("_Drawn", covariant=True)


def _found(path: str | None) -> Path | None:
    return None if path is None else Path(path)


class _View(Generic[_Drawn]):
    """A Camera or a Rig. For type checkers, its parameter is the type that draw() returns."""


def _expect(value: Any, kind: Any, name: str) -> None:
    if not isinstance(value, kind):
        raise TypeError(f"expected {name}, not {type(value).__name__}")


def _refuse_pickle(self: object) -> Any:
    raise TypeError(f"cannot pickle or copy a {type(self).__name__}: load or make it again, in each process")


# In pickle's protocols 0 and 1, pybind11 would end the process.
_binosplat.Model.__reduce__ = _binosplat.Calibration.__reduce__ = _binosplat.Exposures.__reduce__ = _refuse_pickle


def _refuse_masked(given: Any, name: str) -> None:
    if np.ma.is_masked(given):
        raise InputError(f"{name}: masked arrays are not supported: leave the masked rows out, or fill them "
                         "(filled())")


def _dense(array: NDArray[Any], kind: type) -> NDArray[Any]:
    """The array in contiguous memory. Raises OutOfMemory before it allocates more than the machine has."""
    if array.size * (np.dtype(kind).itemsize + 4) > _binosplat.memory_bytes():
        raise OutOfMemory(f"an array of shape {array.shape} takes more memory than there is")
    try:
        with np.errstate(over="ignore"):
            return np.ascontiguousarray(array, kind)
    except MemoryError as error:
        raise OutOfMemory(str(error)) from None


def _array(given: Any, name: str) -> NDArray[Any]:
    """Converts to an array of floats, through ``__array__`` or DLPack. Detaches a tensor with gradients."""
    _refuse_masked(given, name)
    values = given.detach() if hasattr(given, "detach") else given
    lends = hasattr(values, "__dlpack__") and not hasattr(values, "__array__")
    array = np.from_dlpack(values) if lends else np.asarray(values)
    if array.dtype.kind != "f":
        raise TypeError(f"{name}: expected an array of floats, not of {array.dtype}")
    return array


def _rows(given: Any, name: str, shape: tuple[int | None, ...], kind: type = np.float32) -> NDArray[Any]:
    """Returns the values in contiguous memory. Checks their shape; None in ``shape`` allows any size."""
    array = _array(given, name)
    if len(shape) != array.ndim or any(size not in (None, n) for size, n in zip(shape, array.shape)):
        sizes = ", ".join("N" if size is None else str(size) for size in shape)
        raise InputError(f"{name}: an array of shape {array.shape}: expected ({sizes}{',' * (len(shape) == 1)})")
    return _dense(array, kind)


def _rgb(given: Any) -> tuple[float, ...] | None:
    """The numbers of a background."""
    if given is None:
        return None
    array = np.asarray(given)
    if array.shape != (3,) or array.dtype.kind not in "fiu":
        raise TypeError(f"background: expected three numbers from 0 to 1, for red, green and blue, not {given!r}")
    return tuple(map(float, array))


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Model:
    """A model in memory.

    Read one with load_model(), or create one from arrays: NumPy's, torch's on the CPU, or any object with
    ``__array__`` or ``__dlpack__``. Names and order of the arguments are those of gsplat's ``rasterization``.

    Parameters
    ----------
    means : (N, 3) floats
        Centres, world units.
    quats : (N, 4) floats
        Quaternions w, x, y, z. Their lengths are above 0.
    scales : (N, 3) floats
        Standard deviations, world units: exp() of the values that trainers store.
    opacities : (N,) floats
        0 to 1: the sigmoid of the values that trainers store.
    sh : (N, K, 3) floats
        Spherical harmonics, K = 1, 4, 9 or 16 coefficients; the colour at degree 0 is 0.5 + 0.2820948 sh[:, 0].
    name
        The model's name in messages.
    axes
        The directions of the model's x, y and z: R or L (right, left), U or D, F or B. The default is COLMAP's.
    antialiased
        Whether the model was trained with gsplat's ``rasterize_mode="antialiased"`` or Mip-Splatting.

    Raises
    ------
    InputError
        For arrays of other shapes, and for an invalid row, which the text names.
    TypeError
        For arrays that are not of floats.

    Attributes
    ----------
    format
        The file's format, in words.
    count
        Number of Gaussians; for Scaffold-GS, of anchors.
    degree
        Degree of the spherical harmonics, 0 to 3.
    left_out
        Number of the file's Gaussians that were dropped, because they have values that are not finite or out of
        range, scales above 1e13, or no rotation.
    antialiased_by
        The source of ``antialiased``: a comment in the model's file, or a file of the training run; empty: none.
    order, projection
        The sort order and projection of the model's training; draw() also takes others.
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
    def near_plane(self) -> float:
        """A near plane, in world units, for cameras of frame(): 0.2, or less for tiny models."""
        return self._model.near_plane

    @property
    def means(self) -> NDArray[np.float32] | NDArray[np.float64]:
        """A copy in the form of the argument, as are the other four arrays. float64 if the model is far from zero."""
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

    def filtered(self, mask: ArrayLike) -> Model:
        """A model of the Gaussians for which the mask, (N,) bools, is true, in the same order."""
        _refuse_masked(mask, "mask")
        kept = np.asarray(mask)
        if kept.dtype != bool:
            raise TypeError(f"mask: expected an array of bool, not of {kept.dtype}")
        if kept.shape != (self.count,):
            raise InputError(f"mask: an array of shape {kept.shape}: expected ({self.count},)")
        if not kept.any():
            raise InputError("mask: it keeps no Gaussian")
        model = Model.__new__(Model)
        model._take(self._model.filtered(_dense(kept, bool)))
        return model

    def save(self, path: _Path) -> None:
        """Writes a .ply, .spz or .sog, as ``binosplat convert`` does. Warnings name what the format cannot store."""
        self._model.save(path)

    def _copy(self, name: str) -> NDArray[Any]:
        try:
            return self._model.column(name)
        except MemoryError as error:
            raise OutOfMemory(str(error)) from None

    def __repr__(self) -> str:
        return f"<binosplat.Model {self.name}: {self.count} Gaussians, degree {self.degree}>"


def load_model(path: _Path, *, lod: int | None = None, appearance: int | None = None, axes: str | None = None,
               antialiased: bool | None = None, format: str = "") -> Model:
    """Reads a model of any format that ``binosplat render`` supports.

    Parameters
    ----------
    path
        A file, or a folder that holds a model. The content determines the format.
    lod
        Level of detail of a streamed SOG; 0 is the finest.
    appearance
        Index of an appearance of Scaffold-GS.
    axes
        Directions of the model's axes, instead of the file's.
    antialiased
        Whether the model was trained with anti-aliasing, instead of the file's value.
    format
        Name of a format, such as ``"spz"`` or ``".splat"``, as which the file is read. Empty: the content decides.

    Raises
    ------
    InputError
        If the path holds no model; the text names the apparent format.
    """
    model = Model.__new__(Model)
    model._take(_binosplat.load_model(path, lod, appearance, axes, antialiased, format))
    return model


class Calibration:
    """A file that ``binosplat calibrate`` wrote: a model's tolerances, and its table of transmittance by depth.

    ``renderer.draw(camera, calibration=calibration)`` draws by the rule of its first entry, as the programs do.

    Parameters
    ----------
    path
    model
        The calibrated model.

    Raises
    ------
    InputError
        If the file is no calibration, or calibrates another model.
    """

    def __init__(self, path: _Path, model: Model) -> None:
        _expect(model, Model, "a Model")
        self._threshold = _binosplat.Calibration(path, model._model)
        self._model = model._model


@dataclass(frozen=True)
class Report:
    """Times, counts and errors of a frame.

    Attributes
    ----------
    stages
        GPU time of each stage, ms: decode, project, bin, sort, blend, probe.
    gpu_ms
        Sum of the stages, ms.
    submit_ms
        CPU time of submitting the frame to the driver, ms.
    gpu_bytes
        Bytes of all buffers, including the model's.
    visible
        Number of drawn Gaussians, summed over the order groups. Parallel eyes are one order group.
    pairs
        Number of Gaussian-tile pairs in all views.
    threshold
        The rule that drew the frame.
    tolerance
        The tolerance of the frame; 0 is exact.
    quality
        With a requested quality: the reported dB, estimated from parts of this and earlier frames; infinite for an
        exact frame. None without a requested quality.
    exact_because
        With a requested quality: why the frame was drawn exactly: 'unmeasured' (a first frame, a camera cut, very fast
        motion), 'no gain' (a tolerance would save less than 5 %) or 'small' (too few tiles). None if it was not.
    redraws
        Number of repeated drawings because a buffer was too small.
    used_last
        Whether the frame used the transmittance that an earlier frame measured.
    """

    stages: dict[str, float]
    gpu_ms: float
    submit_ms: float
    gpu_bytes: int
    visible: int
    pairs: int
    threshold: Literal["exact", "adagscale", "squared"]
    tolerance: float
    quality: float | None
    exact_because: str | None
    redraws: int
    used_last: bool

    @property
    def is_exact(self) -> bool:
        """Whether no pair was left out: of exact settings, and of a view that a calibration does not cover."""
        return self.tolerance == 0


@dataclass(frozen=True, eq=False, repr=False)
class Picture:
    """The result of draw() for a view; rows from the top.

    Attributes
    ----------
    colour
        (height, width, 3): display-referred RGB over the background, white 1. Values above 1 are not clamped.
    transmittance
        (height, width): the share of light that passes all splats, 1 - alpha.
    depth
        (height, width): depth along the view's axis, world units, as draw(depth=) defines it; inf where alpha is at
        most 0.5.
    report
        The report of the frame.
    """

    colour: _Floats
    transmittance: _Floats
    depth: _Floats
    report: Report


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Camera(_View[Picture]):
    """A pinhole camera in the world: x right, y down, z forward, as in COLMAP.

    Parameters
    ----------
    width, height
        Size of the picture, px.
    fx, fy
        Focal lengths, px; fy is fx by default.
    cx, cy
        Principal point, px from the picture's left and upper edge; the middle by default.
    position : (3,) floats
        World units.
    rotation : (3, 3) floats
        Camera to world: its columns are the camera's axes x right, y down, z forward in the world.
    name
        The camera's name.

    Attributes
    ----------
    time
        Time in a camera path, s; None for other cameras.
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
        """The camera at another size in px, with the same vertical field of view, as ``--size``."""
        return _binosplat.resized(self, width, height)

    def __repr__(self) -> str:
        x, y, z = self.position
        return f"<binosplat.Camera {self.name}: {self.width} x {self.height} px at {x:.4g}, {y:.4g}, {z:.4g}>"


def look_at(eye: ArrayLike, at: ArrayLike, width: int, height: int, *, up: ArrayLike = (0, -1, 0),
            fov: float = 60) -> Camera:
    """A camera at ``eye`` that looks at ``at``.

    Parameters
    ----------
    eye, at : (3,) floats
        World units.
    width, height
        px.
    up : (3,) floats
        The upward direction in the picture.
    fov
        Vertical field of view, degrees.
    """
    return _binosplat.look_at(eye, at, width, height, up, fov)


def frame(model: Model, width: int, height: int, *, up: ArrayLike | None = None, fov: float = 60) -> Camera:
    """The camera that ``binosplat render`` makes for a model without cameras. Draw with
    ``near_plane=model.near_plane``.

    A model that ends is whole in the picture. A scene, which goes on in all directions, is seen from within. ``up``
    is by default the model's own: that of its format (y down), or of a floor that it stands on.
    """
    _expect(model, Model, "a Model")
    return _binosplat.frame(model._model, width, height, up, fov)


class Cameras:
    """The cameras of a file, in its order, indexed by number or name.

    Attributes
    ----------
    source
        The file or folder.
    test, training : Cameras
        The test views, as ``binosplat bench`` and ``calibrate`` take them: those that INRIA's cameras.json lists
        first, else every eighth by name. And all others.
    """

    def __init__(self, source: str, cameras: list[Camera]) -> None:
        self.source = source
        self._cameras = cameras

    @property
    def test(self) -> Cameras:
        return self._split(training=False)

    @property
    def training(self) -> Cameras:
        return self._split(training=True)

    def _split(self, training: bool) -> Cameras:
        names = set(_binosplat.test_split(self.source, self._cameras, training))
        return Cameras(self.source, [camera for camera in self._cameras if camera.name in names])

    def __len__(self) -> int:
        return len(self._cameras)

    def __getitem__(self, which: int | str) -> Camera:
        """The camera with an index, or the first with a name. Raises InputError for an unknown name."""
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
        A model that nerfstudio trained with these cameras. They are moved into the model's world, which
        dataparser_transforms.json in the model's folder or above defines.
    """
    if path is None:
        raise InputError("load_cameras: the path is None; find_cameras() returns None if it finds no cameras")
    return Cameras(os.fsdecode(path), _binosplat.load_cameras(path, model))


def find_cameras(model: _Path) -> Path | None:
    """Finds the file or folder with a model's cameras near the model's path; None if there is none."""
    return _found(_binosplat.find_cameras(model))


def find_photos(cameras: _Path) -> Path | None:
    """Finds the folder of these cameras' photos near the cameras' path; None if there is none."""
    return _found(_binosplat.find_photos(cameras))


def find_photo(folder: _Path, view: Camera | str) -> Path | None:
    """Finds a view's photo in a folder, by camera or name (with or without an ending); None if there is none."""
    return _found(_binosplat.find_photo(folder, view))


class Rig(_View[tuple[Picture, Picture]]):
    """Both eyes of a head camera.

    Parameters
    ----------
    head
        The camera between the eyes.
    ipd
        Distance between the eyes, metres.
    units_per_metre
        World units per metre.
    convergence
        Distance of zero disparity, metres; infinite by default.
    cant
        Outward turn of each eye, degrees.
    """

    def __init__(self, head: Camera, *, ipd: float = 0.063, units_per_metre: float = 1.0,
                 convergence: float | None = None, cant: float = 0.0) -> None:
        _expect(head, Camera, "a Camera")
        self._parts: tuple[Any, ...] = (head, None, ipd, units_per_metre, convergence, cant)
        self.eyes  # raises InputError for invalid values

    @staticmethod
    def of_eyes(left: Camera, right: Camera) -> Rig:
        """The rig of two given cameras."""
        rig = Rig(left)
        _expect(right, Camera, "a Camera")
        rig._parts = (left, (left, right), *rig._parts[2:])
        return rig

    @property
    def eyes(self) -> tuple[Camera, Camera]:
        """The cameras of the left and of the right eye."""
        return _binosplat.eyes(self)


class _Settings(TypedDict, total=False):
    """The keywords of Renderer.draw(), which documents them."""

    quality: float | None
    tolerance: float | None
    threshold: Literal["exact", "adagscale", "squared"] | None
    transmittance: Literal["one", "last", "depth"]
    order: _Order | None
    projection: _Projection | None
    tiles: Literal["aabb", "ellipse", "snug", "obb", "all"]
    background: ArrayLike
    near_plane: float | None
    depth: Literal["mean", "median"]
    follow: bool
    calibration: Calibration | None


_Instance = tuple[Model, ArrayLike] | tuple[Model, ArrayLike, float]


class Renderer:
    """One or more models on a GPU, or in Mesa's software renderer.

    Parameters
    ----------
    model
        A Model, or a list of instances as place() takes it. The first model sets order and projection.
    backend
        'auto' (a GPU, else Mesa), 'device', 'surfaceless' or 'osmesa'.
    device
        Number of the EGL device.
    precision
        'full', or 'half', which halves the memory at a PSNR of 60 dB or more.

    Attributes
    ----------
    device
        Renderer, backend and OpenGL version, in words.
    """

    def __init__(self, model: Model | Sequence[_Instance], *,
                 backend: Literal["auto", "device", "surfaceless", "osmesa"] = "auto",
                 device: int | None = None, precision: Literal["full", "half"] = "full") -> None:
        instances = list(model) if isinstance(model, (list, tuple)) else None
        first = model if instances is None else instances[0][0] if instances else None
        _expect(first, Model, "a Model, or a list of (Model, matrix)")
        self._model = first._model
        self._renderer = _binosplat.Renderer(self._model, backend, device, precision)
        self.device: str = self._renderer.device
        if instances is not None:
            self.place(instances)

    def place(self, instances: Iterable[_Instance]) -> None:
        """Sets the models that later views show, and their places: in draw_all(), views that the iterator yields later.
        Each model is uploaded once.

        Parameters
        ----------
        instances
            (model, matrix) or (model, matrix, opacity) for each. The (4, 4) matrix transforms the model into the
            cameras' world by a rotation, a uniform scale and a translation: ``world = matrix @ (x, y, z, 1)``.
            The opacity, 0 to 1, multiplies each Gaussian's opacity. A model may occur several times.
        """
        parts = []
        for model, matrix, *opacity in instances:
            _expect(model, Model, "a Model")
            numbers = np.asarray(matrix, dtype=np.float64)
            if numbers.shape != (4, 4):
                raise InputError(f"instances[{len(parts)}]: expected a matrix of (4, 4), not {numbers.shape}")
            parts.append((model._model, numbers.ravel().tolist(), *(opacity or (1.0,))))
        self._renderer.place(parts)

    def draw(self, view: _View[_Drawn], **settings: Unpack[_Settings]) -> _Drawn:
        """Draws a view. Without settings the picture is exact.

        Any thread may call it; a Renderer draws one picture at a time. Ctrl-C ends the wait.

        Parameters
        ----------
        view : Camera or Rig
        settings
            The following keywords.
        quality
            Requested PSNR of the picture against the exact one, dB.
        tolerance
            Instead of quality: the loss that the threshold accepts, in the rule's unit.
        threshold
            The threshold rule: 'adagscale', 'squared' or 'exact'. By default that of the calibration's first entry;
            else with quality the faster of both, by each frame's counts; with tolerance 'adagscale'. 'adagscale'
            without tolerance and calibration finds its K, for quality or 40 dB, in up to 16 training views, before
            the first picture.
        transmittance
            The upper bound of transmittance: 'one'; 'last', measured by the previous frame, which needs follow; or
            'depth', by AdaGScale's table: its default if K is found or calibrated, else 'one'.
        order
            Sorts Gaussians by 'depth' or 'distance'; by default as the model was trained.
        projection
            'affine' or 'tangent'; by default as the model was trained.
        tiles
            The tile test: 'ellipse', 'snug' or 'all', which are exact, or 'aabb' or 'obb'.
        background : (3,) floats
            RGB behind the scene, 0 to 1.
        near_plane
            Near plane, world units; by default the calibration's, that of the model's training, or 0.2.
        depth
            'mean', weighted by visibility, or 'median', the depth at which T falls below a half.
        follow
            Draws the next frame of a path, which uses earlier frames' measurements. Otherwise the picture does not
            depend on earlier pictures.
        calibration
            The model's calibration. Gives the table by depth, and the tolerance if neither quality nor tolerance is
            given. Views far from the calibrated cameras are drawn exactly.

        Returns
        -------
        Picture; for a Rig a tuple of two, left and right
        """
        _expect(view, _View, "a Camera or a Rig")
        return _pictures(*self._renderer.draw(view, self._settings("draw", settings)))

    def draw_all(self, views: Iterable[_View[_Drawn]], **settings: Unpack[_Settings]) -> Iterator[_Drawn]:
        """Draws views in sequence. The GPU draws the next view while Python uses the last picture.

        Parameters
        ----------
        views : iterable of Camera or Rig
            A view is taken, and its errors are raised, only when the GPU is to draw it.
        settings
            As for draw(), the same for all views. With follow, the views are the frames of a path.

        Returns
        -------
        iterator of the results of draw()
        """
        return _pictures_of_path(_binosplat.Path(self._renderer, self._settings("draw_all", settings)), iter(views))

    def measure(self, views: Camera | Rig | Iterable[Camera | Rig], **settings: Unpack[_Settings]) -> NDArray[Any]:
        """Measures each Gaussian of the model in each view. A Rig counts as two views, left and right.

        Settings are as for draw(), without quality and follow. A threshold decides with which tiles a Gaussian is
        paired. All pixels of these tiles count, although 'squared' skips some of them in pictures.

        Returns
        -------
        numpy.ndarray, (views, N), with these fields; all are 0 for a Gaussian that is in no tile's list
            - ``radius``: px, three standard deviations along the splat's longer axis. (INRIA's renderer rounds it up.)
              With projection 'tangent' that of the splat's middle; inf for very wide splats.
            - ``tiles``: the number of tiles of 16 x 16 px with which the Gaussian is paired
            - ``transmittance``: max(T), the largest transmittance in front of the Gaussian in a pixel that blends it
            - ``contribution``: alpha T, summed over the pixels that blend it, px; above 0 if the view shows it
        """
        several = [views] if isinstance(views, _View) else list(views)
        for view in several:
            _expect(view, _View, "a Camera or a Rig")
        return self._renderer.measure(several, self._settings("measure", settings))

    def debug_view(self, view: Camera | Rig, show: str, **settings: Unpack[_Settings]) -> Any:
        """The numbers that ``binosplat render --show`` draws in colours, such as 'pairs' or 'transmittance'.

        Settings are as for draw(). Returns an array of float32, (height, width), with NaN in pixels without a number;
        for a Rig a tuple of two, left and right.
        """
        _expect(view, _View, "a Camera or a Rig")
        maps = self._renderer.debug_view(view, show, self._settings("debug_view", settings))
        return tuple(maps) if len(maps) == 2 else maps[0]

    def _settings(self, caller: str, given: _Settings) -> Any:
        keywords: dict[str, Any] = dict(given)
        keywords["background"] = _rgb(keywords.get("background"))
        for unknown in keywords.keys() - _Settings.__annotations__.keys():
            raise TypeError(f"{caller}() got an unexpected keyword argument '{unknown}'")
        calibration = keywords.get("calibration")
        _expect(calibration, (Calibration, type(None)), "a Calibration")
        if calibration:
            if calibration._model is not self._model:
                calibration._threshold.check_model(self._model)
            keywords["calibration"] = calibration._threshold
        return self._renderer.settings(keywords)

    def close(self) -> None:
        """Frees the GPU's memory, as do `with` and the deletion of the last reference."""
        self._renderer.close()

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


def _pictures(arrays: list[tuple[_Floats, _Floats, _Floats]], report: dict[str, Any]) -> Any:
    """Returns the picture of a camera, or a tuple of both eyes' pictures."""
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
    """The difference of two pictures.

    Attributes
    ----------
    psnr
        dB; inf for equal pictures.
    ssim
        1 for equal pictures, otherwise less.
    flip
        Mean of FLIP's map, 0 to 1.
    largest_error
        The largest absolute error of a channel, with white 1.
    at
        Row, column and channel of the largest error.
    """

    psnr: float
    ssim: float
    flip: float
    largest_error: float
    at: tuple[int, int, int]


_whites = {"<f4": 1, "<f8": 1, "|u1": 255, "<u2": 65535}  # by NumPy's type names


def _picture(given: Any, name: str) -> _Floats:
    """Converts an array to a picture with white 1. Refuses floats that seem to have white 255: pictures with a mean
    above 2, and pictures of integers with a value above 1."""
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
                             ": divide them by their white, or pass uint8 or uint16; if the picture is that bright, "
                             "clip it to 0 to 1 first")
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
    """Writes a PNG, completely or not at all.

    Parameters
    ----------
    path
        Must end in .png.
    picture
        (height, width) or (height, width, 1, 3 or 4): float with white 1, uint8 or uint16.
    bits
        8 or 16.
    """
    if not os.fsdecode(path).lower().endswith(".png"):
        raise InputError(f"{os.fsdecode(path)}: save_png writes PNG, so the name must end in .png")
    if bits not in (8, 16):
        raise InputError(f"bits {bits}: expected 8 or 16")
    _binosplat.save_png(path, _picture(picture, "picture"), bits)


def quantised(picture: ArrayLike) -> _Floats:
    """The picture rounded to 8 bits: round(255 clip(v, 0, 1)) / 255."""
    return _binosplat.quantised(_picture(picture, "picture"))


def compare(a: ArrayLike, b: ArrayLike, ppd: float = 67, background: ArrayLike | None = None) -> Comparison:
    """Compares two pictures of one size, as ``binosplat compare``.

    Values are clamped to 0 to 1 but not rounded (see quantised). If only one picture is grey, its channel is repeated.

    Parameters
    ----------
    a, b
        (height, width) or (height, width, 1, 3 or 4): float with white 1, uint8 or uint16.
    ppd
        The viewer's pixels per degree, 1 to 1000, for FLIP.
    background : (3,) floats
        RGB behind pictures with alpha. By default alpha counts as a channel if both pictures have it, unless it is 1
        everywhere. A picture with alpha is composited over black if the other has none.

    Raises
    ------
    InputError
        For pictures of different sizes, with a NaN or an infinity, or smaller than the 11 x 11 px of SSIM's window.
    """
    pictures = {"a": _picture(a, "a"), "b": _picture(b, "b")}
    for name, picture in pictures.items():
        if not np.isfinite(picture).all():
            row, column = np.argwhere(~np.isfinite(picture))[0, :2]
            raise InputError(f"{name}: row {row}, column {column} has a NaN or an infinity: expected finite numbers")
    if min(pictures["a"].shape[:2]) < 11:
        raise InputError(f"pictures of {pictures['a'].shape[1]} x {pictures['a'].shape[0]} px: SSIM needs 11 x 11 or "
                         "more")
    return Comparison(*_binosplat.compare(*pictures.values(), ppd, _rgb(background)))


class Exposures:
    """The exposures that a training applied to its pictures before it compared them with photos.

    Attributes
    ----------
    source
        The file.
    """

    def __init__(self, path: _Path) -> None:
        self.source = os.fsdecode(path)
        self._exposures = _binosplat.Exposures(path)

    def __len__(self) -> int:
        return self._exposures.count

    def of(self, view: str) -> _Floats:
        """Three rows of four numbers, for exposed(); the identity for a view without an exposure."""
        columns = self._exposures.of(view)
        return np.column_stack([columns[:3], columns[3]])


def load_exposures(path: _Path) -> Exposures:
    """Reads the exposure.json of INRIA's training (train_test_exp), indexed by names of views, with or without a
    picture's ending. Raises InputError for another kind of file."""
    return Exposures(path)


def find_exposures(model: _Path) -> Path | None:
    """Finds the exposure.json of a model's training near the model's path; None if there is none."""
    return _found(_binosplat.find_exposures(model))


def exposed(picture: ArrayLike, exposure: ArrayLike) -> _Floats:
    """Applies an exposure to a picture, as training does before it compares it with a photo.

    Parameters
    ----------
    picture
        (height, width, 3): float with white 1, uint8 or uint16.
    exposure : (3, 4) floats
        As in exposure.json: the result is red, green and blue times rows 0, 1 and 2, plus the last column.

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
