"""The names in a scene: what each denotes, what refers to it, and which parts may carry which."""

import math
from typing import get_args

from engine import laws
from engine.parts.actions import Carried, MomentAction, Motor, Tabled, TorsionSpring
from engine.parts.regimes import OF_CRANK, OF_SLIDER, Regime, run_keys
from engine.parts.skeleton import FRAME, CrankInput, Group, SliderInput, Sliding, Yoke
from engine.parts.wanted_motion import wrong_angles
from engine.scene.scene import Scene, SceneError, once
from engine.scene.structure.closing import how_to_close, is_whole
from engine.scene.structure.input_laws import drive_turns, law_rate
from engine.words.glossary import did_you_mean

Problem = tuple[str, str]


def input_point(scene: Scene) -> str:
    """Name of the point moved by the input link: the crank's pin, or the sliding input's point."""
    return scene.input.pin if isinstance(scene.input, CrankInput) else scene.input.point


@once
def definitions(scene: Scene) -> tuple[dict[str, str], dict[str, str], dict[str, str]]:
    """Path at which each point, guide and link is defined.

    Raises
    ------
    SceneError
        A name is defined twice, or a link is moved by two groups (over-constrained).
    """
    problems: list[tuple[str, str]] = []
    points: dict[str, str] = {}
    guides: dict[str, str] = {}
    links: dict[str, str] = {FRAME: FRAME}
    everything: dict[str, str] = {FRAME: "the frame"}

    def define(kind: dict[str, str], name: str, path: str) -> None:
        if kind is links and name in links and name != FRAME:
            problems.append(
                (
                    path,
                    f"link {name!r} is already moved by {links[name]}: over-constrained (W < 1); "
                    "a link belongs to one group",
                )
            )
        elif name in everything:
            problems.append((path, f"the name {name!r} is already taken by {everything[name]}; choose another"))
        kind.setdefault(name, path)
        everything.setdefault(name, path)

    define(links, scene.input.link, "input.link")
    define(points, input_point(scene), "input.pin" if isinstance(scene.input, CrankInput) else "input.point")
    for name, group in scene.groups.items():
        for side in ("first", "second"):
            define(links, getattr(group, side).link, f"groups.{name}.{side}.link")
        if hasattr(group, "inner"):
            define(points, group.inner, f"groups.{name}.inner")
    for name in scene.links:
        define(links, name, f"links.{name}")
    for name in scene.shafts:
        define(links, name, f"shafts.{name}")
    for table in ("inputs", "noncircular_wheels", "racks", "pinions"):
        for name in getattr(scene, table):
            define(links, name, f"{table}.{name}")
    for name, cam in scene.cams.items():
        define(links, cam.follower.link, f"cams.{name}.follower.link")
    for name in scene.points:
        define(points, name, f"points.{name}")
    for name, link in scene.links.items():
        for joint in link.joints:
            if joint not in points:
                define(points, joint, f"links.{name}.joints")
    for name in scene.guides:
        define(guides, name, f"guides.{name}")
    for table in (
        "cams",
        "forces",
        "moments",
        "springs",
        "cylinders",
        "couplings",
        "pins",
        "struts",
        "wanted",
        "elements",
    ):
        for name in getattr(scene, table):
            define({}, name, f"{table}.{name}")
    if problems:
        raise SceneError(problems)
    return points, guides, links


def acting(scene: Scene) -> set[str]:
    """Names of all actions on the machine, which a regime may switch off."""
    return {"gravity", *scene.forces, *scene.moments, *scene.springs, *scene.cylinders, *scene.couplings}


@once
def sliders(scene: Scene) -> tuple[str, ...]:
    """Links with a slide coordinate: on a guide, or, for a block, in the slot of the other link of its group."""
    found = [] if isinstance(scene.input, CrankInput) else [scene.input.link]
    for group in scene.groups.values():
        found += [part.link for part in (group.first, group.second) if isinstance(part, (Sliding, Yoke))]
        if group.type in ("RPR", "RPP"):
            found.append(group.first.link)
    found += [name for name, link in scene.links.items() if link.guide is not None]
    found += [cam.follower.link for cam in scene.cams.values() if cam.translating]
    found += [name for name, second in scene.inputs.items() if second.type == "slider"]
    return (*found, *scene.racks)


