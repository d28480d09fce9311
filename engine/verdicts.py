"""Verdicts on a variant: status codes, each with a sentence that says what is wrong and what to do."""

from enum import IntEnum


class Verdict(IntEnum):
    """Status of a variant."""

    OK = 0
    CANNOT_ASSEMBLE = 1
    SINGULAR = 2
    OUTSIDE_LIMITS = 3
    DROPPED = 4
    NOT_FINITE = 5
    STALLS = 6
    RUNS_AWAY = 7
    NO_END = 8
    JAMS = 9
    ANY_SPEED = 10
    LOCKS = 11
    NO_INERTIA = 12
    UNSTABLE = 13
    RESONANCE = 14
    DOES_NOT_FIT = 15
    SELF_LOCKS = 16
    STANDS = 17
    SLIDES = 18
    UNDERCUT = 19
    LIFTS_OFF = 20
    SLIPS = 21
    MODE_NOT_REACHED = 22
    OTHER_MODE = 23
    GROWS = 24
    TURNS_BACK = 25
    TOO_COARSE = 26
    DOES_NOT_CLOSE = 27
    NOT_COMPUTED = 255


SENTENCES = {
    Verdict.OK: "computed",
    Verdict.CANNOT_ASSEMBLE: (
        "a group can't be assembled at some position: its links don't reach; lengthen them or move their joints"
    ),
    Verdict.SINGULAR: (
        "a group passes through a singular position (dead centre of the driven side, change point): velocities are "
        "infinite or undefined there; change a length, or limit the input's range"
    ),
    Verdict.OUTSIDE_LIMITS: "a varied number is outside its limits (a length must be positive, an assembly mode ±1, …)",
    Verdict.DROPPED: "dropped by a constraint of the study",
    Verdict.NOT_FINITE: "a result is infinite or undefined: an overflow, or a characteristic without a value there",
    Verdict.STALLS: (
        "the machine comes to a stop: its motors can't carry the loads through the cycle, or can't start them; a "
        "stronger motor, a lower load or a heavier flywheel helps"
    ),
    Verdict.RUNS_AWAY: "the machine runs away: at no speed do the loads hold the drive; check signs, or add a load",
    Verdict.NO_END: (
        "a regime doesn't end: the state at which it should end is never reached; change the end or the drive, or "
        "raise at_most. Or a governor is too stiffly damped, or a shaft too stiff for so long a run, to be "
        "followed: damp it less, follow a shorter time"
    ),
    Verdict.JAMS: (
        "friction jams: no force or moment, however great, moves an element; less friction, a smaller angle or a "
        "longer guide helps"
    ),
    Verdict.ANY_SPEED: (
        "nothing decides the speed: whatever it is, the moments do no work over a cycle, and it stays; add what drives "
        "the machine and what resists it"
    ),
    Verdict.LOCKS: (
        "a band brake locks by itself: friction alone presses it on, and its moment has no bound; change the arms of "
        "its lever, or less friction or wrap"
    ),
    Verdict.NO_INERTIA: (
        "at a dead centre nothing moves that has mass: the reduced inertia is zero there, and no moment decides the "
        "speed; give the crank, a shaft or a flywheel its inertia"
    ),
    Verdict.UNSTABLE: (
        "a governor is stable nowhere between its stops: its controlling force rises less than in proportion to the "
        "radius; a stiffer spring with less preload, other stops or other arms help"
    ),
    Verdict.RESONANCE: (
        "resonance without damping: what excites an elastic element has its natural frequency, and the amplitude has "
        "no bound; change the speed, a stiffness or a mass, or give it its damping"
    ),
    Verdict.DOES_NOT_FIT: (
        "wheels don't fit: teeth aren't whole numbers, axes that should be one lie apart, wheels overlap or are larger "
        "than the ring they run in, planets can't be spaced equally or touch each other, or a bore cuts the teeth; "
        "change numbers of teeth or of planets, modules, bores, diameters or the distance of the axes"
    ),
    Verdict.SELF_LOCKS: (
        "a gear train locks by itself: the load can't drive it, as its meshes lose all power; another basic ratio or "
        "less friction of the teeth helps, or a load that resists"
    ),
    Verdict.STANDS: (
        "a gear train stands still: its meshes lose all power that the given moments put in; another basic ratio or "
        "less friction of the teeth helps"
    ),
    Verdict.SLIDES: (
        "friction wheels slide on each other: they are pressed by less than the moment needs; press harder, or give "
        "larger wheels, more friction or grooves"
    ),
    Verdict.UNDERCUT: (
        "a cam is undercut: its profile can't move the follower by the law; a larger base circle, a smaller roller, a "
        "longer section or another law helps"
    ),
    Verdict.LIFTS_OFF: (
        "a follower lifts off its cam: the spring can't keep up with it; a greater preload or stiffness, less mass or "
        "a lower speed helps"
    ),
    Verdict.SLIPS: (
        "a clutch slips on and on: its capacity doesn't suffice for the loads, or its motor can't bring both sides to "
        "one speed; a greater capacity, a stronger motor or a lower load helps"
    ),
    Verdict.MODE_NOT_REACHED: (
        "a group can't be followed in the scene's assembly mode: on the way from the scene's numbers to these that "
        "mode meets another one and ends, or over the cycle it passes too close to dead centres; vary less, sweep from "
        "a scene that is nearer, or change a length"
    ),
    Verdict.OTHER_MODE: (
        "a group comes back from a turn of the input in another assembly mode, without any singular position: its "
        "motion doesn't repeat itself; change a length, or limit the input's range"
    ),
    Verdict.GROWS: (
        "the steady motion on an elastic shaft isn't stable: disturbances grow from cycle to cycle, as the changing "
        "inertia feeds the shaft's vibration (parametric resonance) or a motor drives the more the faster it turns; "
        "another speed or stiffness, more damping or a flywheel at the machine helps"
    ),
    Verdict.TURNS_BACK: (
        "on its elastic shaft the machine doesn't turn through its cycle in one sense: it stops or turns back; a "
        "flywheel at the machine, a stiffer shaft, more damping or a higher speed helps"
    ),
    Verdict.TOO_COARSE: (
        "steps of the method named for a run are too long: with steps of twice the length the motion is another one, "
        "as under a steep motor; raise steps_per_turn, or leave method and steps_per_turn"
    ),
    Verdict.DOES_NOT_CLOSE: (
        "a cycle doesn't close: what hangs on a geared shaft isn't in its place again after input.revolutions turns of "
        "the crank; give ratios whose turns in a cycle are whole"
    ),
    Verdict.NOT_COMPUTED: "not computed yet",
}
