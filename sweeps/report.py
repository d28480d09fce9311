"""What a study will compute, and what its results say, in words and tables."""

import math
import shutil
import time
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from engine import SENTENCES, Machine, Verdict
from engine.demand import describe
from engine.kernel_text import Form
from engine.quantities import InputUnits
from engine.rotation import assembly_ranges
from engine.scene import Scene
from engine.structure import group_links
from sweeps.engineer_units import engineer_unit
from sweeps.results import Result
from sweeps.runner import block_size, evaluate_block, layout_of
from sweeps.study import Study


def table(rows: Sequence[Sequence[str]], indent: str = "") -> str:
    """Rows of cells in aligned columns."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = ("  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows)
    return "\n".join(indent + line for line in lines)


def quantity_text(value: float, units: str, error: float | None = None) -> str:
    """A value with its error figure, in the unit an engineer would use."""
    if not math.isfinite(value):
        return "–"
    factor, label = engineer_unit(units, np.array([value]))
    unit = f" {label}" if label not in ("", "1") else ""
    shown = f"{value * factor:.5g}"
    if error is not None and math.isfinite(error):
        shown += f" ± {error * factor:.1g}"
    return shown + unit


# Before a run


def structure_text(scene: Scene) -> str:
    """The mechanism in the mechanic's words: input, groups in order, mobility."""
    links = 1 + sum(2 for _ in scene.groups)
    pairs = 1 + 3 * len(scene.groups)
    lines = [f"input {scene.input.link} ({scene.input.type})"]
    lines += [f"group {name}: {g.type} of {' and '.join(group_links(scene, name))}" for name, g in scene.groups.items()]
    lines.append(f"W = 3n − 2p₁ = 3·{links} − 2·{pairs} = {3 * links - 2 * pairs}")
    return "\n".join(lines)


def assembly_text(scene: Scene) -> str:
    """Whether the machine as it is assembles all through its cycle."""
    ranges = assembly_ranges(scene)
    units = InputUnits.of(scene).q
    machine = Machine(scene)
    nodes = machine.input_values
    step = nodes[1] - nodes[0]
    if len(ranges) == 1 and ranges[0].stop - ranges[0].start >= nodes[-1] - nodes[0] - 1e-9 * step:
        return "assembles over the whole cycle" if machine.has_cycle else "assembles over the whole range of its input"
    if not ranges:
        return "can't be assembled at any position of the input: a length or a mode is wrong"
    shown = ", ".join(f"{quantity_text(r.start, units)} … {quantity_text(r.stop, units)}" for r in ranges)
    return f"assembles only for the input at {shown}: give input.start and input.stop, or change the lengths"


def nominal_text(study: Study) -> str:
    """Characteristic numbers of the scene as it is."""
    available = Machine(study.scene).available_summaries
    wanted = [n for n in available if n.endswith((".stroke", ".swing", "_time_ratio", ".transmission_angle"))]
    machine = Machine(study.scene, wanted)
    outcome = machine.evaluate({})
    rows = [
        (name, quantity_text(float(outcome.summaries[name][0]), available[name].units, float(outcome.errors[name][0])))
        for name in wanted
        if np.isfinite(outcome.summaries[name][0])
    ]
    verdict = Verdict(outcome.status[0])
    lines = [assembly_text(study.scene)]
    if verdict not in (Verdict.OK, Verdict.CANNOT_ASSEMBLE):
        lines.append(SENTENCES[verdict])
    return "\n".join([*lines, table(rows)] if rows else lines)


def plan_text(machine: Machine) -> tuple[str, str]:
    """What is computed per position, and what is left out because nothing asked needs it."""
    kept = describe(machine.source("whole").steps)
    everything = describe(machine.model.program.steps)
    computed = [f"{subject}: {', '.join(levels)}" for subject, levels in kept.items()]
    left = []
    for subject, levels in everything.items():
        missing = [level for level in levels if level not in kept.get(subject, ())]
        if missing:
            left.append(f"{subject}: {', '.join(missing)}")
    return "\n".join(computed) or "nothing", "\n".join(left) or "nothing"


def probe(study: Study, machine: Machine) -> tuple[float, Form]:
    """Seconds a block takes once compiled, and the form its kernel takes."""
    size = min(block_size(study, machine), 4096)
    buffer = machine.new_buffer(size)
    evaluate_block(study, machine, slice(0, size), buffer)
    start = time.perf_counter()
    evaluate_block(study, machine, slice(0, size), buffer)
    seconds = time.perf_counter() - start
    return seconds / size, "factorised" if "factorised" in machine.forms_used else "whole"


def check_text(study: Study, out: Path) -> str:
    """Everything `sweeps check` says of a study."""
    machine = study.machine()
    layout = layout_of(study, machine)
    computed, left = plan_text(machine)
    seconds, form = probe(study, machine)
    size = layout.bytes()
    free = shutil.disk_usage(next(p for p in (out.parent, *out.absolute().parents) if p.exists())).free
    slots = machine.model.program.slots
    shape = {p for p in study.paths if _decides_shape(machine, p)}
    reused = [p for p in study.paths if p not in shape]
    form_line = (
        f"kinematics once for each geometry, reused for {', '.join(reused)}"
        if form == "factorised"
        else "each variant from its own numbers"
    )
    block = layout.block
    memory = block * (
        8 * (len(slots) + 4 * len(study.summaries)) + machine.nodes.size * machine.dtype.itemsize * len(study.fields)
    )
    sections = [
        ("Study", "\n".join(t for t in (study.title or study.name, study.question) if t)),
        ("Mechanism", structure_text(study.scene)),
        ("Machine as it is", nominal_text(study)),
        ("Variants", f"{study.design.size} = {_design_text(study)}"),
        ("Asked", "\n".join((*study.summaries, *study.fields))),
        (f"Computed at each of {machine.nodes.size} positions", computed),
        ("Left out, as nothing asked needs it", left),
        ("Evaluation", f"{form_line}; {study.precision}; blocks of {block} variants"),
        ("Time", f"about {seconds * study.design.size:.3g} s, {seconds * 1e6:.3g} µs a variant"),
        ("Memory", f"about {memory / 1e6:.3g} MB beside the program's own"),
        ("File", f"{size / 1e6:.3g} MB; {free / 1e9:.3g} GB free"),
    ]
    return "\n".join(f"{title}\n" + "\n".join(f"  {line}" for line in text.splitlines()) for title, text in sections)


