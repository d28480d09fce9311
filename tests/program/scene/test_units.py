"""Quantities with units: accepted texts, the known traps, and hostile input.

Expected values are exact fractions from the definitions of the units (SI Brochure, 9th ed.; inch 25.4 mm;
hp = 550 ft lbf/s; PS = 75 kgf m/s), rounded once to float64. The code works with 40 decimal digits, so its
result is the same correctly rounded float and every comparison is an equality: a relative error of 1e-40
changes the rounding to 53 bits with a chance of about 1e-24.
"""

import decimal
import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from each_case import each
from hypothesis import example, given, settings
from hypothesis import strategies as st

from engine import display_unit, figure_text, quantity_text
from engine.units.dimensions import DIMENSIONS, Powers
from engine.units.reading import UnitError, column_in_text, in_any_unit, in_text, to_si, unit_in

with mpmath.workdps(60):
    PI = Fraction(mpmath.nstr(+mpmath.pi, 55))

# Units of English-speaking and of older drawings by definitions of their own: the international pound and inch, and
# standard gravity (NIST Special Publication 811, appendix B).
INCH, POUND, GRAVITY = Fraction("0.0254"), Fraction("0.45359237"), Fraction("9.80665")
FOOT, LBF = 12 * INCH, POUND * GRAVITY

FACTORS = {
    "length": {"m": 1, "mm": "1e-3", "cm": "0.01", "dm": "0.1", "um": "1e-6", "µm": "1e-6", "km": 1000}
    | {"in": INCH, "inch": INCH, "mil": INCH / 1000, "ft": FOOT, "yd": 3 * FOOT},
    "angle": {"rad": 1, "mrad": "1e-3", "deg": PI / 180, "°": PI / 180, "rev": 2 * PI},
    "time": {"s": 1, "sec": 1, "ms": "1e-3", "us": "1e-6", "min": 60, "h": 3600},
    "mass": {"kg": 1, "g": "1e-3", "mg": "1e-6", "t": 1000, "lb": POUND, "oz": POUND / 16, "slug": LBF / FOOT},
    "force": {"N": 1, "mN": "1e-3", "kN": 1000, "MN": 10**6}
    | {"lbf": LBF, "kip": 1000 * LBF, "ozf": LBF / 16, "kgf": GRAVITY, "kp": GRAVITY},
    "moment": {"Nm": 1, "kNm": 1000, "MNm": 10**6, "Nmm": "1e-3", "J": 1},
    "pressure": {"Pa": 1, "kPa": 1000, "MPa": 10**6, "GPa": 10**9, "bar": 10**5, "psi": LBF / INCH**2, "atm": 101325},
    "power": {"W": 1, "kW": 1000, "MW": 10**6, "hp": 550 * FOOT * LBF, "PS": 75 * GRAVITY},
    "energy": {"J": 1, "kJ": 1000, "MJ": 10**6, "kWh": 3_600_000},
    "volume": {"l": "1e-3", "L": "1e-3", "gal": 231 * INCH**3},
    "speed": {"mph": 5280 * FOOT / 3600},
    "angular_speed": dict.fromkeys(("rpm", "RPM", "spm", "1/min", "min-1", "r/min", "U/min", "rev/min"), 2 * PI / 60),
    "number": {"%": "0.01"},
}
FACTORS = {name: {unit: Fraction(factor) for unit, factor in units.items()} for name, units in FACTORS.items()}

# Numerator and denominator of compound units: (dimension, power) pairs into FACTORS.
COMPOUNDS = {
    "area": ([("length", 2)], []),
    "volume": ([("length", 3)], []),
    "inertia": ([("mass", 1), ("length", 2)], []),
    "density": ([("mass", 1)], [("length", 3)]),
    "area_density": ([("mass", 1)], [("length", 2)]),
    "linear_density": ([("mass", 1)], [("length", 1)]),
    "speed": ([("length", 1)], [("time", 1)]),
    "acceleration": ([("length", 1)], [("time", 2)]),
    "angular_speed": ([("angle", 1)], [("time", 1)]),
    "angular_acceleration": ([("angle", 1)], [("time", 2)]),
    "moment": ([("force", 1), ("length", 1)], []),
    "stiffness": ([("force", 1)], [("length", 1)]),
    "torsional_stiffness": ([("moment", 1)], [("angle", 1)]),
    "damping": ([("force", 1), ("time", 1)], [("length", 1)]),
    "torsional_damping": ([("moment", 1), ("time", 1)], [("angle", 1)]),
    "quadratic_drag": ([("force", 1), ("time", 2)], [("length", 2)]),
    "torsional_quadratic_drag": ([("moment", 1), ("time", 2)], [("angle", 2)]),
}


