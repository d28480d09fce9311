"""Whether the loops of the structural groups close, as nodes: what positions miss of lengths, guides and directions."""

import numpy as np

from engine.graph.nodes import Node
from engine.laws.kinematics.loop_closure import direction_gap, distance, greater, guide_gap, link_gap, unit_gap
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.vectors import named


def closure(kinematics: Kinematics, group: str) -> Node:
    """The greatest of what the loop of a group misses, as a share of a length."""
    gaps = _Loop(kinematics, group).gaps()
    worst = gaps[0]
    for gap in gaps[1:]:
        worst = kinematics.graph.apply(greater, worst, gap)
    return named(worst, f"{group}_closure")


class _Loop:
    """What the loop of one group misses."""

    def __init__(self, kinematics: Kinematics, name: str) -> None:
        self.k, self.name = kinematics, name
        self.group = kinematics.scene.groups[name]
        self.first, self.second = self.group.first, self.group.second

    def gaps(self) -> tuple[Node, ...]:
        return getattr(self, f"_{self.group.type.lower()}")()

    def _number(self, key: str) -> Node:
        return self.k.graph.number(f"groups.{self.name}.{key}")

    def _link(self, side: str) -> Node:
        part, inner = getattr(self, side), self.k.points[self.group.inner]
        link = self.k.links[part.link]
        return self.k.graph.apply(
            link_gap, *self.k.points[part.joint].r, *inner.r, self._number(f"{side}.length"), *link.u
        )

    def _slider(self, side: str, size: Node) -> Node:
        part, inner = getattr(self, side), self.k.points[self.group.inner]
        guide, slide = self.k.guides[part.guide], self.k.slides[part.link]
        return self.k.graph.apply(
            guide_gap, *inner.r, *guide.r, *guide.u, self._number(f"{side}.offset"), slide.d, size
        )

    def _rrr(self) -> tuple[Node, ...]:
        return self._link("first"), self._link("second")

    def _rrp(self) -> tuple[Node, ...]:
        return self._link("first"), self._slider("second", self._number("first.length"))

    def _rpr(self) -> tuple[Node, ...]:
        apply = self.k.graph.apply
        a, d = self.k.points[self.first.joint].r, self.k.points[self.second.joint].r
        u, slide = self.k.links[self.second.link].u, self.k.slides[self.first.link].d
        size = apply(distance, *a, *d)
        return apply(guide_gap, *a, *d, *u, self._number("second.offset"), slide, size), apply(unit_gap, *u)

    def _prp(self) -> tuple[Node, ...]:
        slides = [self.k.slides[part.link].d for part in (self.first, self.second)]
        offsets = [self._number(f"{side}.offset") for side in ("first", "second")]
        size = abs(slides[0]) + abs(slides[1]) + abs(offsets[0]) + abs(offsets[1])
        return self._slider("first", size), self._slider("second", size)

    def _rpp(self) -> tuple[Node, ...]:
        graph = self.k.graph
        a, guide = self.k.points[self.first.joint].r, self.k.guides[self.second.guide]
        slot, crossing = self.k.links[self.first.link].u, self.k.links[self.second.link].origin.r
        yoke, block = self.k.slides[self.second.link].d, self.k.slides[self.first.link].d
        size = abs(yoke) + abs(block)
        path = f"groups.{self.name}.second.slot_angle"
        cosine = graph.derived(f"cos {path}", lambda n: np.cos(n[path]))
        sine = graph.derived(f"sin {path}", lambda n: np.sin(n[path]))
        return (
            graph.apply(guide_gap, *crossing, *guide.r, *guide.u, 0.0, yoke, size),
            graph.apply(guide_gap, *a, *crossing, *slot, 0.0, block, size),
            graph.apply(direction_gap, *slot, *guide.u, cosine, sine),
        )
