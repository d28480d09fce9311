"""What survives kills and full disks."""

import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from store_samples import KILLED, NAMES, complete, files, fill, layout, results, run_child, same_bits

from sweeps.store import MappedResult, Store, StoreError

posix = pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals and limits")


def check_flagged_blocks(path: Path) -> int:
    """Compare each block flagged as done with its numbers; return how many there are."""
    part = path.with_name("out.part.h5")
    if not part.exists():
        return 0
    with h5py.File(part, "r") as file:
        done = np.flatnonzero(file["progress/block_done"][:])
        expected = Store(path, layout(**KILLED))
        for i in done:
            rows = expected.layout.slice(i)
            for name, values in results(expected, i).items():
                assert file[name][rows].tobytes() == values.tobytes()
    return len(done)


def test_every_flush__flagged_blocks_are_in_the_file(path: Path, part: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A kill leaves what the operating system has been given: look at it before and after each flush."""
    shape = layout()
    real = h5py.File.flush
    seen = []

    def look() -> None:
        content = part.read_bytes()
        flags = content[flags_at : flags_at + shape.blocks]
        for i in np.flatnonzero(np.frombuffer(flags, np.uint8)):
            for name, values in results(store, i).items():
                at = rows_at[name] + shape.slice(i).start * (values.nbytes // len(values))
                assert content[at : at + values.nbytes] == values.tobytes()
        seen.append(sum(flags))

    def flush(file: h5py.File) -> None:
        look()
        real(file)
        look()

    with Store.open(path, shape) as store:
        with h5py.File(part, "r+") as file:
            rows_at = {name: file[name].id.get_offset() for name in NAMES}
            flags_at = file["progress/block_done"].id.get_offset()
        monkeypatch.setattr(h5py.File, "flush", flush)
        fill(store)
    assert seen[-1] == shape.blocks


def test_leftover_of_killed_creation__is_made_anew(path: Path, part: Path) -> None:
    part.with_name("out.part.h5.new").write_bytes(b"half a file")
    complete(path, layout())
    assert files(path.parent) == ["out.h5"]


def test_kill_before_rename__next_run_only_finishes(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def killed(old: Path, new: Path) -> None:
        raise KeyboardInterrupt

    with Store.open(path, layout()) as store, monkeypatch.context() as patch:
        fill(store)
        patch.setattr(Path, "replace", killed)
        with pytest.raises(KeyboardInterrupt):
            store.finish("ill")
    with Store.open(path, layout()) as store:
        assert store.pending == []
        store.finish("well")
    assert MappedResult(path).attributes["outcome"] == "well"
    assert files(path.parent) == ["out.h5"]


def test_finishing__changes_attributes_in_place_only(path: Path, part: Path) -> None:
    with Store.open(path, layout()) as store:
        fill(store)
    before = np.frombuffer(part.read_bytes(), np.uint8)
    with Store.open(path, layout()) as store:
        store.finish("x" * 2000)
    after = np.frombuffer(path.read_bytes(), np.uint8)
    assert len(after) == len(before)
    # The two texts hold 32 and 2000 bytes, which start out as zeros.
    changed = np.flatnonzero(before != after)
    assert len(changed) == len(MappedResult(path).attributes["finished"]) + 2000
    assert (before[changed] == 0).all()


def test_unfinished_file__pending_are_the_blocks_not_written(path: Path) -> None:
    with Store.open(path, layout()) as store:
        assert store.pending == [0, 1, 2, 3, 4, 5]
        fill(store, 3)
    with Store.open(path, layout()) as store:
        assert store.pending == [0, 1, 2, 4, 5]
        with pytest.raises(StoreError, match="5 blocks are not done"):
            store.finish()


@posix
def test_disk_full_at_creation__store_error_and_nothing_left(path: Path) -> None:
    message = run_child(f"child_creates_on_full_disk(Path({str(path)!r}))")
    assert "out.part.h5" in message
    assert "disk or the quota is full" in message
    assert files(path.parent) == []


@posix
def test_disk_full_at_work__done_blocks_stay_and_sweep_goes_on(tmp_path: Path, path: Path) -> None:
    message = run_child(f"child_fills_disk_at_work(Path({str(path)!r}))")
    assert message.count("cannot write") == 2
    assert "disk or the quota is full" in message
    assert check_flagged_blocks(path) == 3
    reference = complete(tmp_path / "reference.h5", layout(**KILLED))
    assert same_bits(complete(path, layout(**KILLED)), reference)


@posix
def test_disk_full_at_the_end__finished_all_the_same(path: Path) -> None:
    """Finishing needs no room, so that it cannot fail after the work is done."""
    assert run_child(f"child_finishes_on_full_disk(Path({str(path)!r}))") == ""
    assert MappedResult(path).done.sum() == MappedResult(path).done.size
    assert MappedResult(path).attributes["outcome"] == "n" * 2000


def test_too_little_space__named_before_any_file_is_made(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: SimpleNamespace(free=2_000_000))
    with pytest.raises(StoreError, match=r"needs 4\d\.\d MB, 2\.0 MB are free .* float32"):
        Store.open(path, layout(**KILLED))
    assert files(path.parent) == []
