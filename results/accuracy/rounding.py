"""Rounding of the scalar functions, in units in the last place, against the same formulas in many digits.

Every scalar function of the mechanics is called with random numbers over wide ranges, a half of them on purpose near
dead centres, near the motors' no-load speed, near equal speeds, and so on. The truth is the function's own text carried
out by mpmath at 80 digits from the same numbers; where the text has series or fitted polynomials, the closed form is.
That the formulas are the right ones is for the tests to show. Run from the repository's root:

    python results/accuracy/rounding.py

writes rounding.md beside this file.

What the numbers themselves leave open is told apart: `inherent` is by how much the result moves, to first order, when
every argument is off by half a unit in its last place. No formula can promise less than that and half a unit more.
"""

import builtins
import importlib
import inspect
from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from typing import NamedTuple

import mpmath as mp
import numpy as np
from numba.core.dispatcher import Dispatcher
from rounding_draws import DRAWS, arguments_of

HERE = Path(__file__).parent
_GROUPS = ("rrr", "rrp", "rpr", "prp", "rpp")
# Per position, so in float32 too.
PER_POSITION = tuple(f"laws.kinematics.{name}" for name in (*_GROUPS, "dead_centres", "vectors", "links"))
PER_POSITION += ("laws.loads",)
MODULES = (
    *PER_POSITION,
    "laws.elementary",
    "laws.motor_characteristics",
    "laws.indicator_diagrams",
)
MODULES += ("laws.tables",)
MODULES += tuple(
    f"laws.friction.{name}" for name in ("belts", "coefficients", "guides", "inclines", "journals", "rolling")
)
# They give a number that counts or one of their arguments, measure rounding themselves, or are a step of another one.
LEFT_OUT = (
    "line_pressure",
    *(f"{group}_closure" for group in _GROUPS),
    "left_over",
    "_cubic",
    "_logarithm_parts",
    "_exponential_of_sum",
    "direction_near_zero",
    "_stays_on",
)
SAMPLES, DIGITS, NUDGE = 400, 80, mp.mpf(10) ** -30
# Share of a result from which on the first order says nothing about it any more.
HOPELESS = 1e-3
WORSE_THAN_INHERENT = 8.0


class Rounding(NamedTuple):
    """Errors of a function in units in the last place.

    Attributes
    ----------
    median, greatest : float
        Of all results of all calls.
    inherent : float
        What half a unit in the last place of every argument does, where the error is greatest.
    over : float
        Greatest error over what is inherent plus half a unit.
    lost : int
        Calls that gave no number though there is one, or one though there is none.
    """

    median: float
    greatest: float
    inherent: float
    over: float
    lost: int


# The same text with many digits


class _Mathematics:
    """Python's `math` with many digits: real, NaN where there is no value."""

    inf, nan = mp.inf, mp.nan

    @property
    def pi(self) -> mp.mpf:
        return +mp.pi

    @staticmethod
    def floor(x: mp.mpf) -> mp.mpf:
        return mp.floor(x)

    @staticmethod
    def copysign(x: mp.mpf, y: mp.mpf) -> mp.mpf:
        return abs(x) if y >= 0 else -abs(x)

    def __getattr__(self, name: str) -> Callable:
        function = getattr(mp, name)

        def real(*numbers: mp.mpf) -> mp.mpf:
            found = function(*numbers)
            return mp.nan if isinstance(found, mp.mpc) else found

        return real


