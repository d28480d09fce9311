"""Opening and writing a store: what is refused, what is continued, and in which words."""

import os
import shutil
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from store_samples import (
    KILLED,
    NAMES,
    begun,
    complete,
    files,
    fill,
    layout,
    results,
    run_child,
    same_bits,
    start_child,
)

from sweeps.store import Column, FileLayout, MappedResult, Store, StoreError, read_columns, update_texts
from sweeps.store.errors import explained


def other_study() -> FileLayout:
    return layout(attributes={"study_hash": "9z9z", "study": "steps = 4\nload = 12 kN"})


def test_part_of_another_study__set_aside_as_a_source(path: Path, part: Path) -> None:
    begun(path, 0)
    before = part.read_bytes()
    with Store.open(path, other_study()) as store:
        assert store.pending == [0, 1, 2, 3, 4, 5]
        assert store.sources == (path.with_name("out.1.part.h5"),)
        (note,) = store.notes
        fill(store, 1)
    assert "renamed to" in note
    assert "hash" not in note
    assert path.with_name("out.1.part.h5").read_bytes() == before
    with Store.open(path, other_study()) as store:
        assert store.pending == [0, 2, 3, 4, 5]
        assert store.sources == (path.with_name("out.1.part.h5"),)
        assert store.notes == []


def test_part_of_another_study_without_a_block__thrown_away(path: Path) -> None:
    Store.open(path, layout()).close()
    with Store.open(path, other_study()) as store:
        assert (store.sources, store.notes) == ((), [])
    assert files(path.parent) == ["out.part.h5"]


@pytest.mark.parametrize(
    "changes",
    [
        {"variants": 23},
        {"position": layout().position._replace(values=np.arange(5.0))},
        {"position": layout().position._replace(units="deg")},
        {"status_codes": {0: "ok", 1: "jams"}},
        {"columns": layout().columns[:-1]},
    ],
)
def test_changed_layout__part_set_aside(path: Path, changes: dict) -> None:
    begun(path, 0)
    with Store.open(path, layout(**changes)) as store:
        assert store.layout.blocks == len(store.pending)
    assert files(path.parent) == ["out.1.part.h5", "out.part.h5"]


def test_other_block_size__that_of_the_file_is_kept(path: Path) -> None:
    with Store.open(path, layout(), block=lambda: 5) as store:
        fill(store, 0)
    with Store.open(path, layout(block=7), block=lambda: pytest.fail("asked again")) as store:
        assert store.layout.block == 5
        assert store.pending == [1, 2, 3, 4]


@pytest.mark.parametrize("finished", [True, False])
def test_other_words__change_nothing_else(path: Path, part: Path, finished: bool) -> None:
    if finished:
        arrays = complete(path, layout())
    else:
        begun(path, 0)
        arrays = read_columns(part)
    file = path if finished else part
    update_texts(file, {"title": "Länge", "study": "x" * 100_000})
    assert MappedResult(file).attributes["title"] == "Länge"
    found = read_columns(file, list(arrays))
    assert all(found[name].tobytes() == values.tobytes() for name, values in arrays.items())
    before = file.stat().st_mtime_ns
    update_texts(file, {"title": "Länge"})
    assert file.stat().st_mtime_ns == before
    with Store.open(path, layout()) as store:
        assert store.pending == ([] if finished else [1, 2, 3, 4, 5])
    assert len(files(path.parent)) == 1


def test_restart__old_file_stays_until_the_new_one_is_finished(path: Path) -> None:
    complete(path, layout())
    for _ in range(2):
        with Store.open(path, other_study(), restart=True) as store:
            assert len(store.pending) == 6
            fill(store, 0)
    assert MappedResult(path).attributes["study_hash"] == "1a2b"
    with Store.open(path, other_study()) as store:
        assert store.pending == [1, 2, 3, 4, 5]
    complete(path, other_study())
    assert MappedResult(path).attributes["study_hash"] == "9z9z"
    assert files(path.parent) == ["out.h5"]


