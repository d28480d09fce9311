"""A scene from a file of another program, recognised by its content."""

import json
from pathlib import Path

from engine import Scene
from sweeps.imports.chain import chain_scene
from sweeps.imports.pmks_plus_addresses import is_pmks_plus_address, pmks_plus_chain
from sweeps.imports.pmks_texts import pmks_chain
from sweeps.imports.pylinkage_files import pylinkage_chain
from sweeps.text.input_files import InputError, read_text


def import_scene(path: Path | str, unit: float | None = None, speed: str | None = None) -> Scene:
    """Scene from a linkage of pylinkage (JSON), PMKS (text, address) or PMKS+ (address).

    Parameters
    ----------
    path : Path or str
    unit : float, optional
        What a unit of length of the file is [m]; unless given what addresses of PMKS+ say, 1 mm in other files.
    speed : str, optional
        Of the crank, with its unit; clockwise where pylinkage's crank turns so. Unless given what addresses of PMKS+
        say, 60 rpm in other files.

    Raises
    ------
    InputError
        The file can't be read, or its linkage doesn't become a scene.
    """
    text = read_text(Path(path))
    if is_pmks_plus_address(text):
        return chain_scene(pmks_plus_chain(text, str(path), unit, speed))
    unit, speed = 1e-3 if unit is None else unit, speed or "60 rpm"
    if not text.lstrip().startswith(("{", "[")):
        return chain_scene(pmks_chain(text, str(path), unit, speed))
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        why = "it is nested too deep" if isinstance(error, RecursionError) else error
        raise InputError(str(path), [(None, "", f"is no JSON: {why}")]) from None
    if not isinstance(data, dict) or "joints" not in data:
        raise InputError(str(path), [(None, "", "has no list of joints, as files of pylinkage have")])
    return chain_scene(pylinkage_chain(data, str(path), unit, speed))
