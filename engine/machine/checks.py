"""Checks of requests: names, positions, and values of variants."""

import re
from collections.abc import Iterable, Mapping

import numpy as np

from engine.machine.results import AskError
from engine.parts.skeleton import CrankInput
from engine.scene import structure
from engine.scene.pairs import pairs
from engine.scene.scene import Scene, SceneNumber, within_limits
from engine.units.display import quantity_text
from engine.units.reading import UnitError, in_text
from engine.words.glossary import did_you_mean, nearest_or_known
from engine.words.verdicts import Verdict

# Kernels store rows at a fixed distance.
MOST_POSITIONS = 1_048_576
# Lengths that all exceed the scene's by this factor are probably millimetres without a unit.
OUT_OF_SCALE = 100.0


def check_scene(scene: object) -> None:
    """Check that a machine is made from a scene.

    Raises
    ------
    AskError
        It is another object, such as the name of a file.
    """
    if not isinstance(scene, Scene):
        raise AskError(f"{scene!r} is not a scene; read one from a file by sweeps.read_scene('press.toml')")


def names_of(names: str | Iterable[str]) -> tuple[str, ...]:
    """Names as a tuple; a single string is one name."""
    return (names,) if isinstance(names, str) else tuple(names)


def relative_accuracy(accuracy: float | str | None) -> float | None:
    """An accuracy as a fraction.

    Raises
    ------
    AskError
        It isn't between 0 and 1.
    """
    if accuracy is None:
        return None
    try:
        share = in_text(accuracy, "number")
    except UnitError as error:
        raise AskError(f"accuracy: {error}") from None
    if not 0.0 < share < 1.0:
        raise AskError(f"accuracy = {accuracy!r}: a share between 0 and 1 is needed, such as 0.001 or '0.1 %'")
    return share


def size_remarks(limits: Mapping[str, SceneNumber], given: Mapping[str, np.ndarray]) -> tuple[str, ...]:
    """Remarks on lengths far above the scene's, such as millimetres taken for metres."""
    found = []
    for path, values in given.items():
        size, own = np.abs(values), abs(limits[path].value)
        if limits[path].dimension == "length" and own > 0 and size.size and size.min() >= OUT_OF_SCALE * own:
            times = f"{size[0] / own:.3g} times the scene's {quantity_text(limits[path].value, 'm')}"
            found.append(f"{path} = {values[0]:.6g} m is {times}: plain numbers are in SI, so write '{values[0]:g} mm'")
    return tuple(found)


