"""Layouts, results and child processes for the tests of the store."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np

from sweeps.store import Column, FieldAxis, FileLayout, Store, StoreError, read_columns

# 42 MB in 40 blocks, mostly writing: kills fall on creation, rows and flags.
KILLED = {"variants": 314, "block": 8, "positions": 32768}
NAMES = ("length", "speed", "peak_torque", "order", "status", "torque")
HERE = Path(__file__).parent
CHILD_PATH = os.pathsep.join(str(folder) for folder in (HERE.parents[2], HERE))


def layout(variants: int = 22, block: int = 4, positions: int = 5, **changes: object) -> FileLayout:
    fields = {
        "variants": variants,
        "block": block,
        "columns": (
            Column("length", "crank length", "m"),
            Column("speed", "crank speed", "rad s-1"),
            Column("peak_torque", "greatest driving torque", "N m"),
            Column("order", "strongest order", "1", dtype=np.int64),
            Column("status", "status of the variant", "1", dtype=np.uint8),
            Column("torque", "driving torque", "N m", ("variant", "position"), np.float32),
        ),
        "attributes": {"study_hash": "1a2b", "title": "Shear", "study": "steps = 3\nload = 12 kN"},
        "coordinates": ("length", "speed"),
        "status_codes": {0: "ok", 1: "cannot be assembled"},
        "position": FieldAxis("phi", "crank angle", "rad", np.linspace(0, 2 * np.pi, positions, endpoint=False)),
    }
    return FileLayout(**{**fields, **changes})


def results(store: Store, i: int) -> dict[str, np.ndarray]:
    """Numbers that depend on the block alone, with NaN among them as in real sweeps."""
    rows = store.layout.slice(i)
    rng = np.random.default_rng(i)
    count = rows.stop - rows.start
    arrays = {name: rng.normal(size=count) for name in ("length", "speed", "peak_torque")}
    arrays["order"] = rng.integers(1, 9, count)
    arrays["status"] = rng.integers(0, 2, count, dtype=np.uint8)
    positions = len(store.layout.position.values)
    arrays["torque"] = np.arange(i, i + count * positions, dtype=np.float32).reshape(count, positions)
    arrays["peak_torque"][arrays["status"] > 0] = np.nan
    return arrays


def fill(store: Store, *blocks: int) -> None:
    """Write some blocks, all that are pending where none are named."""
    for i in blocks or store.pending:
        store.write(i, results(store, i))


def begun(path: Path, *blocks: int, **changes: object) -> None:
    """A sweep that ends when some blocks are written."""
    with Store.open(path, layout(**changes)) as store:
        fill(store, *blocks)


def sweep(path: Path, shape: FileLayout, **options: bool) -> None:
    with Store.open(path, shape, **options) as store:
        fill(store)
        store.finish("all is well")


def complete(path: Path, shape: FileLayout, **options: bool) -> dict[str, np.ndarray]:
    sweep(path, shape, **options)
    return read_columns(path, NAMES)


def same_bits(left: dict[str, np.ndarray], right: dict[str, np.ndarray]) -> bool:
    return left.keys() == right.keys() and all(
        left[name].dtype == right[name].dtype and left[name].tobytes() == right[name].tobytes() for name in left
    )


def files(folder: Path) -> list[str]:
    return sorted(entry.name for entry in folder.iterdir())


def start_child(call: str) -> subprocess.Popen:
    code = f"import store_samples; from pathlib import Path; store_samples.{call}"
    return subprocess.Popen(
        [sys.executable, "-W", "error", "-c", code],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": CHILD_PATH},
    )


def run_child(call: str) -> str:
    """Run a function of this module in a process of its own; a crash at its exit is a failure too."""
    with start_child(call) as child:
        out, err = child.communicate(timeout=60)
    assert child.returncode == 0, err
    assert err == ""
    return out


def limit_file_size(size: int) -> None:
    import resource  # absent on Windows

    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))


def child_restarts(path: Path) -> None:
    try:
        Store.open(path, layout(), restart=True).close()
    except StoreError as error:
        print(error)


def child_creates_on_full_disk(path: Path) -> None:
    limit_file_size(100_000)
    try:
        Store.open(path, layout(**KILLED))
    except StoreError as error:
        print(error)


def child_fills_disk_at_work(path: Path) -> None:
    store = Store.open(path, layout(**KILLED))
    fill(store, 0, 1, 2)
    limit_file_size(100_000)
    for i in (20, 21):
        try:
            store.write(i, results(store, i))
        except StoreError as error:
            print(error)
    try:
        store.close()
    except StoreError as error:
        print("close:", error)


def child_finishes_on_full_disk(path: Path) -> None:
    with Store.open(path, layout(**KILLED)) as store:
        fill(store)
        limit_file_size(store.part.stat().st_size)
        store.finish("n" * 5000)


def child_holds(path: Path) -> None:
    with Store.open(path, layout()):
        print("held", flush=True)
        sys.stdin.readline()


def child_locks(part: Path, seconds: float) -> None:
    """As a program does that reads a file."""
    with h5py.File(part):
        print("locked", flush=True)
        time.sleep(seconds)


def child_tries(path: Path) -> None:
    print("trying", flush=True)
    try:
        Store.open(path, layout()).close()
    except StoreError as error:
        print(error, flush=True)
