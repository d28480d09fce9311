"""Numbers of a scene and settings of a study that a command changes."""

from collections.abc import Sequence
from dataclasses import replace

from engine import (
    ACCURACY_SUMMARIES,
    Scene,
    SceneError,
    UnitError,
    in_text,
    nearest_names,
    scene_numbers,
)
from sweeps.study.study import Study
from sweeps.text.input_files import InputError
from sweeps.text.numbers_in_row import numbers_in_row
from sweeps.text.scene_text import with_numbers


def given_values(scene: Scene, settings: Sequence[str]) -> dict[str, float]:
    """Numbers of a scene from texts such as "input.length=55 mm".

    Parameters
    ----------
    scene : Scene
    settings : sequence of str

    Returns
    -------
    dict of str to float
        SI, by path.

    Raises
    ------
    InputError
        A text has no =, names no number of the scene, or its value can't be read.
    """
    known, found = scene_numbers(scene), {}
    for text in settings:
        path, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not path:
            raise InputError("--set", [(None, "", f"{text!r}: write PATH=VALUE, such as input.length='55 mm'")])
        if path not in known:
            near = nearest_names(path, known, 3)
            hint = f"did you mean {' or '.join(map(repr, near))}?" if near else f"numbers are {', '.join(known)}"
            raise InputError("--set", [(None, path, f"is not a number that the scene gives; {hint}")])
        try:
            found[path] = in_text(value.strip("\"'"), known[path].dimension)
        except UnitError as error:
            raise InputError("--set", [(None, path, str(error))]) from None
    return found


def changed_scene(scene: Scene, settings: Sequence[str]) -> Scene:
    """A scene with numbers of it set anew.

    Parameters
    ----------
    scene : Scene
    settings : sequence of str
        As for `given_values`.

    Raises
    ------
    InputError
        As for `given_values`, or the scene doesn't allow a value.
    """
    try:
        return with_numbers(scene, given_values(scene, settings))
    except SceneError as error:
        raise InputError("--set", [(None, path, message) for path, message in error.problems]) from None


def changed_study(
    study: Study, settings: Sequence[str] = (), positions: int | None = None, accuracy: str | None = None
) -> Study:
    """A study with numbers of its scene, its positions or its accuracy set anew.

    Parameters
    ----------
    study : Study
    settings : sequence of str
        As for `given_values`; no number that varies in the study or is derived.
    positions : int, optional
    accuracy : str, optional
        A share such as "0.1 %"; each summary then has an allowed error, as with the key of studies.

    Raises
    ------
    InputError
        As for `changed_scene`; a number varies; or the accuracy is no share.
    AskError
        The number of positions isn't allowed.
    """
    for path in given_values(study.scene, settings):
        if path in study.parameters:
            raise InputError("--set", [(None, path, "varies in this study; change the study, or set another number")])
    changes: dict[str, object] = {"scene": changed_scene(study.scene, settings)} if settings else {}
    if positions is not None:
        changes["positions"] = positions
    if accuracy is not None:
        changes["accuracy"] = _share(accuracy)
        changes["summaries"] = tuple(dict.fromkeys((*study.summaries, *ACCURACY_SUMMARIES)))
    if not changes:
        return study
    changed = replace(study, **changes)
    changed.machine()
    return changed


def _share(text: str) -> float:
    (share,) = numbers_in_row("--accuracy", text, ("number",))
    if not 0.0 < share < 1.0:
        raise InputError("--accuracy", [(None, "", f"{text!r}: a share between 0 and 1 is needed, such as '0.1 %'")])
    return share
