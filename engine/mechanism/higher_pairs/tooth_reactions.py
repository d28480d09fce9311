"""Reactions in the higher pairs of wheels and racks: of shafts, non-circular wheels, racks, and pinions on racks.

Without a pressure angle gears transmit pure moments; with one, the force on a tooth acts along the normal to its flank
at the pitch point, from which losses shift it.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on gearing and on the forces in higher pairs.
"""

import numpy as np

from engine import laws, mechanism
from engine.graph.nodes import Node
from engine.laws.senses import sense
from engine.mechanism.actions.paths import input_sense
from engine.mechanism.higher_pairs.mesh import Toothing, mesh_of
from engine.mechanism.link_loads import LinkForce, Wrench
from engine.mechanism.pair_reactions import PairReactions
from engine.mechanism.vectors import Vector
from engine.parts.skeleton import FRAME
from engine.scene.pairs import lossy_meshes, mesh_driver


class ToothReactions:
    """Balances wheels and racks, each by the teeth of its mesh and by its pivot or guide.

    Parameters
    ----------
    of : PairReactions
        Where the reactions are registered.

    Attributes
    ----------
    kinds : dict of str to callable
        Balances an element of the structure, by its kind.
    """

    def __init__(self, of: PairReactions) -> None:
        self._of, self._loads = of, of.loads
        self.kinematics, self.scene, self.graph = of.kinematics, of.scene, of.graph
        tables = ("shafts", "noncircular_wheels", "racks", "pinions")
        self._paths = {name: f"{table}.{name}" for table in tables for name in getattr(self.scene, table)}
        self.kinds = {
            "shaft": self._shaft,
            "noncircular wheel": self._noncircular_wheel,
            "rack": self._rack,
            "pinion": self._pinion,
        }

    def _shaft(self, name: str) -> None:
        """Balance the moments on a shaft by gear moments on its driver (by the ratio) and on their common carrier."""
        shaft, load = self.scene.shafts[name], self._loads.total(name)
        if shaft.pressure_angle is not None:
            self._in_mesh(name, load)
            return
        moment = load.moment
        if shaft.pivot is not None:
            moment = moment + self._of.in_pivot(name, load)
        passed = self.graph.number(f"shafts.{name}.ratio") * moment * self._lost_share(name, -moment)
        self._transmit(name, shaft.geared_to, shaft.carrier or FRAME, moment, passed)

    def _transmit(self, name: str, driver: str, carrier: str, moment: Node, passed: Node) -> None:
        """Balance a wheel by moments on its driver and on their common carrier."""
        on = ((name, driver, -moment), (driver, name, passed), (carrier, name, moment - passed))
        self._of.forces += [LinkForce("gears", name, link, source, moment=twist) for link, source, twist in on]
        for link, _, twist in on[1:]:
            self._loads.twist(link, twist)

    def _apply_tooth_force(self, name: str, driver: str, place: Vector, force: Vector) -> None:
        """Apply the tooth force to a wheel or rack, and its reaction to the driver."""
        found = LinkForce("reaction", f"{name}.teeth", name, driver, place, force)
        self._of.exert(found, self.kinematics.at_rest(place))

    def _in_mesh(self, name: str, load: Wrench) -> None:
        """Balance the moments on a shaft by the tooth force at the pitch point, which also separates the wheels."""
        shaft, found = self.scene.shafts[name], mesh_of(self.kinematics, name)
        arm = found.radius
        if shaft.efficiency is not None:
            ratio, k = self.graph.number(f"shafts.{name}.ratio"), self._lost_share(name, -load.moment)
            arm = self.graph.apply(laws.friction.teeth.shifted_contact, found.radius, ratio, k)
        tangential = load.moment / arm
        apart = self._separating_force(name, tangential)
        force = -(tangential * found.along) + apart * found.away
        self._between_teeth(found, arm, force, name, shaft.geared_to)
        self._of.in_pivot(name, self._loads.total(name))

    def _lost_share(self, name: str, taken: Node) -> Node:
        """Factor by which mesh losses change the load on the driver.

        Parameters
        ----------
        name : str
            Driven wheel or rack.
        taken : Node
            Moment (for a rack, force) exerted by the driver; its sign gives the direction of power flow.
        """
        if name not in lossy_meshes(self.scene):
            return self.graph.one
        rate, slope = mechanism.friction.rolling_rate(self.kinematics, name)
        self.graph.switches(rate, slope)
        sense_of_input = input_sense(self.kinematics)
        direction = self.graph.held(self.graph.apply(sense, rate)) * sense_of_input
        efficiency = self.graph.number(f"{self._paths[name]}.efficiency")
        k = self.graph.apply(laws.friction.teeth.lost_share, direction * taken, efficiency)
        self.graph.bends(k, taken)
        self._of.lost_in_teeth[name] = sense_of_input * ((k - 1.0) * (taken * rate))
        return k

    def _noncircular_wheel(self, name: str) -> None:
        """Balance the moments on a wheel: by a moment on the driver (by the ratio), or by tooth forces."""
        wheel, found = self.scene.noncircular_wheels[name], self.kinematics.noncircular[name]
        load = self._loads.total(name)
        if wheel.pressure_angle is None:
            passed = -(found.rate * load.moment * self._lost_share(name, -load.moment))
            self._transmit(name, wheel.geared_to, FRAME, load.moment, passed)
            self._of.in_pivot(name, load)
            return
        place = found.pitch_point
        if wheel.efficiency is not None:
            k, along = self._lost_share(name, -load.moment), self._line_of_centres(name)
            shifted = self.graph.apply(laws.friction.teeth.shifted_contact, -found.radius, -found.rate, k)
            place = place + (shifted + found.radius) * along
        arm = place - self.kinematics.links[name].origin.r
        slope = self._tooth_slope(name)
        levers = arm.cross(found.tangent), arm.cross(found.away)
        law = laws.kinematics.noncircular_wheels.noncircular_tooth_force
        tangential, apart = self.graph.apply(law, load.moment, *levers, slope)
        self.graph.bends(tangential, load.moment)
        self.graph.bends(apart, load.moment)
        self._in_teeth(name, tangential, apart)
        self._apply_tooth_force(name, wheel.geared_to, place, tangential * found.tangent + apart * found.away)
        self._of.in_pivot(name, self._loads.total(name))

    def _line_of_centres(self, name: str) -> Vector:
        """Unit vector from the axis of a non-circular wheel's driver to the wheel's axis."""
        links, wheel = self.kinematics.links, self.scene.noncircular_wheels[name]
        line = links[name].origin.r - links[wheel.geared_to].origin.r
        return line * (self.graph.one / line.length)

    def _rack(self, name: str) -> None:
        """Balance the force along a rack's guide by tooth forces; the guide takes the rest."""
        load = self._loads.total(name)
        found = mechanism.higher_pairs.rack_motion.toothing(self.kinematics, name)
        tangential = -load.force.dot(found.along)
        apart = self._separating_force(name, tangential)
        force = tangential * found.along - apart * found.away
        arm = found.radius * self._lost_share(name, tangential)
        self._between_teeth(found, arm, force, name, self.scene.racks[name].pinion)
        left = self._loads.total(name)
        normal = -left.force.dot(self.kinematics.links[name].u.normal)
        self._of.react(self._of.pairs[name], (normal, -left.moment), {name})

    def _pinion(self, name: str) -> None:
        """Balance the moments on a pinion by tooth forces on its rack; the pivot takes the rest."""
        load = self._loads.total(name)
        found = mechanism.higher_pairs.rack_motion.toothing(self.kinematics, name)
        arm = found.radius / self._lost_share(name, -load.moment)
        tangential = -load.moment / arm
        force = tangential * found.along + self._separating_force(name, tangential) * found.away
        self._between_teeth(found, arm, force, name, mesh_driver(self.scene, name))
        self._of.in_pivot(name, self._loads.total(name))

    def _tooth_slope(self, name: str) -> Node:
        """Tangent of the pressure angle."""
        angle = f"{self._paths[name]}.pressure_angle"
        return self.graph.derived(f"slope of the teeth of {name}", lambda n: np.tan(n[angle]))

    def _separating_force(self, name: str, tangential: Node) -> Node:
        """Separating force of a mesh; it has a kink where the tangential force changes sign."""
        apart = abs(tangential) * self._tooth_slope(name)
        self.graph.bends(apart, tangential)
        self._in_teeth(name, tangential, apart)
        return apart

    def _in_teeth(self, name: str, tangential: Node, apart: Node) -> None:
        """Register the components of a tooth force, which acts along the normal to the flanks."""
        normal = Vector(tangential, apart).length
        self.graph.bends(normal, tangential)
        parts = {"tangential": tangential, "radial": apart, "normal": normal}
        self._of.variables |= {f"{name}.{part}_force": force for part, force in parts.items()}

    def _between_teeth(self, found: Toothing, arm: Node, force: Vector, on: str, bearer: str) -> None:
        """Apply a tooth force, with the arm about the wheel's axis that losses shift."""
        place = found.pitch_point
        if arm is not found.radius:
            place = place + (found.radius - arm) * found.along.normal
        self._apply_tooth_force(on, bearer, place, force)
