# The types of the module, for editors and type checkers. What each thing does, help() says.

import os
import types
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Path = str | os.PathLike[str]
_Three = Sequence[float] | NDArray[Any]
_Floats = NDArray[np.float32]
_Th = Literal["tau", "squared", "peripheral"]
_Order = Literal["depth", "distance"]
_Projection = Literal["affine", "tangent"]
_Tiles = Literal["aabb", "ellipse", "snug", "obb", "all"]
_View = Camera | Rig

class Error(Exception): ...
class InputError(Error, ValueError): ...
class OpenGLError(Error, RuntimeError): ...
class OutOfMemory(Error, MemoryError): ...

class Model:
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
    near: float
    means: NDArray[np.float32] | NDArray[np.float64]
    quats: _Floats
    scales: _Floats
    opacities: _Floats
    sh: _Floats
    def __init__(
        self, means: ArrayLike, quats: ArrayLike, scales: ArrayLike, opacities: ArrayLike, sh: ArrayLike, *,
        name: str = "arrays", axes: str = "RDF", antialiased: bool = False,
    ) -> None: ...

def load_model(
    path: _Path, *, lod: int | None = None, appearance: int | None = None, axes: str | None = None,
    antialiased: bool | None = None,
) -> Model: ...

class Camera:
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
    def __init__(
        self, width: int, height: int, fx: float, *, fy: float | None = None, cx: float | None = None,
        cy: float | None = None, position: _Three = ..., rotation: Sequence[_Three] | NDArray[Any] = ...,
        name: str = "",
    ) -> None: ...
    def resized(self, width: int, height: int) -> Camera: ...

class Cameras:
    source: str
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, number: int) -> Camera: ...
    @overload
    def __getitem__(self, name: str) -> Camera: ...
    def __iter__(self) -> Iterator[Camera]: ...

def load_cameras(path: _Path, model: _Path | None = None) -> Cameras: ...
def find_cameras(model: _Path) -> Path | None: ...
def find_photos(cameras: _Path) -> Path | None: ...
def find_photo(folder: _Path, view: Camera | str) -> Path | None: ...
def look_at(
    eye: _Three, at: _Three, width: int, height: int, *, up: _Three = ..., fov: float = ...,
) -> Camera: ...
def frame(model: Model, width: int, height: int, *, up: _Three = ..., fov: float = ...) -> Camera: ...

class Rig:
    eyes: tuple[Camera, Camera]
    def __init__(
        self, head: Camera, *, ipd: float = 0.063, units_per_metre: float = 1.0,
        convergence: float | None = None, cant: float = 0.0,
    ) -> None: ...
    @staticmethod
    def of_eyes(left: Camera, right: Camera) -> Rig: ...

class Picture:
    colour: _Floats
    transmittance: _Floats
    depth: _Floats
    report: dict[str, Any]

class PathPictures(Iterator[Picture | tuple[Picture, Picture]]):
    def __iter__(self) -> PathPictures: ...
    def __next__(self) -> Any: ...

class Renderer:
    device: str
    def __init__(
        self, model: Model, *, backend: Literal["auto", "device", "surfaceless", "osmesa"] = "auto",
        device: int | None = None, precision: Literal["full", "half"] = "full",
    ) -> None: ...
    @overload
    def draw(
        self, view: Camera, *, quality: float | None = None, tolerance: float | None = None,
        th: _Th | None = None, transmittance: Literal["one", "last"] = "one", order: _Order | None = None,
        projection: _Projection | None = None, tiles: _Tiles = "ellipse",
        decode: Literal["eyes", "cyclopean"] = "eyes", background: _Three = ..., near: float = 0.2,
        depth: Literal["mean", "median"] = "mean", follow: bool = False,
    ) -> Picture: ...
    @overload
    def draw(
        self, view: Rig, *, quality: float | None = None, tolerance: float | None = None,
        th: _Th | None = None, transmittance: Literal["one", "last"] = "one", order: _Order | None = None,
        projection: _Projection | None = None, tiles: _Tiles = "ellipse",
        decode: Literal["eyes", "cyclopean"] = "eyes", background: _Three = ..., near: float = 0.2,
        depth: Literal["mean", "median"] = "mean", follow: bool = False,
    ) -> tuple[Picture, Picture]: ...
    def draw_all(
        self, views: Iterable[_View], *, quality: float | None = None, tolerance: float | None = None,
        th: _Th | None = None, transmittance: Literal["one", "last"] = "one", order: _Order | None = None,
        projection: _Projection | None = None, tiles: _Tiles = "ellipse",
        decode: Literal["eyes", "cyclopean"] = "eyes", background: _Three = ..., near: float = 0.2,
        depth: Literal["mean", "median"] = "mean", follow: bool = False,
    ) -> PathPictures: ...
    def close(self) -> None: ...
    def __enter__(self) -> Renderer: ...
    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None,
        trace: types.TracebackType | None,
    ) -> None: ...

class Comparison:
    psnr: float
    ssim: float
    flip: float
    largest_error: float
    at: tuple[int, int, int]

def load_image(path: _Path) -> _Floats: ...
def save_png(path: _Path, picture: ArrayLike, bits: Literal[8, 16] = 8) -> None: ...
def quantised(picture: ArrayLike) -> _Floats: ...
class Exposures:
    source: str
    def __len__(self) -> int: ...
    def of(self, view: str) -> NDArray[np.float32]: ...

def load_exposures(path: _Path) -> Exposures: ...
def find_exposures(model: _Path) -> Path | None: ...
def exposed(picture: ArrayLike, exposure: ArrayLike) -> NDArray[np.float32]: ...
def compare(a: ArrayLike, b: ArrayLike, ppd: float = ..., background: _Three | None = None) -> Comparison: ...
