"""Replace numbers in a scene's text, keeping comments, order and units."""

import tomllib
from collections.abc import Mapping
from pathlib import Path

import tomlkit
from tomlkit.exceptions import TOMLKitError

from engine import Scene, UnitError, scene_numbers, unit_in
from sweeps.text.input_files import InputError
from sweeps.text.scene_text import (
    in_unit,
    number_text,
    scene_from,
    values_of_variant,
    with_numbers,
    write_scene,
)


def edited_scene(scene: Scene, values: Mapping[str, float], text: str, folder: Path) -> str:
    """Text of a scene with some numbers replaced, in the units that the author used.

    Parameters
    ----------
    scene : Scene
    values : mapping of str to float
        New values (SI) by path.
    text : str
        Source of the scene; if numbers can't be replaced in it, the scene is rewritten in common units.
    folder : Path
        Folder of the new text, for relative paths.

    Raises
    ------
    SceneError
        An invalid value.
    """
    values = values_of_variant(scene, values)
    wanted = with_numbers(scene, values)
    try:
        document = tomlkit.parse(text)
        numbers = scene_numbers(scene)
        for path, value in values.items():
            _replace(document, path.split("."), value, numbers[path].dimension)
        edited = tomlkit.dumps(document)
        found = scene_from(tomllib.loads(edited), edited, "scene", folder)
    except (TOMLKitError, InputError, KeyError, TypeError, UnitError):
        return write_scene(scene, values)
    return edited if found.model_dump() == wanted.model_dump() else write_scene(scene, values)


def _replace(document: tomlkit.TOMLDocument, keys: list[str], value: float, dimension: str) -> None:
    """Replace a number, in its unit."""
    *tables, last = keys
    table = document
    for key in tables:
        table = table[key]
    # Defaults may be absent.
    before = table.get(last)
    if isinstance(before, int):
        table[last] = int(value)
    elif isinstance(before, str) and (unit := unit_in(before)):
        table[last] = in_unit(value, unit, dimension) or number_text(value, dimension)
    else:
        table[last] = number_text(value, dimension)
