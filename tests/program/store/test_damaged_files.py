"""Damage of every kind: readers notice it, or hand out what was written."""

import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from commands import done, refused, said
from store_samples import begun, fill, layout, results, same_bits, sweep

import sweeps
from sweeps.store import DamagedError, Store, StoreError, open_dataset

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


CONTENTS = {
    "a number": lambda file: file["ram.stroke"].write_direct(np.array([1e-3]), dest_sel=np.s_[1:2]),
    "a text": lambda file: file.attrs.update(question="What?"),
    "a unit": lambda file: file["ram.stroke"].attrs.update(units="mm"),
}


def replaced(values: object, name: str = "ram.stroke") -> object:
    def change(file: h5py.File) -> None:
        long_name, units = (file[name].attrs[key] for key in ("long_name", "units"))
        del file[name]
        file[name] = values
        file[name].attrs.update({"long_name": long_name, "units": units})

    return change


def shorten_flags(file: h5py.File) -> None:
    del file["progress/block_checksum"]
    file["progress/block_checksum"] = np.zeros(0, np.uint32)


SHAPES = {
    "longer": replaced(np.zeros(9)),
    "shorter": replaced(np.zeros(7)),
    "empty": replaced(np.zeros(0)),
    "a scalar": replaced(1.0),
    "a table": replaced(np.zeros((8, 2))),
    "of other numbers": replaced(np.zeros(8, np.float32)),
    "of other bytes": replaced(np.zeros(8, ">f8")),
    "status of another length": replaced(np.zeros(9, np.uint8), "status"),
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

LOCKING = """
import sys, time
from pathlib import Path
import h5py
part, patience = Path(sys.argv[1]), float(sys.argv[2])
print("here", flush=True)
while not part.exists():
    pass
for attempt in range(2000):
    try:
        file = h5py.File(part, "r")
        break
    except OSError:
        time.sleep(0.002)
else:
    sys.exit(0)
print("holds", flush=True)
time.sleep(patience)
"""


def locking_reader(part: Path, patience: float) -> object:
    line = [sys.executable, "-c", LOCKING, str(part), str(patience)]
    process = subprocess.Popen(line, stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "here\n"
    return process


def test_reader_that_locks_for_a_moment__is_waited_for_and_a_lasting_one_told(tmp_path):
    path, part = tmp_path / "out.h5", tmp_path / "out.part.h5"
    begun(path, 0)
    process = locking_reader(part, 0.4)
    assert process.stdout.readline() == "holds\n"
    with Store.open(path, layout()) as store:
        assert store.pending == [1, 2, 3, 4, 5]
    process.communicate()
    process = locking_reader(part, 60)
    assert process.stdout.readline() == "holds\n"
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