def _decides_shape(machine: Machine, path: str) -> bool:
    """Whether a number decides the shape of the motion: perturbing it changes a slot of shape."""
    source = machine.source("whole")
    nominal = machine.model.numbers({})
    changed = machine.model.numbers({path: np.array([1.1 * nominal[path] + 0.01])})
    slots = [machine.model.program.slots[s] for s in source.slots[: source.shape_slots]]
    with np.errstate(all="ignore"):
        return any(
            not np.allclose(s.compute(nominal), s.compute(changed), rtol=0, atol=0, equal_nan=True) for s in slots
        )


def _design_text(study: Study) -> str:
    axes = " × ".join(f"{' + '.join(axis.names)} [{axis.size}]" for axis in study.design.axes)
    notes = [axis.note for axis in study.design.axes if getattr(axis, "note", "")]
    derived = [f"{path} = {e.text}" for path, e in study.derived.items()]
    dropped = [f"only if {e.text}" for e in study.require]
    return "\n".join([axes or "the scene as it is", *derived, *dropped, *notes])


# After a run


def counts_text(result: Result) -> str:
    """How many variants got which verdict, and of those that fail which group is to blame and at what angle."""
    status = result.columns["status"]
    rows = []
    for verdict in Verdict:
        failed = status == verdict
        if failed.any():
            sentence = "" if verdict == Verdict.OK else SENTENCES[verdict]
            rows.append((f"{int(failed.sum())}", verdict.name.lower().replace("_", " "), sentence))
            rows += [("", "", line) for line in _blame(result, failed)]
    return table(rows)


def _blame(result: Result, failed: np.ndarray) -> list[str]:
    """For each group that fails: how often, and between which input positions it does so first."""
    groups = result.description.attributes.get("groups", "").split(", ")
    number, at = result.columns["status_group"], result.columns["status_at"]
    lines = []
    for i, group in enumerate(groups):
        chosen = failed & (number == i)
        if chosen.any():
            first, last = (
                quantity_text(float(v), result.units["status_at"]) for v in (at[chosen].min(), at[chosen].max())
            )
            place = first if first == last else f"{first} … {last}"
            lines.append(f"group {group}: {int(chosen.sum())}, first at {place}")
    return lines


def variants_text(result: Result, variants: Iterable[int], names: Sequence[str] = ()) -> str:
    """Table of some variants: their parameters and summaries with error figures."""
    shown = [*result.parameters, *(names or result.summaries)]
    units = {name: engineer_unit(result.units[name], result.columns[name]) for name in shown}
    rows = [["variant", *shown], ["", *(label if label != "1" else "" for _, label in units.values())]]
    for variant in variants:
        cells = [str(variant)]
        for name, (factor, _) in units.items():
            value = result.columns[name][variant]
            error = result.columns.get(f"{name}_error")
            cell = f"{value * factor:.6g}" if np.isfinite(value) else "–"
            if error is not None and np.isfinite(error[variant]):
                cell += f" ± {error[variant] * factor:.1g}"
            cells.append(cell)
        rows.append(cells)
    return table(rows)


def answer_text(result: Result) -> str:
    """The answer to the study's question: its best variant, by name, parameters and results."""
    goal = result.goal
    if result.description.variants == 1:
        return "\n".join([*([result.question] if result.question else []), table(_summary_rows(result, 0), "  ")])
    if goal is None:
        return "No [best] in the study: nothing to choose by. Look with `sweeps show`."
    best = result.best()
    word = "least" if goal.sign > 0 else "greatest"
    if best is None:
        return f"No variant was computed that meets the conditions; none has the {word} {goal.goal}."
    lines = [result.question] if result.question else []
    value = quantity_text(result.columns[goal.goal][best], result.units[goal.goal], _error(result, goal.goal, best))
    condition = f" where {goal.where}" if goal.where else ""
    rivals = result.rivals(best)
    lines.append(f"Answer: the {word} {goal.goal}{condition} is {value}, with variant {best}:")
    rows = [(name, "=", quantity_text(result.columns[name][best], result.units[name])) for name in result.parameters]
    rows += [row for row in _summary_rows(result, best) if row[0] != goal.goal]
    lines.append(table(rows, "  "))
    if rivals:
        lines.append(f"{rivals} other variants are as good within the error figures: choose among them by other needs.")
    return "\n".join(lines)


def _summary_rows(result: Result, variant: int) -> list[tuple[str, str, str]]:
    """Every summary of a variant with its error figure."""
    return [
        (name, "→", quantity_text(result.columns[name][variant], result.units[name], _error(result, name, variant)))
        for name in result.summaries
    ]


def _error(result: Result, name: str, variant: int) -> float | None:
    errors = result.columns.get(f"{name}_error")
    return None if errors is None else float(errors[variant])
