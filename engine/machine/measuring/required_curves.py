"""Requirements of measurements on the cycle: curves, structural groups, numbers of every variant."""

from collections import defaultdict
from collections.abc import Sequence

from engine.graph.functions import Functions, functions_of
from engine.graph.nodes import Node, Stage
from engine.machine.measuring.conditions import margins_against_jamming, margins_at_cams, taking_part, wound_springs
from engine.mechanism.mechanics import Mechanics
from engine.quantities.expressions import (
    Average,
    Expression,
    Extreme,
    ExtremePosition,
    Followed,
    Integral,
    LeastMagnitude,
    RootIntegral,
    Speed,
    SteadyCycle,
    StrokeEnd,
    Unbalanced,
    UnloadedArc,
    VariantNumber,
    measurements,
)
from engine.quantities.flywheel_sizes import SteadyMeasurements, without_result
from engine.words.verdicts import Verdict


class RequiredCurves:
    """Curves, groups and numbers of the graph that some measurements require.

    Parameters
    ----------
    mechanics : Mechanics
    expressions : sequence of Expression
    fields : sequence of Node
        Kept fields, whose numbers are included in the layout.
    followed : sequence of Followed
        Kept fields that are integrated over the cycle.
    elsewhere : sequence of Node
        Nodes of the machine that are computed elsewhere: the groups they depend on take part.

    Attributes
    ----------
    functions : Functions
    groups : tuple of str
        Structural groups that take part, in the order of the scene.
    vanishing : list of Vanishing
        For each, a curve that vanishes where it is singular.
    curves : list of Node
        All nodes computed at a position.
    margins : list of Margin
        Margins against jamming of groups whose friction matters, and of cams that take part.
    windings : list of Integral
        Angles by which the cycle winds up torsion springs that matter.
    """

    def __init__(
        self,
        mechanics: Mechanics,
        expressions: Sequence[Expression],
        fields: Sequence[Node],
        followed: Sequence[Followed],
        elsewhere: Sequence[Node] = (),
    ) -> None:
        self.mechanics, self.expressions = mechanics, tuple(expressions)
        self._spaced = list(dict.fromkeys(followed))
        self._asked = measurements(expressions)
        of = self._of = defaultdict(list)
        for asked in self._asked:
            of[type(asked)].append(asked)
        asked = [a.curve for a in (*of[Extreme], *of[ExtremePosition], *of[Average])]
        self._followed = list(dict.fromkeys([*self._spaced, *(c for c in asked if not isinstance(c, Node))]))
        cycles = [*of[SteadyCycle], *(f.steady for f in self._followed if isinstance(f, Speed))]
        curves = [*(a.curve for a in (*of[Integral], *of[LeastMagnitude])), *(c for c in asked if isinstance(c, Node))]
        # The order decides in which order the compiler adds, and so the last bits.
        curves += [c for a in (*of[RootIntegral], *cycles, *of[Unbalanced], *of[UnloadedArc]) for c in a.curves]
        curves += [c for f in self._followed for c in f.curves]
        ends = [a for a in of[StrokeEnd] if a.coordinate.stage == Stage.POSITION]
        found = [mechanics.graph.found(a.coordinate, a.rate, a.which) for a in ends]
        parts = [*curves, *fields, *elsewhere, *(a.coordinate for a in of[StrokeEnd])]
        wound = wound_springs(mechanics, parts)
        self.windings = [Integral(rate) for rate in wound]
        of[Integral] += self.windings
        curves += wound
        self.margins = [
            *margins_against_jamming(mechanics, [*curves, *fields]),
            *margins_at_cams(mechanics, parts),
        ]
        self.groups = taking_part(mechanics, [*parts, *(margin.curve for margin in self.margins)])
        self.vanishing = [mechanics.kinematics.vanishing(group) for group in self.groups]
        sines = [v.curve for v in self.vanishing]
        # Pressing forces become infinite where a group jams first.
        jamming = [margin for margin in self.margins if margin.verdict == Verdict.JAMS]
        pressing = [mechanics.reactions.settlings[margin.group].pressing[0] for margin in jamming]
        curves = list(dict.fromkeys([*curves, *sines, *(m.curve for m in self.margins), *pressing]))
        of[LeastMagnitude] += map(LeastMagnitude, sines)
        for margin in self.margins:
            of[Extreme].append(Extreme(margin.curve, "least"))
            of[ExtremePosition].append(ExtremePosition(margin.curve, "least"))
        self._kinks = mechanics.graph.kinks_behind(curves)
        curves = list(dict.fromkeys([*curves, *self._kinks]))
        # At kinks margins jump, however short a panel is; near 0 the requested forces keep panels short enough.
        self._jumping = {margin.curve for margin in jamming if self._kinks}
        self._auxiliary = [*self._kinks, *pressing]
        # The cycle keeps the first curves; the others are only integrated, or needed for their maximum magnitude.
        measured = (a for kind, every in of.items() if kind is not Integral for a in every)
        kept = {c for a in (*measured, *self._followed) for c in a.curves}
        curves.sort(key=lambda curve: curve not in kept)
        self.curves = list(dict.fromkeys([*curves, *fields]))
        shared = dict.fromkeys(without_result(a) for a in cycles)
        self._steady = [
            SteadyMeasurements(s, {a.result for a in cycles if without_result(a) == s}, mechanics) for s in shared
        ]
        numbers = [number for steady in self._steady for number in steady.numbers]
        numbers += [a.number for a in of[VariantNumber]]
        numbers += [v.beyond for v in self.vanishing if v.beyond is not None]
        self._one = mechanics.graph.derived("one", lambda n: 1.0)
        numbers += [self._one] if of[Unbalanced] else []
        self.functions: Functions = functions_of(
            mechanics.graph,
            mechanics.first,
            mechanics.last,
            curves,
            found,
            [*fields, *numbers],
        )

    @property
    def ends(self) -> tuple[int, int]:
        """Rows of P with the ends of the input's range."""
        return self.functions.rows[self.mechanics.first], self.functions.rows[self.mechanics.last]

    @property
    def all_groups(self) -> tuple[str, ...]:
        """All structural groups of the scene."""
        return tuple(self.mechanics.kinematics.sines)

    def cycle_of(self, asked: SteadyCycle) -> SteadyMeasurements:
        """The steady cycle to which a result belongs."""
        return next(s for s in self._steady if s.of == without_result(asked))
