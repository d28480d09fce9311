"""Verdicts on a variant: each with its code, a short label for legends, and a sentence with fault and remedy."""

from enum import IntEnum


class Verdict(IntEnum):
    """Status of a variant.

    Attributes
    ----------
    short : str
        In a few words, for lists and legends.
    sentence : str
        What is wrong and what to do.
    """

    short: str
    sentence: str

    def __new__(cls, code: int, short: str, sentence: str = "") -> "Verdict":  # noqa: D102
        verdict = int.__new__(cls, code)
        verdict._value_ = code
        verdict.short, verdict.sentence = short, sentence or short
        return verdict

    OK = 0, "ok"
    CANNOT_ASSEMBLE = (
        *(1, "can't be assembled"),
        "a group can't be assembled at some position: its links don't reach; lengthen them or move their joints",
    )
    SINGULAR = (
        *(2, "singular position"),
        "a group passes through a singular position (dead centre of the driven side, change point): velocities are "
        "infinite or undefined there; change a length, or limit the input's range by input.start and input.stop",
    )
    OUTSIDE_LIMITS = (
        *(3, "outside limits"),
        "a varied number is outside its limits (a length must be positive, an assembly mode ±1, …)",
    )
    DROPPED = 4, "dropped", "dropped by a constraint of the study"
    NOT_FINITE = (
        *(5, "infinite or undefined"),
        "a result is infinite or undefined: an overflow, or a characteristic without a value there; check "
        "this variant's numbers and formulas",
    )
    STALLS = (
        *(6, "stalls"),
        "the machine stalls: its motors can't carry the loads through the cycle, or can't start them; fit a "
        "stronger motor or a heavier flywheel, or lower the load",
    )
    RUNS_AWAY = (
        *(7, "runs away"),
        "the machine runs away: the loads balance the drive at no speed; check the signs, or add a load",
    )
    NO_END = (
        *(8, "doesn't reach its end"),
        "a regime, or a governor's response, never reaches its end; change the end, the drive or the damping, raise "
        "at_most, or shorten the response",
    )
    JAMS = (
        *(9, "friction jams"),
        "friction jams: no force or torque, however large, moves an element; reduce the friction or the angle, or "
        "lengthen the guide",
    )
    ANY_SPEED = (
        *(10, "any speed is an equilibrium"),
        "any speed is an equilibrium: drive and loads do no net work over a cycle; add a motor and a load",
    )
    LOCKS = (
        *(11, "brake locks by itself"),
        "a band brake locks by itself: friction alone tightens it, and its torque has no bound; change the arms of its "
        "lever, or reduce friction or wrap",
    )
    NO_INERTIA = (
        *(12, "no inertia at a dead centre"),
        "the reduced inertia is zero at a dead centre, so no torque determines the speed there; give the crank, a "
        "shaft or a flywheel its inertia",
    )
    UNSTABLE = (
        *(13, "governor nowhere stable"),
        "a governor is stable nowhere between its stops: its controlling force rises less than in proportion to the "
        "radius; fit a stiffer spring with less preload, other stops or other arms",
    )
    RESONANCE = (
        *(14, "undamped resonance"),
        "undamped resonance: an elastic element is excited at its natural frequency, and the amplitude has no bound; "
        "change the speed, a stiffness or a mass, or add damping",
    )
    DOES_NOT_FIT = (
        *(15, "wheels don't fit"),
        "wheels don't fit: they overlap, or a wheel is as large as the ring it runs in; change numbers of teeth, "
        "profile shifts, diameters or the centre distance",
    )
    SELF_LOCKS = (
        *(16, "gears lock by themselves"),
        "a gear train is self-locking: the load can't drive it, as its meshes lose all power; choose another basic "
        "ratio, less tooth friction, or a load that resists",
    )
    STANDS = (
        *(17, "losses stop the gears"),
        "a gear train can't move: its meshes lose all power that the given torques put in; choose another basic "
        "ratio or less tooth friction",
    )
    SLIDES = (
        *(18, "friction wheels slide"),
        "friction wheels slide on each other: the contact force is too small for the torque; press harder, or choose "
        "larger wheels, more friction or grooves",
    )
    UNDERCUT = (
        *(19, "cam undercut"),
        "a cam is undercut: its profile can't move the follower by the law; choose a larger base circle, a longer "
        "section, another law, or a smaller roller if it has one",
    )
    LIFTS_OFF = (
        *(20, "follower lifts off"),
        "a follower lifts off its cam: the spring can't keep contact; increase preload or stiffness, or reduce mass or "
        "speed",
    )
    SLIPS = (
        *(21, "clutch never locks"),
        "a clutch never locks: its torque capacity is below the load, or its motor can't bring both sides to one "
        "speed; increase the capacity, fit a stronger motor or lower the load",
    )
    MODE_NOT_REACHED = (
        *(22, "mode not reached"),
        "a group can't be followed in the scene's assembly mode: between the scene's numbers and this variant's the "
        "mode merges with another one and ends, or the cycle passes too close to dead centres; vary less, sweep from a "
        "scene closer to this variant, or change a length",
    )
    OTHER_MODE = (
        *(23, "returns in another mode"),
        "a group returns from a turn of the input in another assembly mode, without any singular position: its motion "
        "isn't periodic; change a length, or limit the input's range",
    )
    GROWS = (
        *(24, "vibration grows"),
        "steady running on an elastic shaft is unstable: disturbances grow from cycle to cycle, as the changing "
        "inertia feeds the shaft's vibration (parametric resonance) or a motor's torque rises with its speed; choose "
        "another speed or stiffness, more damping or a flywheel at the machine",
    )
    TURNS_BACK = (
        *(25, "turns back on its shaft"),
        "on its elastic shaft the machine stops or turns back within a cycle; fit a flywheel at the machine, a stiffer "
        "shaft or more damping, or raise the speed",
    )
    TOO_COARSE = (
        *(26, "steps too long"),
        "the steps of a run's method are too long: with steps twice as long the motion differs, as with a steep "
        "motor characteristic; raise steps_per_turn, or omit method and steps_per_turn",
    )
    DOES_NOT_CLOSE = (
        *(27, "cycle doesn't close"),
        "a cycle doesn't close: after input.revolutions turns of the crank a part isn't back in position, a load over "
        "time hasn't returned to its value, or a torsion spring is wound up; choose ratios and periods that fit "
        "a whole number of times into the cycle",
    )
    INTERFERES = (
        *(28, "teeth interfere"),
        "teeth interfere: the tips of a wheel reach below the involute of the other; choose more teeth on the smaller "
        "wheel (minimum_teeth), a positive profile_shift there or a larger pressure_angle",
    )
    CONTACT_BREAKS = (
        *(29, "contact ratio below 1"),
        "teeth lose contact: the contact ratio is below 1, so a pair parts before the next one meets; choose more "
        "teeth, or less profile_shift in total",
    )
    SHAFT_RIGID = (
        *(30, "shaft rigid at this scale"),
        "an elastic shaft is rigid at this scale: it vibrates too many times within the requested time "
        "(natural_frequency is still computed); shorten the time, use a softer shaft, or omit the shaft and treat both "
        "sides as one inertia",
    )
    FRACTION_OF_A_TOOTH = (
        *(31, "teeth not whole"),
        "a number of teeth or of planets isn't whole; vary it in steps of 1",
    )
    MODULES_DIFFER = (
        *(32, "modules differ"),
        "the meshes of a wheel have different modules or helix angles; make them equal, or put two wheels on one shaft",
    )
    AXES_APART = (
        *(33, "axes apart"),
        "meshes between the same axes have different centre distances (distance_error); change numbers of teeth, "
        "modules or profile shifts",
    )
    UNEVEN_PLANETS = (
        *(34, "planets can't be spaced"),
        "planets can't be spaced equally (spacing_remainder): some would stand between teeth; change numbers of teeth "
        "or of planets",
    )
    PLANETS_TOUCH = (
        *(35, "planets touch"),
        "neighbouring planets touch (neighbour_clearance); choose fewer planets, or a sun with more teeth",
    )
    BORE_TOO_LARGE = (
        *(36, "bore cuts the teeth"),
        "a bore reaches the root circle of its wheel's teeth; choose a smaller bore or more teeth",
    )
    NOT_COMPUTED = 255, "not computed yet"
