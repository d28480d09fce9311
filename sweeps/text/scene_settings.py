"""Changed numbers of a scene."""

from collections.abc import Sequence

from engine import Scene, SceneError, UnitError, in_text, nearest_names, scene_numbers
from sweeps.text.input_files import InputError
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
        A text has no =, an unknown number, or an invalid value.
    """
    known, found = scene_numbers(scene), {}
    for text in settings:
        path, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not path:
            raise InputError.of("--set", f"{text!r}: write PATH=VALUE, such as input.length='55 mm'")
        if path not in known:
            near = nearest_names(path, known, 3)
            hint = f"did you mean {' or '.join(map(repr, near))}?" if near else f"numbers are {', '.join(known)}"
            raise InputError.of("--set", f"is not a number that the scene gives; {hint}", key=path)
        try:
            found[path] = in_text(value.strip("\"'"), known[path].dimension)
        except UnitError as error:
            raise InputError.of("--set", str(error), key=path) from None
    return found


def changed_scene(scene: Scene, settings: Sequence[str]) -> Scene:
    """A scene with changed numbers.

    Parameters
    ----------
    scene : Scene
    settings : sequence of str
        As for `given_values`.

    Raises
    ------
    InputError
        As for `given_values`, or an invalid value.
    """
    try:
        return with_numbers(scene, given_values(scene, settings))
    except SceneError as error:
        raise InputError("--set", [(None, path, message) for path, message in error.problems]) from None
