"""A scene as a text, with its table in the text or in a CSV file, and what is said where it is refused."""

from pathlib import Path

import pytest

from sweeps import InputError, read_scene

GOOD = """\
title = "Crank press with a rocker"

[points]
O = {x = "0 mm", y = "0 mm"}
D = {x = "260 mm", y = "20 mm"}

[points.tip]
link = "rocker"
x = "180 mm"
y = "0 mm"

[guides.way]
angle = "-90 deg"

[input]
type = "crank"
pivot = "O"
pin = "A"
length = "50 mm"
speed = "60 rpm"

[groups.bars]
type = "RRR"
inner = "B"
first = {link = "rod", joint = "A", length = "220 mm"}
second = {link = "rocker", joint = "D", length = "150 mm"}

[groups.press]
type = "RRP"
inner = "C"
first = {link = "pitman", joint = "A", length = "200 mm"}
second = {link = "ram", guide = "way"}

[bodies.ram]
link = "ram"
mass = "100 kg"

[bodies.bar]
link = "rod"
density = "7850 kg/m3"
shape = {type = "rod", length = "220 mm", area = "6 cm2"}

[forces.punch]
type = "table"
on = "C"
angle = "90 deg"
slider = "ram"
measured_from = "high end"
over_stroke = ["0 mm", "1 mm", "8 mm"]
force = ["0 kN", "100 kN", "60 kN"]
interpolation = "linear"
outside = "zero"
acts = "against"

[moments.friction]
type = "against_motion"
on = "rocker"
moment = "2 N m"

[springs.back]
between = ["D", "tip"]
stiffness = "5 N/mm"

[flywheel]
speed_fluctuation = "1/10"
"""

SLIDING = """\
[guides.way]

[guides.slot]
link = "arm"

[points]
D = {x = "200 mm", y = "50 mm"}

[input]
type = "slider"
link = "ram"
guide = "way"
point = "A"
start = "0 mm"
stop = "50 mm"
speed = "1 m/s"

[groups.bars]
type = "RRR"
inner = "B"
first = {link = "rod", joint = "A", length = "200 mm"}
second = {link = "arm", joint = "D", length = "150 mm"}
"""

FROM_CSV = GOOD.replace(
    'over_stroke = ["0 mm", "1 mm", "8 mm"]\nforce = ["0 kN", "100 kN", "60 kN"]', 'file = "punch.csv"'
)

PUNCH = "over_stroke [mm],force [kN]\n0,0\n1,100\n8,60\n"


def refused(folder: Path, text: str | bytes, name: str = "press.toml") -> InputError:
    """The error of a scene; any other exception fails the test, and so does none."""
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError) as caught:
        read_scene(path)
    return caught.value


def line_with(text: str, marker: str) -> int:
    """Number of the last line that holds a marker."""
    return max(i for i, line in enumerate(text.splitlines(), 1) if marker in line)