def guide_of(scene: Scene, link: str) -> str | None:
    """Guide on which a link slides; None for a turning link, and for a block in a slot."""
    if link == scene.input.link:
        return None if isinstance(scene.input, CrankInput) else scene.input.guide
    for group in scene.groups.values():
        for part in (group.first, group.second):
            if part.link == link:
                return part.guide if isinstance(part, (Sliding, Yoke)) else None
    for cam in scene.cams.values():
        if cam.follower.link == link:
            return cam.follower.guide if cam.translating else None
    return getattr({**scene.links, **scene.racks, **scene.inputs}.get(link), "guide", None)


def inner_link(group: Group) -> str:
    """Link that carries the inner joint of a group, of the two that meet there: the sliding one, else the first."""
    return group.second.link if group.type == "RRP" else group.first.link


@once
def joint_owners(scene: Scene) -> dict[str, str]:
    """Link that carries each joint named by free links: the joint's own link, or the first free link to name it."""
    owners = {input_point(scene): scene.input.link}
    for group in scene.groups.values():
        if hasattr(group, "inner"):
            owners[group.inner] = inner_link(group)
    owners |= {name: point.link for name, point in scene.points.items()}
    for name, link in scene.links.items():
        for joint in link.joints:
            owners.setdefault(joint, name)
    return {joint: owners[joint] for link in scene.links.values() for joint in link.joints}


def misplaced(scene: Scene) -> list[Problem]:
    """Parts that are attached to something that can't carry them."""
    checks = (
        _off_the_frame,
        _wrong_shafts,
        _wrong_inputs,
        _wrong_cams,
        _wrong_bodies,
        _wrong_moments,
        _no_stroke,
        _no_cycle,
    )
    checks += (_open_tables, _wrong_wanted, _wrong_regimes, _wrong_couplings, _wrong_at_two_speeds, _wrong_drives)
    return [problem for check in checks for problem in check(scene)]


def _geared_to_input(scene: Scene) -> set[str]:
    return {n for n, s in scene.shafts.items() if s.geared_to == scene.input.link and s.carrier is None}


@once
def turning_evenly(scene: Scene) -> set[str]:
    """Links whose angle is a multiple of the crank's: the crank, and pivoted shafts geared to it through all gears."""
    if not isinstance(scene.input, CrankInput):
        return set()
    even, grown = {FRAME, scene.input.link}, True
    while grown:
        known = {n for n, s in scene.shafts.items() if s.pivot and {s.geared_to, s.carrier or FRAME} <= even}
        grown, even = not known <= even, even | known
    return even - {FRAME}


def _off_the_frame(scene: Scene) -> list[Problem]:
    on_frame = {name for name, point in scene.points.items() if point.link == FRAME}
    pivots = [("input.pivot", scene.input.pivot)] if isinstance(scene.input, CrankInput) else []
    fixed = {n: s.pivot for n, s in scene.shafts.items() if s.pivot is not None and s.carrier is None}
    pivots += [(f"shafts.{n}.pivot", pivot) for n, pivot in fixed.items()]
    pivots += [(f"noncircular_wheels.{n}.pivot", wheel.pivot) for n, wheel in scene.noncircular_wheels.items()]
    pivots += [(f"cams.{n}.follower.pivot", c.follower.pivot) for n, c in scene.cams.items() if not c.translating]
    pivots += [("balance.about", scene.balance.about)] if scene.balance is not None else []
    problems = [
        (path, f"{name!r} is not on the frame; " + did_you_mean(name, on_frame))
        for path, name in pivots
        if name not in on_frame
    ]
    if not isinstance(scene.input, CrankInput) and scene.guides[scene.input.guide].link != FRAME:
        problems.append(
            ("input.guide", f"{scene.input.guide!r} is on a moving link; the input's guide must be on the frame")
        )
    return problems


