"""The model of a scene: its program, and every row that may be asked of it, as sums of terms or plain variables."""

from typing import NamedTuple

import numpy as np

from engine.equal_positions.text.program import Program
from engine.machine.input_motion import InputMotion
from engine.machine.mechanism import Mechanism
from engine.machine.moments import Moments, Term
from engine.machine.quantities.inertia import inertia_fields, write_inertia_forces
from engine.machine.quantities.loops import write_closures
from engine.machine.quantities.quantities import dynamic_fields, kinematic_fields, rates_in_time
from engine.machine.quantities.reactions import acting_fields, reaction_fields
from engine.machine.quantities.shaking import shaking_fields, shaking_terms
from engine.machine.reactions import Reactions
from engine.scene.parts import FRAME, CrankInput
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.scene.structure import Structure, order


class LinearRow(NamedTuple):
    """A row that is a constant plus a sum of coefficient × basis: linear in the loads."""

    constant: str | None
    terms: tuple[tuple[str, str], ...]


class Model:
    """Everything that can be computed of a scene, not yet what is asked.

    Parameters
    ----------
    scene : Scene
    varied : frozenset of str
        Paths of numbers that will vary; what is zero and doesn't vary is left out of the model.
    motion : InputMotion, optional
        Of the input, for the reactions in the pairs; uniform at `input.speed` unless given.

    Attributes
    ----------
    program : Program
    structure : Structure
    linear : dict of str to LinearRow
        Rows linear in the loads, by field name.
    variables : dict of str to str
        Fields that are a variable of the program.
    angles : dict of str to (str, str)
        Fields that are an angle of a direction (cosine, sine).
    closures : dict of str to str
        What the loop of each group misses of being closed.
    reactions : Reactions
    fields : dict of str to Quantity
        Every field one may ask.
    """

    def __init__(self, scene: Scene, varied: frozenset[str] = frozenset(), motion: InputMotion | None = None) -> None:
        self.scene, self.varied = scene, varied
        self.structure: Structure = order(scene)
        self.program = Program()
        self.mechanism = Mechanism(scene, self.structure, self.program, varied)
        self.closures = write_closures(scene, self.mechanism, self.program)
        self.linear: dict[str, LinearRow] = {}
        self._reduce_inertia()
        self.moments = Moments(scene, self.mechanism, self.program, varied)
        self._sum_moments()
        self.variables, self.angles = self._kinematic_rows()
        self._rates_in_time()
        inertia_forces = write_inertia_forces(scene, self.mechanism, self.program)
        self.linear |= {name: LinearRow(None, (term,)) for name, term in inertia_forces.sums.items()}
        self.variables |= inertia_forces.variables
        shaking = shaking_terms(scene, self.mechanism, self.program)
        self.linear |= {name: LinearRow(None, terms) for name, terms in shaking.items()}
        if motion is None:
            motion = InputMotion(self.program.derived("input.square", lambda n: n["input.speed"] ** 2, "load"))
        self.reactions = Reactions(scene, self.structure, self.mechanism, self.moments, self.program, motion)
        self.variables |= self.reactions.variables
        for pair, _ in self.reactions.in_axes:
            self.angles[f"{pair}.reaction_direction"] = tuple(self.variables[f"{pair}.reaction_{i}"] for i in "xy")
        fields = (
            *kinematic_fields(scene, self.structure),
            *dynamic_fields(scene, self.actions),
            *inertia_fields(scene),
            *shaking_fields(scene),
            *reaction_fields(scene),
            *acting_fields(scene),
        )
        self.fields = {q.name: q for q in fields}

    @property
    def actions(self) -> tuple[str, ...]:
        """Names of the actions with a reduced moment row, gravity among them."""
        return tuple(dict.fromkeys(term.action for term in self.moments.terms))

    # Reduced inertia

    def _first_kind(self, numbers: Numbers) -> float | np.ndarray:
        """Inertia that reduces to a constant: bodies on the input, shafts geared to it and bodies on those."""
        scene, total = self.scene, 0.0
        turning = {scene.input.link: 1.0} if isinstance(scene.input, CrankInput) else {}
        for name, shaft in scene.shafts.items():
            if shaft.geared_to == scene.input.link:
                turning[name] = numbers[f"shafts.{name}.ratio"]
                total = total + numbers[f"shafts.{name}.inertia"] * turning[name] ** 2
        for part in self.mechanism.masses.values():
            mass = part.mass(numbers)
            if part.link in turning:
                radius2 = part.along(numbers) ** 2 + part.across(numbers) ** 2
                inertia = 0.0 if part.inertia is None else part.inertia(numbers)
                total = total + (mass * radius2 + inertia) * turning[part.link] ** 2
            elif part.link == scene.input.link:
                total = total + mass
        return total

    def _reduce_inertia(self) -> None:
        scene, p, m = self.scene, self.program, self.mechanism
        inertia: list[tuple[str, str]] = []
        slope: list[tuple[str, str]] = []
        constant = {scene.input.link} | {n for n, s in scene.shafts.items() if s.geared_to == scene.input.link}
        for name, part in m.masses.items():
            centre, link = m.centre(name), m.links[part.link]
            if part.link in constant:
                continue
            mass = p.derived(f"bodies.{name}.mass_of", part.mass, "load")
            p.about(f"inertia of {name}", "velocity")
            inertia.append((mass, p.fresh(f"translation_inertia({centre.vx}, {centre.vy})")))
            p.about(f"inertia of {name}", "acceleration")
            rate = p.fresh(f"translation_inertia_phi({centre.vx}, {centre.vy}, {centre.ax}, {centre.ay})")
            slope.append((mass, rate))
            if part.inertia is not None and link.w is not None:
                own = p.derived(f"bodies.{name}.inertia_of", part.inertia, "load")
                self._rotation(own, link, f"inertia of {name}", inertia, slope)
        for name, shaft in scene.shafts.items():
            if shaft.geared_to != scene.input.link:
                own = p.number(f"shafts.{name}.inertia", "load")
                self._rotation(own, m.links[name], f"shaft {name}", inertia, slope)
        first_kind = p.derived("first_kind_inertia", self._first_kind, "load")
        self.linear["reduced_inertia"] = LinearRow(first_kind, tuple(inertia))
        self.linear["reduced_inertia_phi"] = LinearRow(None, tuple(slope))

    def _rotation(self, own: str, link: object, subject: str, inertia: list, slope: list) -> None:
        p = self.program
        p.about(subject, "velocity")
        inertia.append((own, p.fresh(f"rotation_inertia({link.w})")))
        if link.e is not None:
            p.about(subject, "acceleration")
            slope.append((own, p.fresh(f"rotation_inertia_phi({link.w}, {link.e})")))

    # Reduced moments

    def _sum_moments(self) -> None:
        def row(terms: list[Term]) -> LinearRow:
            return LinearRow(None, tuple((t.coefficient, t.basis) for t in terms))

        for action in self.actions:
            self.linear[f"{action}.moment"] = row([t for t in self.moments.terms if t.action == action])
        # At its speed a machine runs with its brakes released; regimes apply them.
        terms = [t for t in self.moments.terms if t.role != "braking"]
        self.linear["reduced_moment"] = row(terms)
        self.linear["useful_moment"] = row([t for t in terms if t.role == "useful"])
        self.linear["driving_moment"] = row([t for t in terms if t.role == "driving"])
        # What is left beside moments whose work is known exactly.
        for name in ("reduced_moment", "useful_moment"):
            left = [t for t in self.linear[name].terms if t[1] not in self.moments.works]
            self.linear[f"other_{name}"] = LinearRow(None, tuple(left))
        # At uniform speed the input moment carries the change of kinetic energy: M_in = ½ω² dI/dφ − M.
        half_square = self.program.derived("input.half_square", lambda n: 0.5 * n["input.speed"] ** 2, "load")
        minus = [(f"-{t.coefficient}", t.basis) for t in terms]
        rates = [(f"{half_square} * {c}", b) for c, b in self.linear["reduced_inertia_phi"].terms]
        self.linear["input_moment"] = LinearRow(None, (*rates, *minus))

    # Kinematic fields

    def _kinematic_rows(self) -> tuple[dict[str, str], dict[str, tuple[str, str]]]:
        m = self.mechanism
        variables: dict[str, str] = {}
        angles: dict[str, tuple[str, str]] = {}
        on_frame = {n for n, p in self.scene.points.items() if p.link == FRAME}
        for name, point in m.points.items():
            if name not in on_frame and not name.startswith("_"):
                for axis in ("x", "y"):
                    variables[f"{name}.{axis}"] = getattr(point, axis)
                    variables[f"{name}.{axis}_phi"] = getattr(point, f"v{axis}")
                    variables[f"{name}.{axis}_phiphi"] = getattr(point, f"a{axis}")
        for name in self.structure.links:
            link = m.links[name]
            angles[f"{name}.angle"] = (link.c, link.s)
            variables[f"{name}.angle_phi"] = link.w or "zero"
            variables[f"{name}.angle_phiphi"] = link.e or "zero"
        for name, slide in m.slides.items():
            variables[f"{name}.slide"] = slide.d
            variables[f"{name}.slide_phi"] = slide.dv
            variables[f"{name}.slide_phiphi"] = slide.da
        variables.update({f"{name}.transmission": sine for name, sine in m.sines.items()})
        return variables, angles

    def _rates_in_time(self) -> None:
        """Velocities and accelerations at the input's uniform speed: v = ω dr/dφ, a = ω² d²r/dφ²."""
        omega = self.program.number("input.speed", "load")
        square = self.program.derived("input.square", lambda n: n["input.speed"] ** 2, "load")
        for name, (first, second) in rates_in_time(self.variables).items():
            for field, coefficient, source in ((first, omega, f"{name}_phi"), (second, square, f"{name}_phiphi")):
                self.linear[field] = LinearRow(None, ((coefficient, self.variables[source]),))

    def numbers(self, varied: dict[str, np.ndarray]) -> Numbers:
        """The scene's numbers with those of a set of variants in their place."""
        return Numbers(scene_numbers(self.scene), varied)

    def parameters(self, slots: list[str], numbers: Numbers, variants: int, dtype: np.dtype) -> np.ndarray:
        """Values of slots for every variant, (slots, variants)."""
        values = np.empty((len(slots), variants), dtype)
        for row, slot in enumerate(slots):
            values[row] = self.program.slots[slot].compute(numbers)
        return values
