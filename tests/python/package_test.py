"""What the package says of itself: its stubs and its documentation are those of what is there."""

import ast
import inspect
import re
from pathlib import Path

import binosplat

STUBS = Path(binosplat.__file__).with_name("__init__.pyi")


def signature(thing):
    """The names in the first signature that the documentation of a function has, without self."""
    first = next(line for line in thing.__doc__.splitlines() if ") -> " in line)
    return [name for name in re.findall(r"(\w+): ", first) if name != "self"]


def stubbed(text):
    """Of every function and method of the stubs: its arguments' names. Of every class: its attributes."""
    functions, attributes = {}, {}

    def add(node, prefix):
        arguments = node.args.posonlyargs + node.args.args + node.args.kwonlyargs
        functions.setdefault(prefix + node.name, [a.arg for a in arguments if a.arg != "self"])

    for node in ast.parse(text).body:
        if isinstance(node, ast.FunctionDef):
            add(node, "")
        elif isinstance(node, ast.ClassDef):
            attributes[node.name] = {n.target.id for n in node.body if isinstance(n, ast.AnnAssign)}
            for method in (n for n in node.body if isinstance(n, ast.FunctionDef)):
                add(method, node.name + ".")
    return functions, attributes


def faults(text):
    functions, attributes = stubbed(text)
    found = []
    for name in binosplat.__all__:
        thing = getattr(binosplat, name)
        if not inspect.isclass(thing):
            if functions.get(name) != signature(thing):
                found.append(name)
        elif name not in attributes:
            found.append(name)
        elif not issubclass(thing, BaseException):
            # Properties are the things of a class that nobody calls.
            there = {n for n, v in vars(thing).items() if not n.startswith("_") and not callable(v)}
            there -= {n for n, v in vars(thing).items() if isinstance(v, staticmethod)}
            found += [f"{name}.{n}" for n in there ^ attributes[name]]
            for method in ("__init__", "draw", "draw_all", "resized", "of_eyes"):
                if method not in vars(thing) or f"{name}.{method}" not in functions:
                    continue
                if functions[f"{name}.{method}"] != signature(getattr(thing, method)):
                    found.append(f"{name}.{method}")
    return found


def test_the_stubs_are_those_of_what_is_there():
    text = STUBS.read_text()
    assert STUBS.with_name("py.typed").exists() and faults(text) == []
    for planted, name in (("tolerance: float | None = None,", "Renderer.draw"), ("    antialiased: bool\n", "Model.antialiased"),
                          ("background: _Three | None = None", "compare")):
        assert planted in text and name in faults(text.replace(planted, ""))


def test_every_function_says_what_it_takes_and_returns():
    def is_told(thing):
        text = inspect.getdoc(thing) or ""
        return all(f"\n{title}\n{'-' * len(title)}\n" in text for title in ("Returns", "Raises"))

    for name in ("load_model", "load_cameras", "look_at", "frame", "compare", "load_image"):
        assert is_told(getattr(binosplat, name)), name
    assert is_told(binosplat.Renderer.draw) and is_told(binosplat.Renderer.draw_all)
    for name in binosplat.__all__:
        assert inspect.getdoc(getattr(binosplat, name)), name
    assert not is_told(binosplat.Picture)


def test_dir_has_what_there_is_for_users():
    assert sorted(dir(binosplat)) == sorted([*binosplat.__all__, "__version__"])
    assert not [name for name in binosplat.__all__ if name.startswith("_")]