def _wrong_shafts(scene: Scene) -> list[Problem]:
    """Shafts on the frame that are not driven by gears."""
    problems, geared = [], _geared_to_input(scene)
    for name, shaft in scene.shafts.items():
        if shaft.carrier is None and shaft.geared_to == FRAME:
            problems.append((f"shafts.{name}.geared_to", "a shaft can't be geared to 'frame'; name a turning link"))
        if name in geared and not isinstance(scene.input, CrankInput):
            problems.append(
                (f"shafts.{name}.geared_to", "a shaft can't be geared to a sliding input; name a turning link")
            )
    return problems


def _wrong_inputs(scene: Scene) -> list[Problem]:
    """Second inputs whose law has no argument or doesn't close, and parts that require a single drive."""
    if not scene.inputs:
        return []
    problems = []
    for name, second in scene.inputs.items():
        problems += _wrong_argument(scene, name) or _wrong_train(scene, name)
        if second.type == "slider":
            continue
        carried = {input_point(scene), *scene.points}
        if second.pivot not in carried:
            message = f"{second.pivot!r} is a joint of two links, and the drive stands on one: name a point of that; "
            problems.append((f"inputs.{name}.pivot", message + did_you_mean(second.pivot, carried)))
    problems += [] if problems else _open_laws(scene)
    own = [name for name, second in scene.inputs.items() if second.drive == "own"]
    if not own:
        return problems
    alone = f"counts on one drive, and {own[0]!r} has its own, which gives what moment its law needs: leave this out, "
    alone += f"or let gears or cams move it, inputs.{own[0]}.drive = 'crank'"
    problems += [(f"{table}.{n}", alone) for table in ("regimes", "couplings") for n in getattr(scene, table)]
    problems += [(f"moments.{n}", alone) for n, m in scene.moments.items() if isinstance(m, Motor)]
    problems += [("flywheel", alone)] if scene.flywheel is not None else []
    for name, element in scene.elements.items():
        if any(element.machine_needed()):
            problems.append((f"elements.{name}", alone))
    return problems


def _wrong_argument(scene: Scene, name: str) -> list[Problem]:
    """A second input whose law does not fit the motion of the first input."""
    second, at, slides = scene.inputs[name], f"inputs.{name}", not isinstance(scene.input, CrankInput)
    if not slides and second.travel is not None:
        message = "is of a first input that slides, and this one turns: leave it out, for a law of the crank's angle"
        return [(f"{at}.travel", message)]
    if slides and second.drive == "crank":
        return [(f"{at}.drive", "the first input slides, there is no crank: use drive = 'own'")]
    evenly = second.type == "crank" and second.ratio != 0.0
    if slides and (second.repeats or evenly) and second.travel is None and second.period is None:
        message = "the first input slides and has no angle that this law could be of: give travel, the length that it "
        return [(at, f"{message}moves while the law goes through a turn, or period, the time")]
    return []


def _open_laws(scene: Scene) -> list[Problem]:
    """Second inputs that are not back at their start after a cycle of a crank that turns fully."""
    drive, problems = scene.input, []
    if not drive.turns_fully:
        return []
    rates = {name: (law_rate(scene, name), drive_turns(scene, name)) for name in scene.inputs}
    needed = [part for name, second in scene.inputs.items() for part in rates[name][not second.repeats :]]
    mend = how_to_close(needed, drive.revolutions)
    cycle = f"in a cycle of {drive.revolutions} of the crank"
    for name, second in scene.inputs.items():
        periods, turns = (rate * drive.revolutions for rate in rates[name])
        if second.repeats and not is_whole(periods):
            message = f"the law of {name!r} has {abs(periods):.9g} periods {cycle}, and doesn't close: {mend}"
            problems.append((f"inputs.{name}.period", message))
        elif not is_whole(turns):
            key = "period" if second.period is not None else "sections" if second.advance else "ratio"
            key = "speed" if getattr(second, "speed", 0.0) != 0.0 else key
            message = f"{name!r} makes {turns:.9g} turns {cycle}, and doesn't come back to its place: {mend}"
            problems.append((f"inputs.{name}.{key}", message))
    return problems