@pytest.mark.parametrize("content", [b"", b"some text"])
def test_foreign_file_under_the_name__kept(path: Path, content: bytes) -> None:
    path.write_bytes(content)
    with pytest.raises(StoreError, match=r"cannot read .*out\.h5"):
        Store.open(path, layout())
    assert path.read_bytes() == content
    path.unlink()
    h5py.File(path, "w").close()
    with pytest.raises(StoreError, match="not a sweep result"):
        Store.open(path, layout())


def test_part_file_cut_off__set_aside_and_made_anew(path: Path, part: Path) -> None:
    Store.open(path, layout()).close()
    with part.open("rb+") as file:
        file.truncate(1000)
    with Store.open(path, layout()) as store:
        (note,) = store.notes
        assert len(store.pending) == 6
    assert "damaged" in note
    complete(path, layout())
    assert files(path.parent) == ["out.1.part.h5", "out.h5"]


def test_finished_file_cut_off__all_is_pending(path: Path) -> None:
    complete(path, layout())
    with path.open("rb+") as file:
        file.truncate(path.stat().st_size - 1000)
    with pytest.raises(StoreError, match=r"damaged or truncated\. Run its study again"):
        MappedResult(path)
    with Store.open(path, layout()) as store:
        (note,) = store.notes
        assert len(store.pending) == 6
    assert "unreadable" in note


def test_second_writer_in_another_process__refused(path: Path, part: Path) -> None:
    with start_child(f"child_holds(Path({str(path)!r}))") as child:
        assert child.stdout.readline() == "held\n"
        for restart in (False, True):
            with pytest.raises(StoreError, match=r"(?i)another sweep is writing"):
                Store.open(path, layout(), restart=restart)
        assert MappedResult(part).done.sum() == 0
        assert np.isnan(read_columns(part, ["length"])["length"]).all()
        child.communicate("\n", timeout=60)
    complete(path, layout())


def test_second_writer_in_the_process__refused_and_first_goes_on(path: Path) -> None:
    with Store.open(path, layout()) as store:
        for restart in (False, True):
            with pytest.raises(StoreError, match="another sweep is writing"):
                Store.open(path, layout(), restart=restart)
        fill(store, 3)
    store.close()
    with Store.open(path, layout()) as store:
        assert store.pending == [0, 1, 2, 4, 5]
        with pytest.raises(StoreError, match="5 blocks are not done"):
            store.finish()


def test_second_writer_before_the_draft_has_its_name__first_goes_on(path, part, monkeypatch):
    real, children = Path.replace, []

    def late(old: Path, new: Path) -> Path:
        children.append(start_child(f"child_tries(Path({str(path)!r}))"))
        assert children[0].stdout.readline() == "trying\n"
        # Time in which the other one would take the draft, closed already, for what a killed one left.
        time.sleep(0.5)
        return real(old, new)

    with monkeypatch.context() as patched:
        patched.setattr(Path, "replace", late)
        store = Store.open(path, layout())
    with store, children[0] as child:
        out, err = child.communicate(timeout=60)
        assert (err, child.returncode) == ("", 0)
        assert "another sweep is writing" in out
        fill(store, 0)
    assert files(path.parent) == ["out.part.h5"]


def test_part_file_appears_during_creation__not_overwritten(path, part, monkeypatch):
    real = h5py.File

    def slow(name: Path, mode: str, **options: object) -> h5py.File:
        if mode == "x":
            part.write_bytes(b"of the quicker one")
        return real(name, mode, **options)

    monkeypatch.setattr(h5py, "File", slow)
    with pytest.raises(StoreError, match="another sweep is writing"):
        Store.open(path, layout())
    assert part.read_bytes() == b"of the quicker one"
    assert files(path.parent) == ["out.part.h5"]


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (OSError(37, "No locks available"), "HDF5_USE_FILE_LOCKING=FALSE"),
        (RuntimeError("Can't close (errno = 28, error message = 'No space left on device')"), "Make room"),
        (PermissionError(13, "Permission denied"), "Look at the permissions"),
        (OSError(30, "errno = 30, error message = 'x', o_flags = c2"), r"out.h5: Read-only file system\. [^(]*$"),
        (OSError(30, "Read-only file system"), "give another --out"),
    ],
)
def test_system_error__store_error_with_path_and_mend(error: Exception, words: str) -> None:
    with pytest.raises(StoreError, match=words) as caught, explained(Path("a/out.h5"), "write"):
        raise error
    assert "cannot write " in str(caught.value)
    assert "out.h5" in str(caught.value)


