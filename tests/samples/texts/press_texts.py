"""A crank press as a text, for the tests of texts and commands."""

# In line, so that the stroke is twice the crank: a closed form to hold results to.
PRESS = """\
title = "Crank press"

[points]
O = {x = "0 mm", y = "0 mm"}

[guides]
way = {angle = "-90 deg"}

[input]
type = "crank"
pivot = "O"
pin = "A"
length = "50 mm"
speed = "60 rpm"

[groups.slide]
type = "RRP"
inner = "B"
first = {link = "rod", joint = "A", length = "200 mm"}
second = {link = "ram", guide = "way"}

[bodies.ram]
link = "ram"
mass = "100 kg"

[forces.punch]
type = "constant"
on = "B"
angle = "90 deg"
force = "100 kN"
acts = "against"
"""

PRESS_WITH_FLYWHEEL = f"""{PRESS}
[flywheel]
speed_fluctuation = "1/10"
"""
