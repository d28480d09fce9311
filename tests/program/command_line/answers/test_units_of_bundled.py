"""Everything bundled, shown in units that none of it is typed in, and sizes of its quantities in every system."""

import re
import shutil
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from commands import done
from unit_scans import foreign

from engine import display_unit, made_ready, quantity_text, show_units
from sweeps import read_study
from sweeps.study.bundled import STUDIES, bundled_studies
from sweeps.text.templates import bundled_templates

BUNDLED = {**bundled_templates(), **bundled_studies()}
SYSTEMS = ("mm", "US", "SI")
# Sizes of numbers that machines have, in SI units.
SIZES = 3.0 * 10.0 ** np.arange(-9, 10)


@cache
def units_of(name: str) -> frozenset[str]:
    """SI units of all summaries and fields of a bundled scene."""
    machine = made_ready(read_study(BUNDLED[name]).scene)
    known = {**machine.available_summaries, **getattr(machine, "available_fields", {})}
    return frozenset(quantity.units for quantity in known.values())


# Templates, and studies of elements that no template has.
SHOWN = [*bundled_templates(), "braking_car", "screw_jack", "locomotive", "valve_train"]


@pytest.mark.parametrize("name", SHOWN)
def test_bundled__is_shown_in_us_units(name, folder):
    path = Path("machine.toml")
    if STUDIES in BUNDLED[name].parents:
        shutil.copytree(STUDIES, "studies")
        path = "studies" / BUNDLED[name].relative_to(STUDIES)
    path.write_text(f'units = "US"\n{BUNDLED[name].read_text("utf8")}', "utf8")
    # Name, symbol, unit and meaning; symbols are letters too.
    texts = [re.sub(r"(?m)^(  \S+ +)\S+", r"\1", done("quantities", str(path)))]
    study = read_study(path)
    # Of a mechanism numbers are shown in units of the quantities that are listed.
    text = "" if study.scene.input else done("check", str(path), "--all")
    texts += [line for line in text.splitlines() if line.strip() not in (study.title, study.question)]
    show_units({})
    assert [line for text in texts for line in foreign(text, "US")] == []


@pytest.mark.parametrize("system", SYSTEMS)
def test_number_of_any_size__is_in_one_unit_of_its_system_apart_from_metric_prefixes(system):
    wrong, known = [], frozenset.union(*map(units_of, BUNDLED))
    show_units({"system": system})
    for units in sorted(known):
        wrong += foreign("\n".join(quantity_text(float(size), units) for size in SIZES), system)
        labels = {display_unit(units, np.array([size]))[1] for size in SIZES}
        # Many turns are revolutions; kN for N, L for cm³.
        if system != "mm" and units != "rad":
            wrong += [units] if len(labels) > 1 else []
    show_units({})
    assert wrong == []