def test_part_file_renamed_by_hand__not_taken_for_finished(path: Path, part: Path) -> None:
    begun(path, 2)
    part.rename(path)
    with Store.open(path, layout()) as store:
        assert not store.finished
        assert store.sources == (path,)


@pytest.mark.parametrize(("name", "words"), [(".", "is a folder"), ("nowhere/out.h5", "its folder does not exist")])
def test_place_that_cannot_be_written__store_error(tmp_path: Path, name: str, words: str) -> None:
    with pytest.raises(StoreError, match=words):
        Store.open(tmp_path / name, layout(), restart=name == ".")


@pytest.mark.parametrize(
    ("name", "values", "words"),
    [
        ("length", np.zeros(3), r"column length: shape \(3,\), expected \(4,\)"),
        ("torque", np.zeros((4, 6)), r"column torque: shape \(4, 6\), expected \(4, 5\)"),
        ("status", np.full(4, 300), "column status: values do not fit uint8"),
    ],
)
def test_arrays_not_of_the_layout__value_error_and_block_pending(path, name, values, words):
    with Store.open(path, layout()) as store:
        with pytest.raises(ValueError, match=words):
            store.write(0, {**results(store, 0), name: values})
        assert 0 in store.pending


@settings(max_examples=100)
@given(variants=st.integers(1, 3000), block=st.integers(1, 4000))
def test_blocks__each_variant_in_exactly_one(variants: int, block: int) -> None:
    shape = layout(variants, block)
    rows = [shape.slice(i) for i in range(shape.blocks)]
    assert all(0 < r.stop - r.start <= block for r in rows)
    assert [v for r in rows for v in range(r.start, r.stop)] == list(range(variants))


@settings(max_examples=10, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    variants=st.integers(1, 500),
    block=st.integers(1, 50),
    positions=st.integers(1, 50),
    copies=st.integers(1, 40),
    text=st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=200),
)
def test_bytes__at_least_the_size_of_the_file(path, part, variants, block, positions, copies, text):
    more = tuple(Column(f"c{i}", text, "1") for i in range(copies))
    attributes = {"study_hash": "1", "study": text * 50}
    shape = layout(variants, block, positions, columns=(*layout().columns, *more), attributes=attributes)
    Store.open(path, shape, restart=True).close()
    assert part.stat().st_size <= shape.bytes()
    assert MappedResult(part).attributes["study"] == text * 50


@pytest.mark.parametrize("name", ["length", "variant", "progress", "phi"])
def test_name_of_another_column__refused(name: str) -> None:
    with pytest.raises(StoreError, match=f"result files have other columns named {name}:"):
        layout(columns=(*layout().columns, Column(name, "", "1")))


# What survives kills and full disks.


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


def test_finishing__no_other_process_takes_the_part_file_and_the_final_one_is_there_at_any_time(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Takes seconds: a process starts at each of three calls."""
    complete(path, layout())
    refusals = []

    def disturbed(act: Callable) -> Callable:
        def disturbing(*given: object) -> object:
            assert path.exists()
            refusals.append(run_child(f"child_restarts(Path({str(path)!r}))"))
            return act(*given)

        return disturbing

    with Store.open(path, layout(), restart=True) as store:
        fill(store)
        monkeypatch.setattr(os, "fsync", disturbed(os.fsync))
        monkeypatch.setattr(os, "link", disturbed(os.link))
        monkeypatch.setattr(Path, "replace", disturbed(Path.replace))
        store.finish(keep_former=True)
    assert len(refusals) == 3
    assert all("another sweep is writing" in refusal for refusal in refusals)
    assert files(path.parent) == ["out.h5", "out.previous.h5"]
    assert MappedResult(path).done.all()


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
