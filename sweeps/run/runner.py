"""Running a study block by block into a result file, resumable at any moment."""

import json
import platform
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import h5py
import llvmlite
import numba
import numpy as np

from engine import SENTENCES, InputUnits, Machine, Outcome, Quantity, Verdict, threads
from sweeps.store import Column, FileLayout, Store
from sweeps.study.study import Study
from sweeps.study.study_record import study_record
from sweeps.text.engineer_units import units_shown
from sweeps.text.scene_text import write_scene

# A block is long enough that its overhead (a few milliseconds) doesn't count, short enough that a killed sweep
# loses little, and its fields fit in memory beside everything else.
WORK_PER_BLOCK = 5e7
BYTES_PER_BLOCK = 96e6
LARGEST_BLOCK = 65_536
# Motion takes a thousand times as long as a cycle at uniform speed.
LARGEST_BLOCK_IN_MOTION = 4096
# Operations of a variant for each of its numbers, as many panels as it usually takes.
WORK_OF_A_NUMBER = 500


def block_size(study: Study, machine: Machine) -> int:
    """Variants per block: about the same work whatever a variant costs, within a bound on memory.

    It depends on the study alone, so that an interrupted sweep can go on with other settings of the machine.
    """
    return min(largest_block(study, machine), max(study.design.size, 1))


def largest_block(study: Study, machine: Machine) -> int:
    """As `block_size`, however many variants there are."""
    work = WORK_OF_A_NUMBER * machine.numbers_kept * (1 + study.sensitivity.evaluations)
    work += machine.nodes.size * machine.numbers_kept * len(study.fields)
    row = machine.nodes.size * machine.dtype.itemsize * len(study.fields)
    asked = len(study.summaries) + len(study.sensitivity.quantities)
    numbers = 8 * (2 * asked + 4 * len(study.parameters) + machine.numbers_kept + 8)
    most = LARGEST_BLOCK if machine.schedule is None else LARGEST_BLOCK_IN_MOTION
    fitting = min(WORK_PER_BLOCK * 10 / work, BYTES_PER_BLOCK / (row + numbers), most)
    return int(max(2 ** int(np.log2(max(fitting, 1))), 16))


def layout_of(study: Study, machine: Machine) -> FileLayout:
    """Shape of the result file of a study."""
    units = InputUnits.of(study.scene)
    columns = [_parameter_column(study, name) for name in study.parameters]
    columns += [
        Column("status", "verdict on the variant", "1", dtype=np.uint8),
        Column("status_group", "number of the structural group to blame, -1 if none", "1", dtype=np.int16),
        Column("status_at", "input position at which the variant fails", units.q),
    ]
    for name in study.summaries:
        quantity = machine.available_summaries[name]
        columns.append(Column(name, quantity.long_name, quantity.units))
        columns.append(Column(f"{name}_error", f"error figure of: {quantity.long_name}", quantity.units))
    columns += study.sensitivity.columns
    for name in study.fields:
        quantity: Quantity = machine.available_fields[name]
        columns.append(Column(name, quantity.long_name, quantity.units, ("variant", "position"), machine.dtype.type))
    crank = units.q == "rad"
    return FileLayout(
        variants=study.design.size,
        block=block_size(study, machine),
        columns=tuple(columns),
        attributes=_attributes(study, machine),
        coordinates=study.parameters,
        status_codes={int(v): v.name.lower() for v in SENTENCES if v != Verdict.NOT_COMPUTED},
        position=machine.nodes,
        position_name=_position_name(study),
        position_long_name="crank angle" if crank else "displacement of the input as a fraction of its range",
        position_units="rad" if crank else "1",
    )


def _parameter_column(study: Study, name: str) -> Column:
    return Column(name, name, study.unit(name))


def _attributes(study: Study, machine: Machine) -> dict[str, str]:
    try:
        package = version("machine-sweeps")
    except PackageNotFoundError:
        package = "not installed"
    versions = {"machine-sweeps": package, "numba": numba.__version__, "llvmlite": llvmlite.__version__}
    versions |= {"numpy": np.__version__, "h5py": h5py.__version__, "python": platform.python_version()}
    return {
        "title": study.title or study.name,
        "question": study.question,
        "study": study.text,
        "study_json": json.dumps(study_record(study) | {"groups": list(machine.groups), "units": units_shown()}),
        "scene": write_scene(study.scene),
        "scene_text": study.scene_text,
        "study_hash": study.digest,
        "versions": ", ".join(f"{k} {v}" for k, v in versions.items()),
        "machine": f"{platform.machine()} {platform.system()}, {threads()} threads",
    }


def _position_name(study: Study) -> str:
    return "phi" if InputUnits.of(study.scene).q == "rad" else "travel"


def run_study(
    study: Study, path: Path | str, restart: bool = False, progress: Callable[[int, int], None] | None = None
) -> Path:
    """Run a study, or what is left of it, into a result file.

    Parameters
    ----------
    study : Study
    path : Path or str
        The file to make; while the sweep runs it is called NAME.part.h5.
    restart : bool
        Throw away an earlier result under that name.
    progress : callable, optional
        Called with (variants done, of those done before this run) after every block.

    Returns
    -------
    Path
        The finished file.

    Raises
    ------
    StoreError
        The file can't be made or written, or holds another study.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    machine = study.machine()
    layout = layout_of(study, machine)
    with Store.open(path, layout, restart) as store:
        if store.finished:
            return path
        pending = store.pending
        sizes = {i: store.slice(i).stop - store.slice(i).start for i in pending}
        before = study.design.size - sum(sizes.values())
        done, buffer = before, machine.new_buffer(layout.block)
        for i in pending:
            store.write(i, evaluate_block(study, machine, store.slice(i), buffer))
            done += sizes[i]
            if progress:
                progress(done, before)
        store.finish()
    return path


def evaluate_block(study: Study, machine: Machine, variants: slice, buffer: np.ndarray) -> dict[str, np.ndarray]:
    """All columns of a block of variants."""
    values, drop = study.values(variants.start, variants.stop)
    if study.paths:
        outcome = machine.evaluate({p: values[p] for p in study.paths}, drop, buffer)
    else:
        outcome = _repeated(machine.evaluate({}), variants.stop - variants.start, drop)
    results = {"status": outcome.status, "status_group": outcome.status_group, "status_at": outcome.status_at}
    errors = {f"{name}_error": error for name, error in outcome.errors.items()}
    sensitivity = study.sensitivity.of_variants(values, outcome.status)
    return values | results | outcome.summaries | errors | sensitivity | outcome.fields


def _repeated(outcome: Outcome, count: int, drop: np.ndarray) -> Outcome:
    """The outcome of the scene as it is, for variants in which nothing of the scene differs."""

    def again(array: np.ndarray) -> np.ndarray:
        return np.repeat(array, count, axis=0)

    status = np.where(drop, np.uint8(Verdict.DROPPED), again(outcome.status))
    tables = ({k: again(v) for k, v in table.items()} for table in outcome[3:])
    return Outcome(status.astype(np.uint8), again(outcome.status_group), again(outcome.status_at), *tables)
