"""Fields of a sweep's variants as tables for other programs, a row for each variant and position."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from commands import done, refused
from pyarrow import parquet
from scipy.io import loadmat

import sweeps
from sweeps import read
from sweeps.report.files import data_files, exports
from sweeps.report.recorded import result_file

STUDY = """\
scene = "press.toml"
positions = 16

[vary]
"input.length" = {values = ["40 mm", "60 mm", "250 mm", "50 mm"]}

[outputs]
summaries = ["ram.stroke"]
fields = ["B.y", "B.vy"]
"""
HEADS = ["variant", "input.length [m]", "ram.stroke [m]", "phi [deg]", "B.y [m]"]


@pytest.fixture
def result(press_folder):
    Path("s.toml").write_text(f'units = "SI"\n{STUDY}')
    done("run", "s.toml", "--no-plots", "--quiet", "--out", "r.h5")
    return "r.h5"


def exported(name, *more):
    done("export", "r.h5", "--columns", "B.y, ram.stroke", "--to", name, *more)


def test_table_of_fields__holds_the_closed_form(result):
    exported("t.csv")
    with Path("t.csv").open() as file:
        head, *rows = csv.reader(file)
    assert head == HEADS
    variant, crank, stroke, phi, y = np.array(rows, float).T
    # The machine of 250 mm, longer than its rod, can't be assembled and isn't listed.
    assert variant.tolist() == [v for v in (0, 1, 3) for _ in range(16)]
    np.testing.assert_allclose(phi, np.tile(np.arange(16) * 22.5, 3), rtol=1e-15)
    phi = np.radians(phi)
    np.testing.assert_allclose(stroke, 2 * crank, rtol=1e-14)
    # Pin at crank (cos φ, sin φ), ram below it on x = 0; roundings of lengths of at most 0.3 m.
    closed = crank * np.sin(phi) - np.sqrt(0.2**2 - (crank * np.cos(phi)) ** 2)
    np.testing.assert_allclose(y, closed, atol=2e-16 * 10)


def test_every_format__holds_the_same_numbers(result):
    data = read(result)
    chosen = data.isel(variant=[0, 3])
    for ending in ("csv", "json", "parquet", "mat"):
        exported(f"t.{ending}", "--where", "ram.stroke < '110 mm'")
    expected = chosen["B.y"].values.ravel()
    with Path("t.csv").open() as file:
        assert [float(row[HEADS[4]]) for row in csv.DictReader(file)] == expected.tolist()
    assert json.loads(Path("t.json").read_text())["columns"]["B.y"] == {"unit": "m", "values": expected.tolist()}
    assert parquet.read_table("t.parquet")[HEADS[4]].to_pylist() == expected.tolist()
    mat = loadmat("t.mat", simplify_cells=True)
    assert mat["data"]["B_y"].tolist() == expected.tolist()
    assert (mat["names"]["B_y"], mat["units"]["B_y"]) == ("B.y", "m")


def test_columns_without_a_field__have_a_row_for_each_variant(result):
    done("export", "r.h5", "--columns", "ram.stroke_error", "--to", "t.csv")
    lines = Path("t.csv").read_text().splitlines()
    assert lines[0] == "variant,input.length [m],ram.stroke_error [m]"
    assert len(lines) == 4


def test_sorted_table__has_the_variants_that_show_lists(result, monkeypatch):
    monkeypatch.setattr(exports, "ROWS_AT_A_TIME", 2)
    order = ("--sort", "ram.stroke", "--descending", "--limit", "3")
    done("export", "r.h5", "--columns", "ram.stroke", *order, "--to", "t.csv")
    with Path("t.csv").open() as file:
        numbers = [int(row["variant"]) for row in csv.DictReader(file)]
    assert numbers == sweeps.SweepResult(Path("r.h5")).select(None, "ram.stroke", True, 3).tolist()
    assert numbers != sorted(numbers)
    told = refused("export", "r.h5", "--sort", "-ram.stroke", "--to", "t.csv")
    assert "--sort ram.stroke --descending" in told


def test_table_in_parts__is_the_table_as_a_whole(result, monkeypatch):
    endings = ("csv", "json", "parquet")
    for ending in endings:
        exported(f"whole.{ending}")
        done("export", "r.h5", "--to", f"all.{ending}")
    # A part for each variant, of two groups of variants of which the second has one that failed.
    monkeypatch.setattr(exports, "ROWS_AT_A_TIME", 16)
    monkeypatch.setattr(result_file, "VARIANTS_AT_A_TIME", 2)
    for ending in endings:
        exported(f"t.{ending}")
        exported(f"none.{ending}", "--where", "ram.stroke < '1 mm'")
        done("export", "r.h5", "--to", f"parts.{ending}")
    for whole, parts in (("whole", "t"), ("all", "parts")):
        assert Path(f"{whole}.csv").read_text() == Path(f"{parts}.csv").read_text()
        assert json.loads(Path(f"{whole}.json").read_text()) == json.loads(Path(f"{parts}.json").read_text())
        tables = [parquet.read_table(f"{name}.parquet") for name in (whole, parts)]
        assert tables[0].schema == tables[1].schema
        for columns in zip(*(table.columns for table in tables), strict=True):
            np.testing.assert_array_equal(*(column.to_numpy() for column in columns))
    assert parquet.ParquetFile("t.parquet").num_row_groups == 3
    assert Path("none.csv").read_text().splitlines() == [",".join(HEADS)]
    assert parquet.read_table("none.parquet").schema == parquet.read_table("t.parquet").schema
    assert json.loads(Path("none.json").read_text())["columns"]["B.y"] == {"unit": "m", "values": []}


def test_what_cannot_be_listed__is_refused_in_words(result, monkeypatch):
    assert "did you mean 'B.y'" in refused("export", "r.h5", "--columns", "B.yy", "--to", "t.csv")
    assert "where" in refused("export", "r.h5", "--where", "ram.strok < 1", "--to", "t.csv")
    told = refused("export", "r.h5", "--where", "ram.stroke > '2 kg'", "--to", "t.csv")
    assert "compares a length with a mass" in told
    monkeypatch.setattr(data_files, "MOST_IN_MEMORY", 48 * len(HEADS) - 1)
    exported("t.csv")
    answer = refused("export", "r.h5", "--columns", "B.y, ram.stroke", "--to", "t.mat")
    assert answer.startswith("Error: t.mat: a MAT file holds at most 239 numbers")
    assert "--where" in answer
    assert not Path("t.mat").exists()