def _direction_of(angle: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
    return mp.cos(angle), mp.sin(angle)


def _linear_moment(inertia: mp.mpf, m0: mp.mpf, m1: mp.mpf, omega0: mp.mpf, t: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
    x = m1 * t / inertia
    decay = -mp.expm1(-x) / x
    gained = m0 * t / inertia
    return omega0 * mp.exp(-x) + gained * decay, (omega0 * decay + gained * (1 - decay) / x) * t


def _linear_moment_squares(inertia: mp.mpf, m0: mp.mpf, m1: mp.mpf, omega0: mp.mpf, t: mp.mpf) -> mp.mpf:
    omega, phi = _linear_moment(inertia, m0, m1, omega0, t)
    return (m0 * phi - inertia * (omega**2 - omega0**2) / 2) / m1


CLOSED = {
    # With so many digits, whatever is left over is more than rounding.
    "left_over": lambda square, scale: square,
    "direction_of": _direction_of,
    "exponential": mp.exp,
    "logarithm": mp.log,
    "power": mp.power,
    "angle_of": lambda x, y: mp.atan2(y, x),
    "arcsine": mp.asin,
    "linear_moment": _linear_moment,
    "linear_moment_squares": _linear_moment_squares,
}


def exact(function: Dispatcher) -> Callable:
    """The text of a compiled function, to be carried out by mpmath."""
    plain = function.py_func
    if plain.__name__ in CLOSED:
        return CLOSED[plain.__name__]
    names = dict(plain.__globals__, math=_Mathematics(), max=builtins.max, min=builtins.min)
    for name in plain.__code__.co_names:
        if isinstance(names.get(name), Dispatcher):
            names[name] = exact(names[name])
    return FunctionType(plain.__code__, names, plain.__name__, plain.__defaults__)


# Measuring


def widened(argument: object) -> object:
    """An argument as mpmath has it; what chooses a branch stays as it is."""
    if isinstance(argument, np.ndarray):
        return np.array([mp.mpf(float(x)) for x in argument.ravel()], object).reshape(argument.shape)
    return argument if isinstance(argument, (bool, int)) else mp.mpf(float(argument))


def results(function: Callable, arguments: list) -> list[mp.mpf] | None:
    """What a function gives, as a list; None where any of it is undefined."""
    try:
        found = function(*arguments)
    except ZeroDivisionError:
        return None
    found = [mp.mpf(x) for x in (found if isinstance(found, tuple) else (found,))]
    return found if all(mp.isfinite(x) for x in found) else None


def nudges(arguments: list, dtype: type) -> list[tuple[list, mp.mpf]]:
    """Arguments with one number moved by NUDGE of itself, and half a unit in its last place over that move."""
    found = []
    for i, argument in enumerate(arguments):
        if isinstance(argument, (bool, int)):
            continue
        wide = widened(argument)
        for place in np.ndindex(np.shape(wide)):
            number = wide[place] if place else wide
            if number == 0:
                continue
            moved = [widened(a) for a in arguments]
            if place:
                moved[i][place] = number * (1 + NUDGE)
            else:
                moved[i] = number * (1 + NUDGE)
            found.append((moved, mp.mpf(float(np.spacing(dtype(abs(float(number)))))) / 2 / (abs(number) * NUDGE)))
    return found


def errors_of(function: Dispatcher, text: Callable, arguments: list, dtype: type) -> list[tuple[float, float]] | None:
    """Error and inherent error of each result of one call, in units in the last place; None where it is undefined."""
    true = results(text, [widened(a) for a in arguments])
    if true is None:
        return []
    inherent = [mp.mpf(0)] * len(true)
    for moved, share in nudges(arguments, dtype):
        there = results(text, moved)
        if there is None:
            return []
        inherent = [total + abs(a - b) * share for total, a, b in zip(inherent, there, true, strict=True)]
    limits = np.finfo(dtype)
    errors, got = [], results(function, arguments)
    if got is not None and function.py_func.__name__.endswith("_position") and got[-1] == 0:
        # Judged to be singular.
        return []
    for i, value in enumerate(true):
        if not limits.tiny < abs(value) < limits.max / 4:
            continue
        unit = mp.mpf(float(np.spacing(dtype(abs(float(value))))))
        if inherent[i] < HOPELESS * abs(value):
            if got is None:
                return None
            errors.append((float(abs(got[i] - value) / unit), float(inherent[i] / unit)))
    return errors


def measure(function: Dispatcher, dtype: type) -> Rounding:
    """Errors over many calls."""
    rng = np.random.default_rng(1)
    text, found, lost = exact(function), [], 0
    with mp.workdps(DIGITS):
        for call in range(SAMPLES):
            arguments = arguments_of(function.py_func, rng, near=call % 2 == 1, dtype=dtype)
            errors = errors_of(function, text, arguments, dtype)
            if errors is None:
                lost += 1
            else:
                found += errors
    errors, inherent = np.array(found).T
    worst = errors.argmax()
    over = (errors / (inherent + 0.5)).max()
    return Rounding(float(np.median(errors)), errors[worst], inherent[worst], over, lost)


def functions_of(module: str) -> list[Dispatcher]:
    """Scalar functions of numbers that a module defines."""
    namespace = importlib.import_module(f"engine.{module}")
    own = [
        f for f in vars(namespace).values() if isinstance(f, Dispatcher) and f.py_func.__module__ == namespace.__name__
    ]
    return [f for f in own if f.py_func.__name__ not in LEFT_OUT and (f.py_func.__name__ in DRAWS or _of_numbers(f))]


def _of_numbers(function: Dispatcher) -> bool:
    return all(p.annotation in (float, int, bool) for p in inspect.signature(function.py_func).parameters.values())


# The report


def shown(value: float) -> str:
    return f"{value:.2g}" if value < 1e4 else f"{value:.0e}"


def row(name: str, double: Rounding, single: Rounding | None) -> str:
    cells = [f"`{name}`", shown(double.median), shown(double.greatest), shown(double.inherent), f"{double.over:.2g}"]
    cells += ["", ""] if single is None else [shown(single.greatest), f"{single.over:.2g}"]
    return "| " + " | ".join(cells) + " |"


MENDED = inspect.cleandoc(
    """
    What these tables led to, with the same draws:

    | function | before | after |
    |---|---|---|
    | `rrr_position`, error over inherent + ½ | 440, by (r1 + r2)² − d² and d² − (r1 − r2)² | 6, by u (4 r1 r2 − u) |
    | 6 000 change points of parallelograms | 49 % out of reach; sines of up to 2e-7, by rounding alone | all singular |
    """
)


def main() -> None:
    """Measure all functions and write the table."""
    lines, faultless, worse, lost = [], [], [], []
    for module in MODULES:
        rows = []
        for function in functions_of(module):
            name = function.py_func.__name__
            double = measure(function, np.float64)
            single = measure(function, np.float32) if module in PER_POSITION else None
            lost += [f"`{name}` ({double.lost} calls)"] if double.lost else []
            if double.greatest == 0.0:
                faultless.append(f"`{name}`")
                continue
            rows.append(row(name, double, single))
            print(rows[-1], flush=True)
            if max(double.over, single.over if single else 0.0) > WORSE_THAN_INHERENT:
                worse.append(f"`{name}`")
        if rows:
            head = "| function | median | greatest | of which inherent | over inherent + ½ | float32: greatest | over |"
            lines += [f"## engine.{module}", "", head, "|---|---|---|---|---|---|---|", *rows, ""]
    intro = inspect.cleandoc(
        f"""
        # Rounding of the scalar functions

        Errors in units in the last place (ulp) of the result, of {SAMPLES} calls each, half of them drawn near singular
        places, against mpmath at {DIGITS} digits. `of which inherent`: what half an ulp of every argument does, where
        the error is greatest. `over inherent + ½`: the greatest ratio of the two; a few is as good as arithmetic gets.
        Made by `python results/accuracy/rounding.py`.
        """
    )
    closing = [f"Without any error: {', '.join(faultless)}.", ""]
    closing += [f"More than {WORSE_THAN_INHERENT:g} times over what is inherent: {', '.join(worse) or 'none'}.", ""]
    closing += [f"No number where there is one, or one where there is none: {', '.join(lost) or 'none'}.", ""]
    text = "\n".join([intro, "", *closing, MENDED, "", *lines])
    (HERE / "rounding.md").write_text(text, encoding="utf8")


if __name__ == "__main__":
    main()