def _wrong_train(scene: Scene, name: str) -> list[Problem]:
    """A second input that the crank would drive through a moving link."""
    second = scene.inputs[name]
    key, parts = ("guide", scene.guides) if second.type == "slider" else ("pivot", scene.points)
    held = getattr(second, key)
    if second.drive == "own" or getattr(parts.get(held), "link", None) == FRAME:
        return []
    message = f"gears or cams between the crank and {name!r} stand on the frame, and {held!r} is on a moving link; "
    return [(f"inputs.{name}.drive", f"{message}give it a drive of its own, or name a {key} of the frame")]


def _wrong_cams(scene: Scene) -> list[Problem]:
    problems, drive = [], scene.input
    carriers = {n: scene.shafts[n].ratio for n in _geared_to_input(scene) if scene.shafts[n].pivot is not None}
    carriers |= {drive.link: 1.0} if isinstance(drive, CrankInput) else {}
    taken = {*scene.groups, *scene.links, *scene.points, *scene.regimes}
    for name, cam in scene.cams.items():
        at = f"cams.{name}"
        if name in taken:
            problems.append((at, f"the name {name!r} is already taken; choose another"))
        if cam.translating and scene.guides[cam.follower.guide].link != FRAME:
            message = f"{cam.follower.guide!r} is on a moving link; a cam's follower slides on a guide of the frame"
            problems.append((f"{at}.follower.guide", message))
        if cam.on not in carriers:
            allowed = ", ".join(sorted(carriers)) or "none, as the input slides"
            message = f"a cam sits on the crank or on a shaft with a pivot that is geared to it; such are: {allowed}"
            problems.append((f"{at}.on", message))
        elif drive.turns_fully and not is_whole(carriers[cam.on] * drive.revolutions):
            message = (
                f"{cam.on!r} makes {abs(carriers[cam.on] * drive.revolutions):g} turns in a cycle of "
                f"{drive.revolutions} of the crank, and the cam's motion doesn't close: "
            )
            message += how_to_close([carriers[cam.on]], drive.revolutions)
            problems.append((f"{at}.on", message))
        if any(coupling.shaft == cam.on for coupling in scene.couplings.values()):
            problems.append((f"{at}.on", f"shaft {cam.on!r} turns at a speed of its own, by a coupling; name another"))
    return problems


def _loose_shafts(scene: Scene) -> set[str]:
    return {n for n, s in scene.shafts.items() if s.pivot is None}


def _wrong_bodies(scene: Scene) -> list[Problem]:
    problems, loose = [], _loose_shafts(scene)
    for table in ("points", "guides", "bodies"):
        for name, part in getattr(scene, table).items():
            path = f"{table}.{name}.link"
            if part.link in loose:
                problems.append((path, f"shaft {part.link!r} has no pivot; give it one, or use the shaft's inertia"))
            if table == "bodies" and part.link == FRAME:
                problems.append((path, "a body on the frame doesn't move and has no effect; name a moving link"))
    return problems


@once
def still_links(scene: Scene) -> set[str]:
    """Links that never turn: the frame, and links that slide on guides of links that never turn."""
    still = {FRAME} if isinstance(scene.input, CrankInput) else {FRAME, scene.input.link}
    grown = True
    while grown:
        found = set(still)
        for group in scene.groups.values():
            for part in (group.first, group.second):
                if isinstance(part, (Sliding, Yoke)) and scene.guides[part.guide].link in still:
                    found.add(part.link)
            if group.type == "RPP" and group.second.link in still:
                found.add(group.first.link)
        for name, link in scene.links.items():
            if link.guide is not None and scene.guides[link.guide].link in still:
                found.add(name)
        on_guides = {**scene.racks, **{n: second for n, second in scene.inputs.items() if second.type == "slider"}}
        found |= {name for name, part in on_guides.items() if scene.guides[part.guide].link in still}
        found |= {cam.follower.link for cam in scene.cams.values() if cam.translating}
        grown, still = found != still, found
    return still


