"""How the loops of the structural groups stand: whether they close, and how they magnify inaccuracies of their links.

An error dr of a link's length, or of a guide's offset, moves the inner joint B of a dyad so that it keeps to the other
link or guide: u₁·dB = dr, u₂·dB = 0, with u₁ and u₂ along the links or across the guides. So B moves across u₂ by

    |dB| = dr / |sin γ|,

γ the angle between u₁ and u₂: the transmission angle of RRR, that of the rod and the normal of the guide in RRP, of the
two guides in PRP. In RPR the slot's point that lies at the pin moves so by an error of the slot's offset, in RPP the
crossing of slot and guide by an error across the slot. Errors are magnified without bound in dead centres and change
points of the group, where γ is 0.

Source: any course of the theory of mechanisms, chapter on the accuracy of mechanisms; the dyads' equations are those of
`engine.laws.kinematics`, whose `sine` is sin γ.
"""

import numpy as np

from engine.equal_positions.text.program import Program
from engine.machine.mechanism import Mechanism
from engine.machine.quantities.quantities import Quantity
from engine.scene.scene import Scene

MAGNIFICATION, RESIDUAL = "error_magnification", "loop_closure_residual"


def loop_summaries(scene: Scene) -> list[Quantity]:
    """What may be asked of the loops of the groups."""
    if not scene.groups:
        return []
    words = "displacement of the joint or block by an error of a length or offset, in its worst position, as a multiple"
    kept = "lengths, guides and directions that computed positions miss by, as a share of the links' lengths, at worst"
    return [
        *(Quantity(f"{group}.{MAGNIFICATION}", f"group {group}: {words}", "1") for group in scene.groups),
        Quantity(MAGNIFICATION, f"of the worst group: {words}", "1"),
        Quantity(RESIDUAL, kept, "1"),
    ]


def magnifications(sines: dict[str, str]) -> dict[str, tuple[str, str]]:
    """Expressions of the magnifications, and of what they miss where sin γ is still less.

    Parameters
    ----------
    sines : dict of str to str
        Variable of sin γ by group; `least__` and `off__` before it stand for its least magnitude over the cycle and
        for what that may be off by.
    """
    found = {}
    for group, sine in sines.items():
        least, off = f"least__{sine}", f"off__{sine}"
        found[f"{group}.{MAGNIFICATION}"] = (f"1.0 / {least}$", f"{off} / ({least} * max({least} - {off}, zero))")
    values, missed = (", ".join(part[i] for part in found.values()) for i in (0, 1))
    if len(found) > 1:
        values, missed = f"max({values})", f"max({missed})"
    return found | {MAGNIFICATION: (values, missed)} if found else found


def write_closures(scene: Scene, mechanism: Mechanism, program: Program) -> dict[str, str]:
    """Write what the loop of each group misses; variables by group."""
    found = {}
    for name, group in scene.groups.items():
        program.about(f"closure of group {name}", "position")
        gaps = _Closure(mechanism, program, name).gaps(group.type)
        expression = gaps[0]
        for gap in gaps[1:]:
            expression = f"greater({expression}, {gap})"
        found[name] = program.let(f"{name}_closure", expression)
    return found


class _Closure:
    """Expressions of what the loop of a group misses."""

    def __init__(self, mechanism: Mechanism, program: Program, name: str) -> None:
        self.m, self.p, self.name = mechanism, program, name
        self.first, self.second = (getattr(mechanism.scene.groups[name], side) for side in ("first", "second"))

    def gaps(self, kind: str) -> tuple[str, ...]:
        """Of a dyad's kind."""
        return getattr(self, f"_{kind.lower()}")()

    def _number(self, key: str) -> str:
        return self.p.number(f"groups.{self.name}.{key}")

    def _link(self, side: str) -> str:
        part, inner = getattr(self, side), self.m.points[self.m.scene.groups[self.name].inner]
        joint, link = self.m.points[part.joint], self.m.links[part.link]
        length = self._number(f"{side}.length")
        return f"link_gap({joint.x}, {joint.y}, {inner.x}, {inner.y}, {length}, {link.c}, {link.s})"

    def _slider(self, side: str, size: str) -> str:
        part, inner = getattr(self, side), self.m.points[self.m.scene.groups[self.name].inner]
        guide, slide = self.m.guides[part.guide], self.m.slides[part.link]
        line = f"{guide.x}, {guide.y}, {guide.c}, {guide.s}"
        return f"guide_gap({inner.x}, {inner.y}, {line}, {self._number(f'{side}.offset')}, {slide.d}, {size})"

    def _rrr(self) -> tuple[str, ...]:
        return self._link("first"), self._link("second")

    def _rrp(self) -> tuple[str, ...]:
        return self._link("first"), self._slider("second", self._number("first.length"))

    def _rpr(self) -> tuple[str, ...]:
        a, d = self.m.points[self.first.joint], self.m.points[self.second.joint]
        rocker, slide = self.m.links[self.second.link], self.m.slides[self.first.link]
        size = f"distance({a.x}, {a.y}, {d.x}, {d.y})"
        line = f"{d.x}, {d.y}, {rocker.c}, {rocker.s}, {self._number('second.offset')}"
        return f"guide_gap({a.x}, {a.y}, {line}, {slide.d}, {size})", f"unit_gap({rocker.c}, {rocker.s})"

    def _prp(self) -> tuple[str, ...]:
        slides = [self.m.slides[part.link].d for part in (self.first, self.second)]
        offsets = [self._number(f"{side}.offset") for side in ("first", "second")]
        size = self.p.fresh(" + ".join(f"abs({part})" for part in (*slides, *offsets)))
        return self._slider("first", size), self._slider("second", size)

    def _rpp(self) -> tuple[str, ...]:
        a, guide = self.m.points[self.first.joint], self.m.guides[self.second.guide]
        slot, crossing = self.m.links[self.first.link], self.m.links[self.second.link].origin
        yoke, block = self.m.slides[self.second.link].d, self.m.slides[self.first.link].d
        size = self.p.fresh(f"abs({yoke}) + abs({block})")
        on_guide = f"{guide.x}, {guide.y}, {guide.c}, {guide.s}, zero, {yoke}, {size}"
        on_slot = f"{crossing.x}, {crossing.y}, {slot.c}, {slot.s}, zero, {block}, {size}"
        beta = f"groups.{self.name}.second.slot_angle"
        turn = f"{self.p.derived(f'{beta}.cos', lambda n: np.cos(n[beta]))}, "
        turn += self.p.derived(f"{beta}.sin", lambda n: np.sin(n[beta]))
        return (
            f"guide_gap({crossing.x}, {crossing.y}, {on_guide})",
            f"guide_gap({a.x}, {a.y}, {on_slot})",
            f"direction_gap({slot.c}, {slot.s}, {guide.c}, {guide.s}, {turn})",
        )
