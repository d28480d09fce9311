"""Settings of a study changed by a command."""

import re
from collections.abc import Sequence
from dataclasses import replace

from engine import ACCURACY_SUMMARIES
from sweeps.study.study import Study
from sweeps.text.input_files import InputError
from sweeps.text.numbers_in_row import numbers_in_row
from sweeps.text.scene_text import changed_scene, given_values


def changed_study(
    study: Study, settings: Sequence[str] = (), positions: int | None = None, accuracy: str | None = None
) -> Study:
    """A study with changed scene numbers, which its name then includes, positions or accuracy.

    Parameters
    ----------
    study : Study
    settings : sequence of str
        As for `given_values`; not for varied or derived numbers.
    positions : int, optional
    accuracy : str, optional
        Relative accuracy such as "0.1 %", as the study's key.

    Raises
    ------
    InputError
        As for `changed_scene`; a number varies; or the accuracy is invalid.
    AskError
        The number of positions isn't allowed.
    """
    for path in given_values(study.scene, settings):
        if path in study.parameters:
            raise InputError.of("--set", "varies in this study; change the study, or set another number", key=path)
    changes: dict[str, object] = {}
    if settings:
        name = "_".join([study.name, *(re.sub(r"[^\w-]+", "_", setting).strip("_") for setting in settings)])
        changes = {"scene": changed_scene(study.scene, settings), "name": name}
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
        raise InputError.of("--accuracy", f"{text!r}: must be between 0 and 1, such as '0.1 %'")
    return share
