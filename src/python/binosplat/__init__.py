"""3D Gaussian Splatting models as pictures for one eye or both, drawn by OpenGL compute shaders.

A picture in four lines:

>>> import binosplat
>>> model = binosplat.load_model("garden.ply")
>>> picture = binosplat.Renderer(model).draw(binosplat.frame(model, 1280, 720), near=model.near)
>>> binosplat.save_png("garden.png", picture.colour)

Files, arrays and settings that cannot be used raise InputError, a ValueError; OpenGLError and OutOfMemory are the
other two kinds of Error.
"""

import difflib
import functools
import re

from . import _binosplat
from ._binosplat import *  # noqa: F403
from ._binosplat import __version__  # noqa: F401

__all__ = [name for name in vars(_binosplat) if not name.startswith("_")]


def __dir__():
    return [*__all__, "__version__"]


def _keywords(function):
    """The names of a function's arguments, from the signatures with which its documentation begins."""
    signatures = [line for line in function.__doc__.splitlines() if ") -> " in line]
    return {name for line in signatures for name in re.findall(r"(\w+): ", line)}


def _in_plain_words(function, name):
    """The function, whose error for a mistyped keyword names that keyword, and not all that there are."""
    keywords = _keywords(function)

    @functools.wraps(function)
    def call(*arguments, **options):
        try:
            return function(*arguments, **options)
        except TypeError:
            unknown = next((option for option in options if option not in keywords), None)
            if unknown is None:
                raise
            near = difflib.get_close_matches(unknown, keywords, 1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise TypeError(f"{name}() has no argument {unknown!r}{hint}") from None

    return call


def _use_plain_words():
    for name in __all__:
        thing = globals()[name]
        if not isinstance(thing, type):
            globals()[name] = _in_plain_words(thing, name)
        elif not issubclass(thing, BaseException):
            for method in ("__init__", "draw", "draw_all", "resized"):
                if method in vars(thing):
                    shown = name if method == "__init__" else f"{name}.{method}"
                    setattr(thing, method, _in_plain_words(vars(thing)[method], shown))


_use_plain_words()
