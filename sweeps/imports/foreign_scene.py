"""A scene from another program's file, recognised by its content."""

import json
from pathlib import Path

from engine import Scene
from sweeps.imports.chain import Chain, LinkageError, SceneOfChain
from sweeps.imports.pmks_plus_addresses import PmksPlusAddress, is_pmks_plus_address
from sweeps.imports.pmks_texts import pmks_chain
from sweeps.imports.pylinkage_files import pylinkage_chain
from sweeps.text.input_files import InputError, read_text


def import_scene(path: Path | str, unit: float | None = None, speed: str | None = None) -> Scene:
    """Scene from a linkage of pylinkage (JSON), PMKS (text, address) or PMKS+ (address).

    Parameters
    ----------
    path : Path or str
    unit : float, optional
        Length unit of the file [m]; default: as in the PMKS+ address, else 1 mm.
    speed : str, optional
        Crank speed with unit, clockwise if pylinkage's crank turns so; default: as in the PMKS+ address, else 60 rpm.

    Raises
    ------
    InputError
        The file can't be read, or its linkage can't be converted to a scene.
    """
    text = read_text(Path(path))
    try:
        return SceneOfChain(_chain(text, unit, speed)).scene()
    except LinkageError as error:
        raise InputError.of(str(path), str(error)) from None


def _chain(text: str, unit: float | None, speed: str | None) -> Chain:
    if is_pmks_plus_address(text):
        return PmksPlusAddress(text).chain(unit, speed)
    unit, speed = 1e-3 if unit is None else unit, speed or "60 rpm"
    if not text.lstrip().startswith(("{", "[")):
        return pmks_chain(text, unit, speed)
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        why = "nested too deep" if isinstance(error, RecursionError) else error
        raise LinkageError(f"is not JSON: {why}") from None
    if not isinstance(data, dict) or "joints" not in data:
        raise LinkageError("has no list of joints; pylinkage files have one")
    return pylinkage_chain(data, unit, speed)
