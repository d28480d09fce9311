"""Report on what a study will compute, what is skipped, and the cost."""

import math
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import engine
from sweeps.report import accuracy_words
from sweeps.report.answers.shown_results import answers_among, lacks_lines, names_in_conditions
from sweeps.report.answers.unmet_conditions import drop_lines, outside_lines
from sweeps.report.readings import assembled_text
from sweeps.report.regime_words import MOTION_VERDICTS, by_regime, failure_text, part_words, regime_words
from sweeps.report.variant_warnings import known_summaries, machine_warnings
from sweeps.run.blocks import LARGEST_BLOCK, block_size, bytes_of_fields
from sweeps.run.cost import on_shafts_text, probe
from sweeps.run.runner import crew_of, layout_of
from sweeps.store import bytes_text
from sweeps.study.default_summaries import answers
from sweeps.study.study import Study
from sweeps.study.study_content import ReadyMachine
from sweeps.text.tables import table

if TYPE_CHECKING:
    from distributed import Client

# Keys of a governor's engine that belong to its motion.
_OF_MOTION = ("duration", "settling_band")
# Summary of a regime that `check` shows with its method.
_STEEP = "implicit_steps"
# Up to this many variants `check` counts dropped variants exactly; of more it takes SAMPLED ones from PLACES
# positions, which gives the share within 0.4 %.
MOST_COUNTED, SAMPLED, PLACES = 4 * LARGEST_BLOCK, 1 << 16, 256
# Warn if a field's peak exceeds its peak at the kept positions by this share.
MISSED = 0.02
# Printed lines that compile within half a minute; `check` doesn't compile longer functions.
MOST_COMPILED = 15_000
# Group classes in Roman numerals.
ROMAN = ("", "I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX", "X")


def structure_text(scene: engine.Scene) -> str:
    """The structure of the mechanism: input, groups in order, mobility."""
    if scene.input is None:
        return "none (only machine elements)"
    free = engine.order_groups(scene).free_groups.values()
    # A shaft that only transmits torque and inertia isn't part of the mechanism.
    wheels = [name for name, shaft in scene.shafts.items() if shaft.carrier or shaft.pivot]
    lines = [f"input {scene.input.link} ({scene.input.type})"]
    lines += [_second_input_text(scene, name) for name in scene.inputs]
    lines += [
        f"group {name}: {g.type} of {' and '.join(engine.group_links(scene, name))}" for name, g in scene.groups.items()
    ]
    lines += [
        f"group {g.name}: class {ROMAN[g.group_class]}, order {g.order}, of {engine.enumerated(g.links)}" for g in free
    ]
    lines += [
        f"cam {name} on {cam.on}: {cam.follower.type} follower {cam.follower.link}, {cam.follower.contact}"
        for name, cam in scene.cams.items()
    ]
    lines += [_wheel_text(scene, name) for name in wheels]
    lines += [
        f"non-circular wheel {name} about {wheel.pivot}, driven by {wheel.geared_to}: {wheel.law.type}"
        for name, wheel in scene.noncircular_wheels.items()
    ]
    lines += [f"rack {name} on guide {rack.guide}, driven by {rack.pinion}" for name, rack in scene.racks.items()]
    rolls = {n: p.rack or f"a fixed rack along {p.guide}" for n, p in scene.pinions.items()}
    lines += [f"pinion {name} about {scene.pinions[name].pivot}, driven by {rack}" for name, rack in rolls.items()]
    found = engine.mobility(scene)
    higher = (" − p₂", f" − {found.higher_pairs}") if found.higher_pairs else ("", "")
    counts = f"3·{found.links} − 2·{found.lower_pairs}{higher[1]}"
    lines.append(f"W = 3n − 2p₁{higher[0]} = {counts} = {found.degrees_of_freedom}")
    return "\n".join(lines)


def _wheel_text(scene: engine.Scene, name: str) -> str:
    """Bearing and driver of a shaft that belongs to the mechanism."""
    shaft = scene.shafts[name]
    placed = f"planet {name} on {shaft.carrier}" if shaft.carrier else f"shaft {name} about {shaft.pivot}"
    return f"{placed}, geared to {shaft.geared_to}"


