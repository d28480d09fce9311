"""Remake one picture of each kind, and the page that shows them: `python results/gallery/gallery.py`."""

import shutil
import tempfile
from contextlib import chdir
from pathlib import Path
from typing import NamedTuple

from PIL import Image

from sweeps.cli import main

HERE = Path(__file__).parent
WIDTH = 1000


class Shown(NamedTuple):
    """An entry: heading, commands, and the pictures chosen from their output."""

    words: str
    commands: tuple[str, ...]
    pictures: tuple[str, ...]


def of_template(words: str, name: str, *pictures: str) -> Shown:
    """Pictures that `sweeps plot` makes of a template."""
    return Shown(words, (f"sweeps new {name}", f"sweeps plot {name}.toml"), pictures)


SHOWN = (
    of_template("A machine and its diagrams", "slider_crank", "slider_crank.png", "slider_crank_diagrams.png"),
    Shown(
        "Centres of mass, forces and links by name",
        ("sweeps new watt_six_bar", "sweeps plot watt_six_bar.toml --with masses,forces,links,scale --out named.png"),
        ("named.png",),
    ),
    of_template("A machine of two groups", "crank_shaper", "crank_shaper.png"),
    of_template("A linkage", "watt_six_bar", "watt_six_bar.png"),
    Shown(
        "Velocities, accelerations and forces at a position",
        ("sweeps new slider_crank", "sweeps plot slider_crank.toml --plans --at 60"),
        ("slider_crank_velocity.png", "slider_crank_acceleration.png", "slider_crank_forces_drive.png"),
    ),
    Shown(
        "Hodograph of the shaking force",
        ("sweeps new four_bar", "sweeps plot four_bar.toml --hodograph"),
        ("four_bar.png", "four_bar_hodograph.png"),
    ),
    Shown("Animation", ("sweeps new whitworth", "sweeps animate whitworth.toml --frames 36"), ("whitworth.gif",)),
    of_template("Motion under the motor", "press_with_motor", "press_with_motor_history.png"),
    Shown(
        "Loads of bearings over the cycle",
        ("sweeps new slider_crank", "sweeps run loads.toml"),
        ("results/loads_reactions.png", "results/loads_bearing_drive_inner.png"),
    ),
    Shown(
        "Sweeps over one, two and many numbers; scatter of two results",
        (
            "sweeps run one_number.toml",
            "sweeps run two_numbers.toml",
            "sweeps run many_numbers.toml",
            "sweeps plot results/many_numbers.h5 -x drive.inner.reaction.max -y wheel_mass --out many_scatter.png",
        ),
        ("results/one_number.png", "results/two_numbers.png", "results/many_numbers.png", "many_scatter.png"),
    ),
    Shown("A Pareto front", ("sweeps optimise front.toml",), ("results/front_optimised.png",)),
    of_template("A rotor", "rotor", "rotor*.png"),
    of_template("An engine's orders", "engine", "engine*.png"),
    of_template("A governor", "governor", "governor*.png"),
    of_template("A torsional train", "torsional_train", "torsional_train*.png"),
    of_template("An oscillator", "oscillator", "oscillator*.png"),
    of_template("A start through backlash", "elastic_drive", "elastic_drive*.png"),
    of_template("A cam", "cam", "cam*.png"),
    of_template("A gear train", "planetary_train", "planetary_train*.png"),
    of_template(
        "A machine behind an elastic shaft", "driven_machine", "driven_machine*cycle.png", "driven_machine*run.png"
    ),
    Shown("Other elements of machines", ("sweeps plot elements.toml",), ("elements_*.png",)),
    Shown("A locomotive's driving axle", ("sweeps plot locomotive",), ("locomotive_*.png",)),
    Shown("Brakes of a car", ("sweeps plot braking_car",), ("braking_car_*.png",)),
)


def make(shown: Shown, folder: Path) -> list[str]:
    """Run the commands of an entry in a folder; keep its pictures small, return their names."""
    with chdir(folder):
        for command in shown.commands:
            if not (command.startswith("sweeps new") and Path(f"{command.split()[-1]}.toml").exists()):
                main(command.split()[1:], standalone_mode=False)
        found = [path for pattern in shown.pictures for path in sorted(Path().glob(pattern))]
        return [shrink(path) for path in found]


def shrink(path: Path) -> str:
    """Copy a picture to the gallery, no wider than a page and in 256 colours, including those of thin lines."""
    if path.suffix == ".gif":
        shutil.copy(path, HERE / path.name)
        return path.name
    picture = Image.open(path).convert("RGB")
    if picture.width > WIDTH:
        picture = picture.resize((WIDTH, round(picture.height * WIDTH / picture.width)), Image.Resampling.LANCZOS)
    picture.quantize(256, Image.Quantize.MAXCOVERAGE).save(HERE / path.name, optimize=True)
    return path.name


def page(entries: list[tuple[Shown, list[str]]]) -> str:
    """The gallery in Markdown."""
    parts = [
        "# Pictures\n\n"
        "One picture of each kind, with its commands. To remake all: `python results/gallery/gallery.py`.\n"
        "Pictures of the guide: `python results/gallery/worked_pages.py`.\n"
        "A design in Python, from the requirements to the flywheel, is a notebook: [hacksaw.ipynb](hacksaw.ipynb)."
    ]
    for shown, names in entries:
        commands = "\n".join(shown.commands)
        pictures = "\n".join(f"![{name}]({name})" for name in names)
        parts.append(f"## {shown.words}\n\n```sh\n{commands}\n```\n\n{pictures}")
    return "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        for text in HERE.glob("*.toml"):
            shutil.copy(text, scratch)
        entries = [(shown, make(shown, Path(scratch))) for shown in SHOWN]
    (HERE / "README.md").write_text(page(entries), encoding="utf8")