def outside_limits(limits: Mapping[str, SceneNumber], given: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Which variants have a number outside its limits, (variants,) of bool for each path with such a number.

    Parameters
    ----------
    limits : mapping of path to SceneNumber
    given : mapping of path to ndarray (variants,)
        Varied numbers [SI].
    """
    found = {path: ~within_limits(limits[path], values) for path, values in given.items()}
    for path, number in limits.items():
        if number.above and given.keys() & {path, number.above}:
            own, lower = (given.get(p, limits[p].value) for p in (path, number.above))
            found[path] = found.get(path, False) | ~(own > lower)
    return {path: outside for path, outside in found.items() if outside.any()}


def check_positions(positions: int) -> None:
    """Check a number of positions.

    Raises
    ------
    AskError
        It is odd, less than 8, too large, or not a whole number.
    """
    if isinstance(positions, (int, np.integer)) and positions > MOST_POSITIONS:
        raise AskError(f"positions = {positions}: at most {MOST_POSITIONS} are allowed; give accuracy instead")
    if isinstance(positions, bool) or not isinstance(positions, (int, np.integer)) or positions < 8 or positions % 2:
        raise AskError(f"positions = {positions!r}: an even number of at least 8 is needed, such as 360 or 720")


def check_names(names: Iterable[str], known: Iterable[str], kind: str) -> None:
    """Check that names are known.

    Raises
    ------
    AskError
        A name is unknown; the message gives its expected `kind` and similar names.
    """
    known = list(known)
    for name in names:
        if name not in known:
            own = [n for n in known if n.startswith(f"{name.partition('.')[0]}.")] or sorted(known)
            raise AskError(f"{name!r} is not a {kind} of this scene; {nearest_or_known(name, known, own)}")


def check_varied(scene: Scene, varied: Iterable[str], limits: Mapping[str, SceneNumber]) -> None:
    """Check that numbers can differ between the variants of a machine.

    Parameters
    ----------
    scene : Scene
    varied : iterable of str
        Their paths.
    limits : mapping of path to SceneNumber
        Numbers of the scene.

    Raises
    ------
    AskError
        A path is unknown, or its number is the same for all variants.
    """
    check_names(varied, limits, "number")
    turning = {f"shafts.{cam.on}.ratio": name for name, cam in scene.cams.items()}
    by_laws = structure.input_laws.fixed_by_laws(scene) if scene.inputs else ()
    for path in varied:
        if isinstance(scene.input, CrankInput) and path in ("input.start", "input.stop"):
            raise AskError("input.start and input.stop of a crank are the same for all variants; vary another number")
        if path.startswith("near."):
            raise AskError(f"{path} selects the scene's assembly mode for all variants; vary another number")
        if path in turning:
            raise AskError(f"{path} turns cam {turning[path]!r}, whose cycle must close; vary another number")
        if path in by_laws:
            raise AskError(f"{path}: its turns in a cycle are the same for all variants; vary another number")


def full_names(scene: Scene, text: str) -> str:
    """Replace forces named by the joint on the drawing by their full names.

    "A.reaction.peak" becomes "drive.first.reaction.peak".

    Parameters
    ----------
    scene : Scene
    text : str
        A name, or an expression or condition with names.

    Raises
    ------
    AskError
        The joint contains several pairs; the message lists them.
    """
    if scene.input is None or ".reaction" not in text:
        return text
    there = pairs(scene)
    names = {pair.name for pair in there}

    def full(found: re.Match[str]) -> str:
        regime, joint = found.groups()
        held = [pair for pair in there if pair.joint == joint]
        if joint in names or not held:
            return found[0]
        if len(held) > 1:
            known = " or ".join(f"{pair.name}.reaction ({pair.other} on {pair.link})" for pair in held)
            raise AskError(f"{found[0]!r} is ambiguous: joint {joint} holds {len(held)} pairs; ask for {known}")
        return f"{regime or ''}{held[0].name}.reaction"

    regimes = "|".join(re.escape(f"{name}.") for name in scene.regimes)
    return re.sub(rf"(?<![\w.])({regimes})?(\w+)\.reaction", full, text)


def given_numbers(
    limits: Mapping[str, SceneNumber], paths: tuple[str, ...], varied: Mapping[str, np.ndarray], drop: np.ndarray | None
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Values of variants (SI), as arrays (variants,), and their first verdicts, (variants,) of uint8.

    Parameters
    ----------
    limits : mapping of path to SceneNumber
        Numbers of a scene.
    paths : tuple of str
        Paths that vary.
    varied : mapping of path to ndarray (variants,)
        Their values, in SI or as texts with units; one variant if empty.
    drop : ndarray (variants,) of bool, optional
        Variants not to evaluate.

    Raises
    ------
    AskError
        The paths differ from `paths`, or values are not rows of real numbers of equal length.
    """
    if not isinstance(varied, Mapping):
        raise AskError(f"give values by path, such as {{{next(iter(paths), 'input.length')!r}: [...]}}, not {varied!r}")
    for path in varied:
        if path not in paths:
            raise AskError(f"{path!r} is not varied by this machine; {did_you_mean(path, paths)}")
    for path in paths:
        if path not in varied:
            raise AskError(f"no values are given for {path!r}, which this machine varies; add them")
    arrays = {path: _row(path, values, limits[path].dimension) for path, values in varied.items()}
    first = next(iter(arrays), None)
    count = 1 if first is None else arrays[first].size
    for path, values in arrays.items():
        if values.size != count:
            raise AskError(f"{path!r} has {values.size} values, {first!r} has {count}: give one for every variant")
    status = np.zeros(count, np.uint8)
    for outside in outside_limits(limits, arrays).values():
        status[outside] = Verdict.OUTSIDE_LIMITS
    if drop is not None:
        drop = np.asarray(drop)
        if drop.shape != status.shape or drop.dtype != np.bool_:
            raise AskError(
                f"drop is an array of {drop.dtype} of the shape {drop.shape}: give True or False for each of the "
                f"{count} variants"
            )
        status[drop] = Verdict.DROPPED
    return arrays, status


def _row(path: str, values: object, dimension: str) -> np.ndarray:
    """Values for a path as a row of float64."""
    if np.ma.is_masked(values):
        raise AskError(f"{path!r} has masked values: leave out the variants that have none")
    try:
        row = np.atleast_1d(np.asarray(values))
    except ValueError:
        raise AskError(f"{path!r}: rows differ in length; give one row of numbers, one for every variant") from None
    if row.dtype.kind == "c":
        raise AskError(f"{path!r} has complex values: give real numbers")
    if row.ndim > 1:
        shape = " × ".join(map(str, row.shape))
        raise AskError(f"{path!r} has {shape} values: give one row of numbers, one for every variant")
    if row.dtype.kind == "U":
        try:
            return np.array([in_text(text, dimension) for text in row.tolist()])
        except UnitError as error:
            raise AskError(f"{path!r}: {error}") from None
    if row.dtype.kind not in "iuf":
        words = "give numbers in SI units, or texts with units such as '50 mm'"
        raise AskError(f"{path!r} has non-numeric values, such as {row.tolist()[0]!r}: {words}")
    return row.astype(np.float64)
