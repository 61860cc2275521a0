#pragma once
// What help() says, in the style of NumPy's documentation; pybind11 puts the signature before it.

namespace binosplat::python::help {

constexpr const char* model = R"(A model in memory.

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
name : str
    What messages call it.
axes : str
    Where its x, y and z point: R or L, U or D, F or B. The default is that of COLMAP's world.
antialiased : bool
    Whether it was trained with gsplat's ``rasterize_mode="antialiased"`` or Mip-Splatting.

Raises
------
InputError
    For other shapes, and for a row that is no Gaussian, which it names.
TypeError
    For arrays of other numbers than floats.
)";

constexpr const char* load_model = R"(Reads a model of any format that ``binosplat render`` takes.

Parameters
----------
path : str or os.PathLike
    A file or its folder. What it is, its content decides.
lod : int, optional
    Level of detail of a streamed SOG, 0 the finest.
appearance : int, optional
    Of Scaffold-GS.
axes : str, optional
    Where the model's axes point, if the file is wrong about it.
antialiased : bool, optional
    Whether it was trained with anti-aliasing, if the file is wrong about it.

Returns
-------
Model

Raises
------
InputError
    For what is no model; the text says what it looks like instead.
)";

constexpr const char* camera =
    R"(A pinhole camera of the world: x right, y down, z forward, as COLMAP leaves it.

Parameters
----------
width, height : int
    Of the picture, px.
fx, fy : float
    Focal lengths, px; fy is fx by default.
cx, cy : float
    Principal point, px from the picture's left and upper edge; the middle by default.
position : (3,) floats
    World units.
rotation : (3, 3) floats
    Camera to world: its columns are the camera's axes x right, y down, z forward in the world.
name : str
    What messages call it.

Raises
------
InputError
    For numbers that make no camera.
)";

constexpr const char* resized =
    R"(The camera at another size in px, as ``--size`` does: the vertical field of view is kept.

Returns
-------
Camera
)";

constexpr const char* look_at = R"(A camera at a point that looks at another.

Parameters
----------
eye, at : (3,) floats
    World units.
width, height : int
    px.
up : (3,) floats
    What is up in the picture.
fov : float
    Vertical field of view, degrees.

Returns
-------
Camera

Raises
------
InputError
    If they make no camera.
)";

constexpr const char* frame =
    R"(A camera that shows all of a model from outside; draw with ``near=model.near``.

Parameters
----------
model : Model
width, height : int
    px.
up : (3,) floats
    What is up in the picture.
fov : float
    Vertical field of view, degrees.

Returns
-------
Camera

Raises
------
InputError
    If they make no camera.
)";

constexpr const char* load_cameras =
    R"(Reads cameras.json, transforms.json, nerfstudio's camera_path.json, a COLMAP
reconstruction, or the camera in a SHARP model's ply.

Parameters
----------
path : str or os.PathLike
    The file or its folder.
model : str or os.PathLike, optional
    A model that nerfstudio trained with them: they are moved into the world of its training, which
    dataparser_transforms.json beside it tells.

Returns
-------
Cameras

Raises
------
InputError
    For what lists no cameras.
)";

constexpr const char* rig = R"(Both eyes of a head camera.

Parameters
----------
head : Camera
    In the middle between the eyes.
ipd : float
    Distance of the eyes, metres.
units_per_metre : float
    World units that make a metre.
convergence : float, optional
    Distance without disparity, metres; infinite by default.
cant : float
    Degrees by which each eye is turned outwards.

Raises
------
InputError
    For values that make no rig.
)";

constexpr const char* renderer = R"(A model on a GPU, or in Mesa's software renderer.

Parameters
----------
model : Model
backend : str
    'auto' (a GPU, else Mesa), 'device', 'surfaceless' or 'osmesa'.
device : int, optional
    Number of the EGL device.
precision : str
    'full', or 'half' for half the memory at 60 dB and more.

Raises
------
OpenGLError, OutOfMemory, InputError
)";

constexpr const char* draw = R"(Draws a view. Without settings the picture is exact.

May be called from any thread; pictures of one Renderer are drawn one after the other. Ctrl-C ends the wait.

