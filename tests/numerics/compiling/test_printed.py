"""Printed modules: packed instructions, the cache on disk and what spoils it, several threads, sources reached."""

import ast
import hashlib
import os
import pickle
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from packed import assert_packed
from printed_calls import assembly_of, call_printed, filled

from engine.compiling import kept_code, printed_functions, sources
from engine.compiling.blocks import LANES, PANEL_POSITIONS
from engine.compiling.decorators import driver
from engine.compiling.printed_code import PrintedCode
from engine.compiling.running import spread
from engine.compiling.sources import digest_of_printed
from engine.graph.functions import field_function, functions_of
from engine.graph.nodes import Graph
from engine.laws.kinematics.rrr import rrr_position

ROOT = Path(__file__).parents[3]
POSITIONS = 48


def forget() -> None:
    """As if the process had been started anew."""
    for known in (printed_functions._library, kept_code._say_once, kept_code.folder_of):
        known.cache_clear()


@pytest.fixture
def fresh_cache(tmp_path, monkeypatch) -> Path:
    """An empty cache of this test's own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    forget()
    yield tmp_path / "machine-sweeps"
    forget()


def coupler(length: float = 0.2) -> tuple[object, list, PrintedCode]:
    """Functions of a graph that gives the coupler of a four-bar, its nodes, and what fills rows of them."""
    graph = Graph()
    first, last = graph.derived("first", lambda n: 0.0), graph.derived("last", lambda n: 6.0)
    r = graph.derived("r", lambda n: 0.05)
    x, y, *_ = graph.apply(rrr_position, (r * graph.cos_q, r * graph.sin_q), (0.22, 0.01), length, 0.15, 1.0)
    functions = functions_of(graph, first, last, [x, y])
    return functions, [x, y], field_function([x, y], functions.rows, np.dtype(float))


def coupler_rows(code: PrintedCode, functions: object) -> np.ndarray:
    """What the printed function makes of one variant."""
    q = np.arange(POSITIONS) * (2 * np.pi / POSITIONS)
    p = np.array([n.compute({}) for n in functions.numbers])
    rows = np.empty((2, 1, POSITIONS))
    call_printed(code, p, functions.memory, q, np.cos(q), np.sin(q), 0, rows)
    return rows[:, 0]


def assert_right(length: float = 0.2) -> None:
    """The coupler's joint lies `length` from the crank's pin and 0.15 from the pivot, to some roundings."""
    functions, _, code = coupler(length)
    x, y = coupler_rows(code, functions)
    q = np.arange(POSITIONS) * (2 * np.pi / POSITIONS)
    np.testing.assert_allclose(np.hypot(x - 0.05 * np.cos(q), y - 0.05 * np.sin(q)), length, rtol=1e-14)
    np.testing.assert_allclose(np.hypot(x - 0.22, y - 0.01), 0.15, rtol=1e-14)


@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("many", [1, 6], ids=["rows one by one", "rows together"])
def test_fields__are_filled_by_packed_instructions(dtype, many, fresh_cache):
    functions, (x, y), _ = coupler()
    # With more rows than the compiler tells apart.
    nodes = [x, y, *(x * (2.0 + i) + y for i in range(many - 1))]
    assert_packed(assembly_of(field_function(nodes, functions.rows, np.dtype(dtype))), 1, ("root", "quotient"))


def test_tiles__are_filled_by_packed_instructions(fresh_cache):
    assert_packed(assembly_of(coupler()[0].codes["curves"]), 1, ("root", "quotient"))


def test_tile__is_the_same_to_the_last_bit_in_every_lane_and_at_every_position(fresh_cache):
    functions, *_ = coupler()
    numbers = np.repeat(np.array([[n.compute({})] for n in functions.numbers]), LANES, axis=1)
    q = np.full((PANEL_POSITIONS, LANES), 1.234)
    tile = filled(functions, "curves", numbers, q, 2)
    assert (tile == tile[:, :1, :1]).all()


# The cache


def test_cache__has_what_was_compiled(fresh_cache):
    assert_right()
    folder = fresh_cache / digest_of_printed(coupler()[2])[:32]
    assert list(folder.glob("*.nbc"))
    assert list(folder.glob("*.nbi"))
    for made in (fresh_cache, folder):
        assert made.stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("kind", ["nbc", "nbi"])
@pytest.mark.parametrize("left", ["none", "half", "rubbish", "one bit"])
def test_broken_cache__is_recovered(kind, left, fresh_cache):
    assert_right()
    spoilt = list(fresh_cache.rglob(f"*.{kind}"))
    assert spoilt
    for path in spoilt:
        content = path.read_bytes()
        changed = bytearray(content)
        changed[len(content) // 2] ^= 1
        half = content[: len(content) // 2]
        path.write_bytes({"none": b"", "half": half, "rubbish": b"\x07rubbish" * 9, "one bit": bytes(changed)}[left])
    for _ in range(2):
        forget()
        assert_right()
    for path in spoilt:
        assert hashlib.sha256(path.read_bytes()[32:]).digest() == path.read_bytes()[:32]


def counted(begin, end, found):
    for i in range(begin, end):
        found[i] = i


@pytest.mark.parametrize("kind", ["nbc", "nbi"])
def test_broken_driver__is_recovered(kind, fresh_cache):
    for turn in range(3):
        found = np.zeros(9)
        own = driver(counted)
        spread(own, 9, lambda found=found: (found,))
        assert (found == np.arange(9)).all()
        spoilt = list(fresh_cache.rglob(f"*counted*.{kind}"))
        assert spoilt
        for path in spoilt if turn == 0 else []:
            path.write_bytes(b"\x07rubbish" * 9)


def called(begin, end, function):
    function(begin, end, np.zeros(end))


def test_function_without_its_type__is_refused():
    """Two such functions have two types in Numba; code compiled for one would be run with the other."""
    plain = driver(counted)
    with pytest.raises(TypeError, match="value of its signature"):
        spread(driver(called), 1, lambda: (plain,))


@pytest.mark.parametrize("variable", ["XDG_CACHE_HOME", "HOME"])
def test_cache_that_cannot_be_made__is_done_without(variable, tmp_path, monkeypatch, caplog):
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    (tmp_path / "file").write_text("")
    monkeypatch.setenv(variable, str(tmp_path / "file"))
    forget()
    assert kept_code.cache_folder() is None
    assert_right()
    forget()
    (record,) = caplog.records
    assert "Machine code is compiled in every run: no cache" in record.getMessage()
    assert list(tmp_path.iterdir()) == [tmp_path / "file"]


def test_cache_that_others_may_write_to__is_not_believed(fresh_cache, caplog):
    assert_right()
    before = sorted(fresh_cache.rglob("*"))
    fresh_cache.chmod(0o770)
    forget()
    assert kept_code.cache_folder() is None
    assert_right(0.21)
    assert sorted(fresh_cache.rglob("*")) == before
    assert len(caplog.records) == 1


class Planted:
    """What leaves a mark when it is unpickled."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self) -> tuple:
        return Path.touch, (self.mark,)


