"""Makes motion_reference.json: two machines by mpmath's Taylor method at 30 digits. Takes some minutes.

    python tests/oracles/motion/motion_reference.py

The equation of motion is integrated as dω/dφ = (M − ½ω²·dI/dφ)/(I·ω), dt/dφ = 1/ω, with I and dI/dφ of the
slider-crank in closed form: neither the engine's form of the equation nor any of its code.
"""

import json
from pathlib import Path

from motion_scenes import MOMENTS, dc_moment, kloss_moment, reduced
from mpmath import mp

PATH = Path(__file__).with_name("motion_reference.json")
TURNS = 3
# Of each machine: speed at φ = 0, flywheel, and the moments beside gravity.
MACHINES = {
    "dc": (20.0, 0.0, lambda w: dc_moment(w) - mp.mpf(MOMENTS["fan"]["coefficient"]) * w * w),
    "induction": (15.0, 0.5, lambda w: kloss_moment(w) + mp.mpf(MOMENTS["load"]["moment"])),
}


def motion(name: str) -> dict[str, str]:
    """Speed and time after three turns, to 25 digits."""
    begin, flywheel, moment = MACHINES[name]

    def rates(phi: object, state: list) -> list:
        omega = state[0]
        inertia, inertia_phi, _, weight = reduced(phi, flywheel=flywheel)
        return [(moment(omega) + weight - omega * omega * inertia_phi / 2) / (inertia * omega), 1 / omega]

    omega, time = mp.odefun(rates, 0, [mp.mpf(begin), mp.mpf(0)])(2 * TURNS * mp.pi)
    return {"omega": mp.nstr(omega, 25), "time": mp.nstr(time, 25)}


if __name__ == "__main__":
    with mp.workdps(30):
        PATH.write_text(json.dumps({name: motion(name) for name in MACHINES}, indent=2) + "\n")
