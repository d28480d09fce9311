"""A crank press as a text, for the tests of texts and commands."""


def slider_crank_text(
    guide: str = 'angle = "0 deg"', speed: str = "60 rpm", group: str = "drive", slider: str = "ram", more: str = ""
) -> str:
    """A slider-crank as a text: crank 50 mm, rod 200 mm."""
    more = more and f"\n{more}"
    return f"""\
[points]
O = {{x = "0 mm", y = "0 mm"}}

[guides]
way = {{{guide}}}

[input]
type = "crank"
pivot = "O"
pin = "A"
length = "50 mm"
speed = "{speed}"{more}

[groups.{group}]
type = "RRP"
inner = "B"
first = {{link = "rod", joint = "A", length = "200 mm"}}
second = {{link = "{slider}", guide = "way"}}
"""


# In line, so that the stroke is twice the crank: a closed form to hold results to.
PRESS = f"""\
title = "Crank press"

{slider_crank_text('angle = "-90 deg"', group="slide")}
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

COMPRESSOR = """
[cylinders.gas]
type = "compressor"
piston = "ram"
bore = "80 mm"
clearance = "6 %"
suction = "1 bar"
discharge = "7 bar"
"""

# A press that starts, works and is stopped.
_USEFUL = PRESS.replace('force = "100 kN"', 'force = "5 kN"\nrole = "useful"')
MOTION = f"""{_USEFUL}
[flywheel]
inertia = "30 kg m2"

[moments.motor]
type = "dc_motor"
on = "crank"
stall_moment = "800 N m"
no_load_speed = "66 rpm"

[moments.brake]
type = "block_brake"
on = "crank"
force = "2 kN"
friction = 0.3
radius = "200 mm"

[regimes.start]
type = "run"
off = ["punch", "brake"]
speed = "60 rpm"
at_most = 20

[regimes.work]
type = "steady"
off = ["brake"]

[regimes.stop]
type = "run"
off = ["motor", "punch"]
rest = true
"""