@pytest.mark.parametrize("where", ["folder", "entry"])
def test_entry_that_others_may_have_written__is_neither_unpickled_nor_run(where, fresh_cache):
    assert_right()
    payload = pickle.dumps(Planted(fresh_cache.parent / "mark"))
    entries = list(fresh_cache.rglob("*.nb?"))
    for path in entries:
        path.write_bytes(hashlib.sha256(payload).digest() + payload)
        (path if where == "entry" else path.parent).chmod(0o770)
    forget()
    assert_right()
    assert not (fresh_cache.parent / "mark").exists()
    # Made again, for the user alone.
    assert all(path.stat().st_mode & 0o777 == 0o600 for path in entries)
    assert all(path.parent.stat().st_mode & 0o777 == 0o700 for path in entries)


def test_full_disk_under_the_cache__is_said_once_and_nothing_left(fresh_cache, monkeypatch, caplog):
    def full(self: object, path: str) -> None:
        raise OSError(28, "No space left on device")

    forget()
    monkeypatch.setattr(kept_code._VerifiedFiles, "_open_for_write", full)
    assert_right()
    assert [path for path in fresh_cache.rglob("*") if path.is_file()] == []
    (record,) = caplog.records
    assert "can't be written (No space left on device)" in record.getMessage()


def test_warm_cache_that_cannot_be_written__is_read_and_left_as_it_is(fresh_cache, monkeypatch, caplog):
    assert_right()
    before = {path: path.stat() for path in sorted(fresh_cache.rglob("*")) if path.is_file()}
    forget()

    def refused(*arguments: object, **options: object) -> None:
        raise OSError(30, "Read-only file system")

    # An administrator may write anywhere.
    for name in ("mkdir", "makedirs", "utime", "unlink", "replace"):
        monkeypatch.setattr(os, name, refused)
    monkeypatch.setattr(kept_code._VerifiedFiles, "_open_for_write", refused)
    assert_right()
    assert caplog.records == []
    assert {path: path.stat() for path in sorted(fresh_cache.rglob("*")) if path.is_file()}.keys() == before.keys()
    forget()


