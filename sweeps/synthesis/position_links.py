"""Guiding links through positions, from the user's choices."""

import cmath
from collections.abc import Sequence

from sweeps.synthesis.dyads import PlaneDyad, PlanePosition, dyad_of_centre, dyad_of_circle, dyads_of_turn
from sweeps.text.input_files import InputError
from sweeps.text.numbers_in_row import numbers_in_row


def chosen_links(
    positions: Sequence[PlanePosition], pivots: Sequence[str], joints: Sequence[str], turns: Sequence[str]
) -> list[PlaneDyad]:
    """Two links through the positions: those by pivots, then by joints, or those by turns.

    Parameters
    ----------
    positions : sequence of PlanePosition
    pivots, joints : sequence of str
        "X, Y" of frame pivots, and of joints on the plane in its first position.
    turns : sequence of str
        "ANGLE, 1" or "ANGLE, 2": rotation of a link from the first of four positions to the second, and the solution.

    Raises
    ------
    InputError
        The choices don't fit the number of positions.
    SynthesisError
        There is no such link.
    """
    if len(positions) not in (3, 4):
        raise InputError.of("--at", f"three or four positions are needed, not {len(positions)}")
    if len(positions) == 4 and (pivots or joints):
        raise InputError.of("--pivot", "--pivot and --joint are for three positions; for four give --turn")
    if len(positions) == 3 and turns:
        raise InputError.of("--turn", "is for four positions; for three give --pivot or --joint")
    given = [*pivots, *joints, *turns]
    if len(given) != 2:
        kinds = "--turn" if len(positions) == 4 else "--pivot or --joint"
        raise InputError.of("--at", f"two links are needed, each by its {kinds}; {len(given)} given")
    links = [dyad_of_centre(positions, complex(*_xy("--pivot", text))) for text in pivots]
    for text in joints:
        seen = (complex(*_xy("--joint", text)) - positions[0].point) * cmath.exp(-1j * positions[0].angle)
        links.append(dyad_of_circle(positions, seen))
    for text in turns:
        angle, which = numbers_in_row("--turn", text, ("angle", "number"))
        found = dyads_of_turn(positions, angle)
        if which not in (1.0, 2.0):
            raise InputError.of("--turn", f"{text!r}: there are two solutions, 1 and 2")
        if len(found) < 2:
            raise InputError.of("--turn", f"{text!r}: no link on the curve turns by this angle; give another")
        links.append(found[int(which) - 1])
    return links


def _xy(option: str, text: str) -> tuple[float, ...]:
    return numbers_in_row(option, text, ("length", "length"))
