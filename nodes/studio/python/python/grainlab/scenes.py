"""Scenes: what a run simulates."""

from __future__ import annotations

import json
import operator
import os
import re
import warnings
from collections.abc import Mapping
from typing import Any

from . import _grainlab


def toml(value: Any) -> str:
    """A value in TOML: numbers, flags, texts, paths, lists and mappings. Raises TypeError for others."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, float) and value.is_integer() and abs(value) < 2**53:
        # A column of a data frame has whole numbers as 200.0.
        value = int(value)
    if isinstance(value, (bool, int, float)):
        return str(value).lower()
    if isinstance(value, (str, os.PathLike)):
        return json.dumps(os.fspath(value), ensure_ascii=False)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(str(k))} = {toml(v)}" for k, v in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(toml, value)) + "]"
    raise TypeError(f"{value!r} is no value of TOML: give numbers, texts, lists and mappings")


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_.-]+", key) else json.dumps(key)


def whole(name: str, value: Any, least: int = 0) -> int:
    """A whole number. Raises ValueError, which names it, for others, flags, and numbers below the least."""
    try:
        number = operator.index(value)
    except TypeError:
        number = -1
    if isinstance(value, bool) or not least <= number < 2**63:
        raise ValueError(f"{name} is {value!r}; it must be a whole number, {least} or more")
    return number


class Scene:
    """A scene with its settings: a built-in name, the path of a TOML file, or a text of several lines.

    ``set`` has keys such as ``"grains.count": 500``, in SI units, with numbers, texts, lists or mappings as values. All functions that take
    a scene take this, too. Raises SceneError for faults, as soon as it is used.

    >>> scene = grainlab.Scene("s2", set={"grains": {"count": 200}, "phase.load.until": {"strain": 0.01}})
    >>> scene.check()
    """

    def __init__(
        self, scene: str | os.PathLike[str] | Scene = "demo", *, seed: int | None = None, set: Mapping[str, Any] | None = None
    ) -> None:
        of = scene if isinstance(scene, Scene) else None
        self.source: str = of.source if of else os.fspath(scene)
        #: Settings as on the command line: ``key=value``.
        self.settings: list[str] = of.settings.copy() if of else []
        if set is not None and not hasattr(set, "items"):
            raise TypeError(f"set is {set!r}; it must be a mapping, such as {{'grains.count': 200}}")
        given = {} if set is None else dict(set.items())
        if seed is not None and "seed" in given:
            raise ValueError("seed is a keyword, and a key of set: give one of them")
        given |= {} if seed is None else {"seed": whole("seed", seed)}
        self.settings += [f"{key}={toml(value)}" for key, value in given.items()]

    def __repr__(self) -> str:
        return f"<grainlab.Scene {self.source.splitlines()[0]} {' '.join(self.settings)}>".replace(" >", ">")

    @property
    def text(self) -> str:
        """The complete scene in TOML: bases applied, every default written out. Raises SceneError."""
        return _grainlab.scene(self.source, self.settings)[0]

    @property
    def name(self) -> str:
        """Name of the scene. Raises SceneError."""
        return _grainlab.scene(self.source, self.settings)[1]

    def check(self) -> list[str]:
        """Notes on the scene. Raises SceneError with all its faults."""
        return _grainlab.scene(self.source, self.settings)[2]


def scenes() -> dict[str, str]:
    """The built-in scenes, each with its description. It has no units, and raises nothing.

    >>> grainlab.scenes()["s2"]
    """
    return _grainlab.scenes_built_in()


def scene_check(scene: str | os.PathLike[str] | Scene, *, set: Mapping[str, Any] | None = None) -> list[str]:
    """Notes on a scene: of ``Scene(scene, set=set).check()``, with settings in SI units. Raises SceneError with all faults.

    >>> grainlab.scene_check("s2", set={"grains.count": 200})
    """
    return Scene(scene, set=set).check()


def scene_keys() -> str:
    """Every key of a scene with its unit, default and range, as a text in Markdown. Raises nothing.

    >>> print(grainlab.scene_keys())
    """
    from .program import call

    return call("scene", "keys")


def warn(notes: list[str]) -> None:
    """Notes as warnings of Python."""
    for note in notes:
        warnings.warn(note, stacklevel=3)