@each(
    "text, dimension, expected",
    [
        ("80\N{NO-BREAK SPACE}mm", "length", 0.08),
        (".5 mm", "length", 0.0005),
        ("5 μm", "length", 5e-6),
        ("0.5 kg·m²", "inertia", 0.5),
        ("7850 kg·m⁻³", "density", 7850.0),
        ("40 N/(m/s)", "damping", 40.0),
        ("2 kg/(m s2)", "pressure", 2.0),
        ("1 kgf/cm2", "pressure", 98066.5),
        ("\N{MINUS SIGN}90°", "angle", -math.pi / 2),
        ("1 rev/min", "angular_speed", 2 * math.pi / 60),
        ("60 rpm/s", "angular_acceleration", 2 * math.pi),
        ("1 1/4 in", "length", 0.03175),
        ("-3/4in", "length", -0.01905),
        ("1/3 hp", "power", 745.69987158227022 / 3),
        ("2 1/2", "number", 2.5),
        ("-1 / 4", "number", -0.25),
        ("500 mm/m", "number", 0.5),
    ],
)
def test_accepted_text__gives_hand_computed_value(text, dimension, expected):
    # The expected values with pi or a repeating factor are themselves rounded up to three times: 4 eps.
    assert to_si(text, dimension) == pytest.approx(expected, rel=4 * np.finfo(float).eps, abs=0)
    assert in_text(text, dimension) == to_si(text, dimension)


@each("text", ["60 rpm", "60 1/min", "60 1 / min", "60 /min", "60 min-1", "60 min⁻¹"])
def test_per_minute_as_angular_speed__means_revolutions(text):
    assert to_si(text, "angular_speed") == 2 * math.pi


# Pounds that people write for forces, and hyphens, by what they mean in lbf, in and ft.
HABITS = {
    "moment": {
        "ft-lb": LBF * FOOT,
        "ft-lbf": LBF * FOOT,
        "in-lb": LBF * INCH,
        "in-lbs": LBF * INCH,
        "lb-in": LBF * INCH,
    }
    | {"lb-ft": LBF * FOOT, "lbf-in": LBF * INCH, "lb in": LBF * INCH, "oz-in": LBF / 16 * INCH, "N-m": Fraction(1)}
    | {"kip-ft": 1000 * LBF * FOOT, "tonf-ft": 2000 * LBF * FOOT},
    "energy": {"ft-lb": LBF * FOOT, "in-lb": LBF * INCH},
    "mass": {"lbs": POUND, "lb": POUND},
    "force": {"lb": LBF, "lbs": LBF, "kips": 1000 * LBF, "klbf": 1000 * LBF, "tonf": 2000 * LBF},
    "pressure": {"lb/in2": LBF / INCH**2},
    "stiffness": {"lb/in": LBF / INCH},
    "torsional_stiffness": {"in-lb/rad": LBF * INCH},
    "inertia": {"lb-ft2": POUND * FOOT**2, "lb-in²": POUND * INCH**2, "lbf-ft-s2": LBF * FOOT, "kg-m2": Fraction(1)},
}


@each("dimension, unit", [(name, unit) for name in HABITS for unit in HABITS[name]])
def test_unit_as_people_type_it__is_what_they_mean(dimension, unit):
    assert to_si(f"7.5 {unit}", dimension) == exact("7.5", HABITS[dimension][unit])


def test_pounds_where_no_dimension_is_known__are_of_force_in_foot_pounds_alone():
    energy = Powers(mass=1, length=2, time=-2)
    for unit, size, powers in (
        ("ft-lb", LBF * FOOT, energy),
        ("lb-in", LBF * INCH, energy),
        ("lb-in2", POUND * INCH**2, Powers(mass=1, length=2)),
        ("lb in", POUND * INCH, Powers(mass=1, length=1)),
        ("oz-in", POUND / 16 * INCH, Powers(mass=1, length=1)),
    ):
        assert in_any_unit(f"3 {unit}") == (exact("3", size), powers)


