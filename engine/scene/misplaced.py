"""Parts of a scene that can't work where they are; references to the wrong kind of part are rejected in `names`."""

import math
from collections.abc import Iterator
from typing import get_args

from engine import laws
from engine.parts.actions import Carried, MomentAction, Tabled, TorsionSpring
from engine.parts.formulas.by_formula import ByFormula
from engine.parts.motors import Motor
from engine.parts.regimes import OF_CRANK, OF_SLIDER, run_keys
from engine.parts.requirements import wrong_angles
from engine.parts.skeleton import FRAME, CrankInput
from engine.scene import structure
from engine.scene.attachments import geared_to_input
from engine.scene.names import wrong_reference
from engine.scene.pairs import own_drives
from engine.scene.scene import Problem, Scene
from engine.scene.structure.closing import how_to_close, is_whole


def misplaced(scene: Scene) -> list[Problem]:
    """Parts that can't work where they are, each with a remedy."""
    checks = (_shafts, _second_inputs, _one_drive, _cams, _cycles, _angle_tables, _wanted)
    checks += (_regimes, _couplings, _at_two_speeds, _machine_drives)
    return [problem for check in checks for problem in check(scene)]


def _shafts(scene: Scene) -> Iterator[Problem]:
    """Shafts on the frame, which gears drive."""
    for name, shaft in scene.shafts.items():
        at = f"shafts.{name}"
        if shaft.carrier is None and shaft.pivot is not None:
            yield from wrong_reference(scene, f"{at}.pivot", "point of the frame", shaft.pivot)
        if shaft.carrier is None and shaft.geared_to == FRAME:
            yield f"{at}.geared_to", "a shaft can't be geared to 'frame'; name a turning link"
        if name in geared_to_input(scene) and not isinstance(scene.input, CrankInput):
            yield f"{at}.geared_to", "a shaft can't be geared to a sliding input; name a turning link"


def _second_inputs(scene: Scene) -> Iterator[Problem]:
    """Second inputs whose law has no argument, doesn't close, or is driven through a moving link."""
    problems = [wrong for name in scene.inputs for wrong in (*_argument(scene, name), *_driven_by_crank(scene, name))]
    yield from problems or (_open_laws(scene) if scene.inputs else ())


def _argument(scene: Scene, name: str) -> Iterator[Problem]:
    """A second input whose law does not fit the motion of the first input."""
    second, at, slides = scene.inputs[name], f"inputs.{name}", not isinstance(scene.input, CrankInput)
    evenly = second.type == "crank" and second.ratio != 0.0
    if not slides and second.travel is not None:
        message = "needs a first input that slides, and this one turns: omit it to make the law follow the crank angle"
        yield f"{at}.travel", message
    elif slides and second.drive == "crank":
        yield f"{at}.drive", "the first input slides, there is no crank: use drive = 'own'"
    elif slides and (second.repeats or evenly) and second.travel is None and second.period is None:
        message = "the first input slides and has no angle for this law to follow: give travel, the distance it "
        yield at, f"{message}moves per turn of the law, or period, the time per turn"


def _driven_by_crank(scene: Scene, name: str) -> Iterator[Problem]:
    """A second input that the crank would drive through a moving link."""
    second = scene.inputs[name]
    key, parts = ("guide", scene.guides) if second.type == "slider" else ("pivot", scene.points)
    on = getattr(second, key)
    if isinstance(scene.input, CrankInput) and second.drive == "crank" and getattr(parts.get(on), "link", "") != FRAME:
        message = f"gears or cams between the crank and {name!r} are on the frame, but {on!r} is on a moving link; "
        yield f"inputs.{name}.drive", f"{message}set drive = 'own', or name a {key} of the frame"


