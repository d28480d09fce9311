"""Text on the regimes of a scene: descriptions and failures."""

import math
from collections.abc import Sequence

import numpy as np

import engine
from engine import InputUnits, RunRegime, Scene, Verdict, quantity_text, run_keys

# Verdicts of motion.
MOTION_VERDICTS = (
    *(Verdict.STALLS, Verdict.RUNS_AWAY, Verdict.NO_END, Verdict.ANY_SPEED, Verdict.LOCKS, Verdict.NO_INERTIA),
    Verdict.SLIPS,
    Verdict.TOO_COARSE,
)
# Positions per cycle of a history that locates a failure.
STEPS = 240
# A run abandoned after at least this many cycles was still moving.
MANY_CYCLES = 1000
# Tolerance for the end of the input's range, as a share of it.
_AT_END = 1e-9
# Below this share of its peak speed a machine is dying out.
_NEXT_TO_NOTHING = 1e-6


def regime_words(scene: Scene, name: str) -> str:
    """Description of a regime, such as "run from rest until 38 rpm; off: punching".

    Parameters
    ----------
    scene : Scene
    name : str
    """
    regime = scene.regimes[name]
    doing = "steady running"
    if isinstance(regime, RunRegime):
        doing = f"run from {_begin(scene, name, regime)} {_end(scene, regime)}"
    return doing + (f"; off: {', '.join(regime.off)}" if regime.off else "")


def _begin(scene: Scene, name: str, regime: RunRegime) -> str:
    keys, units, names = run_keys(scene.input), InputUnits.of(scene), list(scene.regimes)
    before = names[: names.index(name)]
    begin = f"where {before[-1]} ended" if before else "rest"
    speed, place = getattr(regime, keys.from_speed), getattr(regime, keys.from_place)
    if speed is not None:
        begin = "rest" if speed == 0 else quantity_text(speed, units.speed)
    if regime.from_shaft_speed is not None:
        shaft = next(iter(scene.couplings.values())).shaft
        begin += f", {shaft} from {quantity_text(regime.from_shaft_speed, 'rad s-1')}"
    if place is None:
        return begin
    at = f"{units.symbols[0]} = {quantity_text(place, units.q)}"
    if not before or speed is not None:
        return f"{begin} at {at}"
    # The speed of a run belongs to its end, that of steady running to the position.
    speed_of = "with the final speed of" if scene.regimes[before[-1]].type == "run" else "of"
    return f"{at} {speed_of} {before[-1]}"


def _end(scene: Scene, regime: RunRegime) -> str:
    if regime.cycles is not None:
        return f"for {regime.cycles:g} cycle{'' if regime.cycles == 1 else 's'}"
    if regime.lock_up:
        return "until the clutch locks"
    if regime.time is not None:
        return f"for {quantity_text(regime.time, 's')}"
    if regime.end_of_range:
        return "to the end of its range"
    if regime.reversal:
        return "until it first stops"
    return (
        "to rest" if regime.rest else f"until {quantity_text(_asked_speed(scene, regime), InputUnits.of(scene).speed)}"
    )


def _asked_speed(scene: Scene, regime: RunRegime) -> float | None:
    """Final speed of a run."""
    return getattr(regime, run_keys(scene.input).speed)


# Failures


def part_words(name: str) -> str:
    """A part that fails: the path of an element or a regime, or the name of a structural group."""
    return name if "." in name else f"group {name}"


def failure_text(scene: Scene, verdict: Verdict, seen: "engine.History | None" = None) -> str:
    """Which regime fails, where and how, with a remedy.

    Parameters
    ----------
    scene : Scene
        The scene with the machine's numbers.
    verdict : Verdict
        Verdict on the machine.
    seen : History, optional
        Its history, if known.
    """
    seen = engine.history(scene, STEPS) if seen is None else seen
    if seen.verdict == Verdict.OK:
        # Near a limit the step count matters, and the variant may have a sized flywheel that the scene lacks.
        return f"{verdict.sentence} (with {STEPS} positions and the scene's flywheel it runs)"
    name = str(seen.regime[-1])
    if seen.verdict == Verdict.NO_END:
        return f"regime {name}: {_no_end(scene, name, seen)}"
    if seen.verdict == Verdict.STALLS and isinstance(scene.regimes[name], RunRegime):
        return f"regime {name}: {_stall_text(scene, seen)}"
    if seen.verdict == Verdict.LOCKS:
        off = scene.regimes[name].off
        brakes = [n for n, m in scene.moments.items() if n not in off and m.type == "band_brake"]
        return f"regime {name}, {' or '.join(brakes)}: {seen.verdict.sentence}"
    return f"regime {name}: {seen.verdict.sentence}"