# Message, and texts that are taken for a dimension.
TRAPS = {
    "expected a length such as '80 mm', got 'N m'": [("12 N m", "length")],
    "use a decimal point, not a comma, as in '1.5 mm'": [("1,5 mm", "length")],
    "write a ratio as a fraction, as in '1/10'": [("1:10", "number"), ("1 : 10", "number")],
    r"ambiguous: 120000 or 120\.000\? Write it without": [("120,000 lbf", "force"), ("120,000", "number")],
    "without commas, 1000.5": [("1,000.5 mm", "length")],
    "ambiguous: the short ton is 2000 lb, the long ton 2240 lb, the metric ton 1000 kg": [
        ("2 ton", "mass"),
        ("60 tons", "force"),
        ("60 ton-ft", "moment"),
    ],
    "ambiguous for an angular speed: write rpm or rad/s": [
        *(("200 Hz", "angular_speed"), ("200 1/s", "angular_speed"), ("200 s-1", "angular_speed")),
    ],
    '5 has no unit: write "5 deg", or "5 rad"': [("5", "angle")],
    "pressures are absolute: add 14.696 psi": [("190 psig", "pressure")],
    "pressures are absolute: add 1.01325 bar": [("13 barg", "pressure")],
    "unknown unit": [("5 nm", "length"), ("5 kn", "speed"), ("3 cal", "energy"), ("1 P", "pressure")],
    "in one piece, without gaps": [("1 000 mm", "length"), ("1 000", "number")],
    "unknown unit 'mmm': did you mean 'mm'": [("80 mmm", "length")],
    r"did you mean 'mm'\?": [("80 MM", "length")],
    r"did you mean 'mN' or 'MN'\?": [("5 mn", "force")],
    "does not begin with a number": [("mm", "length"), ("", "length"), ("nan m", "length"), ("inf m", "length")],
    "got 'rpm'": [("200 rpm", "number")],
    "ambiguous for a torsional stiffness: write N m/rad": [("5 N m", "torsional_stiffness")],
    "ambiguous for an angular acceleration: write rad/s2": [("5 1/s2", "angular_acceleration")],
    r"ambiguous after the '/': use brackets": [("5 N/m s", "damping")],
    "cannot read the unit": [
        *(("5 % m", "length"), ("5 %/%", "number"), ("10² m", "length"), ("5 m2m", "volume"), ("5 m10", "length")),
        *(("5 (m", "length"), ("5 m)", "length"), ("5 ()", "number"), ("5 m**", "length"), ("1/30 m", "length")),
        *(("1/30", "length"), ("1 -1/4 in", "length"), ("1/0 in", "length"), ("1/2/4 in", "length")),
    ],
    "not a finite number": [("1/0", "number")],
    "1e-308 to 1e308": [("1e999 m", "length"), ("1e-999 m", "length")],
    "not a finite length": [("1e" + 80 * "9" + " m", "length")],
}


@each("text, dimension, message", [(*pair, words) for words in TRAPS for pair in TRAPS[words]])
def test_trap__is_refused_with_its_mend(text, dimension, message):
    for read in (to_si, in_text):
        with pytest.raises(UnitError, match=message):
            read(text, dimension)


ABSURD = [
    *("9**9**9**9 m", "1 m**9**9**9", "__import__('os')", "1 __import__('os')", "5 os.system", "80 m m m mm/..."),
    *("80 " + "(" * 90, "80 " + "m9" * 40, "80 " + "km9 " * 20 + "/" + "mm9", "1 " + "m" * 10_000, "9" * 10_000 + " m"),
    *("1e" + "9" * 10_000, "\0", "1 \ud800", "\N{ARABIC-INDIC DIGIT FIVE} m", "\N{FULLWIDTH DIGIT FIVE} m"),
    *("1_000 m", "0x10 m"),
]


@each("text", ABSURD)
def test_absurd_text__is_a_short_unit_error(text):
    for dimension in DIMENSIONS:
        with pytest.raises(UnitError) as caught:
            in_text(text, dimension)
        assert len(str(caught.value)) < 400


NO_QUANTITIES = {
    "expected a length such as '80 mm', got ": [True, False, None, [80], b"80 mm", 1j, np.True_],
    "not a finite": [math.nan, math.inf, -math.inf, 10**400],
}