def _second_input_text(scene: engine.Scene, name: str) -> str:
    """Type and driver of a second input."""
    second = scene.inputs[name]
    held = f"on guide {second.guide}" if second.type == "slider" else f"about {second.pivot}"
    return f"second input {name} {held}" + (f", driven from {scene.input.link}" if second.drive == "crank" else "")


def assembly_text(machine: engine.Machine) -> str:
    """Whether the unmodified machine assembles over its whole cycle."""
    ranges, nodes = engine.assembly_ranges(machine.mechanics), machine.input_values
    step = nodes[1] - nodes[0]
    if len(ranges) == 1 and ranges[0].stop - ranges[0].start >= nodes[-1] - nodes[0] - 1e-9 * step:
        return "assembles over the whole cycle" if machine.has_cycle else "assembles over the whole range of its input"
    return assembled_text(machine.mechanics)


def nominal_text(study: Study, machine: ReadyMachine) -> str:
    """Answers of the unmodified scene without its regimes, from the study's machine if it has them all."""
    wanted = [name for name in answers(machine) if name.partition(".")[0] not in study.scene.regimes]
    if _is_followed(study.scene):
        machine = engine.made_ready(_unfollowed(study.scene))
        wanted = [name for name in wanted if name in machine.available_summaries]
    if machine.has_regimes or not set(wanted) <= set(machine.asked_summaries):
        machine = engine.made_ready(machine.scene, wanted)
    outcome = machine.evaluate({})
    verdict, lines, alone = engine.Verdict(outcome.status[0]), [], isinstance(machine, engine.ElementsAlone)
    rows = _asked_rows(machine, outcome, [n for n in wanted if alone or np.isfinite(outcome.summaries[n][0])])
    # The mode depends on the path to a position, so ranges would be meaningless.
    if not alone and verdict != engine.Verdict.OTHER_MODE:
        lines.append(assembly_text(machine))
    part = part_words(machine.groups[outcome.status_group[0]]) if outcome.status_group[0] >= 0 else ""
    if part and np.isfinite(outcome.status_at[0]):
        at = float(outcome.status_at[0])
        place = engine.quantity_text(at, engine.InputUnits.of(study.scene).q)
        gap = gap_text(study.scene, machine.groups[outcome.status_group[0]], at)
        lines.append(f"{part} fails first, at {place}{gap and f': {gap}'}")
    if verdict not in (engine.Verdict.OK, engine.Verdict.CANNOT_ASSEMBLE) or alone:
        lines.append(": ".join(filter(None, (part, verdict.sentence))))
    if verdict == engine.Verdict.NOT_FINITE:
        lacking = [name for name in wanted if not np.isfinite(outcome.summaries[name][0])]
        lines += lacks_lines(lacking) if alone else _undefined_loads(study.scene)
    return "\n".join([*lines, table(rows)] if rows else lines)


def gap_text(scene: engine.Scene, name: str, at: float) -> str:
    """Distance that the bars of a dyad have to span at an input position, and their reach; "" if not known.

    Parameters
    ----------
    scene : Scene
    name : str
        A group, or a part that has no such distance.
    at : float
        [rad] or [m].
    """
    found = engine.MovingMachine(scene, positions=[at]).dyad_gap(name)
    if found is None or not math.isfinite(found.distance[0]):
        return ""
    lengths = found.distance[0], found.least, found.greatest
    group, (gap, least, greatest) = scene.groups[name], (engine.quantity_text(length, "m") for length in lengths)
    if group.type == "RRR":
        joints = f"joints {group.first.joint} and {group.second.joint} are {gap} apart"
        return f"{joints}, its bars span {least} … {greatest}"
    return f"joint {group.first.joint} is {gap} from the line of joint {group.inner}, its rod spans {greatest}"


