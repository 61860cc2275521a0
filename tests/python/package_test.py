"""The package has type annotations for type checkers and docstrings for help()."""

import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

import binosplat


def callables():
    """Yields the name and the function of everything that users call: functions, and methods of classes."""
    for name in binosplat.__all__:
        thing = getattr(binosplat, name)
        if not inspect.isclass(thing):
            yield name, thing
        elif not issubclass(thing, BaseException):
            for method, function in vars(thing).items():
                if inspect.isfunction(function) and (method == "__init__" or not method.startswith("_")):
                    yield f"{name}.{method}", function


def test_arguments_and_results_have_types():
    assert Path(binosplat.__file__).with_name("py.typed").exists()
    for name, function in callables():
        for argument in inspect.signature(function).parameters.values():
            assert argument.name == "self" or argument.annotation is not argument.empty, (name, argument)
        if not name.startswith(("Picture.", "Comparison.")):  # dataclass() makes these
            assert inspect.signature(function).return_annotation is not inspect.Signature.empty, name


def test_documentation_covers_all_arguments():
    for name in binosplat.__all__:
        assert inspect.getdoc(getattr(binosplat, name)), name
    for name, function in callables():
        owner = getattr(binosplat, name.removesuffix(".__init__")) if name.endswith("__init__") else function
        text = inspect.getdoc(owner)
        assert text, name
        if "\nParameters\n----------\n" not in text:
            continue
        told = text.split("\nParameters\n----------\n")[1]
        for argument in inspect.signature(function).parameters:
            assert argument == "self" or re.search(rf"^(\w+, )*{argument}\b", told, re.M), (name, argument)


TYPED = """
import binosplat
camera = binosplat.look_at((0, 0, 0), (0, 0, 1), 64, 48)
renderer = binosplat.Renderer(binosplat.load_model("a.ply"))
reveal_type(renderer.draw(camera))
reveal_type(renderer.draw(binosplat.Rig(camera)))
reveal_type([picture for picture in renderer.draw_all([camera])])
renderer.draw(camera, tiles="round")
renderer.draw(3)
camera.widht
"""


def test_type_checkers_infer_draw_result(tmp_path):
    pytest.importorskip("mypy")
    (tmp_path / "program.py").write_text(TYPED)
    command = [sys.executable, "-m", "mypy", "--enable-incomplete-feature", "Unpack",  # on by itself from mypy 1.7 on
               "--cache-dir", tmp_path / "cache", tmp_path / "program.py"]
    said = subprocess.run(command, capture_output=True, text=True).stdout
    picture = "binosplat.Picture"
    for words in (f'"{picture}"', f'"Tuple[{picture}, {picture}]"', f'"builtins.list[{picture}"'):
        assert f"Revealed type is {words[:-1]}".lower() in said.lower(), said
    for line in (7, 8, 9):
        assert f"program.py:{line + 1}: error" in said, said


def test_dir_lists_public_names():
    assert sorted(dir(binosplat)) == sorted([*binosplat.__all__, "__version__"])
    assert not [name for name in binosplat.__all__ if name.startswith("_")]