def _open_laws(scene: Scene) -> Iterator[Problem]:
    """Second inputs that are not back at their start after a cycle of a crank that turns fully."""
    drive = scene.input
    if not drive.turns_fully:
        return
    of = structure.input_laws
    rates = {name: (of.law_rate(scene, name), of.drive_turns(scene, name)) for name in scene.inputs}
    needed = [part for name, second in scene.inputs.items() for part in rates[name][not second.repeats :]]
    mend = how_to_close(needed, drive.revolutions)
    cycle = f"in a cycle of {drive.revolutions} of the crank"
    for name, second in scene.inputs.items():
        periods, turns = (rate * drive.revolutions for rate in rates[name])
        if second.repeats and not is_whole(periods):
            message = f"the law of {name!r} has {abs(periods):.9g} periods {cycle}, and doesn't close: {mend}"
            yield f"inputs.{name}.period", message
        elif not is_whole(turns):
            key = "period" if second.period is not None else "sections" if second.advance else "ratio"
            key = "speed" if getattr(second, "speed", 0.0) != 0.0 else key
            message = f"{name!r} makes {turns:.9g} turns {cycle}, and doesn't return to its position: {mend}"
            yield f"inputs.{name}.{key}", message


def _one_drive(scene: Scene) -> Iterator[Problem]:
    """Parts that require a single drive, and parts that a run with a second drive ignores."""
    own = next(iter(own_drives(scene)), None)
    if own is None:
        return
    remedy = f"or let gears or cams move it, inputs.{own}.drive = 'crank'"
    counting = [f"couplings.{name}" for name in scene.couplings]
    counting += [f"regimes.{name}" for name, regime in scene.regimes.items() if regime.type == "steady"]
    counting += ["flywheel"] if scene.flywheel is not None else []
    counting += [f"elements.{name}" for name, element in scene.elements.items() if any(element.machine_needed())]
    for path in counting:
        message = f"needs a single drive, but {own!r} has its own, which supplies the torque its law needs: omit this"
        yield path, f"{message}, {remedy}"
    tables = ("links", "noncircular_wheels", "racks", "pinions", "cams", "cylinders", "friction")
    uncounted = [f"{table}.{name}" for table in tables for name in getattr(scene, table)]
    uncounted += [f"shafts.{name}.pivot" for name, shaft in scene.shafts.items() if shaft.pivot is not None]
    uncounted += [f"shafts.{name}.efficiency" for name, shaft in scene.shafts.items() if shaft.efficiency is not None]
    for name, second in scene.inputs.items():
        unlike = {"sections": second.sections, "table": second.table is not None, "drive": second.drive != "own"}
        uncounted += [f"inputs.{name}.{key}" for key, given in unlike.items() if given]
    for path in uncounted if scene.regimes else ():
        message = f"a run with {own!r}, which has its own drive, ignores this: omit regimes"
        yield path, f"{message}, {remedy}"


def _cams(scene: Scene) -> Iterator[Problem]:
    drive, taken = scene.input, {*scene.groups, *scene.links, *scene.points, *scene.regimes}
    for name, cam in scene.cams.items():
        at = f"cams.{name}"
        turns = drive.revolutions * (1.0 if cam.on == drive.link else scene.shafts[cam.on].ratio)
        if name in taken:
            yield at, f"the name {name!r} is already taken; choose another"
        if drive.turns_fully and not is_whole(turns):
            mend = how_to_close([turns / drive.revolutions], drive.revolutions)
            cycle = f"{abs(turns):g} turns in a cycle of {drive.revolutions} of the crank"
            yield f"{at}.on", f"{cam.on!r} makes {cycle}, and the cam's motion doesn't close: {mend}"
        if any(coupling.shaft == cam.on for coupling in scene.couplings.values()):
            yield f"{at}.on", f"shaft {cam.on!r} turns at a separate speed, behind a coupling; name another"