Parameters
----------
view : Camera or Rig
quality : float, optional
    dB of PSNR that the picture should have against the exact one.
tolerance : float, optional
    In place of quality: what leaving a Gaussian out of a tile may cost, in the unit of th.
th : str, optional
    The rule that leaves Gaussians out: 'squared' (where quality or tolerance is given), 'peripheral', or
    'tau', which is exact.
transmittance : str
    The light that a Gaussian is taken to get: 'one', or 'last', which the frame before measured; that needs
    follow.
order : str, optional
    What Gaussians are sorted by, 'depth' or 'distance'; as the model was trained by default.
projection : str, optional
    'affine' or 'tangent'; as the model was trained by default.
tiles : str
    Which tiles get a Gaussian: 'ellipse', 'snug' or 'all', which are exact, 'aabb' or 'obb'.
decode : str
    Of Scaffold-GS: 'eyes' or, with a Rig, 'cyclopean'.
background : (3,) floats
    RGB behind the scene, 0 to 1.
near : float
    Nothing nearer is drawn, world units.
depth : str
    'mean' of what is seen, or 'median', by which half of it is.
follow : bool
    This is the next frame of a path, and uses what the one before measured. Else the picture depends on
    nothing drawn before.

Returns
-------
Picture, or of a Rig a tuple of two, left and right

Raises
------
InputError
    For settings that contradict each other.
OutOfMemory
)";

constexpr const char* draw_all =
    R"(Draws one view after another, each while Python has the picture of the one before.

Parameters
----------
views : iterable of Camera or Rig
    Each is taken when its turn comes.
quality, tolerance, th, transmittance, order, projection, tiles, decode, background, near, depth, follow
    As of draw(), and the same for all; with follow they are the frames of a path.

Returns
-------
iterator of what draw() returns

Raises
------
InputError, OutOfMemory
    As draw(), at the view concerned.
)";

constexpr const char* load_image = R"(Reads a PNG, JPEG or OpenEXR.

Returns
-------
numpy.ndarray of float32
    Display-referred, white 1: (height, width) of grey, (height, width, 3) of RGB, (height, width, 4) with
    straight alpha.

Raises
------
InputError
)";

constexpr const char* save_png = R"(Writes a PNG; it is there whole or not at all.

Parameters
----------
path : str or os.PathLike
    Ends in .png.
picture : array
    (height, width) or (height, width, 1, 3 or 4): float with white 1, uint8 or uint16.
bits : int
    8 or 16.

Raises
------
InputError
    For other names, shapes and bits, and for floats that count to 255.
)";

constexpr const char* quantised = R"(The picture as 8 bits keep it: round(255 clip(v, 0, 1)) / 255.

Returns
-------
numpy.ndarray of float32
)";

constexpr const char* load_exposures = R"(Reads the exposure.json of INRIA's training (train_test_exp).

Returns
-------
Exposures
    By the names of views, with or without a picture's ending.

Raises
------
InputError
)";

constexpr const char* exposed = R"(A picture as a training made it before it was compared with the photo.

Parameters
----------
picture : array
    (height, width, 3): float with white 1, uint8 or uint16.
exposure : (3, 4) floats
    As in exposure.json: a colour is a row before the first three columns, and the last column is added.

Returns
-------
numpy.ndarray of float32
    Not clamped; quantised() and compare() clamp.

Raises
------
InputError
    For pictures of other shapes, and for floats that count to 255.
)";

constexpr const char* compare = R"(What ``binosplat compare`` says of two pictures of one size.

Values are clamped to 0 to 1 and not rounded (see quantised); grey counts as colour beside colour.

Parameters
----------
a, b : array
    (height, width) or (height, width, 1, 3 or 4): float with white 1, uint8 or uint16.
ppd : float
    Pixels per degree that the viewer has, 1 to 1000, for FLIP.
background : (3,) floats, optional
    RGB before which pictures with alpha are compared. By default alpha counts where both have some that is
    not 1, and is before black where one has.

Returns
-------
Comparison

Raises
------
InputError
    For shapes that do not go together, and for floats that count to 255.
TypeError
    For other types of numbers.
)";

}  // namespace binosplat::python::help