def _stall_text(scene: Scene, seen: "engine.History") -> str:
    """Where a machine stalls, and the torques there."""
    way = math.copysign(1.0, scene.input.speed)
    drive = way * float(seen.motor_moment[-1] + seen.load_moments["driving"][-1])
    loads = -way * float(sum(row[-1] for channel, row in seen.load_moments.items() if channel != "driving"))
    units, at = InputUnits.of(scene), float(seen.angle[-1])
    place = f"{units.symbols[0]} = {quantity_text(at % math.tau if scene.has_cycle else at, units.q)}"
    after = f"comes to rest at {place} after {quantity_text(float(seen.time[-1]), 's')}" if seen.time[-1] > 0 else ""
    pair, keys = (quantity_text(moment, units.moment) for moment in (drive, loads)), run_keys(scene.input)
    moments = "{} drives it there, {} holds it (at the {})".format(*pair, "crank" if units.q == "rad" else "input")
    mend = f"use a stronger motor, a lower load, or another start ({keys.from_place}, {keys.from_speed})"
    return f"the machine {after or f'does not start at {place}'}: {moments}; {mend}"


def _no_end(scene: Scene, name: str, seen: "engine.History") -> str:
    """How a run fails to end."""
    regime, key, chosen = scene.regimes[name], f"regimes.{name}", seen.regime == name
    if not scene.has_cycle:
        return _no_end_in_range(scene, regime, seen)
    turn = math.tau * scene.input.revolutions
    angle, speed = np.abs(seen.angle[chosen] - seen.angle[chosen][0]), np.abs(seen.speed[chosen])
    last = speed[angle >= angle[-1] - turn]
    least, most = (quantity_text(float(v), "rad s-1") for v in (last.min(), last.max()))
    goes = f"it runs at {least if least == most else f'{least} … {most}'}"
    along = math.copysign(1.0, scene.input.speed) * seen.speed[chosen]
    if along.min() < 0.0:
        span = " … ".join(quantity_text(float(a), "rad") for a in (seen.angle[chosen].min(), seen.angle[chosen].max()))
        swings = (along[(along < 0.0).argmax() :] > 0.0).any()
        if regime.rest and swings:
            return f"it does not come to rest: it swings between φ = {span}; add a brake"
        doing = f"swings between φ = {span}" if swings else "accelerates backwards"
        return f"the machine {doing}: the drive is too weak for the loads; use a stronger motor or a lower load"
    short = angle[-1] < turn * (1.0 - _NEXT_TO_NOTHING)
    if (regime.rest or regime.reversal) and (short or speed[-1] < _NEXT_TO_NOTHING * speed.max()):
        return "it does not come to rest: all resistance vanishes with the speed; add a brake"
    if short:
        after = quantity_text(float(np.ptp(seen.time[chosen])), "s")
        return f"it neither ends nor starts: after {after} {goes}; change its end condition, drive or loads"
    early = angle[-1] / turn < 0.5 * min(regime.at_most, MANY_CYCLES)
    goes += f" after {angle[-1] / turn:.3g} cycles" if early else f" after {regime.at_most:g} cycles"
    raising = "" if early else f", or raise {key}.at_most"
    if regime.speed is not None:
        asked, slow = quantity_text(regime.speed, "rad s-1"), last.max() < regime.speed
        nearer = f"and closer to that speed it {'slows down' if slow else 'speeds up'}"
        goes += f", {'as in the cycle before' if scene.couplings else nearer}" if early else ""
        mend = "choose a speed that the motors reach under these loads" if slow else "add a brake"
        return f"{asked} is not reached: {goes}; {mend}{raising}"
    if regime.rest or regime.reversal:
        goes += ", and a slower machine accelerates" if early else ""
        return f"it does not come to rest: {goes}; switch off the drive or add a brake{raising}"
    return f"{key}.at_most ends it early: {goes}; raise it"


def _no_end_in_range(scene: Scene, regime: RunRegime, seen: "engine.History") -> str:
    """How a run fails to end if the input doesn't turn fully."""
    units, drive = InputUnits.of(scene), scene.input
    angle, at, speed = seen.angle[seen.regime == seen.regime[-1]], float(seen.angle[-1]), float(seen.speed[-1])
    place, pace = f"{units.symbols[0]} = {quantity_text(at, units.q)}", quantity_text(abs(speed), units.speed)
    asked = _asked_speed(scene, regime)
    reach = abs(drive.stop - drive.start)
    if asked is not None and min(abs(at - drive.start), abs(at - drive.stop)) <= _AT_END * reach:
        wanted = quantity_text(asked, units.speed)
        return f"it reaches the end of its range, {place}, at {pace}, before {wanted}"
    span = " … ".join(quantity_text(float(a), units.q) for a in (angle.min(), angle.max()))
    mend = "end it after a time, or change its drive or loads"
    return f"it moves between {units.symbols[0]} = {span} and never reaches its end (last at {pace}); {mend}"


# Grouping by regime


def by_regime(scene: Scene, names: Sequence[str]) -> dict[str, list[str]]:
    """Summary names by regime, in the scene's order, and last those of none (""): the real motion comes first.

    Parameters
    ----------
    scene : Scene
    names : sequence of str
    """
    found: dict[str, list[str]] = {regime: [] for regime in (*scene.regimes, "")}
    for name in names:
        owner = name.partition(".")[0]
        found[owner if owner in scene.regimes else ""].append(name)
    return {regime: chosen for regime, chosen in found.items() if chosen}
