"""The regimes of a scene in words: what each does, what is worth asking of it, and where one goes wrong."""

import math
from collections.abc import Sequence

import numpy as np

from engine import SENTENCES, History, RunRegime, Scene, Verdict, history
from sweeps.text.engineer_units import quantity_text

# Verdicts that only a motion gets.
MOTION_VERDICTS = (
    *(Verdict.STALLS, Verdict.RUNS_AWAY, Verdict.NO_END, Verdict.ANY_SPEED, Verdict.LOCKS, Verdict.NO_INERTIA),
    Verdict.SLIPS,
    Verdict.TOO_COARSE,
)
# Positions in a cycle of a history that is made to see where a motion fails.
STEPS = 240
# A run abandoned after at least this many cycles was still moving; the history of a longer one may be cut.
MANY_CYCLES = 1000


def regime_words(scene: Scene, name: str) -> str:
    """What a regime does, such as "run from rest until 38 rpm; off: punching".

    Parameters
    ----------
    scene : Scene
    name : str
    """
    regime = scene.regimes[name]
    doing = "the motion that repeats itself every cycle"
    if isinstance(regime, RunRegime):
        doing = f"run from {_begin(scene, name, regime)} {_end(regime)}"
    return doing + (f"; off: {', '.join(regime.off)}" if regime.off else "")


def _begin(scene: Scene, name: str, regime: RunRegime) -> str:
    before = list(scene.regimes)[: list(scene.regimes).index(name)]
    begin = f"where {before[-1]} ended" if before else "rest"
    if regime.from_speed is not None:
        begin = "rest" if regime.from_speed == 0 else quantity_text(regime.from_speed, "rad s-1")
    if regime.from_shaft_speed is not None:
        shaft = next(iter(scene.couplings.values())).shaft
        begin += f", {shaft} from {quantity_text(regime.from_shaft_speed, 'rad s-1')}"
    return begin + ("" if regime.from_angle is None else f" at φ = {quantity_text(regime.from_angle, 'rad')}")


def _end(regime: RunRegime) -> str:
    if regime.cycles is not None:
        return f"for {regime.cycles:g} cycle{'' if regime.cycles == 1 else 's'}"
    if regime.lock_up:
        return "until the clutch holds"
    if regime.time is not None:
        return f"for {quantity_text(regime.time, 's')}"
    return "to rest" if regime.rest else f"until {quantity_text(regime.speed, 'rad s-1')}"


# Where a motion fails


def failure_text(scene: Scene, verdict: Verdict, seen: History | None = None) -> str:
    """Which regime of a machine fails, where and how, and what to change.

    Parameters
    ----------
    scene : Scene
        Of the machine, its numbers in place.
    verdict : Verdict
        On the machine.
    seen : History, optional
        Its history, if it is known already.
    """
    seen = history(scene, STEPS) if seen is None else seen
    if seen.verdict == Verdict.OK:
        # Near a limit the number of steps decides, and a flywheel may have been sized that the scene doesn't have.
        return f"{SENTENCES[verdict]} (over {STEPS} positions, with the flywheel of the scene, it runs)"
    name = str(seen.regime[-1])
    if seen.verdict == Verdict.NO_END:
        return f"regime {name}: {_no_end(scene, name, seen)}"
    if seen.verdict == Verdict.STALLS and isinstance(scene.regimes[name], RunRegime):
        return f"regime {name}: {_stands(scene, seen)}"
    if seen.verdict == Verdict.LOCKS:
        off = scene.regimes[name].off
        brakes = [n for n, m in scene.moments.items() if n not in off and m.type == "band_brake"]
        return f"regime {name}, {' or '.join(brakes)}: {SENTENCES[seen.verdict]}"
    return f"regime {name}: {SENTENCES[seen.verdict]}"


def _stands(scene: Scene, seen: History) -> str:
    """Where a machine stands still, and which moments leave it there."""
    way = math.copysign(1.0, scene.input.speed)
    drive = way * float(seen.motor_moment[-1] + seen.load_moments["driving"][-1])
    loads = -way * float(sum(row[-1] for channel, row in seen.load_moments.items() if channel != "driving"))
    place = f"φ = {quantity_text(float(seen.angle[-1]) % (2 * math.pi), 'rad')}"
    after = f"comes to rest at {place} after {quantity_text(float(seen.time[-1]), 's')}" if seen.time[-1] > 0 else ""
    moments = f"{quantity_text(drive, 'N m')} drive it there, {quantity_text(loads, 'N m')} hold it (on the crank)"
    mend = "a stronger motor, a lower load, or another begin (from_angle, from_speed) helps"
    return f"the machine {after or f'does not start at {place}'}: {moments}; {mend}"


def _no_end(scene: Scene, name: str, seen: History) -> str:
    """What a run does instead of ending."""
    regime, key, chosen = scene.regimes[name], f"regimes.{name}", seen.regime == name
    turn = 2 * math.pi * scene.input.revolutions
    angle, speed = np.abs(seen.angle[chosen] - seen.angle[chosen][0]), np.abs(seen.speed[chosen])
    last = speed[angle >= angle[-1] - turn]
    least, most = (quantity_text(float(v), "rad s-1") for v in (last.min(), last.max()))
    goes = f"it goes at {least if least == most else f'{least} … {most}'}"
    along = math.copysign(1.0, scene.input.speed) * seen.speed[chosen]
    if along.min() < 0.0:
        span = " … ".join(quantity_text(float(a), "rad") for a in (seen.angle[chosen].min(), seen.angle[chosen].max()))
        swings = (along[(along < 0.0).argmax() :] > 0.0).any()
        doing = f"swings back and forth between φ = {span}" if swings else "turns backwards, ever faster"
        return f"the machine {doing}: what drives it doesn't carry its loads; a stronger motor or a lower load helps"
    if regime.rest and angle[-1] / turn < 0.5 * min(regime.at_most, MANY_CYCLES):
        return "it doesn't come to rest: all that slows it vanishes with the speed; brake it"
    if angle[-1] / turn < 0.5 * min(regime.at_most, MANY_CYCLES):
        after = quantity_text(float(np.ptp(seen.time[chosen])), "s")
        return f"it neither ends nor gets going: after {after} {goes}; change its end, or what drives and loads it"
    goes += f" after {regime.at_most:g} cycles"
    if regime.speed is not None:
        asked = quantity_text(regime.speed, "rad s-1")
        mend = "ask for a speed that its motors reach with these loads" if last.max() < regime.speed else "brake it"
        return f"the speed of {asked} isn't reached: {goes}; {mend}, or raise {key}.at_most"
    if regime.rest:
        return f"it doesn't come to rest: {goes}; switch off what drives it, brake it, or raise {key}.at_most"
    return f"{key}.at_most comes before its end: {goes}; raise it"


# Names by regime


def by_regime(scene: Scene, names: Sequence[str]) -> dict[str, list[str]]:
    """Names of summaries by the regime they belong to, "" for those of none, in the order of the scene.

    Parameters
    ----------
    scene : Scene
    names : sequence of str
    """
    found: dict[str, list[str]] = {"": [], **{regime: [] for regime in scene.regimes}}
    for name in names:
        owner = name.partition(".")[0]
        found[owner if owner in scene.regimes else ""].append(name)
    return {regime: chosen for regime, chosen in found.items() if chosen}
