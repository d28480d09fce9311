"""Loops over positions that fill many rows: still vectorised, the same numbers, and nothing undefined gets lost."""

import platform
import re

import numpy as np
import pytest
from machines import crank, frame, rrr

from engine import Scene, Verdict
from engine.compiling import jit
from engine.equal_positions.rows_machine import RowsMachine as Machine
from engine.equal_positions.text.apart import is_long, said_apart

SCENE = Scene.model_validate(
    {
        "points": {"O": frame(0.0, 0.0), "D": frame(1.0, 0.1)},
        "input": crank(),
        "groups": {"bars": rrr("B", ("coupler", "A", 1.0), ("rocker", "D", 0.8))},
        "bodies": {"coupler": {"link": "coupler", "mass": 1.0, "x": 0.5, "inertia": 0.1}},
    }
)
PAIRS = ("input", "bars.first", "bars.inner", "bars.second")
MANY = [f"{pair}.reaction{part}" for pair in PAIRS for part in ("", "_x", "_y", "_along", "_across")]
EPS = np.finfo(float).eps


def evaluated(fields: list[str], **numbers: list) -> tuple:
    varied = {path.replace("__", "."): np.array(values, float) for path, values in numbers.items()}
    machine = Machine(SCENE, fields=fields, varied=varied, positions=48)
    return machine, machine.evaluate(varied)


def test_loop_of_few_rows__is_left_alone():
    few = [f"row__{i}[k] = x + table[k]" for i in range(9)]
    assert not is_long(few)
    assert is_long([*few, "row__9[k] = x", "row__10[k] = other[k]"])


def test_reads_and_writes_of_a_long_loop__say_which_rows():
    lines = ["x = table[k] + row__a[k]", "row__a[k] = x", "row__b[k] = 2 * x * other[k]"]
    assert said_apart(lines) == [
        "x = read_apart(table, k, 2) + read_own(row__a, k, 0, 2)",
        "write_apart(row__a, k, x, 0, 2)",
        "write_apart(row__b, k, 2 * x * read_apart(other, k, 2), 1, 2)",
    ]


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="knows the names of this processor's")
def test_many_rows__are_compiled_to_packed_instructions(tmp_path, monkeypatch):
    # Machine code can be read only where it was compiled, not where it comes from a cache.
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    jit.load_kernel.cache_clear()
    machine, _ = evaluated(MANY)
    text = machine.source("whole").text
    assembly = "\n".join(jit.load_kernel(text).kernel.inspect_asm().values())
    jit.load_kernel.cache_clear()
    assert "write_apart(" in text
    assert re.search(r"\bv?sqrtpd\b", assembly)
    assert re.search(r"\bv?divpd\b", assembly)


def test_a_row_among_many__is_the_row_asked_alone():
    _, among_many = evaluated(MANY)
    _, alone = evaluated(["bars.inner.reaction"])
    row = alone.fields["bars.inner.reaction"]
    # The compiler may fuse other products with sums: some ten roundings.
    np.testing.assert_allclose(among_many.fields["bars.inner.reaction"], row, rtol=64 * EPS)


def test_undefined_variants_of_a_long_loop__get_their_verdicts():
    _, outcome = evaluated(
        MANY,
        input__length=[0.3, 2.5, 0.3, 0.005],
        bodies__coupler__mass=[1.0, 1.0, 1e308, 1.0],
    )
    assert list(outcome.status) == [Verdict.OK, Verdict.CANNOT_ASSEMBLE, Verdict.NOT_FINITE, Verdict.OK]
