"""What readers see in a result file: plain h5py, xarray, and the functions of the store."""

import copy
import functools
import itertools
import json
import math
import operator
import os
import random
import shutil
import subprocess
import sys
import threading
import tracemalloc
from collections.abc import Iterable, Iterator
from pathlib import Path

import h5py
import numpy as np
import pytest
from commands import done, refused, said
from store_samples import NAMES, begun, complete, fill, layout, results, same_bits, start_child, sweep

import sweeps
from sweeps.store import (
    NOT_COMPUTED,
    Column,
    DamagedError,
    FileLayout,
    MappedResult,
    Store,
    StoreError,
    creating,
    open_dataset,
    read_columns,
)


def test_rows_not_written__nan_and_status_255(path: Path, part: Path) -> None:
    with Store.open(path, layout()) as store:
        fill(store, 1)
        expected = results(store, 1)
    got = read_columns(part, NAMES)
    rest = np.delete(np.arange(22), np.s_[4:8])
    for name in ("length", "speed", "peak_torque", "torque"):
        assert np.isnan(got[name][rest]).all()
    assert (got["status"][rest] == NOT_COMPUTED).all()
    assert (got["order"][rest] == np.iinfo(np.int64).min).all()
    assert same_bits({name: got[name][4:8] for name in expected}, expected)


def test_times_in_seconds_under_xarray__stay_numbers(path: Path) -> None:
    shape = layout(columns=(Column("duration", "duration", "s"),), coordinates=())
    with Store.open(path, shape) as store:
        for i in store.pending:
            rows = store.layout.slice(i)
            store.write(i, {"duration": np.ones(rows.stop - rows.start)})
        store.finish()
    with open_dataset(path) as data:
        assert dict(data.sizes) == {"variant": 22}
        assert data.duration.dtype == np.float64


