"""The kinematics of an ordered mechanism as steps of a program, one structural group after another."""

from typing import NamedTuple

import numpy as np

from engine.equal_positions.text.program import Program
from engine.scene.masses import LinkMass, masses, whole_body
from engine.scene.parts import FRAME, CrankInput
from engine.scene.scene import Scene
from engine.scene.structure import Structure


class Moving(NamedTuple):
    """Variables of a moving point: position, transfer velocity and acceleration. "zero" where it is at rest."""

    x: str
    y: str
    vx: str = "zero"
    vy: str = "zero"
    ax: str = "zero"
    ay: str = "zero"


class Turning(NamedTuple):
    """Variables of a link: its origin, direction, angular velocity and acceleration; None where it doesn't turn."""

    origin: Moving
    c: str
    s: str
    w: str | None
    e: str | None


class GuideLine(NamedTuple):
    """Variables of a guide: the link that carries it, a point and a direction."""

    carrier: Turning
    x: str
    y: str
    c: str
    s: str


class Slide(NamedTuple):
    """Variables of a slide coordinate and its first two derivatives."""

    d: str
    dv: str
    da: str


def own(name: str) -> Moving:
    """Variables of a point named in the scene."""
    return Moving(*(f"{name}_{suffix}" for suffix in ("x", "y", "vx", "vy", "ax", "ay")))