# Other processes. A law called by what is printed, in a file of its own, is what a compiler's cache overlooks.

CHILD = """
import sys
sys.path[1:1] = sys.argv[1:]
from test_printed import coupler, coupler_rows
functions, _, code = coupler()
print(coupler_rows(code, functions).tobytes().hex())
"""


def child(engine_in: Path, cache: Path) -> np.ndarray:
    """Rows that a process computes with the engine in a folder."""
    done = subprocess.run(
        [sys.executable, "-c", CHILD, str(Path(__file__).parent), str(ROOT / "tests" / "oracles")],
        env={**os.environ, "PYTHONPATH": str(engine_in), "XDG_CACHE_HOME": str(cache)},
        cwd=engine_in,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return np.frombuffer(bytes.fromhex(done.stdout.strip())).reshape(2, POSITIONS)


def compiled_in(cache: Path) -> dict[Path, int]:
    """Files of machine code, and when each was written."""
    return {path: path.stat().st_mtime_ns for path in (cache / "machine-sweeps").rglob("*.nbc")}


def test_second_process__loads_what_the_first_compiled_and_computes_the_same_bits(tmp_path):
    before = child(ROOT, tmp_path)
    kept = compiled_in(tmp_path)
    assert kept
    assert child(ROOT, tmp_path).tobytes() == before.tobytes()
    assert compiled_in(tmp_path) == kept
    # Laws outlive what they were compiled for; what is printed anew meets some of their files broken, of either kind.
    shutil.rmtree(tmp_path / "machine-sweeps" / digest_of_printed(coupler()[2])[:32])
    spoilt = sorted(tmp_path.rglob("*.nb?"))[::3]
    assert {path.suffix for path in spoilt} == {".nbc", ".nbi"}
    for path in spoilt:
        path.write_bytes(path.read_bytes()[:100])
    assert child(ROOT, tmp_path).tobytes() == before.tobytes()


def test_changed_law__is_compiled_anew_and_what_cannot_be_reached_is_not(tmp_path):
    copy, cache = tmp_path / "copy", tmp_path / "cache"
    shutil.copytree(ROOT / "engine", copy / "engine", ignore=shutil.ignore_patterns("__pycache__"))
    before = child(copy, cache)
    kept = compiled_in(cache)
    elsewhere = copy / "engine" / "laws" / "brakes.py"
    elsewhere.write_text(elsewhere.read_text() + "\n# Nothing that a coupler depends on.\n")
    assert child(copy, cache).tobytes() == before.tobytes()
    assert compiled_in(cache) == kept
    law = copy / "engine" / "laws" / "kinematics" / "rrr.py"
    text = law.read_text()
    mirrored = text.replace("mode * math.sqrt(", "-mode * math.sqrt(", 1)
    assert mirrored != text
    law.write_text(mirrored)
    # The joint lies on the other side of A → D: well apart.
    assert np.abs(child(copy, cache) - before).max() > 0.05
    assert len(compiled_in(cache)) > len(kept)


# Which sources are reached


@cache
def imported_by(path: Path) -> set[Path]:
    """Files of the engine that one imports, read off its syntax tree."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "engine":
            if node.module == "engine":
                # Of a room loaded on use, any module may be used.
                rooms = [ROOT / "engine" / alias.name for alias in node.names if alias.name != "on_use"]
                assert all(room.is_dir() for room in rooms), f"{path} imports from the engine's door"
                found.update(file for room in rooms for file in room.rglob("*.py") if file.name != "__init__.py")
            names = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
            files = [ROOT.joinpath(*name.split(".")).with_suffix(".py") for name in names]
            found.update(file for file in files if file.exists())
        assert not (isinstance(node, ast.Import) and any(a.name.split(".")[0] == "engine" for a in node.names))
    return found


def test_reached_sources__are_all_that_is_imported():
    for path in sorted((ROOT / "engine").rglob("*.py")):
        if path.name == "__init__.py":
            continue
        module = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        reached = sources._reached(module)
        assert path in reached
        for file in reached:
            if file.name != "__init__.py":
                assert imported_by(file) <= reached, file


def test_reached_sources__are_few():
    """An edit to most of the engine leaves what was compiled as it is."""
    assert len(sources._reached("engine.laws.kinematics.rrr")) < 15
    assert len(sources._reached("engine.cycle.driver")) < 40


# Several threads


def test_several_threads__may_all_be_the_first(fresh_cache):
    with ThreadPoolExecutor(3) as pool:
        for done in [pool.submit(assert_right, 0.2 + 0.01 * (i % 2)) for i in range(6)]:
            done.result()
