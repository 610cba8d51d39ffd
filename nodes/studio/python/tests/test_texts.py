"""The texts of ``help()``: units, errors and an example, and the same for type checkers."""

import ast
import inspect
import os
import pathlib
import re

import grainlab
import pytest
from grainlab import _grainlab

STUB = pathlib.Path(grainlab.__file__).parents[0] / "_grainlab.pyi"
SOURCE = pathlib.Path(__file__).parents[1] / "python/grainlab/_grainlab.pyi"
UNITS = re.compile(r"\b(SI|Pa|kPa|m/s|m|s|N|ns|pixels|unit|units)\b")
ERRORS = {"FileError", "GrainlabError", "PhysicsError", "SceneError"}


@pytest.mark.parametrize("name", sorted(set(grainlab.__all__) - ERRORS - {"__version__"}))
def test_every_function_and_class_states_units_errors_and_an_example(name):
    item = getattr(grainlab, name)
    text = inspect.getdoc(item) or ""
    assert UNITS.search(text) and re.search("[Rr]aises?", text) and ">>> " in text, f"{name}: {text}"
    members = vars(item) if inspect.isclass(item) else {}
    public = [m for m in members if not m.startswith("_") and (callable(members[m]) or inspect.isdatadescriptor(members[m]))]
    without = [m for m in public if not inspect.getdoc(getattr(item, m))]
    assert not without, f"{name}: {without}"


def test_the_beginnings_of_the_readme_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", (SOURCE.parents[2] / "README.md").read_text(), re.DOTALL)
    assert len(blocks) == 5
    exec("\n".join(blocks), {})


def test_every_command_of_the_readme_is_in_the_table_of_functions():
    rows = re.compile(r"^\| (`.+?`) \| (.+) \|$", re.MULTILINE)
    here = {name: text for names, text in rows.findall((SOURCE.parents[2] / "README.md").read_text()) for name in re.findall("`(.+?)`", names)}
    of_program = re.findall(r"^\| `(\w+)` \|", (SOURCE.parents[5] / "README.md").read_text().split("<!-- commands")[1].split("<!-- end")[0], re.MULTILINE)
    assert set(here) == set(of_program)
    named = {name.split("(")[0] for text in here.values() for name in re.findall(r"`(\w+(?:\(\))?)`", text)}
    assert {"invert", "probe", "campaign", "launch", "calibrate", "view"} <= named & set(grainlab.__all__)


def stubbed():
    """Names and nodes of the types for type checkers."""
    for node in ast.parse(SOURCE.read_text()).body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            yield node.name, node
            members = node.body if isinstance(node, ast.ClassDef) else []
            yield from ((f"{node.name}.{m.name}", m) for m in members if isinstance(m, ast.FunctionDef))


def runtime(name):
    item = _grainlab
    for part in name.split("."):
        item = getattr(item, part)
    return item


def written(name, node):
    """The text of the module under this name; none for what a reader does not see."""
    return None if node.name.startswith("_") else inspect.getdoc(runtime(name))


def bless():
    """Writes the texts of the module into the types."""
    lines = SOURCE.read_text().splitlines()
    for name, node in sorted(stubbed(), key=lambda n: -n[1].lineno):
        text = written(name, node)
        if text is None or text == ast.get_docstring(node):
            continue
        indent = " " * (node.col_offset + 4)
        body = node.body[0]
        has = ast.get_docstring(node) is not None
        if not has and isinstance(node, ast.FunctionDef):
            lines[body.lineno - 1] = lines[body.lineno - 1].removesuffix(" ...")
        at = body.lineno - 1 if has or isinstance(node, ast.ClassDef) else body.lineno
        new = [(indent + line).rstrip() for line in f'"""{text}"""'.splitlines()]
        if len(new) > 1:
            new = [*new[:-1], new[-1].removesuffix('"""'), indent + '"""']
        lines[at : body.end_lineno if has else at] = new
    SOURCE.write_text("\n".join(lines) + "\n")


def test_type_checkers_read_the_texts_and_the_names_of_the_module():
    if os.environ.get("GRAINLAB_BLESS"):
        bless()
    differ = [name for name, node in stubbed() if written(name, node) != (ast.get_docstring(node) if written(name, node) else None)]
    assert not differ, f"GRAINLAB_BLESS=1 pytest {__file__} writes the texts of {differ}"
    names = {name for name, _ in stubbed()}
    for name in ("Packing", "Recording"):
        public = {f"{name}.{m}" for m in vars(getattr(_grainlab, name)) if not m.startswith("_")}
        assert public <= names, public - names
    for name, node in stubbed():
        if isinstance(node, ast.FunctionDef) and "." not in name:
            arguments = node.args
            of_stub = [a.arg for a in arguments.posonlyargs + arguments.args + arguments.kwonlyargs]
            assert of_stub == list(inspect.signature(runtime(name)).parameters), name