def _angle_tables(scene: Scene) -> Iterator[Problem]:
    """Tables over the angle of an input that slides, or that don't close over the cycle of a crank that turns fully."""
    tables = {f"{table}.{n}": a for table in ("forces", "moments") for n, a in getattr(scene, table).items()}
    for at, action in tables.items():
        if not isinstance(action, Tabled) or action.over_angle is None:
            continue
        if not isinstance(scene.input, CrankInput):
            yield f"{at}.over_angle", "a sliding input has no crank angle; give over_stroke or over_time"
        if not scene.has_cycle:
            continue
        if action.gives("outside"):
            message = "a table over the angle of a crank that turns fully repeats with the cycle: nothing is outside; "
            yield f"{at}.outside", f"{message}omit it, and give rows for the whole cycle, two where it jumps"
        try:
            angles, period = [math.degrees(angle) for angle in action.over_angle], 360.0 * scene.input.revolutions
            names = ("over_angle [deg]", action.ordinate)
            laws.tables.make_table(angles, action.ordinates, action.interpolation, period, names=names)
        except laws.tables.TableError as error:
            yield f"{at}.{action.ordinate}", str(error)


def _cycles(scene: Scene) -> Iterator[Problem]:
    """Parts that need an input that turns fully, or an even number of revolutions per cycle."""
    drive = scene.input
    if scene.flywheel is not None and not drive.turns_fully:
        yield "flywheel", "needs a crank that turns fully; leave it out, or input.start and input.stop"
    for name, cylinder in scene.cylinders.items():
        if cylinder.type == "four_stroke" and not (drive.turns_fully and drive.revolutions % 2 == 0):
            message = "a four-stroke engine's cycle is two turns of a crank: set input.revolutions = 2"
            yield f"cylinders.{name}.type", f"{message}, or more cycles of it where another part needs them: 4, 6, …"


def _wanted(scene: Scene) -> Iterator[Problem]:
    for name, wanted in scene.wanted.items():
        yield from wrong_angles(name, wanted, scene.input)


def _regimes(scene: Scene) -> Iterator[Problem]:
    """Regimes whose names are taken, and keys that don't apply to the input: turning fully, partly, or sliding."""
    drive, turns, own = scene.input, scene.input.turns_fully, run_keys(scene.input)
    taken = {*scene.groups, *scene.links, *scene.points, *scene.elements, *scene.cams, *scene.forces, *scene.moments}
    other, kind = (OF_SLIDER, "a sliding input") if own == OF_CRANK else (OF_CRANK, "a crank")
    for name, regime in scene.regimes.items():
        at = f"regimes.{name}"
        for action in regime.off:
            if isinstance(scene.moments.get(action), Carried):
                yield f"{at}.off", f"the mass of {action!r} always moves with the machine: leave it out of off"
        if name in taken:
            yield at, f"the name {name!r} is already taken; choose another"
        if regime.type == "steady":
            if not turns:
                message = "an input that doesn't turn fully has no cycle, so no steady motion; use type = 'run'"
                yield f"{at}.type", message
            continue
        for key, right in zip(other, own, strict=True):
            if getattr(regime, key) is not None:
                yield f"{at}.{key}", f"belongs to {kind}; use {right}"
        if turns and regime.end_of_range:
            yield f"{at}.end_of_range", "the crank turns fully; use another end, or input.start and stop"
        if own == OF_SLIDER and regime.at is not None and regime.at.angles is not None:
            yield f"{at}.at.angles", "a sliding input has no angle; give times"
        if not turns and regime.cycles is not None:
            yield f"{at}.cycles", "an input that doesn't turn fully has no cycles; use end_of_range = true"
        place = getattr(regime, own.from_place)
        if not (turns or place is None or min(drive.start, drive.stop) <= place <= max(drive.start, drive.stop)):
            yield f"{at}.{own.from_place}", "lies outside the range of the input, input.start … input.stop"


