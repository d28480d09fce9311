"""The machine described by a file (scene, study or result variant), and input positions."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from engine import (
    CrankInput,
    Element,
    Mechanics,
    Scene,
    SceneError,
    UnitError,
    did_you_mean,
    full_names,
    in_text,
    scene_numbers,
)
from sweeps.report.readings import Readings, readings_at
from sweeps.study.bundled import find_study
from sweeps.study.study_text import is_scene
from sweeps.text.input_files import InputError, is_hdf5, read_text
from sweeps.text.scene_settings import changed_scene, given_values
from sweeps.text.scene_text import scene_from, with_values
from sweeps.text.toml_text import parse_toml, problems_in

if TYPE_CHECKING:
    from sweeps.report.sweep_result import SweepResult
    from sweeps.study.study import Study


def is_result(file: str) -> bool:
    """Whether a file is a sweep result, judged by extension or content."""
    return file.endswith(".h5") or is_hdf5(Path(file))


def _result(file: str) -> "SweepResult":
    # Slow imports that a scene doesn't need.
    from sweeps.report.sweep_result import SweepResult

    return SweepResult(Path(file))


def _study(file: str) -> "Study":
    from sweeps.study.study_reader import read_study

    return read_study(find_study(file))


def _scene_alone(file: str) -> Scene | None:
    """The scene in a file; None for a study, whose reader is slow to import."""
    path = find_study(file)
    text = read_text(path)
    data = parse_toml(text, path.name)
    if not is_scene(data):
        return None
    scene = scene_from(data, text, path.name, path.parent)
    try:
        if scene.input is not None:
            Mechanics(scene)
    except SceneError as error:
        raise InputError(path.name, problems_in(text, error.problems)) from None
    return scene


def machine_of(file: str, variant: int | None, settings: Sequence[str] = ()) -> tuple[Scene, Mapping[str, float], str]:
    """Scene, replaced values and name from a result, study or scene file.

    Parameters
    ----------
    file : str
    variant : int, optional
        Default: the best variant of a result, the last choice of a Pareto front (the knee if there is one), the
        unchanged scene of a study.
    settings : sequence of str
        Changed numbers, as for `given_values`.

    Raises
    ------
    InputError, StoreError
        The file can't be read, or has no such variant.
    """
    if is_result(file):
        from sweeps.optimising.optimum import choices, is_front

        result = _result(file)
        result.show_own_units()
        if variant is None:
            variant = result.best()
        if variant is None and is_front(result):
            variant = next((choice.variant for choice in reversed(choices(result))), None)
        chosen = 0 if variant is None else variant
        return (*_set_anew(result.scene, result.variant_values(chosen), settings), f"{Path(file).stem}_{chosen}")
    scene = _scene_alone(file) if variant is None else None
    if scene is not None:
        return (*_set_anew(scene, {}, settings), find_study(file).stem)
    study = _study(file)
    if variant is None:
        return (*_set_anew(study.scene, {}, settings), study.name)
    if not 0 <= variant < study.design.size:
        raise InputError.of(file, f"{variant} is not one of 0 … {study.design.size - 1}", key="variant")
    values, _ = study.values(variant, variant + 1)
    return (*_set_anew(study.scene, {p: float(values[p][0]) for p in study.paths}, settings), f"{study.name}_{variant}")


def _set_anew(scene: Scene, values: Mapping[str, float], settings: Sequence[str]) -> tuple[Scene, Mapping[str, float]]:
    """A scene and its replaced numbers, with the settings applied."""
    anew = given_values(scene, settings)
    return changed_scene(scene, settings), {path: value for path, value in values.items() if path not in anew}


def in_full(file: str, asked: str | tuple[str, ...]) -> str | tuple[str, ...]:
    """Names or conditions asked of a file's machine, forces in joints by their full names.

    Raises
    ------
    AskError
        Several pairs are in a joint.
    """
    scene = _result(file).scene if is_result(file) else machine_of(file, None)[0]
    return full_names(scene, asked) if isinstance(asked, str) else tuple(full_names(scene, text) for text in asked)


def scene_text_of(file: str) -> str:
    """TOML source of the scene in a file; "" if unknown."""
    if is_result(file):
        return _result(file).description.attributes.get("scene_text", "")
    return _study(file).scene_text


def numbers_replaced(file: str, values: Mapping[str, float], settings: Sequence[str]) -> tuple[Scene, dict[str, float]]:
    """The scene of a file and all replaced numbers: the variant's and the settings.

    Parameters
    ----------
    file : str
    values : mapping of str to float
        The variant's numbers (SI) by path.
    settings : sequence of str
        As for `given_values`.

    Raises
    ------
    SceneError
        The variant can't be assembled in the scene's assembly mode.
    """
    scene = _result(file).scene if is_result(file) else _study(file).scene
    own, rest = _set_anew(scene, values, settings)
    told = {p: number.value for p, number in scene_numbers(with_values(own, rest)).items() if p.startswith("near.")}
    return scene, {**values, **given_values(scene, settings), **(told if rest or settings else {})}


def element_named(scene: Scene, types: Sequence[str], name: str | None) -> Element | None:
    """An element of some types: by its name, or the only one of a scene without a mechanism.

    Parameters
    ----------
    scene : Scene
    types : sequence of str
    name : str or None

    Returns
    -------
    Element or None
        None if the mechanism is meant, or if there is no element of these types.

    Raises
    ------
    InputError
        There is no such element, or several and no name.
    """
    found = {key: element for key, element in scene.elements.items() if element.type in types}
    if name is None and (scene.input is not None or not found):
        return None
    if name is None and len(found) == 1:
        (name,) = found
    if name not in found:
        kinds = " or ".join(kind.replace("_", " ") for kind in types)
        raise InputError.of(
            name or "scene", f"name a {kinds} of this scene: {', '.join(found) or 'none'}", key="--element"
        )
    return found[name]


def positions_of(scene: Scene, text: str) -> tuple[float, ...]:
    """Input positions from a comma-separated text.

    Parameters
    ----------
    scene : Scene
    text : str
        Crank angles (default unit: degrees), or displacements of a sliding input.

    Returns
    -------
    tuple of float
        [rad] or [m].

    Raises
    ------
    InputError
        An entry isn't a position.
    """
    turns = scene.input is None or isinstance(scene.input, CrankInput)
    dimension, mend = ("angle", "0,60,120") if turns else ("length", "'0 mm, 20 mm'")
    parts = [part.strip() for part in text.split(",") if part.strip()]
    try:
        return tuple(in_text(f"{part} deg" if turns and part[-1].isdigit() else part, dimension) for part in parts)
    except UnitError as error:
        raise InputError.of("--at", f"{error}; for example --at {mend}") from None


def read_at(scene: Scene, text: str, names: Sequence[str] = ()) -> Readings:
    """Fields at input positions, or the motion at given times, from a comma-separated text.

    Parameters
    ----------
    scene : Scene
    text : str
        Positions as for `positions_of`, or times ("0.2 s").
    names : sequence of str
        Fields (default: all).

    Raises
    ------
    InputError
        An entry is neither, or times and positions are mixed.
    AskError
        There is no such field.
    """
    times = [_time(part) for part in text.split(",") if part.strip()]
    if not times:
        raise InputError.of("--at", "no positions; for example --at 0,60,120")
    if None not in times and times:
        # Only regimes need compiled code.
        from sweeps.report.readings_in_time import readings_in_time

        found = readings_in_time(scene, [time for time in times if time is not None])
        unknown = [name for name in names if name not in found.values]
        if unknown:
            message = f"{unknown[0]!r} is not available at an instant; {did_you_mean(unknown[0], found.values)}"
            raise InputError.of("--at", message)
        kept = names or found.values
        return found._replace(values={name: found.values[name] for name in kept})
    return readings_at(scene, positions_of(scene, text), names)


def _time(text: str) -> float | None:
    try:
        return in_text(text, "time") if text.strip()[-1:].isalpha() else None
    except UnitError:
        return None
