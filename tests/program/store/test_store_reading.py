"""What readers see in a result file: plain h5py, xarray, and the functions of the store."""

import os
import sys
import tracemalloc
from pathlib import Path

import h5py
import numpy as np
import pytest
from store_samples import NAMES, begun, complete, fill, layout, results, same_bits

from sweeps.store import (
    NOT_COMPUTED,
    Column,
    DamagedError,
    FileLayout,
    MappedResult,
    Store,
    StoreError,
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


def test_h5py__contiguous_data_over_positions_as_given(path: Path) -> None:
    complete(path, layout())
    with h5py.File(path, "r") as file:
        for name in NAMES:
            assert (file[name].chunks, file[name].compression) == (None, None)
        assert file["phi"][:].tobytes() == layout().position.values.tobytes()
        assert file["status"].attrs["flag_meanings"] == "ok cannot_be_assembled not_computed"


def test_xarray__numbers_bit_for_bit_and_what_they_are(path: Path) -> None:
    arrays = complete(path, layout())
    with open_dataset(path) as data:
        assert data.torque.attrs == {"long_name": "driving torque", "units": "N m"}
        assert data.phi.attrs == {"long_name": "crank angle", "units": "rad"}
        assert data.attrs["finished"].endswith("+00:00")
        assert same_bits({name: data[name].values for name in NAMES}, arrays)


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


def test_columns_by_default__no_fields(path: Path) -> None:
    complete(path, layout())
    assert list(read_columns(path)) == list(NAMES[:-1])
    assert read_columns(path, ["phi"])["phi"].shape == (5,)


def test_unknown_column__suggestion(path: Path) -> None:
    complete(path, layout())
    with pytest.raises(StoreError, match=r"no column 'peak_torqe'\. Did you mean 'peak_torque'"):
        read_columns(path, ["peak_torqe"])


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


def test_finished_file_with_a_block_not_flagged__damaged(path: Path) -> None:
    complete(path, layout())
    with h5py.File(path, "r+") as file:
        file["progress/block_done"][1] = 0
        file["status"][5] = 83
    assert MappedResult(path).damaged() == [1]
    with pytest.raises(DamagedError, match=r"is damaged \(variants 4 … 7\)"):
        MappedResult(path).numbers()


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