def _undefined_loads(scene: engine.Scene) -> list[str]:
    """Loads whose torque on the input is infinite or undefined at a position, and the first such position."""
    machine, lines = engine.MovingMachine(scene), []
    loads = (
        f"{name}.moment" for table in (scene.forces, scene.moments, scene.cylinders, scene.springs) for name in table
    )
    known = machine.register.available_fields
    for name, row in machine.fields([name for name in loads if name in known]).items():
        if not np.isfinite(row).all():
            place = float(machine.q[np.argmin(np.isfinite(row))])
            at = engine.quantity_text(place, engine.InputUnits.of(scene).q)
            lines.append(f"{name}, the {known[name].long_name}, is infinite or undefined, first at {at}")
    return lines


def _is_followed(scene: engine.Scene) -> bool:
    """Whether a scene without a mechanism has a governor whose motion takes half a minute to compile."""
    return scene.input is None and any(getattr(element, "is_followed", False) for element in scene.elements.values())


def _unfollowed(scene: engine.Scene) -> engine.Scene:
    """The same scene without the motion of its governors after a change of load."""
    data = scene.model_dump(exclude_unset=True)
    for governor in data["elements"].values():
        kept = {key: value for key, value in governor.get("engine", {}).items() if key not in _OF_MOTION}
        governor |= {"engine": kept} if kept else {}
    return engine.Scene.model_validate(data)


def between_positions_text(study: Study) -> str:
    """Kept fields of the unmodified scene with much higher peaks between the kept positions."""
    if not study.fields or study.scene.input is None:
        return ""
    of_cycle = [name for name in study.fields if name.partition(".")[0] not in study.scene.regimes]
    peaks = {name: f"{name}.peak" for name in of_cycle}
    machine = engine.Machine(study.scene, peaks.values(), of_cycle, positions=study.positions)
    outcome = machine.evaluate({})
    if outcome.status[0] != engine.Verdict.OK:
        return ""
    lines, units = [], machine.available_fields
    for name, peak in peaks.items():
        true, kept = float(outcome.summaries[peak][0]), float(np.abs(outcome.fields[name][0]).max())
        if true > (1.0 + MISSED) * kept:
            shown = [engine.quantity_text(value, units[name].units) for value in (true, kept)]
            lines.append(f"{name}: peak {shown[0]}, at the {study.positions} kept positions {shown[1]}")
    hint = "these fields peak between the kept positions; use summaries or more positions:"
    return "\n".join([hint, *lines]) if lines else ""


def regimes_text(machine: engine.Machine, outcome: engine.Outcome) -> str:
    """Each regime of the unmodified machine: description, method, and the outcome."""
    scene, asked = machine.scene, by_regime(machine.scene, machine.asked_summaries)
    lines = []
    for name, case, method in engine.regime_text(machine.mechanics):
        steep = ", in part by implicit steps, as it is steep" if outcome.summaries[f"{name}.{_STEEP}"][0] == 1.0 else ""
        lines += [f"{name}: {regime_words(scene, name)}", f"  {case}; {method}{steep}"]
        if outcome.status[0] == engine.Verdict.OK:
            shown = [summary for summary in asked[name] if summary != f"{name}.{_STEEP}"]
            lines += table(_asked_rows(machine, outcome, shown), "  ").splitlines()
    verdict = engine.Verdict(outcome.status[0])
    if verdict in MOTION_VERDICTS:
        lines.append(f"{verdict.short}: {failure_text(scene, verdict)}")
    return "\n".join(lines)


def _asked_rows(machine: ReadyMachine, outcome: engine.Outcome, names: Sequence[str]) -> list[tuple[str, ...]]:
    """Summaries of the first variant, with their meaning."""
    known, rows = machine.available_summaries, []
    for name in names:
        value, error = float(outcome.summaries[name][0]), float(outcome.errors[name][0])
        if outcome.status[0] != engine.Verdict.OK and np.isnan(value):
            continue
        rows.append((name, engine.quantity_text(value, known[name].units, error), known[name].long_name))
    return rows