def _wrong_moments(scene: Scene) -> list[Problem]:
    problems, loose, still = [], _loose_shafts(scene), still_links(scene)
    turning = {scene.input.link} if isinstance(scene.input, CrankInput) else set()
    driven = turning | _geared_to_input(scene)
    for name, moment in scene.moments.items():
        path = f"moments.{name}.on"
        if isinstance(moment, Motor) and moment.on not in driven:
            allowed = ", ".join(sorted(driven)) or "none, as the input slides"
            problems.append(
                (path, f"a motor drives the crank or a shaft geared to it, not {moment.on!r}; allowed: {allowed}")
            )
        elif isinstance(moment, Carried) and moment.on not in {*turning, *scene.shafts}:
            allowed = ", ".join(sorted({*turning, *scene.shafts})) or "none: add a shaft to [shafts]"
            problems.append(
                (path, f"a {moment.type} is on the crank or on a shaft, not on {moment.on!r}; allowed: {allowed}")
            )
        elif moment.on in still:
            problems.append((path, f"{moment.on!r} doesn't turn: a moment on it does no work; name a turning link"))
        elif isinstance(moment, TorsionSpring) and moment.on in loose:
            problems.append((path, f"shaft {moment.on!r} has no angle; give it a pivot, or name another link"))
    return problems


def _no_stroke(scene: Scene) -> list[Problem]:
    slide = set(sliders(scene))
    named = [(f"cylinders.{n}.piston", c.piston) for n, c in scene.cylinders.items()]
    named += [(f"wanted.{n}.of", wanted.of) for n, wanted in scene.wanted.items() if wanted.type == "slider"]
    for table in ("forces", "moments"):
        for name, action in getattr(scene, table).items():
            if isinstance(action, Tabled) and action.slider is not None:
                named.append((f"{table}.{name}.slider", action.slider))
        for name, action in getattr(scene, table).items():
            if isinstance(action, Tabled) and action.over_angle is not None and not isinstance(scene.input, CrankInput):
                path = f"{table}.{name}.over_angle"
                return [(path, "a sliding input has no crank angle; give over_stroke or over_time")]
    listed = ", ".join(sorted(slide)) or "none"
    return [(path, f"{link!r} doesn't slide; sliders are: {listed}") for path, link in named if link not in slide]


def _no_cycle(scene: Scene) -> list[Problem]:
    """Parts that need an input that turns fully, or an even number of revolutions per cycle."""
    drive, problems = scene.input, []
    turns = drive.turns_fully
    if scene.flywheel is not None and not turns:
        problems.append(("flywheel", "needs a crank that turns fully; leave it out, or input.start and input.stop"))
    for name, cylinder in scene.cylinders.items():
        path = f"cylinders.{name}.type"
        if cylinder.type == "four_stroke" and not (turns and drive.revolutions % 2 == 0):
            message = "a four-stroke engine's cycle is two turns of a crank: set input.revolutions = 2"
            problems.append((path, f"{message}, or more cycles of it where another part needs them: 4, 6, …"))
    return problems


def _open_tables(scene: Scene) -> list[Problem]:
    """Tables over the angle that don't close over the cycle of a crank that turns fully."""
    drive, problems = scene.input, []
    if not drive.turns_fully:
        return []
    for table, ordinate in (("forces", "force"), ("moments", "moment")):
        for name, action in getattr(scene, table).items():
            if isinstance(action, Tabled) and action.over_angle is not None:
                if action.gives("outside"):
                    message = "a table over the angle of a crank that turns fully repeats with the cycle, and has no "
                    message += "outside; leave it out, and give rows for all of the cycle, two where it jumps"
                    problems.append((f"{table}.{name}.outside", message))
                try:
                    angles, period = [math.degrees(angle) for angle in action.over_angle], 360.0 * drive.revolutions
                    names = ("over_angle [deg]", ordinate)
                    laws.tables.make_table(angles, action.ordinates, action.interpolation, period, names=names)
                except laws.tables.TableError as error:
                    problems.append((f"{table}.{name}.{ordinate}", str(error)))
    return problems


