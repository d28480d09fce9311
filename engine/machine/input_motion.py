"""How the input moves at a position, as variables of a program: at its own speed, or at any speed and acceleration."""

from typing import NamedTuple


class InputMotion(NamedTuple):
    """How the input moves at a position.

    Attributes
    ----------
    square, epsilon : str
        Variables of the square of its speed and of its acceleration ("zero": uniform).
    speed : str
        Variable of its speed by magnitude, for loads that depend on it; their coefficients are those at unit speed
        then. Without it they are those at the speed itself.
    """

    square: str
    epsilon: str = "zero"
    speed: str = ""

    def power(self, order: str) -> str:
        """Power of the speed by which a load of some order exceeds its coefficient."""
        if not self.speed or order == "0":
            return "one"
        return {"1": self.speed, "2": self.square}.get(order, f"{self.speed} ** {order}")

    def acceleration(self, second: str, first: str) -> str:
        """Acceleration ω² r″ + ε r′ of what has the transfer functions r″ and r′."""
        parts = ((self.square, second), (self.epsilon, first))
        terms = [f"{factor} * {r}" for factor, r in parts if "zero" not in (factor, r)]
        return " + ".join(terms) or "zero"
