"""A program: the straight-line mathematics of one machine at one position, as steps that name their results.

Every variable is assigned once. A step that nothing asked depends on is left out, so the program of an output
holds just what that output needs.
"""

import re
from collections.abc import Callable, Iterable
from typing import Literal, NamedTuple

import numpy as np

from engine.scene.scene import Numbers

# A name that isn't part of a longer one, nor an attribute.
_NAME = re.compile(r"(?<![\w.])[A-Za-z_]\w*")


class Slot(NamedTuple):
    """A run-time argument of a kernel: one number per variant.

    Attributes
    ----------
    variable : str
        Its name in the kernel.
    compute : callable
        Its value (SI) from the numbers of the variants.
    role : {"shape", "load"}
        A "load" enters rows linearly (masses, forces); all others decide the shape of the motion.
    """

    variable: str
    compute: Callable[[Numbers], float | np.ndarray]
    role: Literal["shape", "load"]


class Step(NamedTuple):
    """One assignment: `targets` = `expression`; `subject` and `level` say to a reader what it belongs to."""

    targets: tuple[str, ...]
    expression: str
    subject: str
    level: str

    @property
    def needs(self) -> frozenset[str]:
        """Names that the expression uses."""
        return frozenset(_NAME.findall(self.expression))

    @property
    def line(self) -> str:
        """The step as a line of source."""
        return f"{', '.join(self.targets)} = {self.expression}"


class Program:
    """Steps and slots of a machine, in order."""

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self.slots: dict[str, Slot] = {}
        self._subject = ""
        self._level = ""
        self._count = 0

    def about(self, subject: str, level: str) -> None:
        """Name the subject and the level ("position", "velocity", "acceleration", …) of the steps that follow."""
        self._subject, self._level = subject, level

    def let(self, targets: str, expression: str) -> str:
        """Add a step; returns the targets."""
        names = tuple(t.strip() for t in targets.split(","))
        self.steps.append(Step(names, expression, self._subject, self._level))
        return targets

    def fresh(self, expression: str) -> str:
        """Name the result of an expression."""
        self._count += 1
        return self.let(f"_{self._count}", expression)

    def fresh_pair(self, expression: str) -> tuple[str, str]:
        """Name the two components of a vector expression."""
        self._count += 1
        x, y = f"_{self._count}x", f"_{self._count}y"
        self.let(f"{x}, {y}", expression)
        return x, y

    def number(self, path: str, role: Literal["shape", "load"] = "shape") -> str:
        """Slot for a number of the scene as it is."""
        return self.derived(path, lambda numbers: numbers[path], role)

    def derived(
        self,
        label: str,
        compute: Callable[[Numbers], float | np.ndarray],
        role: Literal["shape", "load"] = "shape",
    ) -> str:
        """Slot for a number computed once per variant from the scene's numbers."""
        variable = "num__" + re.sub(r"\W+", "__", label)
        self.slots.setdefault(variable, Slot(variable, compute, role))
        return variable

    def needed(self, asked: Iterable[str]) -> list[Step]:
        """The steps on which the asked variables depend, in order."""
        wanted, kept = set(asked), []
        for step in reversed(self.steps):
            if wanted.intersection(step.targets):
                kept.append(step)
                wanted |= step.needs
        return kept[::-1]
