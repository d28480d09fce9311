"""The machine described by a file (scene, study or result variant), and input positions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

import engine
from engine import CrankInput, Element, Mechanics, Scene, SceneError, UnitError, full_names, in_text, scene_numbers
from sweeps.cli import needed
from sweeps.report.readings import Readings, readings_at
from sweeps.study.bundled import find_study
from sweeps.study.study_text import is_scene
from sweeps.text.input_files import InputError, is_hdf5, need_known, read_text
from sweeps.text.scene_text import changed_scene, given_values, scene_from, with_values
from sweeps.text.toml_text import parse_toml, problems_in

MOST_POSITIONS = 100_000


def is_result(file: str) -> bool:
    """Whether a file is a sweep result, judged by extension or content."""
    return file.endswith(".h5") or is_hdf5(Path(file))


@dataclass(frozen=True)
class NamedMachine:
    """The machine that a file describes.

    Attributes
    ----------
    written : Scene
        As in the file.
    text : str
        Its TOML source, "" if unknown.
    values : mapping of str to float
        Numbers (SI) of a variant.
    name : str
    settings : tuple of str
        Changed numbers, as for `given_values`; they replace the variant's.
    variant : int or None
        Its index; None without a variant.
    """

    written: Scene
    text: str
    values: Mapping[str, float]
    name: str
    settings: tuple[str, ...] = ()
    variant: int | None = None

    @cached_property
    def before(self) -> Scene:
        """The scene with the settings, without the variant's numbers."""
        return changed_scene(self.written, self.settings)

    @cached_property
    def scene(self) -> Scene:
        """The scene with all its numbers.

        Raises
        ------
        SceneError
            The variant can't be assembled in the scene's assembly mode.
        """
        anew = given_values(self.written, self.settings)
        return with_values(self.before, {path: value for path, value in self.values.items() if path not in anew})

    def edited(self, folder: Path) -> str:
        """TOML text of the scene with all its numbers, in its author's words and units.

        Parameters
        ----------
        folder : Path
            Of the files that the text names.

        Raises
        ------
        SceneError
            As for `scene`.
        """
        replaced = {**self.values, **given_values(self.written, self.settings)}
        if replaced:
            numbers = scene_numbers(self.scene).items()
            replaced |= {path: number.value for path, number in numbers if path.startswith("near.")}
        return needed.edited_scene(self.written, replaced, self.text, folder)


def _written(file: str, variant: int | None) -> NamedMachine:
    """The machine of a file without settings, as for `machine_of`."""
    if is_result(file):
        # Slow imports that a scene doesn't need.
        result = needed.SweepResult(Path(file))
        result.show_own_units()
        if variant is None:
            variant = next(reversed(needed.answering(result)), 0)
        text = result.file.attributes.get("scene_text", "")
        values, name = result.variant_values(variant), f"{Path(file).stem}_{variant}"
        return NamedMachine(result.scene, text, values, name, variant=variant)
    if variant is None and (alone := _scene_alone(find_study(file))):
        return alone
    study = needed.read_study(find_study(file))
    if variant is None:
        return NamedMachine(study.scene, study.scene_text, {}, study.name)
    if not 0 <= variant < study.design.size:
        raise InputError.of(file, f"{variant} is not one of 0 … {study.design.size - 1}", key="variant")
    values = {path: float(row[0]) for path, row in study.values(variant, variant + 1)[0].items() if path in study.fixed}
    return NamedMachine(study.scene, study.scene_text, values, f"{study.name}_{variant}", variant=variant)


def _scene_alone(path: Path) -> NamedMachine | None:
    """The scene in a file; None for a study, whose reader is slow to import."""
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
    return NamedMachine(scene, text, {}, path.stem)


def machine_of(file: str, variant: int | None, settings: Sequence[str] = ()) -> NamedMachine:
    """The machine that a result, study or scene file describes.

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
    return replace(_written(file, variant), settings=tuple(settings))


def with_full_joint_names(file: str, asked: str | tuple[str, ...]) -> str | tuple[str, ...]:
    """Names or conditions for a file's machine, with the full names of joint forces.

    Raises
    ------
    AskError
        Several pairs are in a joint.
    """
    scene = machine_of(file, 0 if is_result(file) else None).written
    return full_names(scene, asked) if isinstance(asked, str) else tuple(full_names(scene, text) for text in asked)


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
        Crank angles (default unit: degrees), or displacements of a sliding input; or "FIRST to LAST, HOW MANY".

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
    spaced = engine.first_last_count(text)
    if spaced and not 1 < spaced[2] <= MOST_POSITIONS:
        raise InputError.of("--at", f"from 2 to {MOST_POSITIONS} positions are possible, not {spaced[2]}")
    parts = spaced[:2] if spaced else [part.strip() for part in text.split(",") if part.strip()]
    try:
        found = tuple(in_text(f"{part} deg" if turns and part[-1].isdigit() else part, dimension) for part in parts)
    except UnitError as error:
        raise InputError.of("--at", f"{error}; for example --at {mend}") from None
    return tuple(engine.even_steps(*found, spaced[2], np.arange(spaced[2])).tolist()) if spaced else found


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
    if None not in times:
        # Only regimes need compiled code.
        found = needed.readings_in_time(scene, times)
        need_known(names, found.values, "--at", "is not available at an instant")
        kept = names or found.values
        return found._replace(values={name: found.values[name] for name in kept})
    return readings_at(scene, positions_of(scene, text), names)


def _time(text: str) -> float | None:
    try:
        return in_text(text, "time") if text.strip()[-1:].isalpha() else None
    except UnitError:
        return None