@each("value, message", [(value, words) for words, values in NO_QUANTITIES.items() for value in values])
def test_value_that_is_no_quantity__is_refused(value, message):
    for read in (to_si, in_text):
        with pytest.raises(UnitError, match=message):
            read(value, "length")


@each("value", [80, "80", " 80 "])
def test_number_without_unit__is_refused_with_the_ways_to_write_it(value):
    with pytest.raises(UnitError, match='write "80 mm", or "80 m" if the SI unit is meant'):
        in_text(value, "length")


@each("zero", [0, 0.0, "0", "0.0", "-0"])
@each("dimension", DIMENSIONS)
def test_exact_zero__needs_no_unit(zero, dimension):
    assert in_text(zero, dimension) == 0


@each("value", [3, 0.25, "0.25", "1/4"])
def test_number_dimension_in_text__takes_bare_numbers(value):
    assert in_text(value, "number") == float(Fraction(value))


@each("dimension", [name for name in DIMENSIONS if name != "number"])
def test_si_unit_of_dimension__is_readable_and_has_factor_one(dimension):
    assert to_si(f"1 {DIMENSIONS[dimension].unit}", dimension) == 1


@each("dimension", DIMENSIONS)
def test_example_of_dimension__fits_that_dimension_alone(dimension):
    example_text = DIMENSIONS[dimension].example
    assert in_text(example_text, dimension) > 0
    # A moment and an energy are both N m; N s2/m2 is kg/m.
    twins = [{"moment", "energy"}, {"linear_density", "quadratic_drag"}]
    same = next((pair for pair in twins if dimension in pair), {dimension})
    for other in set(DIMENSIONS) - same:
        with pytest.raises(UnitError):
            in_text(example_text, other)


def test_caller_with_few_decimal_digits__gets_the_same_value():
    with decimal.localcontext(decimal.Context(prec=3)):
        assert to_si("123.456789 mm", "length") == 0.123456789


magnitudes = st.floats(min_value=-1e200, max_value=1e200).filter(lambda x: x == 0 or abs(x) > 1e-200)


def exact(text, factor):
    return float(Fraction(text) * factor)


@settings(max_examples=150)
@given(st.sampled_from(sorted(FACTORS)), st.data(), magnitudes)
def test_any_value_in_simple_unit__is_correctly_rounded(dimension, data, value):
    unit = data.draw(st.sampled_from(sorted(FACTORS[dimension])))
    gap = data.draw(st.sampled_from(["", " ", "  "])) if not unit[0].isdigit() else " "
    assert to_si(f"{value!r}{gap}{unit}", dimension) == exact(repr(value), FACTORS[dimension][unit])


def spelled(data, parts, join):
    """Draw units for `parts`; return their joined text and the product of their exact factors."""
    texts, factor = [], Fraction(1)
    for dimension, power in parts:
        unit = data.draw(st.sampled_from(sorted(FACTORS[dimension])))
        mark = data.draw(st.sampled_from(["", "^", "**"])) if power != 1 else ""
        texts.append(unit + (f"{mark}{power}" if power != 1 else ""))
        factor *= FACTORS[dimension][unit] ** power
    return join.join(texts), factor


@settings(max_examples=150)
@given(st.sampled_from(sorted(COMPOUNDS)), st.data(), magnitudes)
def test_any_value_in_compound_unit__is_correctly_rounded(dimension, data, value):
    join = data.draw(st.sampled_from([" ", "*", "·", " * "]))
    above, numerator = spelled(data, COMPOUNDS[dimension][0], join)
    below, denominator = spelled(data, COMPOUNDS[dimension][1], join)
    slash = data.draw(st.sampled_from(["/", " / "]))
    bracketed = data.draw(st.booleans())
    unit = above + (slash + (f"({below})" if bracketed else below) if below else "")
    assert to_si(f"{value!r} {unit}", dimension) == exact(repr(value), numerator / denominator)


@settings(max_examples=100)
@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(sorted(DIMENSIONS)))
def test_si_number_written_with_its_unit__reads_back_bit_for_bit(value, dimension):
    unit = "" if dimension == "number" else DIMENSIONS[dimension].unit
    assert in_text(f"{value!r} {unit}", dimension) == value