class Mechanism:
    """Writes the kinematics of a scene into a program.

    Attributes
    ----------
    points, links, guides, slides : dict
        Variables of each by its name in the scene.
    sines : dict
        Variable of the transmission quality of each group that has one.
    masses : dict of str to LinkMass
        Bodies and the point masses that stand for bodies.
    """

    def __init__(self, scene: Scene, structure: Structure, program: Program, varied: frozenset[str]) -> None:
        self.scene, self.program, self.varied = scene, program, varied
        rest = Moving("zero", "zero")
        self.points: dict[str, Moving] = {}
        self.links: dict[str, Turning] = {FRAME: Turning(rest, "one", "zero", None, None)}
        self.guides: dict[str, GuideLine] = {}
        self.slides: dict[str, Slide] = {}
        self.sines: dict[str, str] = {}
        self.masses = masses(scene, varied)
        self._centres: dict[str, Moving] = {}
        # The input may stand before the frame's points in the order; its pivot or guide is on the frame.
        for name, point in scene.points.items():
            if point.link == FRAME:
                self._point(name)
        for name, guide in scene.guides.items():
            if guide.link == FRAME:
                self._guide(name)
        write = {
            "input": self._input,
            "shaft": self._shaft,
            "group": self._group,
            "point": self._point,
            "guide": self._guide,
        }
        for element in structure.elements:
            if element.name not in self.points and element.name not in self.guides:
                write[element.kind](element.name)

    # Rigid links

    def velocity_at(self, link: Turning, px: str, py: str) -> str:
        """Expression of the velocity of the point of a link at the arm (px, py)."""
        o = link.origin
        if link.w is None:
            return f"{o.vx}, {o.vy}"
        return f"rigid_velocity({o.vx}, {o.vy}, {link.w}, {px}, {py})"

    def acceleration_at(self, link: Turning, px: str, py: str) -> str:
        """Expression of the acceleration of the point of a link at the arm (px, py)."""
        o = link.origin
        if link.w is None:
            return f"{o.ax}, {o.ay}"
        if link.e is None:
            return f"{o.ax} - {link.w} * {link.w} * {px}, {o.ay} - {link.w} * {link.w} * {py}"
        return f"rigid_acceleration({o.ax}, {o.ay}, {link.w}, {link.e}, {px}, {py})"

    def point_on(self, name: str, link: Turning, along: str, across: str) -> Moving:
        """Write a rigid point of a link and return its variables."""
        self.program.about(f"point {name}", "position")
        return self._placed(own(name), link, along, across)

    def _placed(self, point: Moving, link: Turning, along: str, across: str) -> Moving:
        p = self.program
        px, py = p.fresh_pair(f"arm({along}, {across}, {link.c}, {link.s})")
        p.let(f"{point.x}, {point.y}", f"{link.origin.x} + {px}, {link.origin.y} + {py}")
        return self._moved(point, link, px, py)

    def _moved(self, point: Moving, link: Turning, px: str, py: str) -> Moving:
        p = self.program
        p.about(p._subject, "velocity")
        p.let(f"{point.vx}, {point.vy}", self.velocity_at(link, px, py))
        p.about(p._subject, "acceleration")
        p.let(f"{point.ax}, {point.ay}", self.acceleration_at(link, px, py))
        return point

    def centre(self, name: str) -> Moving:
        """Variables of the centre of one of the `masses`: a point known before where it lies in one always."""
        return self._centre_of(name, self.masses[name])

    def body_centre(self, name: str) -> Moving:
        """Variables of the centre of mass of a body, whatever stands for it."""
        return self._centre_of(name, whole_body(self.scene, name, self.varied))

    def _centre_of(self, name: str, mass: LinkMass) -> Moving:
        p = self.program
        if mass.point is not None:
            return self.points[mass.point]
        if mass.at_origin:
            return self.links[mass.link].origin
        if name not in self._centres:
            along = p.derived(f"bodies.{name}.along", mass.along)
            across = p.derived(f"bodies.{name}.across", mass.across)
            p.about(f"centre of {name}", "position")
            # Links make points of their own name with one underscore.
            self._centres[name] = self._placed(own(f"__{name}"), self.links[mass.link], along, across)
        return self._centres[name]

    # Elements of the ordering

    def _point(self, name: str) -> None:
        part, p = self.scene.points[name], self.program
        x, y = p.number(f"points.{name}.x"), p.number(f"points.{name}.y")
        if part.link == FRAME:
            self.points[name] = Moving(x, y)
        else:
            self.points[name] = self.point_on(name, self.links[part.link], x, y)

    def _guide(self, name: str) -> None:
        part, p = self.scene.guides[name], self.program
        x, y = p.number(f"guides.{name}.x"), p.number(f"guides.{name}.y")
        c = p.derived(f"guides.{name}.cos", lambda n: np.cos(n[f"guides.{name}.angle"]))
        s = p.derived(f"guides.{name}.sin", lambda n: np.sin(n[f"guides.{name}.angle"]))
        carrier = self.links[part.link]
        if part.link != FRAME:
            p.about(f"guide {name}", "position")
            px, py = p.fresh_pair(f"arm({x}, {y}, {carrier.c}, {carrier.s})")
            x, y = p.fresh_pair(f"{carrier.origin.x} + {px}, {carrier.origin.y} + {py}")
            c, s = p.fresh_pair(f"arm({c}, {s}, {carrier.c}, {carrier.s})")
        self.guides[name] = GuideLine(carrier, x, y, c, s)

    def _input(self, name: str) -> None:
        drive, p = self.scene.input, self.program
        p.about(f"input {name}", "position")
        if isinstance(drive, CrankInput):
            pivot = self.points[drive.pivot]
            self.links[name] = Turning(pivot, "cos_q", "sin_q", "one", None)
            self.points[drive.pin] = self.point_on(drive.pin, self.links[name], p.number("input.length"), "zero")
            return
        guide, point = self.guides[drive.guide], own(drive.point)
        start, stop = p.number("input.start"), p.number("input.stop")
        p.let(f"{name}_d", f"{start} + ({stop} - {start}) * q")
        p.let(f"{point.x}, {point.y}", f"{guide.x} + {name}_d * {guide.c}, {guide.y} + {name}_d * {guide.s}")
        moving = Moving(point.x, point.y, guide.c, guide.s)
        self.points[drive.point] = moving
        self.links[name] = Turning(moving, guide.c, guide.s, None, None)
        self.slides[name] = Slide(f"{name}_d", "one", "zero")

    def _shaft(self, name: str) -> None:
        shaft, p = self.scene.shafts[name], self.program
        driver = self.links[shaft.geared_to]
        ratio = p.number(f"shafts.{name}.ratio")
        p.about(f"shaft {name}", "velocity")
        w = ratio if driver.w == "one" else p.let(f"{name}_w", f"{ratio} * {driver.w}")
        e = None if driver.e is None else p.let(f"{name}_e", f"{ratio} * {driver.e}")
        if shaft.pivot is None:
            self.links[name] = Turning(Moving("zero", "zero"), "one", "zero", w, e)
            return
        p.about(f"shaft {name}", "position")
        p.let(f"{name}_angle", f"{ratio} * q + {p.number(f'shafts.{name}.phase')}")
        p.let(f"{name}_c, {name}_s", f"math.cos({name}_angle), math.sin({name}_angle)")
        self.links[name] = Turning(self.points[shaft.pivot], f"{name}_c", f"{name}_s", w, e)

    # Structural groups

    def _group(self, name: str) -> None:
        getattr(self, f"_{self.scene.groups[name].type.lower()}")(name)

    def _new_link(self, name: str, origin: Moving) -> Turning:
        link = Turning(origin, f"{name}_c", f"{name}_s", f"{name}_w", f"{name}_e")
        self.links[name] = link
        return link

    def _rrr(self, name: str) -> None:
        g, p = self.scene.groups[name], self.program
        a, d, b = self.points[g.first.joint], self.points[g.second.joint], own(g.inner)
        l1, l2 = self._new_link(g.first.link, a), self._new_link(g.second.link, d)
        r1, r2 = p.number(f"groups.{name}.first.length"), p.number(f"groups.{name}.second.length")
        sine = self.sines[name] = f"{name}_sine"
        p.about(f"group {name} (RRR)", "position")
        p.let(
            f"{b.x}, {b.y}, {l1.c}, {l1.s}, {l2.c}, {l2.s}, {sine}",
            f"rrr_position({a.x}, {a.y}, {d.x}, {d.y}, {r1}, {r2}, {p.number(f'groups.{name}.mode')})",
        )
        p1x, p1y = p.fresh_pair(f"{r1} * {l1.c}, {r1} * {l1.s}")
        p2x, p2y = p.fresh_pair(f"{r2} * {l2.c}, {r2} * {l2.s}")
        solve = f"{r1}, {l1.c}, {l1.s}, {r2}, {l2.c}, {l2.s}, {sine}"
        p.about(f"group {name} (RRR)", "velocity")
        gx, gy = p.fresh_pair(f"{d.vx} - {a.vx}, {d.vy} - {a.vy}")
        p.let(f"{l1.w}, {l2.w}", f"rrr_rates({gx}, {gy}, {solve})")
        p.about(f"group {name} (RRR)", "acceleration")
        gx, gy = p.fresh_pair(
            f"{d.ax} - {a.ax} + {l1.w} * {l1.w} * {p1x} - {l2.w} * {l2.w} * {p2x}, "
            f"{d.ay} - {a.ay} + {l1.w} * {l1.w} * {p1y} - {l2.w} * {l2.w} * {p2y}"
        )
        p.let(f"{l1.e}, {l2.e}", f"rrr_rates({gx}, {gy}, {solve})")
        # From the side whose outer joint is at rest the joint's motion takes fewer operations.
        if d.vx == "zero":
            self.points[g.inner] = self._moved(b, l2, p2x, p2y)
        else:
            self.points[g.inner] = self._moved(b, l1, p1x, p1y)

    def _on_guide(self, guide: GuideLine, x: str, y: str) -> tuple[str, str]:
        """Arm of a place on the link that carries a guide."""
        o = guide.carrier.origin
        return self.program.fresh_pair(f"{x} - {o.x}, {y} - {o.y}")

    def _under_slider(self, guide: GuideLine, x: str, y: str) -> Moving:
        """Motion of the carrier's point that lies at (x, y) at the moment."""
        p, carrier = self.program, guide.carrier
        if carrier.w is None:
            o = carrier.origin
            return Moving(x, y, o.vx, o.vy, o.ax, o.ay)
        level = p._level
        px, py = self._on_guide(guide, x, y)
        vx, vy = p.fresh_pair(self.velocity_at(carrier, px, py))
        ax, ay = p.fresh_pair(self.acceleration_at(carrier, px, py))
        p.about(p._subject, level)
        return Moving(x, y, vx, vy, ax, ay)

    def _with_coriolis(self, guide: GuideLine, under: Moving, vx: str, vy: str) -> tuple[str, str]:
        """Acceleration of the carrier's point plus the Coriolis term of a relative velocity (vx, vy)."""
        if guide.carrier.w is None:
            return under.ax, under.ay
        kx, ky = self.program.fresh_pair(f"coriolis({guide.carrier.w}, {vx}, {vy})")
        return self.program.fresh_pair(f"{under.ax} + {kx}, {under.ay} + {ky}")

    def _slider(self, link: str, origin: Moving, guide: GuideLine) -> Slide:
        self.links[link] = Turning(origin, guide.c, guide.s, guide.carrier.w, guide.carrier.e)
        self.slides[link] = Slide(f"{link}_d", f"{link}_dv", f"{link}_da")
        return self.slides[link]

    def _rrp(self, name: str) -> None:
        g, p = self.scene.groups[name], self.program
        a, guide, b = self.points[g.first.joint], self.guides[g.second.guide], own(g.inner)
        rod, slide = self._new_link(g.first.link, a), self._slider(g.second.link, b, guide)
        r = p.number(f"groups.{name}.first.length")
        sine = self.sines[name] = f"{name}_sine"
        p.about(f"group {name} (RRP)", "position")
        p.let(
            f"{b.x}, {b.y}, {rod.c}, {rod.s}, {slide.d}, {sine}",
            f"rrp_position({a.x}, {a.y}, {guide.x}, {guide.y}, {guide.c}, {guide.s}, {r}, "
            f"{p.number(f'groups.{name}.second.offset')}, {p.number(f'groups.{name}.mode')})",
        )
        px, py = p.fresh_pair(f"{r} * {rod.c}, {r} * {rod.s}")
        solve = f"{r}, {rod.c}, {rod.s}, {guide.c}, {guide.s}, {sine}"
        p.about(f"group {name} (RRP)", "velocity")
        under = self._under_slider(guide, b.x, b.y)
        gx, gy = p.fresh_pair(f"{under.vx} - {a.vx}, {under.vy} - {a.vy}")
        p.let(f"{rod.w}, {slide.dv}", f"rrp_rates({gx}, {gy}, {solve})")
        sx, sy = p.fresh_pair(f"{slide.dv} * {guide.c}, {slide.dv} * {guide.s}")
        p.let(f"{b.vx}, {b.vy}", f"{under.vx} + {sx}, {under.vy} + {sy}")
        p.about(f"group {name} (RRP)", "acceleration")
        cx, cy = self._with_coriolis(guide, under, sx, sy)
        gx, gy = p.fresh_pair(f"{cx} - {a.ax} + {rod.w} * {rod.w} * {px}, {cy} - {a.ay} + {rod.w} * {rod.w} * {py}")
        p.let(f"{rod.e}, {slide.da}", f"rrp_rates({gx}, {gy}, {solve})")
        p.let(f"{b.ax}, {b.ay}", f"{cx} + {slide.da} * {guide.c}, {cy} + {slide.da} * {guide.s}")
        self.points[g.inner] = b

    def _rpr(self, name: str) -> None:
        g, p = self.scene.groups[name], self.program
        a, d = self.points[g.first.joint], self.points[g.second.joint]
        rocker = self._new_link(g.second.link, d)
        self.links[g.first.link] = rocker._replace(origin=a)
        slide = self.slides[g.first.link] = Slide(*(f"{g.first.link}_{k}" for k in ("d", "dv", "da")))
        offset = p.number(f"groups.{name}.second.offset")
        sine = self.sines[name] = f"{name}_sine"
        p.about(f"group {name} (RPR)", "position")
        p.let(
            f"{rocker.c}, {rocker.s}, {slide.d}, {sine}",
            f"rpr_position({a.x}, {a.y}, {d.x}, {d.y}, {offset}, {p.number(f'groups.{name}.mode')})",
        )
        solve = f"{rocker.c}, {rocker.s}, {offset}, {slide.d}"
        p.about(f"group {name} (RPR)", "velocity")
        gx, gy = p.fresh_pair(f"{a.vx} - {d.vx}, {a.vy} - {d.vy}")
        p.let(f"{rocker.w}, {slide.dv}", f"rpr_rates({gx}, {gy}, {solve})")
        p.about(f"group {name} (RPR)", "acceleration")
        kx, ky = p.fresh_pair(f"coriolis({rocker.w}, {slide.dv} * {rocker.c}, {slide.dv} * {rocker.s})")
        gx, gy = p.fresh_pair(
            f"{a.ax} - {d.ax} + {rocker.w} * {rocker.w} * ({a.x} - {d.x}) - {kx}, "
            f"{a.ay} - {d.ay} + {rocker.w} * {rocker.w} * ({a.y} - {d.y}) - {ky}"
        )
        p.let(f"{rocker.e}, {slide.da}", f"rpr_rates({gx}, {gy}, {solve})")

    def _prp(self, name: str) -> None:
        g, p = self.scene.groups[name], self.program
        one, two, b = self.guides[g.first.guide], self.guides[g.second.guide], own(g.inner)
        s1, s2 = self._slider(g.first.link, b, one), self._slider(g.second.link, b, two)
        e1, e2 = p.number(f"groups.{name}.first.offset"), p.number(f"groups.{name}.second.offset")
        solve = f"{one.c}, {one.s}, {two.c}, {two.s}"
        sine = self.sines[name] = f"{name}_sine"
        p.about(f"group {name} (PRP)", "position")
        p.let(sine, f"{one.c} * {two.s} - {one.s} * {two.c}")
        q1x, q1y = p.fresh_pair(f"{one.x} - {e1} * {one.s}, {one.y} + {e1} * {one.c}")
        q2x, q2y = p.fresh_pair(f"{two.x} - {e2} * {two.s}, {two.y} + {e2} * {two.c}")
        m1, m2 = p.fresh_pair(f"oblique_components({q2x} - {q1x}, {q2y} - {q1y}, {solve})")
        p.let(f"{s1.d}, {s2.d}", f"{m1}, -{m2}")
        p.let(f"{b.x}, {b.y}", f"{q1x} + {m1} * {one.c}, {q1y} + {m1} * {one.s}")
        p.about(f"group {name} (PRP)", "velocity")
        under1, under2 = self._under_slider(one, b.x, b.y), self._under_slider(two, b.x, b.y)
        gap = f"{under2.vx} - {under1.vx}, {under2.vy} - {under1.vy}"
        m1, m2 = p.fresh_pair(f"oblique_components({gap}, {solve})")
        p.let(f"{s1.dv}, {s2.dv}", f"{m1}, -{m2}")
        v1x, v1y = p.fresh_pair(f"{s1.dv} * {one.c}, {s1.dv} * {one.s}")
        v2x, v2y = p.fresh_pair(f"{s2.dv} * {two.c}, {s2.dv} * {two.s}")
        p.let(f"{b.vx}, {b.vy}", f"{under1.vx} + {v1x}, {under1.vy} + {v1y}")
        p.about(f"group {name} (PRP)", "acceleration")
        c1x, c1y = self._with_coriolis(one, under1, v1x, v1y)
        c2x, c2y = self._with_coriolis(two, under2, v2x, v2y)
        m1, m2 = p.fresh_pair(f"oblique_components({c2x} - {c1x}, {c2y} - {c1y}, {solve})")
        p.let(f"{s1.da}, {s2.da}", f"{m1}, -{m2}")
        p.let(f"{b.ax}, {b.ay}", f"{c1x} + {s1.da} * {one.c}, {c1y} + {s1.da} * {one.s}")
        self.points[g.inner] = b

    def _rpp(self, name: str) -> None:
        g, p = self.scene.groups[name], self.program
        a, guide = self.points[g.first.joint], self.guides[g.second.guide]
        cross = own(f"_{g.second.link}")
        yoke = self._slider(g.second.link, cross, guide)
        beta = f"groups.{name}.second.slot_angle"
        cb = p.derived(f"{beta}.cos", lambda n: np.cos(n[beta]))
        sb = p.derived(f"{beta}.sin", lambda n: np.sin(n[beta]))
        # The slot's angle to the guide never changes: neither does the quality of transmission.
        sine = self.sines[name] = f"{name}_sine"
        p.about(f"group {name} (RPP)", "position")
        p.let(sine, f"{sb} * one")
        slot = p.fresh_pair(f"arm({cb}, {sb}, {guide.c}, {guide.s})")
        carrier = guide.carrier
        self.links[g.first.link] = Turning(a, *slot, carrier.w, carrier.e)
        block = self.slides[g.first.link] = Slide(*(f"{g.first.link}_{k}" for k in ("d", "dv", "da")))
        solve = f"{guide.c}, {guide.s}, {slot[0]}, {slot[1]}"
        p.let(f"{yoke.d}, {block.d}", f"oblique_components({a.x} - {guide.x}, {a.y} - {guide.y}, {solve})")
        p.let(f"{cross.x}, {cross.y}", f"{guide.x} + {yoke.d} * {guide.c}, {guide.y} + {yoke.d} * {guide.s}")
        p.about(f"group {name} (RPP)", "velocity")
        under_pin = self._under_slider(guide, a.x, a.y)
        under_cross = self._under_slider(guide, cross.x, cross.y)
        vx, vy = p.fresh_pair(f"{a.vx} - {under_pin.vx}, {a.vy} - {under_pin.vy}")
        p.let(f"{yoke.dv}, {block.dv}", f"oblique_components({vx}, {vy}, {solve})")
        sx, sy = p.fresh_pair(f"{yoke.dv} * {guide.c}, {yoke.dv} * {guide.s}")
        p.let(f"{cross.vx}, {cross.vy}", f"{under_cross.vx} + {sx}, {under_cross.vy} + {sy}")
        p.about(f"group {name} (RPP)", "acceleration")
        cx, cy = self._with_coriolis(guide, under_pin, vx, vy)
        p.let(f"{yoke.da}, {block.da}", f"oblique_components({a.ax} - {cx}, {a.ay} - {cy}, {solve})")
        kx, ky = self._with_coriolis(guide, under_cross, sx, sy)
        p.let(f"{cross.ax}, {cross.ay}", f"{kx} + {yoke.da} * {guide.c}, {ky} + {yoke.da} * {guide.s}")
