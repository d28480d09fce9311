"""Generated kernels: what is left out, packed instructions, the cache on disk, calls from several threads."""

import os
import platform
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from engine import Machine, Scene
from engine.compiling import jit
from engine.equal_positions.text.demand import describe

ROOT = Path(__file__).parents[2]

SCENE = Scene.model_validate(
    {
        "points": {"O": {"x": 0, "y": 0}, "D": {"x": 0.22, "y": 0.01}},
        "guides": {"way": {"angle": 0.3}},
        "input": {"type": "crank", "pivot": "O", "pin": "A", "length": 0.05, "speed": 6.0},
        "groups": {
            "bars": {
                "type": "RRR",
                "inner": "B",
                "first": {"link": "coupler", "joint": "A", "length": 0.2},
                "second": {"link": "rocker", "joint": "D", "length": 0.15},
            },
            "press": {
                "type": "RRP",
                "inner": "C",
                "first": {"link": "rod", "joint": "B", "length": 0.4},
                "second": {"link": "ram", "guide": "way"},
            },
        },
        "bodies": {
            "coupler": {"link": "coupler", "mass": 1.0, "x": 0.1, "y": 0.01, "inertia": 0.01},
            "ram": {"link": "ram", "mass": 3.0},
        },
        "forces": {"load": {"type": "constant", "on": "C", "angle": 0.0, "force": 100.0}},
        "flywheel": {"speed_fluctuation": 0.02},
    }
)
EPS = np.finfo(float).eps