hostile = st.text(alphabet="0123456789.,eE+-*/^()[]_ '\"%°µ²⁻·mMkNgsradinhpPa1\n\0", max_size=40)
near_misses = st.builds(
    lambda text, position, junk: text[:position] + junk + text[position + 1 :],
    st.sampled_from([entry.example for entry in DIMENSIONS.values()]),
    st.integers(0, 12),
    hostile,
)
anything = st.one_of(
    st.text(max_size=200),
    hostile,
    near_misses,
    hostile.map(lambda unit: "5 " + unit),
    st.none() | st.booleans() | st.integers() | st.floats() | st.binary() | st.complex_numbers(),
    st.lists(st.integers()) | st.fractions() | st.decimals(),
)


@settings(max_examples=100)
@given(anything, st.sampled_from(sorted(DIMENSIONS)))
@example("1e999999 m", "length")
@example("1/" + "0" * 50, "number")
@example("sNaN m", "length")
def test_any_input__is_a_finite_float_or_a_unit_error(value, dimension):
    for read in (to_si, in_text):
        try:
            number = read(value, dimension)
        except UnitError:
            continue
        assert type(number) is float
        assert math.isfinite(number)


@given(st.lists(st.decimals(-(10**6), 10**6, places=6).map(str), min_size=1), st.sampled_from(["mm", "in", "ft"]))
def test_column__is_what_its_cells_are(cells, unit):
    assert column_in_text(cells, unit, "length") == [in_text(f"{cell} {unit}", "length") for cell in cells]


@each("cell", ["nan", "inf", "1_000", "1e999", "1 0", "", "٣"])
def test_column_with_a_cell_that_is_no_number__is_refused(cell):
    with pytest.raises(UnitError):
        column_in_text(["1", cell], "mm", "length")


def test_fractions__are_read_in_columns_and_give_their_unit():
    assert column_in_text(["1 1/4", "3/4", "2"], "in", "length") == [0.03175, 0.01905, 0.0508]
    assert unit_in(" 1 1/4 in ") == "in"
    assert unit_in("1/4") == unit_in("x") == ""


def test_flows_of_pumps_and_fans__are_gallons_and_cubic_feet_per_minute():
    assert to_si("60 gpm", "m3 s-1") == float(231 * INCH**3)
    assert to_si("60 cfm", "m3 s-1") == float(FOOT**3)


# Shown


@each(
    "units, largest, factor, label",
    [
        ("m", 0.25, 1e3, "mm"),
        ("rad", 3.0, 180 / math.pi, "°"),
        ("rad s-1", 100.0, 30 / math.pi, "rpm"),
        ("N", -1.2e4, 1e-3, "kN"),
        ("N m", 2.5e3, 1e-3, "kN·m"),
        ("kg", 0.02, 1e3, "g"),
        ("Pa", 6e5, 1e-3, "kPa"),
        ("1", 0.3, 1.0, "1"),
    ],
)
def test_engineer_unit__as_on_a_drawing(units, largest, factor, label):
    found, text = display_unit(units, np.array([0.0, largest, np.nan]))
    assert found == pytest.approx(factor)
    assert text == label


@each(
    "value, error, shown",
    [
        (66.34, 0.41, "66.3 ± 0.4"),
        (0.0731, 0.012, "0.07 ± 0.01"),
        (99.96, 0.095, "100.0 ± 0.1"),
        (1234.6, 80.0, "1230 ± 80"),
        (-0.2, 0.7, "-0.2 ± 0.7"),
        (-0.2, 3.0, "0 ± 3"),
        (2.4e-7, 3.1e-5, "0 ± 3e-05"),
        (1.503e-9, 2e-11, "1.50e-09 ± 2e-11"),
        (120.0, 4e-13, "120"),
        (1 / 3, None, "0.33333"),
        (1 / 3, math.nan, "0.33333"),
        (0.0, 1e-5, "0 ± 1e-05"),
        (0.0, 1e-12, "0"),
        (0.0, 0.0, "0"),
        (120.0, 1e-4, "120"),
        (120.0, 1.3e-4, "120 ± 0.0001"),
    ],
)
def test_figure__has_no_digits_beyond_its_error(value, error, shown):
    """Of errors below a millionth of the value, only those that decide something are shown."""
    assert figure_text(value, error, 5) == shown
    assert figure_text(120.0, 1e-12, 5, True) == "120 ± 1e-12"


def test_quantity__is_rounded_in_the_unit_shown():
    assert quantity_text(0.12345, "m", 0.0004) == "123.5 ± 0.4 mm"
    assert quantity_text(math.nan, "m", 0.0004) == "–"
