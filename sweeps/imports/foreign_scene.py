"""A scene from a file of another program, told by what it holds."""

import json
from pathlib import Path

from engine import Scene
from sweeps.imports.chain import chain_scene
from sweeps.imports.pmks_texts import pmks_chain
from sweeps.imports.pylinkage_files import pylinkage_chain
from sweeps.text.input_files import InputError, read_text


def import_scene(path: Path | str, unit: float = 1e-3, speed: str = "60 rpm") -> Scene:
    """Scene from a linkage of pylinkage (JSON) or PMKS (text, address).

    Parameters
    ----------
    path : Path or str
    unit : float
        What a unit of length of the file is [m]; files of both don't say.
    speed : str
        Of the crank, with its unit; clockwise where the file's crank turns so.

    Raises
    ------
    InputError
        The file can't be read, or its linkage doesn't become a scene.
    """
    text = read_text(Path(path))
    if not text.lstrip().startswith(("{", "[")):
        return chain_scene(pmks_chain(text, str(path), unit, speed))
    try:
        data = json.loads(text)
    except ValueError as error:
        raise InputError(str(path), [(None, "", f"is no JSON: {error}")]) from None
    if not isinstance(data, dict) or "joints" not in data:
        raise InputError(str(path), [(None, "", "has no list of joints, as files of pylinkage have")])
    return chain_scene(pylinkage_chain(data, str(path), unit, speed))