@pytest.fixture
def fresh_cache(tmp_path, monkeypatch) -> Path:
    """An empty cache of this test's own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    jit.load_kernel.cache_clear()
    yield tmp_path / "machine-sweeps"
    jit.load_kernel.cache_clear()


def crank_lengths(count: int) -> dict[str, np.ndarray]:
    return {"input.length": np.linspace(0.03, 0.05, count)}


# What is compiled

# Packed square roots and divisions of float64 and float32, by the machine's architecture.
PACKED = {
    "x86_64": {"float64": (r"\bv?sqrtpd\b", r"\bv?divpd\b"), "float32": (r"\bv?sqrtps\b", r"\bv?divps\b")},
    "AMD64": {"float64": (r"\bv?sqrtpd\b", r"\bv?divpd\b"), "float32": (r"\bv?sqrtps\b", r"\bv?divps\b")},
    "aarch64": {"float64": (r"\bfsqrt\W+v\d+\.2d", r"\bfdiv\W+v\d+\.2d"), "float32": (r"\bfsqrt\W+v\d+\.4s",)},
    "arm64": {"float64": (r"\bfsqrt\.2d", r"\bfdiv\.2d"), "float32": (r"\bfsqrt\.4s",)},
}


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_kernel__is_compiled_to_packed_instructions(dtype, fresh_cache):
    machine = Machine(SCENE, fields=["C.x"], positions=48, dtype=np.dtype(dtype).type)
    machine.evaluate({})
    kernel = jit.load_kernel(machine.source("whole").text).kernel
    assembly = "\n".join(kernel.inspect_asm().values())
    # Elsewhere it is enough that there is machine code at all.
    patterns = PACKED.get(platform.machine(), {}).get(dtype, (r"\S",))
    for pattern in patterns:
        assert re.search(pattern, assembly), pattern
    # The loop over positions calls nothing: sines, cosines and Python are outside of it.
    assert not re.search(r"\bcall\w*\s+\W*(sin|cos|atan2?)\b", assembly)


def levels(*fields: str, summaries: tuple[str, ...] = ()) -> dict[str, set[str]]:
    machine = Machine(SCENE, summaries, fields)
    return {subject.split(" (")[0]: set(found) for subject, found in describe(machine.source("whole").steps).items()}


def test_position_alone__leaves_out_velocities_and_later_groups():
    found = levels("B.x")
    assert found["group bars"] == {"position"}
    assert "group press" not in found
    assert not any({"velocity", "acceleration"} & kept for kept in found.values())


def test_inertia__leaves_out_accelerations_and_forces():
    found = levels("reduced_inertia")
    assert found["group bars"] == found["group press"] == {"position", "velocity"}
    assert not any("acceleration" in kept for kept in found.values())
    assert not any(subject.startswith("force") for subject in found)


def test_slope_of_inertia__needs_accelerations():
    assert levels("reduced_inertia_phi")["group press"] == {"position", "velocity", "acceleration"}


def test_moment__leaves_out_bodies():
    found = levels("reduced_moment")
    assert any(subject.startswith("force load") for subject in found)
    assert not any(subject.startswith("inertia") for subject in found)


def test_nothing_of_the_motion__leaves_out_everything():
    assert levels(summaries=("first_kind_inertia",)) == {}


def test_massless_parts__are_left_out_unless_their_mass_varies():
    light = SCENE.model_copy(update={"bodies": {"ram": SCENE.bodies["ram"]}})
    found = describe(Machine(light, fields=["reduced_inertia"]).source("whole").steps)
    assert not any("coupler" in subject for subject in found)


ALL = ["B.x", "C.x_phi", "reduced_inertia", "reduced_inertia_phi", "reduced_moment"]


def test_asking_less__does_not_change_what_is_still_asked():
    varied = crank_lengths(3)
    whole = Machine(SCENE, ["ram.stroke", "excess_work"], ALL, varied, 48).evaluate(varied)
    for kept_summaries, kept_fields in ((["excess_work"], []), (["ram.stroke"], ["reduced_inertia_phi"])):
        part = Machine(SCENE, kept_summaries, kept_fields, varied, 48).evaluate(varied)
        for name in kept_fields:
            # The compiler may fuse other products with sums: some ten roundings on the way to a row.
            scale = np.abs(whole.fields[name]).max()
            np.testing.assert_allclose(part.fields[name], whole.fields[name], rtol=0, atol=64 * EPS * scale)
        for name in kept_summaries:
            np.testing.assert_allclose(part.summaries[name], whole.summaries[name], rtol=256 * EPS)
            np.testing.assert_allclose(part.errors[name], whole.errors[name], rtol=1e-6, atol=1e-12)


def test_both_forms__agree():
    rng = np.random.default_rng(1)
    varied = {
        "input.length": np.repeat([0.03, 0.04, 0.05], 4),
        "bodies.ram.mass": rng.uniform(1, 5, 12),
        "forces.load.force": rng.uniform(-100, 100, 12),
    }
    fields, summaries = ["reduced_inertia", "reduced_moment"], ["excess_work", "flywheel_wittenbauer"]
    machine = Machine(SCENE, summaries, fields, varied, 48)
    together = machine.evaluate(varied)
    assert machine.forms_used == {"factorised"}
    assert not together.status.any()
    for i in range(12):
        alone = machine.evaluate({path: values[i : i + 1] for path, values in varied.items()})
        for name in fields:
            scale = np.abs(alone.fields[name]).max()
            np.testing.assert_allclose(together.fields[name][i], alone.fields[name][0], rtol=0, atol=64 * EPS * scale)
        for name in summaries:
            np.testing.assert_allclose(together.summaries[name][i], alone.summaries[name][0], rtol=256 * EPS)
    assert machine.forms_used == {"factorised", "whole"}


def test_part_of_a_buffer__gives_the_same_bits_as_a_buffer_of_its_own():
    varied = crank_lengths(5)
    machine = Machine(SCENE, ["excess_work"], ["reduced_moment"], varied, 48)
    own = machine.evaluate(varied)
    part = machine.evaluate(varied, buffer=machine.new_buffer(64))
    for ours, theirs in ((own.summaries, part.summaries), (own.errors, part.errors), (own.fields, part.fields)):
        for name in ours:
            assert ours[name].tobytes() == theirs[name].tobytes(), name


# The cache

CHILD = """
import json, sys
import numpy as np
from engine import Machine, Scene
scene = Scene.model_validate(json.loads(sys.stdin.read()))
print(float(Machine(scene, fields=["B.y"], positions=8).evaluate({}).fields["B.y"][0, 3]))
"""


# Functions that the compiler doesn't take into the kernel could come from elsewhere on another run.
ERRORS = """
import json, sys
import numpy as np
from engine import Machine, Scene
scene = Scene.model_validate(json.loads(sys.stdin.read()))
varied = {"input.length": np.linspace(0.03, 0.05, 64)}
machine = Machine(scene, ["excess_work", "speed_fluctuation"], varied=varied, positions=20000)
outcome = machine.evaluate(varied)
print(*(a.tobytes().hex() for a in (*outcome.summaries.values(), *outcome.errors.values())))
"""


def child(engine_in: Path, cache: Path, program: str = CHILD) -> str:
    """What a process computes with the engine in a folder: B.y at the fourth position, or another program's output."""
    done = subprocess.run(
        [sys.executable, "-c", program],
        input=SCENE.model_dump_json(),
        env={**os.environ, "PYTHONPATH": str(engine_in), "XDG_CACHE_HOME": str(cache)},
        cwd=engine_in,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_first_run_and_runs_from_the_cache__give_the_same_bits(tmp_path):
    assert child(ROOT, tmp_path, ERRORS) == child(ROOT, tmp_path, ERRORS)


def kernels_in(cache: Path) -> int:
    return len(list((cache / "machine-sweeps").glob("*/kernel.py")))


def test_changed_engine__is_compiled_anew_and_never_taken_from_the_cache(tmp_path):
    """A function called by the kernel, in a file of its own, is what a compiler's cache overlooks."""
    copy, cache = tmp_path / "copy", tmp_path / "cache"
    shutil.copytree(ROOT / "engine", copy / "engine", ignore=shutil.ignore_patterns("__pycache__"))
    before = child(copy, cache)
    assert kernels_in(cache) == 1
    law = copy / "engine" / "laws" / "kinematics" / "rrr.py"
    text = law.read_text()
    mirrored = text.replace("mode * math.sqrt(", "-mode * math.sqrt(", 1)
    assert mirrored != text
    law.write_text(mirrored)
    after = child(copy, cache)
    assert kernels_in(cache) == 2
    # B lies on the other side of A → D: well apart in y.
    assert abs(float(after) - float(before)) > 0.05
    law.write_text(text)
    assert child(copy, cache) == before
    assert kernels_in(cache) == 2


@pytest.mark.parametrize("kind", ["nbc", "nbi"])
@pytest.mark.parametrize("left", ["none", "half"])
def test_broken_cache_of_functions__is_recovered(kind, left, tmp_path):
    """Functions outlive the kernels they were compiled for; a kernel that is new meets them broken."""
    before = child(ROOT, tmp_path)
    for kernel in (tmp_path / "machine-sweeps").glob("*/kernel.py"):
        shutil.rmtree(kernel.parent)
    for path in tmp_path.rglob(f"*.{kind}"):
        content = path.read_bytes()
        path.write_bytes(content[: len(content) // 2] if left == "half" else b"")
    assert child(ROOT, tmp_path) == before


def test_process_without_any_place_for_a_cache__computes_all_the_same(tmp_path):
    (tmp_path / "file").write_text("")
    assert child(ROOT, tmp_path / "file") == child(ROOT, tmp_path / "cache")


def small() -> Machine:
    return Machine(SCENE, fields=["A.x"], positions=8)


# The crank alone: 0.05 cos φ, one rounding for the product, one for the cosine, one for the angle.
EXPECTED = 0.05 * np.cos(np.arange(8) * np.pi / 4)


def assert_right(machine: Machine) -> None:
    np.testing.assert_allclose(machine.evaluate({}).fields["A.x"][0], EXPECTED, rtol=0, atol=4 * EPS * 0.05)


def test_cache_that_cannot_be_made__is_replaced_by_a_temporary_one(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    jit.load_kernel.cache_clear()
    folder = jit.cache_folder()
    assert tmp_path not in folder.parents
    assert os.access(folder, os.W_OK)
    assert_right(small())


def test_home_that_cannot_be_written__is_replaced_by_a_temporary_folder(tmp_path, monkeypatch):
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    (tmp_path / "home").write_text("")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    jit.load_kernel.cache_clear()
    assert tmp_path not in jit.cache_folder().parents
    assert_right(small())


def test_cache__has_the_kernel_and_what_was_compiled(fresh_cache):
    assert_right(small())
    (kernel,) = fresh_cache.glob("*/kernel.py")
    assert kernel.read_text() == small().source("whole").text
    assert list(kernel.parent.rglob("*.nbc"))
    assert list(kernel.parent.rglob("*.nbi"))


@pytest.mark.parametrize("kind", ["nbc", "nbi", "py"])
@pytest.mark.parametrize("left", ["none", "half", "rubbish"])
def test_broken_cache__is_recovered(kind, left, fresh_cache):
    assert_right(small())
    spoilt = list(fresh_cache.rglob(f"*.{kind}"))
    assert spoilt
    for path in spoilt:
        content = path.read_bytes()
        path.write_bytes({"none": b"", "half": content[: len(content) // 2], "rubbish": b"\x07rubbish" * 9}[left])
    jit.load_kernel.cache_clear()
    assert_right(small())
    jit.load_kernel.cache_clear()
    assert_right(small())


# Several threads


def test_two_threads__get_what_one_gets():
    varied = crank_lengths(400)
    machine = Machine(SCENE, ["excess_work"], ["reduced_moment"], varied, 48)
    other = Machine(SCENE, [], ["A.x"], varied, 48)
    expected, crank = machine.evaluate(varied), other.evaluate(varied)

    def again(i: int) -> bool:
        if i % 3 == 0:
            return other.evaluate(varied).fields["A.x"].tobytes() == crank.fields["A.x"].tobytes()
        found = machine.evaluate(varied)
        return (
            found.summaries["excess_work"].tobytes() == expected.summaries["excess_work"].tobytes()
            and found.fields["reduced_moment"].tobytes() == expected.fields["reduced_moment"].tobytes()
        )

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(again, range(40)))


def test_two_threads__may_both_be_the_first(fresh_cache):
    with ThreadPoolExecutor(2) as pool:
        for done in [pool.submit(assert_right, small()) for _ in range(4)]:
            done.result()