def check_text(
    study: Study,
    out: Path,
    client: "Client | None" = None,
    tell: Callable[[str], None] = lambda sentence: None,
    every: bool = False,
) -> str:
    """The report of `sweeps check` on a study and its cluster.

    Parameters
    ----------
    study : Study
    out : Path
        Planned result file.
    client : Client, optional
        Client of the cluster.
    tell : callable
        Receives progress messages.
    every : bool
        Name all requested results, also further ones and checks.
    """
    machine = study.machine()
    uncompiled, followed = _uncompiled_text(machine), _is_followed(study.scene)
    if on_shafts := "" if uncompiled else on_shafts_text(study):
        tell(on_shafts)
    between = "" if uncompiled else between_positions_text(study)
    regimes, known = "", {}
    if study.scene.regimes and not uncompiled:
        asked = [name for name in answers(machine) if name.partition(".")[0] in study.scene.regimes]
        asked += [f"{name}.{_STEEP}" for name in study.scene.regimes]
        moving = engine.Machine(study.scene, asked, positions=study.positions)
        outcome = moving.evaluate({})
        regimes, known = regimes_text(moving, outcome), known_summaries(outcome)
    warned = "\n".join([*machine_warnings(machine, known), *filter(None, [between])])
    nominal = uncompiled or nominal_text(study, machine)
    sections = [
        ("Study", "\n".join(t for t in (study.title or study.name, study.question) if t)),
        ("Mechanism", structure_text(study.scene)),
        ("Unmodified machine", nominal),
        *([("Regimes", regimes)] if regimes else []),
        *([("Warnings", warned)] if warned else []),
        ("Variants", f"{study.design.size} = {_design_text(study)}"),
        ("Asked", _asked_text(study, machine, every, f"{nominal}\n{regimes}")),
        *_plan_sections(machine),
        *([("Time", "the motion of governors is compiled and followed by `sweeps run`")] if followed else []),
        *(_file_sections(study, out) if uncompiled or followed else _cost_sections(study, out, on_shafts)),
        *([] if client is None else [("Cluster", _cluster_text(study, client, out, tell))]),
    ]
    return "\n".join(f"{title}\n" + "\n".join(f"  {line}" for line in text.splitlines()) for title, text in sections)


def _asked_text(study: Study, machine: ReadyMachine, every: bool, above: str) -> str:
    """Names of the requested results that have no line above, the answers first, and the number of the others."""
    used = names_in_conditions([condition.text for condition in study.require], study.best)
    first = study.summaries if every else answers_among(machine, study.summaries, used)
    known = {line.split()[0] for line in above.splitlines() if line.strip()}
    shown, hidden = len(known.intersection(first)), len(study.summaries) - len(first)
    lines = [f"{engine.counted(shown, 'number')} above"] if shown else []
    lines += [name for name in first if name not in known]
    lines += [*study.fields, *(quantity.name for quantity in study.sensitivity.quantities)]
    return "\n".join([*lines, *([f"{hidden} more with --all"] if hidden else [])])


def _plan_sections(machine: ReadyMachine) -> list[tuple[str, str]]:
    if isinstance(machine, engine.ElementsAlone):
        return [("Computed once for each variant", ", ".join(machine.elements))]
    plan = {f"Computed at {_positions_text(machine)}": machine.computed}
    plan["Skipped (not needed for the outputs)"] = machine.left_out
    return [
        (head, "\n".join(f"{subject}: {', '.join(levels)}" for subject, levels in found.items()) or "nothing")
        for head, found in plan.items()
    ]


def _positions_text(machine: engine.Machine) -> str:
    if machine.accuracy is not None:
        return f"positions as needed for an accuracy of {accuracy_words.share_text(machine.accuracy)}"
    if not machine.asked_fields:
        return "adaptive positions"
    return f"adaptive positions, fields at {machine.nodes.size}"


def _cost_sections(study: Study, out: Path, on_shafts: str) -> list[tuple[str, str]]:
    """Evaluation, time, memory and file size of a study; runs on elastic shafts report their own."""
    cost, machine = probe(study), study.machine()
    seconds = on_shafts or f"about {_duration(cost.seconds * study.design.size)}"
    if machine.has_regimes:
        seconds += "; plus up to a minute of compilation the first time"
    numbers = 8 * (machine.numbers_kept + 4 * len(study.summaries))
    block = block_size(study, lambda: cost.seconds)
    memory = block * (numbers + bytes_of_fields(study))
    saved = "saved after each variant" if block == 1 else f"saved after every {block} variants"
    reached = [] if cost.tried is None else [("Accuracy", accuracy_words.of_sample(study, cost.tried))]
    return [
        *reached,
        ("Evaluation", f"no sharing between variants; fields in {study.field_precision}; {saved}"),
        ("Time", seconds),
        ("Memory", f"about {bytes_text(memory + cost.motion_bytes)} plus the program itself"),
        *_file_sections(study, out),
    ]