def test_xarray_missing__store_error_names_the_extra(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    complete(path, layout())
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(StoreError, match=r"pip install 'machine-sweeps\[xarray\]'"):
        open_dataset(path)


def test_describe__columns_attributes_and_progress_of_open_part_and_of_final_file(path: Path, part: Path) -> None:
    with Store.open(path, layout()) as store:
        fill(store, 2)
        shown = MappedResult(part)
    assert (shown.title, shown.variants, shown.axes["position"]["count"]) == ("Shear", 22, 5)
    assert (shown.done.size, shown.done.sum()) == (6, 1)
    assert shown.described == layout().columns
    assert shown.attributes["study"] == "steps = 3\nload = 12 kN"
    complete(path, layout())
    assert MappedResult(path).done.sum() == 6


def test_pipe__is_refused_without_waiting_for_its_other_end(path: Path) -> None:
    os.mkfifo(path)
    for reader in (MappedResult, open_dataset):
        with pytest.raises(StoreError, match="device or a pipe"):
            reader(path)


def test_final_file_missing__part_file_named(path: Path) -> None:
    Store.open(path, layout()).close()
    with pytest.raises(StoreError, match=r"not finished.*out\.part\.h5"):
        read_columns(path)


# Damage


def spoilt(path: Path, name: str, element: int) -> None:
    """Change a bit in an element of a dataset, as a failing disk does."""
    with h5py.File(path, "r") as file:
        dataset = file[name]
        at = dataset.id.get_offset() + element * dataset.dtype.itemsize
    with path.open("rb+") as file:
        file.seek(at)
        byte = file.read(1)[0]
        file.seek(at)
        file.write(bytes([byte ^ 16]))


@pytest.mark.parametrize(
    ("name", "element", "block"),
    [
        ("length", 0, 0),
        ("peak_torque", 9, 2),
        ("status", 21, 5),
        ("torque", 5 * 13, 3),
        ("order", 4, 1),
        ("progress/block_done", 2, 2),
    ],
)
def test_changed_bit__found_named_and_pending_again(path: Path, name: str, element: int, block: int) -> None:
    complete(path, layout())
    spoilt(path, name, element)
    mapped = MappedResult(path)
    assert mapped.damaged() == [block]
    last = min(4 * block + 3, 21)
    words = rf"out\.h5 is damaged \(variants {4 * block} … {last}\)"
    with pytest.raises(DamagedError, match=words):
        read_columns(path, ["torque"])
    if name == "torque":
        assert set(read_columns(path)) == set(NAMES[:-1])
    else:
        with pytest.raises(DamagedError, match=words):
            read_columns(path)
    with Store.open(path, layout()) as store:
        assert not store.finished
        (note,) = store.notes
    assert f"variants {4 * block} … {last} are recomputed" in note


def test_finished_file_with_a_block_not_flagged__damaged(path: Path) -> None:
    complete(path, layout())
    with h5py.File(path, "r+") as file:
        file["progress/block_done"][1] = 0
        file["status"][5] = 83
    assert MappedResult(path).damaged() == [1]
    with pytest.raises(DamagedError, match=r"is damaged \(variants 4 … 7\)"):
        MappedResult(path).numbers()


def test_changed_bit_in_a_part_file__block_pending_and_not_computed_for_readers(path: Path, part: Path) -> None:
    with Store.open(path, layout()) as store:
        for i in (1, 3):
            store.write(i, results(store, i))
    spoilt(part, "speed", 5)
    with Store.open(path, layout()) as store:
        assert store.pending == [0, 1, 2, 4, 5]
        assert len(store.notes) == 1
        status = read_columns(part, ["status"])["status"]
        assert (status[4:8] == NOT_COMPUTED).all()
        assert (status[12:16] != NOT_COMPUTED).all()
        fill(store)
        store.finish()
    assert MappedResult(path).damaged() == []


def test_status_of_blocks_not_done__not_computed_whatever_stands_there(path: Path, part: Path) -> None:
    begun(path, 1)
    with h5py.File(part, "r+") as file:
        file["status"][:4] = (0, 83, 0, 254)
    for status in (read_columns(part)["status"], MappedResult(part).numbers()["status"]):
        assert (status[:4] == NOT_COMPUTED).all()
        assert (status[4:8] != NOT_COMPUTED).all()
        assert (status[8:] == NOT_COMPUTED).all()


def test_opening__holds_no_number_of_every_variant(path: Path) -> None:
    # An axis compared as a whole took 8 bytes a variant, and 1 for the comparison.
    count = 3_000_000
    columns = (Column("status", "verdict", "1", dtype=np.uint8),)
    with Store.open(path, FileLayout(count, count, columns, {"study_hash": "many"})) as store:
        store.write(0, {"status": np.zeros(count, np.uint8)})
        store.finish()
    tracemalloc.start()
    assert MappedResult(path).edited == []
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 3 * count
    spoilt(path, "variant", count - 1)
    assert MappedResult(path).edited == ["variant"]


def test_edited_texts__named_and_decisive_ones_refused(path: Path) -> None:
    complete(path, layout(attributes={**layout().attributes, "study_json": "{}"}))
    with h5py.File(path, "r+") as file:
        file.attrs["comment"] = "looks good"
        file.attrs["title"] = "Mine"
    assert MappedResult(path).edited == ["title"]
    read_columns(path)
    with h5py.File(path, "r+") as file:
        file.attrs["study_json"] = "{ }"
    with pytest.raises(DamagedError, match="study_json"):
        read_columns(path)


# Damage of every kind: readers notice it, or hand out what was written.


FLIPS = 50
# Not those that are written last, in place: no checksum covers them.
TEXTS = ("Conventions", "title", "study", "study_hash")
TOLD = ("long_name", "units", "flag_values", "flag_meanings")


def everything(path: Path, check: bool) -> dict[str, tuple]:
    """What a reader of datasets is given: names, dimensions, types, numbers, texts."""
    with open_dataset(path, check) as data:
        found = {
            name: (v.dims, str(v.dtype), v.values.tobytes(), {k: str(v.attrs.get(k)) for k in TOLD})
            for name, v in data.variables.items()
        }
        return found | {"": tuple(str(data.attrs.get(name)) for name in TEXTS)}


# A file that xarray can't open it leaves to Python to close.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning", "ignore::ResourceWarning")
def test_flipped_byte__is_noticed_or_harmless(tmp_path):
    """Anywhere in a file, HDF5's own tables among it."""
    path, spoilt = tmp_path / "out.h5", tmp_path / "spoilt.h5"
    sweep(path, layout(variants=6, block=3, positions=3))
    whole, rng, noticed, unseen = everything(path, check=True), np.random.default_rng(3), 0, 0
    content = path.read_bytes()
    used = np.flatnonzero(np.frombuffer(content, np.uint8))
    for at in rng.choice(used, FLIPS, replace=False):
        changed = bytearray(content)
        changed[at] ^= 1 << int(rng.integers(8))
        spoilt.write_bytes(changed)
        try:
            assert everything(spoilt, check=True) == whole, at
        except StoreError:
            noticed += 1
            try:
                unseen += everything(spoilt, check=False) != whole
            except Exception:
                continue
    # So that the test tests something: without the comparison much of it would go unnoticed.
    assert noticed > FLIPS / 4
    assert unseen > 3


OTHERS = {
    "nothing": lambda group, name: None,
    "a group": lambda group, name: group.create_group(name),
    "a type": lambda group, name: group.update({name: np.dtype("f8")}),
    "a number": lambda group, name: group.create_dataset(name, data=1.0),
    "a text": lambda group, name: group.create_dataset(name, data="two"),
    "no numbers": lambda group, name: group.create_dataset(name, data=h5py.Empty("f8")),
    "lists": lambda group, name: group.create_dataset(name, (6,), h5py.vlen_dtype(np.float64)),
    "a longer row": lambda group, name: group.create_dataset(name, data=np.zeros(9)),
    "a table": lambda group, name: group.create_dataset(name, data=np.zeros((6, 2))),
    "other bytes": lambda group, name: group.create_dataset(name, data=np.zeros(6, ">f8")),
    "records": lambda group, name: group.create_dataset(name, data=np.zeros(6, [("a", "f8"), ("b", "i4")])),
    "a link to nothing": lambda group, name: group.update({name: h5py.SoftLink("/nowhere")}),
    "a link to all": lambda group, name: group.update({name: h5py.SoftLink("/")}),
    "a link to no file": lambda group, name: group.update({name: h5py.ExternalLink("no.h5", "/x")}),
}
OTHER_TEXTS = [
    3,
    1.5,
    np.arange(3.0),
    np.bytes_(b"\xff"),
    h5py.Empty("S3"),
    np.zeros(0),
    "{",
    "[1]",
    "null",
    "[" * 9999,
]
OTHER_ENTRIES = [None, True, -1, 1.5, math.nan, 10**30, "x", [], {}, [[1]], ["variant", "variant"]]


def replace(name: str, make: object, file: h5py.File) -> None:
    if name in file:
        del file[name]
    make(file, name)


def rewrite(name: str, key: str, value: object, file: h5py.File) -> None:
    file[name].attrs[key] = value


def is_refused(path: Path, change: object, *wrong: object) -> bool:
    """Whether a changed copy of a file is refused; otherwise its numbers are those of the file."""
    spoilt = path.with_name("spoilt.h5")
    shutil.copyfile(path, spoilt)
    with h5py.File(spoilt, "r+") as file:
        change(*wrong, file)
    try:
        found = read_columns(spoilt, NAMES)
    except StoreError:
        return True
    assert same_bits(found, read_columns(path, NAMES)), wrong
    return False


def chosen(cases: Iterable[tuple]) -> list[tuple]:
    """Some of many cases, the same every time."""
    return random.Random(3).sample(list(cases), FLIPS)


def entries(record: object, at: tuple = ()) -> Iterator[tuple]:
    """Paths of everything within a record."""
    inner = record.items() if isinstance(record, dict) else enumerate(record) if isinstance(record, list) else ()
    for key, value in inner:
        yield (*at, key)
        yield from entries(value, (*at, key))


def test_object_of_another_kind__is_refused(path):
    """It takes ten seconds: a file is changed in 200 ways and read."""
    sweep(path, layout(variants=6, block=3, positions=3))
    objects = []
    with h5py.File(path) as file:
        file.visit(objects.append)
        texts = [(name, key) for name in ("/", *objects) for key in file[name].attrs]
    for name, kind in itertools.product(objects, OTHERS):
        assert is_refused(path, replace, name, OTHERS[kind]), (name, kind)
    # What doesn't belong there.
    for name, kind in itertools.product(("more", "progress/more"), OTHERS):
        is_refused(path, replace, name, OTHERS[kind])
    for (name, key), value in chosen(itertools.product(texts, OTHER_TEXTS)):
        is_refused(path, rewrite, name, key, value)


def test_other_entry_of_the_layout__is_refused(path):
    made = layout(variants=6, block=3, positions=3)
    sweep(path, made)
    infinite = [(at, math.inf) for at in (("variants",), ("block",), ("position", "count"))]
    for at, value in [*infinite, *chosen(itertools.product(entries(made.record()), OTHER_ENTRIES))]:
        record = copy.deepcopy(made.record())
        functools.reduce(operator.getitem, at[:-1], record)[at[-1]] = value
        assert is_refused(path, rewrite, "progress", "layout", json.dumps(record)), (at, value)


CONTENTS = {
    "a number": lambda file: file["ram.stroke"].write_direct(np.array([1e-3]), dest_sel=np.s_[1:2]),
    "a text": lambda file: file.attrs.update(question="What?"),
    "a unit": lambda file: file["ram.stroke"].attrs.update(units="mm"),
}


def replaced(values: object) -> object:
    def change(file: h5py.File) -> None:
        long_name, units = (file["ram.stroke"].attrs[key] for key in ("long_name", "units"))
        del file["ram.stroke"]
        file["ram.stroke"] = values
        file["ram.stroke"].attrs.update({"long_name": long_name, "units": units})

    return change


def shorten_flags(file: h5py.File) -> None:
    del file["progress/block_checksum"]
    file["progress/block_checksum"] = np.zeros(0, np.uint32)


SHAPES = {
    "longer": replaced(np.zeros(9)),
    "of other numbers": replaced(np.zeros(8, np.float32)),
    "checksums of another length": shorten_flags,
}


@pytest.mark.parametrize("change", [*CONTENTS, *SHAPES])
def test_dataset_of_a_damaged_file__is_refused_unless_unchecked(change, press_result):
    with sweeps.read(press_result) as before:
        assert before.sizes["variant"] == 8
    with h5py.File(press_result, "r+") as file:
        (CONTENTS | SHAPES)[change](file)
    for grid in (False, True):
        with pytest.raises(DamagedError, match="is damaged"):
            sweeps.read(press_result, grid=grid)
    if change in CONTENTS:
        with sweeps.read(press_result, check=False) as data:
            assert data.sizes["variant"] == 8


@pytest.mark.parametrize("kind", SHAPES)
def test_column_of_another_length_or_type__is_told_by_every_command(kind, press_result):
    with h5py.File(press_result, "r+") as file:
        SHAPES[kind](file)
    for command in ("verify r.h5", "show r.h5", "plot r.h5", "export r.h5 --to o.csv", "compare r.h5 r.h5"):
        message = refused(*command.split())
        assert "has the wrong length or type" in message
        assert message.count("\n") == 1
    # Its study, run again, makes it whole.
    done("run", "study.toml", "--no-plots", "--out", press_result)
    done("verify", press_result)
    done("show", press_result)


def test_damaged_texts__are_shown_with_a_warning(press_result):
    names = ["question", "study", "scene", "scene_text"]
    with h5py.File(press_result, "r+") as file:
        for name in names:
            file.attrs[name] = file.attrs[name].replace("a", "b")
    for command in ("show r.h5", "report r.h5 --out o.html", "export r.h5 --variant 0 --to o.toml"):
        told = said(*command.split()).stderr
        assert all(f"Warning: {press_result}: {name} was modified\n" in told for name in names), command
    assert all(f"{name} was modified" in Path("o.html").read_text("utf8") for name in names)


def test_record_of_another_version__is_told_with_both(press_result):
    shutil.copyfile(press_result, "old.h5")
    with h5py.File("old.h5", "r+") as file:
        file.attrs["versions"] = "machine-sweeps 0.0.9, numba 0.60.0"
        file.attrs["study_json"] = "{}"
        del file["progress"].attrs["text_checksums"]
    message = refused("show", "old.h5")
    assert "it was made by machine-sweeps 0.0.9, and this is machine-sweeps 0." in message
    assert "edited" not in message


# Readers that lock


def locking_reader(part: Path, seconds: float) -> subprocess.Popen:
    process = start_child(f"child_locks(Path({str(part)!r}), {seconds})")
    assert process.stdout.readline() == "locked\n"
    return process


def test_reader_that_locks_for_a_moment__is_waited_for_and_a_lasting_one_told(tmp_path):
    path, part = tmp_path / "out.h5", tmp_path / "out.part.h5"
    begun(path, 0)
    process = locking_reader(part, 0.4)
    with Store.open(path, layout()) as store:
        assert store.pending == [1, 2, 3, 4, 5]
    process.communicate()
    process = locking_reader(part, 60)
    with pytest.raises(StoreError, match="locking=False"):
        Store.open(path, layout())
    process.kill()
    process.communicate()


def test_dataset_of_a_running_sweep__keeps_nobody_from_writing(tmp_path):
    path, part = tmp_path / "out.h5", tmp_path / "out.part.h5"
    with Store.open(path, layout()) as store:
        fill(store, 0)
        with sweeps.read(part) as data:
            assert same_bits({"length": data["length"].values[:4]}, {"length": results(store, 0)["length"]})
            fill(store, 1)


def is_left_to_others(path: Path) -> bool:
    """Whether another thread can open a file."""
    thread = threading.Thread(target=lambda: h5py.File(path).close(), daemon=True)
    thread.start()
    thread.join(20.0)
    return not thread.is_alive()


def test_errors_while_texts_are_read__leave_the_library_to_other_threads(path: Path, monkeypatch) -> None:
    # An error keeps what its functions were iterating over.
    complete(path, layout())
    monkeypatch.setattr(creating, "_TOLD", (object(),))
    with h5py.File(path) as file, pytest.raises((TypeError, AttributeError)) as error:
        creating.texts_of(file)
    assert is_left_to_others(path)
    with h5py.File(path, "r+") as file:
        file.attrs["title"] = np.bytes_(b"\xff\xfe")
    with pytest.raises(StoreError) as damaged:
        MappedResult(path)
    assert is_left_to_others(path)
    assert error.tb is not None
    assert damaged.tb is not None