def _machine_drives(scene: Scene) -> Iterator[Problem]:
    """Machines that the elastic shaft of an element can't drive."""
    toothed = {**scene.shafts, **scene.noncircular_wheels, **scene.racks, **scene.pinions}
    lossy = scene.friction or any(part.efficiency is not None for part in toothed.values())
    motors = {n for n, moment in scene.moments.items() if isinstance(moment, Motor)}
    for name, element in scene.elements.items():
        if element.type != "machine_drive":
            continue
        at, shaft = f"elements.{name}", element.driver
        if lossy:
            yield at, "friction in pairs and mesh losses aren't computed on an elastic shaft; leave these or this out"
        if not motors:
            yield at, "no motor drives it: add one to [moments], such as type = 'dc_motor'"
        elif not motors - set(element.off):
            yield f"{at}.off", "every motor is off; leave one on"
        if shaft is not None and scene.shafts[shaft].inertia == 0.0:
            yield f"{at}.driver", f"shafts.{shaft}.inertia = 0: the motors' end needs inertia; give it"
        for load, moment in scene.moments.items():
            if isinstance(moment, Carried) and moment.on == shaft:
                yield f"{at}.driver", f"{load!r} moves other masses with this shaft; name another"


# Moments that depend on more than the speed of their shaft.
_NOT_BY_SPEED = (Tabled, ByFormula, TorsionSpring, Carried)


def _couplings(scene: Scene) -> Iterator[Problem]:
    for i, (name, coupling) in enumerate(scene.couplings.items()):
        shaft, on_shaft = coupling.shaft, {n: m for n, m in scene.moments.items() if m.on == coupling.shaft}
        speed = f"shaft {shaft!r} turns at a separate speed, behind coupling {name!r}"
        if i > 0:
            yield f"couplings.{name}", "a machine can have at most two speeds: keep only one coupling"
        elif scene.regimes and not scene.has_cycle:
            message = "motion at two speeds needs a crank that turns fully; omit it, or input.start and input.stop"
            yield f"couplings.{name}", message
        elif scene.shafts[shaft].pivot is not None:
            message = f"shaft {shaft!r} has a pivot and carries points, which a shaft behind a coupling can't"
            yield f"couplings.{name}.shaft", message
        for other, own in scene.shafts.items():
            if own.geared_to == shaft:
                yield f"shafts.{other}.geared_to", f"{speed}; name another"
        for load, moment in on_shaft.items():
            if isinstance(moment, _NOT_BY_SPEED):
                kinds = [kind for kind in get_args(get_args(MomentAction)[0]) if not issubclass(kind, _NOT_BY_SPEED)]
                allowed = ", ".join(get_args(kind.model_fields["type"].annotation)[0] for kind in kinds)
                message = f"{speed}, and a moment on it may depend on that speed only; allowed: {allowed}"
                yield f"moments.{load}.type", message
        if len({n in on_shaft for n, m in scene.moments.items() if isinstance(m, Motor)}) == 2:
            yield f"couplings.{name}", "motors are on both of its sides; put them on one"


def _at_two_speeds(scene: Scene) -> Iterator[Problem]:
    """Regimes that need a coupling, or an engaged clutch."""
    clutches = {name for name, coupling in scene.couplings.items() if coupling.type == "friction_clutch"}
    for name, regime in scene.regimes.items():
        at = f"regimes.{name}"
        if regime.type == "steady":
            if set(scene.couplings) & set(regime.off):
                message = "with its coupling open a machine has two independent motions; use a run"
                yield f"{at}.type", message
            continue
        if regime.lock_up and not clutches - set(regime.off):
            yield f"{at}.lock_up", "no friction clutch is engaged here; give another end"
        if regime.at is not None and scene.couplings:
            message = "fields of a run at the two speeds of a coupling aren't kept; `sweeps export --history` has them"
            yield f"{at}.at", message
        if regime.from_shaft_speed is not None and not scene.couplings:
            message = "no shaft has a separate speed: the scene has no coupling; use from_speed"
            yield f"{at}.from_shaft_speed", message
