"""Tables of variants in Parquet and HDF5: the same as in CSV, or refused by what is wrong with them."""

from pathlib import Path

import h5py
import numpy as np
import pyarrow
import pytest
from each_case import each
from press_sweeps import DISTINCT, HEAD, STROKE, run, study_of
from pyarrow import parquet

from sweeps import InputError, read_study
from sweeps.study.variant_tables import read_variant_table

LENGTHS, MASSES = np.array([30.0, 40.0, 55.0]), np.array([1, 2, 3])
GOOD = {"input.length [mm]": LENGTHS, "bodies.ram.mass [kg]": MASSES}
MADE_OF = {"t.parquet": "Parquet", "t.h5": "HDF5", "t.csv": "CSV"}


def written(path: Path, columns: dict) -> None:
    """A table of columns named `name [unit]`, in the format of the ending."""
    if path.suffix == ".parquet":
        parquet.write_table(pyarrow.table(columns), path)
        return
    parts = {title: title.rstrip("]").split(" [") for title in columns}
    if path.suffix == ".csv":
        rows = zip(*columns.values(), strict=True)
        path.write_text("\n".join([",".join(columns), *(",".join(map(str, row)) for row in rows)]))
        return
    with h5py.File(path, "w") as file:
        for title, (name, *unit) in parts.items():
            file[name] = columns[title]
            file[name].attrs["units"] = "".join(unit)


def study_with(folder: Path, table: str):
    return study_of(folder, f'{HEAD}variants = "{table}"\n{STROKE}')


@each(
    "text",
    [
        "input.length,bodies.ram.mass [kg]\n30 mm,1\n4 cm,2000 g\n0.055 m,3\n",
        "input.length [mm];bodies.ram.mass\n30;1 kg\n40,0 mm;2 kg\n5,5 cm;0,003 t\n",
    ],
)
def test_units__stand_in_the_header_or_in_the_cells(text, tmp_path):
    (tmp_path / "t.csv").write_text(text)
    found = study_with(tmp_path, "t.csv").values(0, 3)[0]
    assert found["input.length"] == pytest.approx(LENGTHS / 1000, rel=1e-15)
    assert found["bodies.ram.mass"] == pytest.approx(MASSES, rel=1e-15)


@each("name", MADE_OF)
def test_table__holds_the_same_variants_in_every_format(name, tmp_path):
    written(tmp_path / name, GOOD)
    found = study_with(tmp_path, name).values(0, 3)[0]
    assert found["input.length"] == pytest.approx(LENGTHS / 1000, rel=1e-15)
    assert found["bodies.ram.mass"].tolist() == MASSES.tolist()


WRONG = {
    "text beside": (GOOD | {"who": ["a", "b", "c"]}, "column 'who' is not numeric"),
    "empty": ({"input.length [mm]": np.zeros(0)}, "at least one row"),
    "nothing": ({}, "no columns of numbers"),
    "unknown": ({"input.lenght [mm]": LENGTHS}, "did you mean 'input.length'"),
    "wrong unit": ({"input.length [kg]": LENGTHS}, "column input.length: expected a length"),
    "no unit": ({"input.length": LENGTHS}, "has no unit"),
    "no number": ({"input.length [mm]": [30.0, np.nan, 40.0]}, "got 'nan'"),
}


@each("case", WRONG)
@each("name", ["t.parquet", "t.h5"])
def test_wrong_table__is_refused_by_name_and_column(name, case, tmp_path):
    columns, words = WRONG[case]
    written(tmp_path / name, columns)
    with pytest.raises(InputError, match=r"study\.toml, line") as refused:
        study_with(tmp_path, name)
    assert words in str(refused.value)


def test_column_given_twice__is_refused_whatever_its_units(tmp_path):
    written(tmp_path / "t.parquet", {"input.length [mm]": LENGTHS, "input.length [m]": LENGTHS / 1000})
    with pytest.raises(InputError, match=r"'input\.length' is given twice"):
        read_variant_table(tmp_path / "t.parquet")


def test_packed_table__may_not_be_longer_than_memory(tmp_path):
    with h5py.File(tmp_path / "t.h5", "w") as file:
        file.create_dataset("input.length", shape=(10**12,), chunks=(10**6,), dtype="f8", compression="gzip")
    assert (tmp_path / "t.h5").stat().st_size < 100_000
    with pytest.raises(InputError, match="1000000000000 rows"):
        read_variant_table(tmp_path / "t.h5")


def test_table__takes_no_numbers_out_of_other_files(tmp_path):
    (tmp_path / "secret").write_bytes(b"root:x:0:0:root:/root:/bin/bash\n")
    with h5py.File(tmp_path / "t.h5", "w") as file:
        file.create_dataset("input.length", shape=(2,), dtype="f8", external=[(str(tmp_path / "secret"), 0, 16)])
    with pytest.raises(InputError, match="links to other files"):
        read_variant_table(tmp_path / "t.h5")


@each("name", ["t.parquet", "t.h5"])
def test_table_cut_off__is_refused_in_words(name, tmp_path):
    written(tmp_path / name, GOOD)
    whole = (tmp_path / name).read_bytes()
    # Libraries look for the end of a file first.
    for cut in np.linspace(0, len(whole) - 1, 30).astype(int):
        (tmp_path / name).write_bytes(whole[:cut])
        with pytest.raises(InputError, match=f"{name}: is damaged, or not {MADE_OF[name]}"):
            read_variant_table(tmp_path / name)


def test_parameters_of_a_result__are_a_table_while_they_are_as_they_were_written(tmp_path):
    result = run(tmp_path, DISTINCT, "done")
    found, made = study_with(tmp_path, "done.h5"), read_study(tmp_path / "done.toml")
    assert found.values(0, 200)[0]["input.length"].tolist() == made.values(0, 200)[0]["input.length"].tolist()
    with h5py.File(result, "r+") as file:
        file["input.length"][7] *= 1.01
    with pytest.raises(InputError, match=r"done\.h5.*is damaged"):
        read_variant_table(result)


def test_unfinished_result__is_no_table(tmp_path):
    result = run(tmp_path, DISTINCT, "done")
    with h5py.File(result, "r+") as file:
        file["progress/block_done"][0] = 0
    with pytest.raises(InputError, match="isn't finished"):
        read_variant_table(result)