def _wrong_wanted(scene: Scene) -> list[Problem]:
    problems = []
    for name, wanted in scene.wanted.items():
        problems += wrong_angles(name, wanted, scene.input)
        if wanted.type == "path" and wanted.point in scene.points and scene.points[wanted.point].link == FRAME:
            problems.append((f"wanted.{name}.point", f"{wanted.point!r} is at rest on the frame; name a moving point"))
        if wanted.type == "link" and wanted.of == FRAME:
            problems.append((f"wanted.{name}.of", "the frame doesn't turn; name a link that does"))
    return problems


def _wrong_regimes(scene: Scene) -> list[Problem]:
    drive, problems = scene.input, []
    for name, regime in scene.regimes.items():
        at = f"regimes.{name}"
        problems += [
            (f"{at}.off", f"the mass of {action!r} always goes along: it can't be off")
            for action in regime.off
            if isinstance(scene.moments.get(action), Carried)
        ]
        taken = {*scene.groups, *scene.links, *scene.points, *scene.elements, *scene.cams}
        if name in scene.forces or name in scene.moments or name in taken:
            problems.append((at, f"the name {name!r} is already taken; choose another"))
        problems += _wrong_for_range(drive, name, regime)
    return problems


def _wrong_for_range(drive: CrankInput | SliderInput, name: str, regime: Regime) -> list[Problem]:
    """Keys of a regime that do not apply to its input: one that turns fully, one that doesn't, one that slides."""
    at, turns = f"regimes.{name}", drive.turns_fully
    if regime.type == "steady":
        message = "an input that doesn't turn fully has no cycle, so no steady motion; use type = 'run'"
        return [] if turns else [(f"{at}.type", message)]
    own = run_keys(drive)
    other, kind = (OF_SLIDER, "a sliding input") if own == OF_CRANK else (OF_CRANK, "a crank")
    problems = [
        (f"{at}.{key}", f"belongs to {kind}; use {right}")
        for key, right in zip(other, own, strict=True)
        if getattr(regime, key) is not None
    ]
    if turns and regime.end_of_range:
        problems.append((f"{at}.end_of_range", "the crank turns fully; use another end, or input.start and stop"))
    if own == OF_SLIDER and regime.at is not None and regime.at.angles is not None:
        problems.append((f"{at}.at.angles", "a sliding input turns no angle; give times"))
    if not turns and regime.cycles is not None:
        problems.append((f"{at}.cycles", "an input that doesn't turn fully has no cycles; use end_of_range = true"))
    place = getattr(regime, own.from_place)
    if not turns and place is not None and not min(drive.start, drive.stop) <= place <= max(drive.start, drive.stop):
        problems.append((f"{at}.{own.from_place}", "lies outside the range of the input, input.start … input.stop"))
    return problems


def _wrong_drives(scene: Scene) -> list[Problem]:
    """Machines that the elastic shaft of an element can't drive."""
    problems = []
    for name, element in scene.elements.items():
        if element.type != "machine_drive":
            continue
        at, off = f"elements.{name}", set(element.off)
        toothed = {**scene.shafts, **scene.noncircular_wheels, **scene.racks, **scene.pinions}
        if scene.friction or any(part.efficiency is not None for part in toothed.values()):
            lost = "friction in pairs and losses of teeth aren't counted on an elastic shaft; leave these or this out"
            problems.append((at, lost))
        motors = {n for n, moment in scene.moments.items() if isinstance(moment, Motor)}
        if not motors:
            problems.append((at, "no motor drives it: add one to [moments], such as type = 'dc_motor'"))
        elif not motors - off:
            problems.append((f"{at}.off", "every motor is off; leave one on"))
        geared = _geared_to_input(scene)
        if element.driver is not None and element.driver not in geared:
            message = f"{element.driver!r} is not a shaft geared to the crank; " + did_you_mean(element.driver, geared)
            problems.append((f"{at}.driver", message))
        elif element.driver is not None and scene.shafts[element.driver].inertia == 0.0:
            problems.append((f"{at}.driver", f"shafts.{element.driver}.inertia = 0: the motors' end needs inertia"))
        carried = [n for n, m in scene.moments.items() if isinstance(m, Carried) and m.on == element.driver]
        if carried:
            problems.append((f"{at}.driver", f"{carried[0]!r} moves masses of its own with this shaft; name another"))
    return problems


