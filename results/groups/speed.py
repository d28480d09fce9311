"""What a triad costs beside a six-bar of dyads: I, dI/dφ and M at every position, and compilation.

    python results/groups/speed.py

Times are of the processor, one thread, so that what else runs on the machine counts little; each the least of five. A
further position is what 3600 positions cost more than 360, over their difference; a variant is what is left of the
360: tables of seeds where geometry varies, and the panels in which verdicts are found.
Compilation is that of a fresh process with an empty cache less that of one with the machine's functions in it.
"""

import os
import subprocess
import sys
import tempfile
import time

import numpy as np

VARIANTS, FEW, MANY = 1024, 360, 3600
FIELDS = ["reduced_inertia", "reduced_inertia_phi", "reduced_moment"]
MACHINES = {
    "six-bar of dyads": ("stephenson_six_bar", "bodies.feeder_body.mass", "groups.output.first.length"),
    "triad": ("triad", "bodies.plate_body.mass", "links.rod.length"),
}


def seconds(template: str, path: str, share: float, positions: int) -> float:
    """Processor time of a sweep of a number of a template, by up to a share of it."""
    from engine import Machine, scene_numbers, set_threads
    from sweeps.text.scene_text import read_scene
    from sweeps.text.templates import bundled_templates

    set_threads(1)
    scene = read_scene(bundled_templates()[template])
    machine = Machine(scene, fields=FIELDS, varied=[path], positions=positions)
    values = scene_numbers(scene)[path].value * np.linspace(1.0, 1.0 + share, VARIANTS)
    machine.evaluate({path: values[:64]})
    found = []
    for i in range(5):
        begin = time.process_time()
        outcome = machine.evaluate({path: values * (1.0 + 1e-6 * i)})
        found.append(time.process_time() - begin)
    assert (outcome.status == 0).all()
    return min(found)


def compile_seconds(template: str, path: str) -> float:
    """Processor time that a fresh process takes for a machine more than one whose functions are kept."""
    text = f"import sys; sys.path.insert(0, {os.path.dirname(os.path.abspath(__file__))!r}); import speed; "
    text += f"speed.once({template!r}, {path!r})"
    with tempfile.TemporaryDirectory() as folder:
        # What all machines share is compiled by another one first.
        env = os.environ | {"XDG_CACHE_HOME": folder}
        other = "import speed; speed.once('slider_crank', 'input.length'); speed.once('watt_six_bar', 'input.length')"
        subprocess.run([sys.executable, "-c", text.split("; speed.once")[0] + "; " + other], env=env, check=True)
        times = []
        for _ in range(2):
            begin = os.times()
            subprocess.run([sys.executable, "-c", text], env=env, check=True)
            end = os.times()
            times.append(end.children_user + end.children_system - begin.children_user - begin.children_system)
    return times[0] - times[1]


def once(template: str, path: str) -> None:
    """Evaluate one variant."""
    from engine import Machine, scene_numbers
    from sweeps.text.scene_text import read_scene
    from sweeps.text.templates import bundled_templates

    scene = read_scene(bundled_templates()[template])
    machine = Machine(scene, fields=FIELDS, varied=[path], positions=FEW)
    machine.evaluate({path: np.array([scene_numbers(scene)[path].value])})


def main() -> None:
    """Print the table."""
    print("| | masses vary: ns a position, µs a variant | geometry varies: ns a position, µs a variant | compiled in |")
    print("|---|---|---|---|")
    for name, (template, mass, length) in MACHINES.items():
        cells = []
        for path, share in ((mass, 1.0), (length, 0.02)):
            few, many = (seconds(template, path, share, positions) for positions in (FEW, MANY))
            per = (many - few) / (VARIANTS * (MANY - FEW))
            cells.append(f"{1e9 * per:.1f}, {1e6 * (few / VARIANTS - FEW * per):.0f}")
        print(f"| {name} | {cells[0]} | {cells[1]} | {compile_seconds(template, length):.1f} s |")


if __name__ == "__main__":
    main()