def _duration(seconds: float) -> str:
    """A time for a person: "5 ms", "12 s", "3.4 h"."""
    unit, size = next(((u, s) for u, s in (("h", 3600), ("min", 60), ("s", 1)) if seconds >= s), ("ms", 1e-3))
    return f"{seconds / size:.3g} {unit}"


def _uncompiled_text(machine: ReadyMachine) -> str:
    """Why `check` doesn't evaluate a machine, or ""."""
    lines = 0 if isinstance(machine, engine.ElementsAlone) else len(machine.source().splitlines())
    if lines <= MOST_COMPILED:
        return ""
    return (
        "not evaluated, so assembly and time per variant are unknown:\n"
        f"its {lines} generated lines take minutes to compile; `sweeps run` compiles them once and caches them"
    )


def _file_sections(study: Study, out: Path) -> list[tuple[str, str]]:
    """Cost of a study that is known without evaluation."""
    free = shutil.disk_usage(_existing_folder(out)).free
    return [("File", f"{bytes_text(layout_of(study).bytes())}; {bytes_text(free)} free")]


def _existing_folder(out: Path) -> Path:
    """The result folder, or its nearest existing parent."""
    return next(p for p in (out.parent, *out.absolute().parents) if p.exists())


def _cluster_text(study: Study, client: "Client", out: Path, tell: Callable[[str], None]) -> str:
    """Workers, speed and bottleneck of a study on a cluster."""
    from sweeps.run.cluster.limits import measure_limits

    with crew_of(client, study, layout_of(study), tell) as crew:
        limits = measure_limits(crew, _existing_folder(out))
        words = crew.words
    rates = [
        f"workers: {limits.workers:.3g} variants a second",
        f"network: {limits.network:.3g} variants a second",
        f"disk: {limits.disk:.3g} variants a second",
    ]
    seconds = study.design.size * limits.seconds
    return "\n".join([words, *rates, f"bottleneck: {limits.least}; about {seconds:.3g} s"])


def _design_text(study: Study) -> str:
    axes = " × ".join(f"{' + '.join(axis.names)} [{axis.size}]" for axis in study.design.axes)
    notes = [axis.note for axis in study.design.axes if getattr(axis, "note", "")]
    derived = [f"{path} = {e.text}" for path, e in study.derived.items()]
    return "\n".join([axes or "the unmodified scene", *derived, *_required_text(study), *notes])


def _required_text(study: Study) -> list[str]:
    """Variants dropped by each condition, and those outside the limits of numbers, from a sample if there are many."""
    size = study.design.size
    whole = size <= MOST_COUNTED
    block = LARGEST_BLOCK if whole else SAMPLED // PLACES
    starts = range(0, size, block) if whole else np.linspace(0, size - block, PLACES).astype(np.int64)
    parts = [(int(start), min(int(start) + block, size)) for start in starts]
    found = [study.completed(study.design.values(*part), part[1] - part[0]) for part in parts]
    missed = [part for _, part in found]
    dropped, lines = np.concatenate([part.any(axis=0) for part in missed]), []
    if study.require:
        share = f"{round(dropped.mean() * size)}" if whole else f"about {100 * dropped.mean():.3g} %"
        counted = drop_lines([condition.text for condition in study.require], missed, not whole)
        lines += [f"required, {share} of {size} dropped:", *(f"  {line}" for line in counted)]
    values = {path: np.concatenate([part[path] for part, _ in found]) for path in found[0][0]}
    outside = outside_lines(study.scene, values, ~dropped)
    if outside:
        lines += [f"outside limits, of {dropped.size} variants examined:", *(f"  {line}" for line in outside)]
    return lines
