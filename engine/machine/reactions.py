"""Kinetostatics of an ordered mechanism as steps of a program: the reactions in all pairs, last group first.

By d'Alembert inertia forces join the forces that act on a link; each group is then in equilibrium under its own
loads and what later groups leave on it. The last step is the input link: the reaction of its pivot or guide, and the
moment or force that drives it. Gears carry moments alone: forces between teeth depend on how they are cut.

Friction in pairs acts back within its own group, and on what comes after it in this order; see
`engine.equal_positions.text.settling`.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on kinetostatics; N. E. Zhukovsky's lever for
the input moment by virtual power.
"""

from collections.abc import Iterable

import numpy as np

from engine.equal_positions.text.program import Program
from engine.equal_positions.text.settling import Settling
from engine.machine.friction_in_pairs import Rubbing
from engine.machine.input_motion import InputMotion
from engine.machine.link_loads import Force, Load
from engine.machine.mechanism import Mechanism, Moving, Turning
from engine.machine.moments import Moments
from engine.scene import actions
from engine.scene.pairs import Pair, pairs, pairs_of_group
from engine.scene.parts import FRAME, CrankInput
from engine.scene.scene import Scene
from engine.scene.structure import Structure


class Reactions:
    """Writes the reactions of a scene into a program.

    Parameters
    ----------
    scene, structure, mechanism, moments, program
    motion : InputMotion

    Attributes
    ----------
    variables : dict of str to str
        Fields that are a variable of the program.
    checks : dict of str to str
        Variables of the equilibrium of the whole: "force" and "moment" left, sums of the magnitudes of all
        "forces" in pairs and of all "moments" on the frame.
    settlings : dict of str to Settling
        Of each group with friction.
    lost : dict of str to str
        Work lost in each pair with friction, for each unit of the input's motion.
    in_axes : dict of (str, str) to (str, str)
        Of each revolute pair and either of its links, the force on that link in its own axes.
    """

    def __init__(
        self,
        scene: Scene,
        structure: Structure,
        mechanism: Mechanism,
        moments: Moments,
        program: Program,
        motion: InputMotion,
    ) -> None:
        self.scene, self.mechanism, self.moments, self.program = scene, mechanism, moments, program
        self.motion = motion
        self.variables: dict[str, str] = {}
        self._pairs = {pair.name: pair for pair in pairs(scene)}
        self.in_axes: dict[tuple[str, str], tuple[str, str]] = {}
        self._rubs = Rubbing(scene, mechanism, program).rubs
        self.settlings: dict[str, Settling] = {}
        self.lost = {friction.pair: "zero" for friction in scene.friction.values()}
        self._moving = [name for name in mechanism.links if name != FRAME]
        self._loads = {name: Load() for name in mechanism.links}
        for name in mechanism.masses:
            self._inertia(name)
        for name in scene.shafts:
            self._shaft_inertia(name)
        for applied in moments.applied:
            self._apply(applied)
        own = {name: self._total(name, f"loads on {name}") for name in mechanism.links}
        self._loads = {name: Load(total) for name, total in own.items()}
        self._loads[FRAME] = Load()
        for element in reversed(structure.elements):
            if element.kind == "group":
                self._group(element.name)
            elif element.kind == "shaft":
                self._shaft(element.name)
        self._input()
        self._losses()
        self._power(own)
        self._frame(own)

    # Loads

    def _push(self, link: str, at: Moving, fx: str, fy: str) -> None:
        self._loads[link].push(self.mechanism.links[link].origin, at, fx, fy)

    def _twist(self, link: str, moment: str) -> None:
        self._loads[link].m.append(moment)

    def _inertia(self, name: str) -> None:
        """Inertia force and moment, and weight, of one of the mechanism's masses."""
        p, part, centre = self.program, self.mechanism.masses[name], self.mechanism.centre(name)
        link = self.mechanism.links[part.link]
        p.about(f"loads on {part.link}", "force")
        mass = p.derived(f"bodies.{name}.mass_of", part.mass, "load")
        ax = self.motion.acceleration(centre.ax, centre.vx)
        ay = self.motion.acceleration(centre.ay, centre.vy)
        fx, fy = p.fresh_pair(f"inertia_force({mass}, {ax}, {ay})")
        weight = self.moments.weight(name)
        if weight is not None:
            fy = p.fresh(f"{fy} - {weight}")
        self._push(part.link, centre, fx, fy)
        if part.inertia is not None:
            own = p.derived(f"bodies.{name}.inertia_of", part.inertia, "load")
            self._rotary_inertia(part.link, link, own)

    def _shaft_inertia(self, name: str) -> None:
        self.program.about(f"loads on {name}", "force")
        own = self.program.number(f"shafts.{name}.inertia", "load")
        self._rotary_inertia(name, self.mechanism.links[name], own)

    def _rotary_inertia(self, name: str, link: Turning, inertia: str) -> None:
        epsilon = self.motion.acceleration(link.e or "zero", link.w or "zero")
        if epsilon != "zero":
            self._twist(name, self.program.fresh(f"inertia_moment({inertia}, {epsilon})"))

    def _apply(self, applied: object) -> None:
        """A force or moment of the scene, and its counterpart where something in the machine bears it."""
        p, grip = self.program, applied.grip
        # At its speed a machine runs with its brakes released; regimes apply them.
        if isinstance(self.scene.moments.get(applied.action), actions.Brake) and not self.motion.speed:
            return
        p.about(f"loads on {grip.link}", "force")
        order = p.number(applied.order) if isinstance(applied.order, str) else str(applied.order)
        power = self.motion.power(order)
        value = p.fresh(f"{applied.coefficient} * {'' if power == 'one' else f'{power} * '}({applied.characteristic})")
        if grip.at is None:
            self._register(applied.action, acting_moment=value)
            self._twist(grip.link, value)
            if grip.bearer is not None:
                self._twist(grip.bearer[0], f"-{value}")
            return
        fx, fy = p.fresh_pair(f"{value} * {grip.direction[0]}, {value} * {grip.direction[1]}")
        self._register(applied.action, force_x=fx, force_y=fy)
        self._push(grip.link, grip.at, fx, fy)
        if grip.bearer is not None:
            link, at = grip.bearer
            self._push(link, at, f"-{fx}", f"-{fy}")

    def _register(self, action: str, **parts: str) -> None:
        """Fields of a force or moment of the scene; the damping of a spring adds to its pull."""
        for key, variable in parts.items():
            known = self.variables.get(f"{action}.{key}")
            self.variables[f"{action}.{key}"] = self.program.fresh(f"{known} + {variable}") if known else variable

    def _total(self, link: str, subject: str) -> Force:
        """Sum of the loads on a link, written into the program."""
        self.program.about(subject, "force")
        load = self._loads[link]
        return Force(*(self._sum(terms) for terms in (load.x, load.y, load.m)))

    def _sum(self, terms: Iterable[str]) -> str:
        terms = [term for term in terms if term != "zero"]
        if len(terms) == 1 and terms[0].isidentifier():
            return terms[0]
        return self.program.fresh(" + ".join(terms)) if terms else "zero"

    # Pairs

    def _revolute(self, pair: Pair, at: Moving, x: str, y: str) -> None:
        """Register the reaction of a revolute pair; what carries an outer pair bears the opposite."""
        p, link = self.program, self.mechanism.links[pair.link]
        found = {
            "x": x,
            "y": y,
            "along": p.fresh(f"{x} * {link.c} + {y} * {link.s}"),
            "across": p.fresh(f"{y} * {link.c} - {x} * {link.s}"),
        }
        self.variables |= {f"{pair.name}.reaction_{part}": variable for part, variable in found.items()}
        self.variables[f"{pair.name}.reaction"] = p.fresh(f"math.sqrt({x} * {x} + {y} * {y})")
        other = self.mechanism.links[pair.other]
        self.in_axes[pair.name, pair.link] = found["along"], found["across"]
        around = f"-{x} * {other.c} - {y} * {other.s}, {x} * {other.s} - {y} * {other.c}"
        self.in_axes[pair.name, pair.other] = p.fresh_pair(around)
        if not pair.name.endswith(".inner"):
            self._push(pair.other, at, f"-{x}", f"-{y}")

    def _prismatic(self, pair: Pair, normal: str, moment: str) -> None:
        """Register the reaction of a prismatic pair; what carries an outer pair bears the opposite."""
        p, link = self.program, self.mechanism.links[pair.link]
        x, y = p.fresh_pair(f"-{normal} * {link.s}, {normal} * {link.c}")
        found = {"reaction": normal, "reaction_x": x, "reaction_y": y, "reaction_moment": moment}
        self.variables |= {f"{pair.name}.{part}": variable for part, variable in found.items()}
        if not pair.name.endswith(".inner"):
            self._push(pair.other, link.origin, f"-{x}", f"-{y}")
            self._twist(pair.other, f"-{moment}")

    # Groups, last first, then what turns on the frame

    def _group(self, name: str) -> None:
        g, links = self.scene.groups[name], self.mechanism.links
        subject = f"reactions in group {name} ({g.type})"
        loads = [self._total(part.link, subject) for part in (g.first, g.second)]
        geometry = self._geometry(name)
        found = self._solved(name, loads, geometry)
        if any(pair.name in self._rubs for pair in pairs_of_group(self.scene, name)):
            found = self._with_friction(name, found, geometry)
        for i, pair in enumerate(pairs_of_group(self.scene, name)):
            a, b = found[2 * i : 2 * i + 2]
            if pair.kind == "revolute":
                self._revolute(pair, links[pair.link].origin, a, b)
            else:
                self._prismatic(pair, a, b)

    def _solved(self, name: str, loads: list[Force], geometry: list[str], mark: str = "") -> list[str]:
        """Components of the reactions in a group, two of each pair."""
        found = [f"_{name}__{i}{mark}" for i in range(6)]
        arguments = ", ".join((*loads[0], *loads[1], *geometry))
        self.program.let(", ".join(found), f"{self.scene.groups[name].type.lower()}_reactions({arguments})")
        return found

    def _geometry(self, name: str) -> list[str]:
        """Last arguments of the function of a group's reactions."""
        g, m, p = self.scene.groups[name], self.mechanism, self.program
        one, two, sine = m.links[g.first.link], m.links[g.second.link], m.sines[name]
        if g.type == "PRP":
            return [one.c, one.s, two.c, two.s]
        if g.type == "RPP":
            return [two.c, two.s, one.c, one.s, m.slides[g.first.link].d]
        if g.type == "RPR":
            return [two.c, two.s, m.slides[g.first.link].d]
        rod = [p.number(f"groups.{name}.first.length"), one.c, one.s]
        if g.type == "RRP":
            return [*rod, two.c, two.s, sine]
        return [*rod, p.number(f"groups.{name}.second.length"), two.c, two.s, sine]

    def _shaft(self, name: str) -> None:
        """Gears balance the moments on a shaft, load its driver by the ratio, and leave the rest to the frame."""
        p, shaft = self.program, self.scene.shafts[name]
        load = self._total(name, f"reactions of shaft {name}")
        if shaft.pivot is not None:
            load = load._replace(m=self._sum((load.m, self._in_pivot(name, name, load))))
        if load.m != "zero":
            passed = p.fresh(f"{p.number(f'shafts.{name}.ratio')} * {load.m}")
            self._twist(shaft.geared_to, passed)
            self._twist(FRAME, p.fresh(f"{load.m} - {passed}"))

    def _in_pivot(self, pair: str, link: str, load: Force) -> str:
        """Register the reaction of a pivot on the frame; returns the moment of its friction."""
        x, y = self.program.fresh_pair(f"zero - {load.x}, zero - {load.y}")
        self._revolute(self._pairs[pair], self.mechanism.links[link].origin, x, y)
        return self._rubbed(self._pairs[pair], self.variables[f"{pair}.reaction"])

    def _input(self) -> None:
        drive, p = self.scene.input, self.program
        link = self.mechanism.links[drive.link]
        load = self._total(drive.link, f"reactions of input {drive.link}")
        if isinstance(drive, CrankInput):
            total = self._sum((load.m, self._in_pivot("input", drive.link, load)))
            moment = p.fresh(f"zero - {total}")
            self._twist(FRAME, total)
        else:
            normal = p.fresh(f"{load.x} * {link.s} - {load.y} * {link.c}")
            turning = p.fresh(f"zero - {load.m}")
            self._prismatic(self._pairs["input"], normal, turning)
            edge = self._rubs["input"].edge if "input" in self._rubs else "zero"
            friction = self._rubbed(self._pairs["input"], f"guide_pressing({normal}, {turning}, {edge})")
            moment = p.fresh(f"-({load.x} * {link.c} + {load.y} * {link.s} + {friction})")
            self._push(FRAME, link.origin, f"-{moment} * {link.c}", f"-{moment} * {link.s}")
        self.variables["input_moment_by_equilibrium"] = moment

    # Friction

    def _with_friction(self, name: str, free: list[str], geometry: list[str]) -> list[str]:
        """Reactions in a group from those without its friction, and from what each of its rubbing pairs adds."""
        p, around = self.program, pairs_of_group(self.scene, name)
        rubbing = [(i, pair) for i, pair in enumerate(around) if pair.name in self._rubs]
        p.about(f"friction in group {name}", "force")
        backs = [self._solved(name, self._for_a_newton(name, pair), geometry, f"by{i}") for i, pair in rubbing]
        rows = [f"prs__{pair.name.replace('.', '__')}" for _, pair in rubbing]
        self.settlings[name] = Settling(
            name,
            tuple(rows),
            tuple((free[2 * i], free[2 * i + 1]) for i, _ in rubbing),
            tuple(tuple((back[2 * i], back[2 * i + 1]) for back in backs) for i, _ in rubbing),
            tuple(self._rubs[pair.name].edge for _, pair in rubbing),
        )
        found = []
        for i, part in enumerate(free):
            added = [f"{back[i]} * {row}[k]" for back, row in zip(backs, rows, strict=True)]
            found.append(p.fresh(" + ".join((part, *added))))
        for (_, pair), row in zip(rubbing, rows, strict=True):
            self._rubbed(pair, f"{row}[k]")
        return found

    def _for_a_newton(self, name: str, pair: Pair) -> list[Force]:
        """Loads on the links of a group by friction in one of its pairs, for each newton that presses."""
        g, p, link = self.scene.groups[name], self.program, self.mechanism.links[pair.link]
        drag, own, opposite = self._rubs[pair.name].drag, Load(), Load()
        if pair.kind == "revolute":
            own.m.append(drag)
            opposite.m.append(f"-{drag}")
        else:
            fx, fy = p.fresh_pair(f"{drag} * {link.c}, {drag} * {link.s}")
            own.push(link.origin, link.origin, fx, fy)
            opposite.push(self.mechanism.links[g.second.link].origin, link.origin, f"-{fx}", f"-{fy}")
        both = [own, opposite] if pair.name.endswith(".inner") else [own, Load()]
        loads = [Force(*(self._sum(terms) for terms in (load.x, load.y, load.m))) for load in both]
        return loads[::-1] if pair.name.endswith(".second") else loads

    def _rubbed(self, pair: Pair, pressing: str) -> str:
        """Friction on a pair's link by its pressing force; what carries an outer pair bears the opposite."""
        if pair.name not in self._rubs:
            return "zero"
        p, rub, link = self.program, self._rubs[pair.name], self.mechanism.links[pair.link]
        friction = p.fresh(f"{rub.drag} * {pressing}")
        kind = "moment" if pair.kind == "revolute" else "force"
        self.variables[f"{pair.name}.friction_{kind}"] = friction
        self.lost[pair.name] = p.fresh(f"{rub.lost} * {pressing}")
        if not pair.name.endswith(".inner"):
            if pair.kind == "revolute":
                self._twist(pair.other, f"-{friction}")
            else:
                self._push(pair.other, link.origin, f"-{friction} * {link.c}", f"-{friction} * {link.s}")
        return friction

    def _losses(self) -> None:
        """Powers lost to friction, and the moment on the input that stands for them."""
        if not self.scene.friction:
            return
        p = self.program
        p.about("losses by friction", "force")
        speed = p.derived("input.speed_magnitude", lambda n: np.abs(n["input.speed"]), "load")
        for pair, lost in self.lost.items():
            kind = "moment" if self._pairs[pair].kind == "revolute" else "force"
            self.variables.setdefault(f"{pair}.friction_{kind}", "zero")
            self.variables[f"{pair}.friction_power"] = p.fresh(f"{speed} * {lost}")
        forward = p.derived("input.forward", lambda n: np.sign(n["input.speed"]) + 0.0)
        self.variables["friction_moment"] = p.fresh(f"-{forward} * ({' + '.join(self.lost.values())})")
        self.variables["input_moment_with_friction"] = self.variables["input_moment_by_equilibrium"]

    # The whole

    def _power(self, own: dict[str, Force]) -> None:
        """Input moment by virtual power: that of all forces on all links, inertia forces among them, is zero."""
        self.program.about("virtual power of all forces", "force")
        powers = []
        for name in self._moving:
            link, load = self.mechanism.links[name], own[name]
            factors = ((load.x, link.origin.vx), (load.y, link.origin.vy), (load.m, link.w or "zero"))
            powers += [f"{force} * {rate}" for force, rate in factors if "zero" not in (force, rate)]
        powers += [self.variables["friction_moment"]] if self.scene.friction else []
        self.variables["input_moment_by_power"] = self.program.fresh(f"-({' + '.join(powers) or 'zero'})")

    def _frame(self, own: dict[str, Force]) -> None:
        """What the machine does to its frame, and the equilibrium of the machine without it."""
        p, terms = self.program, list(self._loads[FRAME].m)
        left = self._total(FRAME, "reactions on the frame")
        for key, a, b in zip(("x", "y", "moment"), own[FRAME], left, strict=True):
            self.variables[f"frame.reaction_{key}"] = self._sum((a, b))
        total = Load()
        for name in self._moving:
            origin, load = self.mechanism.links[name].origin, own[name]
            total.push(Moving("zero", "zero"), origin, load.x, load.y)
            total.m.append(load.m)
        x, y, m = (self._sum(terms) for terms in (total.x, total.y, total.m))
        p.about("equilibrium of the whole", "force")
        gap_x, gap_y = p.fresh_pair(f"{x} - {left.x}, {y} - {left.y}")
        magnitudes = [f"abs({self.variables[f'{name}.reaction']})" for name in self._pairs]
        self.checks = {
            "force": p.fresh(f"math.sqrt({gap_x} * {gap_x} + {gap_y} * {gap_y})"),
            "forces": p.fresh(" + ".join(magnitudes)),
            "moment": p.fresh(f"{m} - {left.m}"),
            "moments": p.fresh(" + ".join(f"abs({term})" for term in terms) or "zero"),
        }