def _by_speed_alone() -> list[str]:
    """Types of moments that depend on nothing but the speed of their shaft."""
    kinds = get_args(get_args(MomentAction)[0])
    return [get_args(kind.model_fields["type"].annotation)[0] for kind in kinds if kind.by_speed_alone]


def _wrong_couplings(scene: Scene) -> list[Problem]:
    problems, geared = [], _geared_to_input(scene)
    for i, (name, coupling) in enumerate(scene.couplings.items()):
        path, shaft = f"couplings.{name}.shaft", coupling.shaft
        if i > 0:
            problems.append((f"couplings.{name}", "a machine goes at two speeds at most: leave one coupling"))
        elif shaft not in geared:
            allowed = ", ".join(sorted(geared)) or "none: add one to [shafts]"
            problems.append((path, f"a coupling joins the crank to a shaft geared to it; such are: {allowed}"))
        elif scene.regimes and not scene.input.turns_fully:
            message = "motion at two speeds needs a crank that turns fully; leave it, or input.start and input.stop"
            problems.append((f"couplings.{name}", message))
        elif scene.shafts[shaft].pivot is not None:
            problems.append((path, f"shaft {shaft!r} has a pivot and carries points; behind a coupling it can't"))
        problems += [
            (f"shafts.{other}.geared_to", f"{shaft!r} turns at a speed of its own, by coupling {name!r}; name another")
            for other, own in scene.shafts.items()
            if own.geared_to == shaft
        ]
        on_shaft = {n: moment for n, moment in scene.moments.items() if moment.on == shaft}
        problems += [
            (
                f"moments.{n}.type",
                f"shaft {shaft!r} turns at a speed of its own, by coupling {name!r}, and a moment on it may depend on "
                f"that speed alone; allowed: {', '.join(_by_speed_alone())}",
            )
            for n, moment in on_shaft.items()
            if not moment.by_speed_alone
        ]
        sides = {n in on_shaft for n, m in scene.moments.items() if isinstance(m, Motor)}
        if len(sides) == 2:
            problems.append((f"couplings.{name}", "motors are on both of its sides; put them on one"))
    return problems


def _wrong_at_two_speeds(scene: Scene) -> list[Problem]:
    """Regimes that need a coupling, or an engaged clutch."""
    problems: list[Problem] = []
    clutches = {name for name, coupling in scene.couplings.items() if coupling.type == "friction_clutch"}
    for name, regime in scene.regimes.items():
        if regime.type == "steady":
            if set(scene.couplings) & set(regime.off):
                message = "with its coupling open a machine has two motions that know nothing of each other; use a run"
                problems.append((f"regimes.{name}.type", message))
            continue
        if regime.lock_up and not clutches - set(regime.off):
            problems.append((f"regimes.{name}.lock_up", "no friction clutch is engaged here; give another end"))
        if regime.at is not None and scene.couplings:
            message = "fields of a run at the two speeds of a coupling aren't kept; `sweeps export --history` has them"
            problems.append((f"regimes.{name}.at", message))
        if regime.from_shaft_speed is not None and not scene.couplings:
            message = "no shaft has a speed of its own: the scene has no coupling; use from_speed"
            problems.append((f"regimes.{name}.from_shaft_speed", message))
    return problems
