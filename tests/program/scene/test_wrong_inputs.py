"""Wrong inputs as people make them: each answer has the place, the key, the reason and the mend, in plain words."""

import re
import tomllib
from pathlib import Path

import pytest
from commands import said
from each_case import each
from press_texts import COMPRESSOR, MOTION, PRESS_WITH_FLYWHEEL, slider_crank_text
from scene_samples import FROM_CSV, GOOD, PUNCH, SLIDING
from slips import cases, changed
from study_samples import STUDY, study_of

from engine import Mechanics, Scene, SceneError
from sweeps import InputError, read_scene

GROUND = """\
[points]
O = {x = "0 mm", y = "0 mm"}
D = {x = "200 mm", y = "0 mm"}
E = {x = "100 mm", y = "200 mm"}

[input]
type = "crank"
pivot = "O"
pin = "A"
length = "50 mm"
speed = "60 rpm"
"""

FOUR_BAR = f"""{GROUND}
[groups.bars]
type = "RRR"
inner = "B"
first = {{link = "coupler", joint = "A", length = "200 mm"}}
second = {{link = "rocker", joint = "D", length = "150 mm"}}
"""

# Two bars carry one more link each, and each of these pairs of links hangs on the other: a triad.
TRIAD = f"""{GROUND}
[points.corner]
link = "plate"
x = "50 mm"
y = "0 mm"

[groups.one]
type = "RRR"
inner = "B"
first = {{link = "plate", joint = "F", length = "100 mm"}}
second = {{link = "bar_1", joint = "D", length = "100 mm"}}

[groups.two]
type = "RRR"
inner = "F"
first = {{link = "bar_2", joint = "E", length = "100 mm"}}
second = {{link = "bar_3", joint = "corner", length = "100 mm"}}
"""

ENGINE = f"""\
{slider_crank_text("", "1500 rpm", "slide", "piston", "revolutions = 2")}
[cylinders.fire]
type = "four_stroke"
piston = "piston"
bore = "80 mm"
clearance = 0.1
intake = "1 bar"
exhaust = "1.1 bar"
peak = "50 bar"
"""

LOADED = f"""{PRESS_WITH_FLYWHEEL}{COMPRESSOR}
[moments.cam]
type = "table"
on = "crank"
over_angle = ["0 deg", "90 deg", "350 deg"]
moment = ["0 N m", "5 N m", "3 N m"]
interpolation = "linear"
"""

TEXTS = {"PRESS": PRESS_WITH_FLYWHEEL, "GOOD": GOOD, "FOUR_BAR": FOUR_BAR, "TRIAD": TRIAD, "SLIDING": SLIDING}
TEXTS |= {"ENGINE": ENGINE, "LOADED": LOADED, "MOTION": MOTION}

# Words of Python and its libraries.
FOREIGN = re.compile(
    r"pydantic|Input should|valid (string|integer|number|list|dict)|[Tt]raceback|(Type|Value|Key|Attribute|Name)Error|"
    r"NoneType|\bdict\b|\bstr\b|\bint\b|\bbool\b|<class|Cannot (declare|overwrite)|could not convert|invalid syntax|"
    r"[a-z][A-Z][a-z]+ can't be|object has no|tuple|Expected '|at line \d+, column|literal|Errno|is not callable|loc="
)

# Name | scene | what of it | becomes | line and key | words of reason and mend.
SCENES = cases(r"""
no unit | PRESS | "50 mm" | 50 | 13: input.length | 50 has no unit: write "50 mm"
no quotes | PRESS | "50 mm" | 50 mm | 13 | has a unit, so it needs quotes: "50 mm"
unknown unit | PRESS | "100 kg" | "100 kgs" | 24: bodies.ram.mass | unknown unit 'kgs' | did you mean 'kg'
decimal comma | PRESS | "50 mm" | "50,5 mm" | 13: input.length | use a decimal point, not a comma, as in '50.5 mm'
weight for mass | PRESS | "100 kg" | "980 N" | 24: bodies.ram.mass | expected a mass such as '1.2 kg', got 'N'
misspelt key | PRESS | mass = | mas = | 24: bodies.ram.mas | unknown key; allowed: link, mass | did you mean 'mass'?
unknown point | PRESS | joint = "A" | joint = "Z" | 19: groups.slide.first.joint | 'Z' is not a point of this scene
    | A, B, O
no guide | PRESS | [guides]\nway = {angle = "-90 deg"} | # | 19: groups.slide.second.guide
    | 'way' is not a guide of this scene; there are none; add [guides.way] with angle = "0 deg"
name taken | PRESS | inner = "B" | inner = "A" | 18: groups.slide.inner | already taken by input.pin; choose another
choice | PRESS | [flywheel] | [forces.f]\ntype = "table"\n[flywheel] | 33: forces.f.interpolation
    | add one of linear, pchip
table twice | PRESS | [flywheel] | [flywheel]\n[flywheel] | 34 | the table [flywheel] appears twice, first in line 33
key twice | PRESS | mass = | mass = "9 kg"\nmass = | 25 | mass appears twice in its table: remove one
cut short | PRESS | "1/10" | [1, | 34 | the text ends within a value
quote | PRESS | "100 kg" | "100 kg | 24 | a quotation mark is missing
curly quotes | PRESS | "100 kg" | “100 kg” | 24 | write straight quotation marks, ", not typographic ones
colon | PRESS | mass = | mass: | 24 | write KEY = VALUE, not KEY: VALUE
semicolon | PRESS | "100 kg" | "100 kg"; | 24 | a line holds one KEY = VALUE
no value | PRESS | mass = "100 kg" | mass = | 24 | no value after =
letter beyond a to z | PRESS | mass = | größe = | 24 | größe is not a name: use the letters a to z
blank in a name | PRESS | [bodies.ram] | [bodies.the ram] | 22
    | a ] is missing after the name of the table, or the name has a
backslash | PRESS | Crank press | C:\press | 1 | write \\ for a backslash, or use single quotes
coordinates | PRESS | {x = "0 mm", y = "0 mm"} | ["0 mm", "0 mm"] | 4: points.O
    | expected a table of keys, got ['0 mm', '0 mm']
units | PRESS | title = "Crank press" | units = "metric" | 1: units | 'metric' is not allowed; allowed: mm, SI, US
formula | PRESS | force = "100 kN" | force = "100 kN * phi = 3" | 30: forces.punch.force
    | expected a force such as '12 kN'
text without quotes | PRESS | type = "crank" | type = crank | 10 | crank is a text
from for start | PRESS | speed = "60 rpm" | speed = "60 rpm"\nfrom = "0 deg" | 15: input.from | did you mean 'start'?
title with an escape | PRESS | title = "Crank press" | title = "\u001b[31mpress" | 1: title | control character
crank at rest | PRESS | speed = "60 rpm" | speed = "0 rpm" | 14: input.speed | at rest
limit of an angle | PRESS | [flywheel] | [limits]\ntransmission_angle = "100 deg"\n[flywheel]
    | 34: limits.transmission_angle | must be less than 90 deg, got '100 deg'
shaft that stands | PRESS | [flywheel] | [shafts.s]\ngeared_to = "crank"\nratio = 0\n[flywheel] | 35: shafts.s.ratio
    | a shaft with the ratio 0
no mass | GOOD | mass = "100 kg"\n |  | 34: bodies.ram | give mass | shape with density
unknown law | GOOD | "table" | "tabel" | 43: forces.punch | constant, table | did you mean 'table'?
no type | GOOD | type = "RRP"\n |  | 28: groups.press | 'type' is missing
fluctuation | GOOD | "1/10" | "3" | 65: flywheel.speed_fluctuation | must be less than 2
spring on nothing | GOOD | "tip"] | "top"] | 61: springs.back.between | 'top' | did you mean 'tip'?
spring with one end | GOOD | ["D", "tip"] | ["D"] | 61: springs.back.between
spring on one point | GOOD | ["D", "tip"] | ["D", "D"] | 61: springs.back.between | 'D'
name of two actions | GOOD | springs.back | springs.punch | 60: springs.punch | taken by forces.punch
bad name | GOOD | inner = "C" | inner = "my C" | 30: groups.press.inner | 'my C' is not a name | underscores
link of two groups | GOOD | link = "pitman" | link = "rod" | 31: groups.press.first.link
    | 'rod' is already moved by groups.bars.first.link | over-constrained
group on the frame | GOOD | joint = "A", length = "220 | joint = "O", length = "220 | 22: groups.bars
    | over-constrained | frame | W =  | moving link
pivot that moves | GOOD | pivot = "O" | pivot = "tip" | 17: input.pivot | not on the frame | D, O
body on the frame | GOOD | link = "ram"\nmass | link = "frame"\nmass | 35: bodies.ram.link | moving link
moment on a slider | GOOD | on = "rocker"\nmoment | on = "ram"\nmoment | 57: moments.friction.on | 'ram'
motor on a rocker | GOOD | type = "against_motion"\non = "rocker"\nmoment = "2 N m"
    | type = "dc_motor"\non = "rocker"\nstall_moment = "2 N m"\nno_load_speed = "90 rpm" | 57: moments.friction.on
    | a motor drives the crank | allowed: crank
stroke of a rocker | GOOD | slider = "ram" | slider = "rocker" | 47: forces.punch.slider | sliders are: ram
stroke of nothing | GOOD | slider = "ram"\n |  | 43: forces.punch | over_stroke and slider | name
table not sorted | GOOD | "1 mm", "8 mm" | "8 mm", "1 mm" | 43: forces.punch | row 3: over_stroke is below | sort
table not equal | GOOD | "1 mm", "8 mm" | "1 mm" | 43: forces.punch | over_stroke has 2 rows | has 3
mass and density | GOOD | density = | mass = "1 kg"\ndensity = | 38: bodies.bar | either mass or density
inertia and shape | GOOD | density = | inertia = "1 kg m2"\ndensity = | 38: bodies.bar | give one of
start alone | GOOD | "60 rpm" | "60 rpm"\nstart = "0 deg" | 15: input | start and stop | give both, or neither
flywheel without a cycle | GOOD | "60 rpm" | "60 rpm"\nstart = "0 deg"\nstop = "9 deg" | 66: flywheel | turns fully
revolutions | GOOD | "60 rpm" | "60 rpm"\nrevolutions = 0 | 21: input.revolutions | 0 | at least 1
mode | GOOD | inner = "C" | inner = "C"\nmode = 0 | 31: groups.press.mode | 1 or -1
list of tables | GOOD | [input] | [[input]] | 15: input | expected a table of keys
Python for a number | GOOD | mass = "100 kg" | mass = "__import__('os').system('touch stolen')" | 36: bodies.ram.mass
    | a mass such as '1.2 kg' | __import__
Python for a name | GOOD | inner = "C" | inner = "C); import os; os.remove('press.toml'); (" | 30: groups.press.inner
    | is not a name
class III | TRIAD |  |  | 18: groups.one | one needs F | two needs corner | class III
undriven link | FOUR_BAR | [input] | [points.P]\nlink = "lever"\nx = "1 mm"\ny = "0 mm"\n\n[input] | 7: points.P.link
    | 'lever' is not a link | coupler, crank, frame, rocker
sliding input on a moving guide | SLIDING | guide = "way" | guide = "slot" | 12: input.guide | moving link
    | must be on the frame
shaft on a sliding input | SLIDING | [groups.bars] | [shafts.wheel]\ngeared_to = "ram"\nratio = 2\n\n[groups.bars]
    | 19: shafts.wheel.geared_to | sliding input
sliding input that doesn't move | SLIDING | stop = "50 mm" | stop = "0 mm" | 9: input | stop | start
shaft on the frame | FOUR_BAR | [groups.bars] | [shafts.wheel]\ngeared_to = "frame"\nratio = 2\n\n[groups.bars]
    | 14: shafts.wheel.geared_to | 'frame'
cylinder on a rod | ENGINE | piston = "piston" | piston = "rod" | 23: cylinders.fire.piston | 'rod' doesn't slide
    | sliders are: piston
no compression | LOADED | "1 bar" | "8 bar" | 36: cylinders.gas | discharge = 700 kPa is not above suction = 800 kPa
beyond a period | LOADED | "350 deg" | "400 deg" | 48: moments.cam.moment
    | row 3: over_angle [deg] = 400 is more than one period (360) after
jump at a period | LOADED | "350 deg" | "360 deg" | 48: moments.cam.moment
    | row 3: moment = 3 one period after the first row, whose moment = 0; make them
unknown action | MOTION | "punch", "brake"] | "punhc", "brake"] | 52: regimes.start.off
    | 'punhc' is not an action of this scene; known are: brake, gravity, motor, punch; did you mean 'punch'?
two ends | MOTION | at_most = 20 | time = "3 s" | 50: regimes.start | after cycles, after a time, at a speed or at rest:
    | time and speed are given; give exactly one of cycles, time, speed, rest = true
no end | MOTION | rest = true |  | 60: regimes.stop | a run ends after cycles, after a time, at a speed or at rest: none
unit of a run | MOTION | speed = "60 rpm"\nat | speed = "60 N"\nat | 53: regimes.start.speed | expected an angular speed
name of a regime | MOTION | [regimes.work] | [regimes.punch] | 56: regimes.punch | the name 'punch' is already taken
four strokes in a turn | ENGINE | revolutions = 2\n |  | 21: cylinders.fire.type | two turns | input.revolutions = 2
""")

# The same of a study.
STUDIES = cases(r"""
condition by a number | "ram.stroke > '90 mm'" | 90 | 19: best.where | expected a list in brackets, [ ], got 90
misspelt result | "ram.stroke > '90 mm'" | "ram.strok > 90 mm" | 19: best.where | did you mean 'ram.stroke'
result in require | positions | require = "ram.stroke > 90 mm"\npositions | 4: require
    | is a result; require drops variants before they are computed, so write where
where at the top | positions | where = "reach > 3"\npositions | 4: where | belongs to [best] or [optimise]
best of what is fixed | "excess_work"\n | "input.speed"\n | 18: best.minimise | the same for all variants: vary it
range | {from = "40 mm", to = "60 mm", count = 3} | "40-60 mm" | 7: vary.input.length | such as '40 mm to 80 mm, 5'
bare range | {from = "40 mm", to = "60 mm", count = 3} | "40 to 60 mm, 3" | 7: vary.input.length | 40 has no unit
minimum | {from = "40 mm", to = "60 mm", count = 3} | {min = "40 mm", count = 3} | 7: vary.input.length.min
    | did you mean 'from'?
list of lists | [3, 4, 5] | [[3, 4]] | 9: vary.reach.values.0 | expected a number or a text in quotes, got [3, 4]
true in a list | [3, 4, 5] | [3, true] | 9: vary.reach.values.1 | such as '40 mm', got true
list in quotes | [3, 4, 5]} | "3, 4, 5"} | 9: vary.reach.values | expected a list in brackets, [ ], got '3, 4, 5'
spreadsheet | "reach * input.length" | "=reach * input.length" | 12: derive.groups.slide.first.length
    | leave the leading = out
number for a text | "reach * input.length" | 0.2 | 12: derive.groups.slide.first.length
    | expected a text in quotes, got 0.2
field for a summary | ["ram.stroke", | ["B.x", | 14: outputs | 'B.x' is a field, a curve | B.x.max
summary for a field | summaries = | fields = | 14: outputs | 'ram.stroke' is a summary, a single number
no scene | scene = "press.toml"\n |  | : scene | is missing: name the file of the scene, scene = "press.toml"
study for a scene | press.toml | study.toml | 3: scene | study.toml is a study; name the file of a scene
no such file | press.toml | Press.toml | 3: scene | Press.toml: there is no such file
nested misspelt path | bodies.ram.mass | bodies.ram.maas | 8: vary.bodies.ram.maas | 'bodies.ram.mass'
path of a text | "input.length" = | "input.pivot" = | 7: vary.input.pivot | not a number
part of a used name | reach = | rea = {values = [1]}\nreach = | 9: vary.rea | not a number
wrong unit | "60 mm" | "60 kg" | 7: vary.input.length | a length such as
no count | , count = 3 |  | 7: vary.input.length.count | is missing
count of none | count = 3 | count = 0 | 7: vary.input.length.count | at least 1
unknown key of an axis | count = 3 | cuont = 3 | 7: vary.input.length.cuont | did you mean 'count'?
not an axis | {values = [3, 4, 5]} | 3 | 9: vary.reach | 3 | a list
range without a count | {values = [3, 4, 5]} | "3 to 5" | 9: vary.reach | '3 to 5' | how many
unknown series | {values = [3, 4, 5]} | {choose = "R30", low = 1, high = 5} | 9: vary.reach.choose
    | 'R30' is not allowed | R5, R10, R20, R40, IEC
series without a range | {values = [3, 4, 5]} | {choose = "R20", low = "3 mm"} | 9: vary.reach.high | is missing
list of nothing | {values = [3, 4, 5]} | {choose = []} | 9: vary.reach.choose | at least 1
series of lengths for a mass | {values = ["50 kg", "0.1 t"]} | {choose = "R20", low = "5 kg", high = "9 kg"}
    | 8: vary.bodies.ram.mass | 'R20' is a series of lengths | list the sizes: ['1.2 kg', …]
series from zero | from = "40 mm", to = "60 mm", count = 3 | choose = "R20", low = "0 mm", high = "60 mm"
    | 7: vary.input.length | low '0 mm' must be above 0
series downwards | from = "40 mm", to = "60 mm", count = 3 | choose = "R20", low = "60 mm", high = "40 mm"
    | 7: vary.input.length | not above high '40 mm'
series between its sizes | from = "40 mm", to = "60 mm", count = 3 | choose = "R5", low = "41 mm", high = "44 mm"
    | 7: vary.input.length | no size of 'R5' lies from '41 mm' to '44 mm'; nearest: 40 mm and 63 mm
list of several kinds | {values = [3, 4, 5]} | {choose = [3, "4 mm"]} | 9: vary.reach | number and length
low without sampling | count = 3 | count = 3}\n"gravity" = {low = "0 m/s2", high = "9 m/s2" | 8: vary.gravity
    | [sampling] | method and count
low with a count | count = 3 | count = 3}\n"gravity" = {low = "0 m/s2", high = "9 m/s2", count = 4
    | 8: vary.gravity.count | count belongs to from and to, or to [sampling]
range without a count | from = "40 mm", to = "60 mm", count = 3 | from = "40 mm", to = "60 mm"
    | 7: vary.input.length.count | is missing: add it; a range that [sampling] samples
absent number | "input.length" = | "input.start" = | 7: vary.input.start | the scene gives; give it there first
misspelt statistic | ["ram.stroke", | ["ram.velocity.peek", | 14: outputs | did you mean 'ram.velocity.peak'
range downwards | count = 3 | count = 3}\n"gravity" = {low = "9 m/s2", high = "1 m/s2" | 8: vary.gravity
    | low '9 m/s2' is above high '1 m/s2'
sampling of nothing | [derive] | [sampling]\nmethod = "sobol"\ncount = 4\n\n[derive] | 11: sampling | low and high
derived and varied | [derive] | [derive]\n"input.length" = "1" | 12: derive.input.length | either varied or derived
unknown name in an expression | reach * input | reech * input | 12: derive.groups.slide.first.length | vary.reach
condition for a number | reach * input | reach < input | 12: derive.groups.slide.first.length | is a condition
    | number
Python in an expression | reach * input.length | __import__('os').system('touch stolen')
    | 12: derive.groups.slide.first.length | allowed
number for a condition | positions | require = ["reach + 1"]\npositions | 4: require | condition
require in best | where = | require = | 19: best.require | did you mean 'where'? | before they are computed
odd positions | positions = 48 | positions = 49 | 4: positions | even
precision | positions | field_precision = "float16"\npositions | 4: field_precision | float64, float32
unknown field | [outputs] | [outputs]\nfields = ["B.z"] | 14: outputs | 'B.z' is not a field | 'B.x'
best without a name | minimise = "excess_work" | minimise = "" | 18: best.minimise | an expression is missing
best of an expression | minimise = "excess_work" | minimise = "2 * excess_work" | 18: best.minimise | [optimise]
entry of require | positions = 48\n | require = [\n"reach < 5",\n"input.length < bodies.ram.mass",\n]\n | 6: require
    | compares a length with a mass:\n    input.length < bodies.ram.mass
best where a list | "ram.stroke > '90 mm'" | ["reach > 1",\n"ram.stroke > 90 kg"] | 20: best.where
    | compares a length with a mass
best of two | minimise = "excess_work" | minimise = "excess_work"\nmaximise = "ram.stroke" | 17: best | either
derived of another dimension | reach * input.length | reach * bodies.ram.mass | 12: derive.groups.slide.first.length
    | gives a mass, but this is a length
dimension of a derived number | positions | require = ["2 * groups.slide.first.length > '1 kg'"]\npositions
    | 4: require | compares a length with a mass
power that varies | reach * input.length | input.length**reach | 12: derive.groups.slide.first.length | fixed number
scene that is a folder | press.toml | . | 3: scene | is a folder
accuracy of all | positions | accuracy = "150 %"\npositions | 4: accuracy | less than 1
accuracy of nothing | positions | accuracy = 0\npositions | 4: accuracy | greater than 0
accuracy as a length | positions | accuracy = "0.1 mm"\npositions | 4: accuracy | mm
accuracy in words | positions | accuracy = "fine"\npositions | 4: accuracy | fine
no such csv | positions | variants = "choice.csv"\npositions | 4: variants | choice.csv: there is no such file
""")

# A table of variants, and its line and column.
TABLES = cases(r"""
empty cell | input.length [mm],bodies.ram.mass\n40,\n | 2: column bodies.ram.mass | '' is not a number such as 0.5
decimal comma | input.length [mm]\n40,5\n | 2 | has 2 cells, the header 1; separate columns by semicolons
no header | 40\n50\n | 1 | the first line must name the columns, such as 'input.length [mm]'
round brackets | input.length (mm)\n40\n | 1 | write a name and a unit for each column, such as 'force [kN]'
open quotation | input.length [mm]\n"40\n | 2 | quotation marks don't match
other dimension | input.length [kg]\n40\n | 1: column input.length | expected a length such as
column twice | input.length [mm],input.length [mm]\n40,40\n | 1 | a column is given twice: input.length, input.length
no rows | input.length [mm]\n |  | at least one row
dot and comma | input.length [mm];reach\n1.234,5;1\n | 2: column input.length | '1.234,5' is not a number
line break in a cell | input.length [mm],reach\n"1,2\n3",4\n |  | a quoted cell spans several lines
""")

# A command, and what is named in place of a file.
COMMANDS = cases(r"""
no such file | run nope.toml | nope.toml | there is no such file
name without its ending | check press | press | did you mean 'press.toml'?
ending of a result | run press.toml --out a.txt | a.txt | --out: results are HDF5: give a file that ends in .h5
folder for a result | show . | this is a folder | There is r.h5.
scene for a result | show press.toml | press.toml | `sweeps run press.toml` computes its numbers
misspelt command | chekc press.toml | chekc | did you mean 'check'?
no command | frobnicate | frobnicate | known are animate, balance, check
no value | check press.toml --set input.length | --set | write PATH=VALUE, such as input.length='55 mm'
words for an angle | show press.toml --at ten | --at | expected an angle such as '30 deg' | for example --at 0,60,120
no angle | show press.toml --at , | --at | no positions; for example --at 0,60,120
mass for an angle | show press.toml --at 37kg | --at | expected an angle
time without regimes | show press.toml --at 0.2s | --at | a time needs regimes
field of a machine | show press.toml --at 10 --columns B.vz | 'B.vz' | or 'B.vx'?
negative length | show press.toml --at 10 --set input.length=-3mm | input.length
nothing to show | show press.toml --set input.length=3mm | --set | requires --at
number that varies | check study.toml --set input.length=60mm | --set | varies in this study
few positions | check press.toml --positions 7 | positions = 7: | an even number of at least 8
accuracy above 1 | check press.toml --accuracy 2 | --accuracy | must be between 0 and 1
accuracy as a length | check press.toml --accuracy 1mm | --accuracy | expected a number
condition on a scene | plot press.toml --where ram.stroke>1mm | --where | no effect on the plot of a mechanism
curves with plans | plot press.toml -y B.vx --plans --colour a | -y, --colour | no effect on the plot of a mechanism
position of a sweep | plot r.h5 -y ram.stroke --at 30 | --at | no effect on the plot of a sweep, whose options are -x
position in a result | plot r.h5 --at ten | --at | expected an angle such as '30 deg'
hodograph of an engine | plot v_twin --hodograph | --hodograph | no effect on the plot of machine elements
path of a rotor | plot fan_rotor --paths B | --paths | no effect on the plot of machine elements
condition on an export | export press.toml --to a.csv --where ram.stroke>1mm | --where | a whole result file
condition on a variant | export r.h5 --variant 1 --to a.csv --where ram.stroke>1mm | --where | a whole result file
sort by a misspelt name | show r.h5 --sort ram.strok | sort | did you mean 'ram.stroke'
misspelt column | show r.h5 --columns ram.strok | columns | 'ram.strok' | ram.stroke
misspelt condition | show r.h5 --where ram.strok>1 | where | did you mean 'ram.stroke'
condition on what was not asked | show r.h5 --where B.y.max<1kg | where | 'B.y.max' is not in this result: add it to
sort by what was not asked | show r.h5 --sort required_power | sort | 'required_power' is not in this result
curve for a number | show r.h5 --columns ram.velocity | columns | 'ram.velocity' is a curve | ram.velocity.max
no condition | show r.h5 --where true | where | 'true' compares nothing | condition
dimension of a condition | show r.h5 --where ram.stroke>'2kg' | where | compares a length with a mass
limit of none | show r.h5 --limit 0 | --limit
descending in no column | show r.h5 --descending | --descending | a column to sort by
order of one machine | export r.h5 --sort ram.stroke --to a.svg | --sort | one machine is written
nothing but articles | help of the | help | no key or type 'of the'
one equals sign | plot r.h5 --where ram.stroke=90 | where: write == instead of =
words for a count | run press.toml --jobs two | --jobs | 'two' is not a whole number of at least 1
too few frames | animate press.toml --frames 2 | --frames | '2' is not a whole number from 4 to 1000
unknown field | plot press.toml -y B.speed | 'B.speed' is not a field | known are B.
accuracy | run press.toml --accuracy high | --accuracy | expected a number such as '0.3'
ending | export press.toml --to a.xls | --to | ending '.xls': allowed are .csv
picture | plot press.toml --out a.bmp | a.bmp | unknown picture format '.bmp'; allowed: .svg
""")


def check(message: str, place: str, words: list[str]) -> None:
    assert place in message, message
    for word in words:
        assert word in message, message
    assert not FOREIGN.search(message), message
    assert "\x1b" not in message


def placed(file: str, place: str) -> str:
    """What a message begins with: the file, and where there is one the line and the key."""
    line, _, key = place.partition(":")
    return f"{file}, line {line}:{key}" if line else f"{file}:{key}"


def test_good_texts__are_read(tmp_path):
    (tmp_path / "punch.csv").write_text(PUNCH)
    for i, text in enumerate((GOOD, FOUR_BAR, SLIDING, ENGINE, LOADED, FROM_CSV)):
        (tmp_path / f"{i}.toml").write_text(text)
        assert read_scene(tmp_path / f"{i}.toml").input.speed > 0


@each("slip", SCENES)
def test_wrong_scene__is_answered(slip, tmp_path):
    text, old, new, place, *words = SCENES[slip]
    (tmp_path / "press.toml").write_text(changed(TEXTS[text], old, new), encoding="utf8")
    with pytest.raises(InputError) as refused:
        read_scene(tmp_path / "press.toml")
    check(str(refused.value), placed("press.toml", place), words)
    assert not Path("stolen").exists()


@each("slip", STUDIES)
def test_wrong_study__is_answered(slip, study_folder):
    old, new, place, *words = STUDIES[slip]
    with pytest.raises(InputError) as refused:
        study_of(study_folder, changed(STUDY, old, new))
    check(str(refused.value), placed("study.toml", place), words)
    assert not Path("stolen").exists()


@each("slip", TABLES)
def test_wrong_table__is_answered(slip, study_folder):
    content, place, *words = TABLES[slip]
    (study_folder / "choice.csv").write_text(content, encoding="utf8")
    with pytest.raises(InputError) as refused:
        study_of(study_folder, 'scene = "press.toml"\nvariants = "choice.csv"\n')
    check(str(refused.value), f"study.toml, line 2: variants: {placed('choice.csv', place)}", words)


@each("slip", COMMANDS)
def test_wrong_command__is_answered(slip, press_result):
    line, place, *words = COMMANDS[slip]
    answer = said(*line.split())
    assert answer.exit_code == 2
    check(answer.stderr, place, words)


@each("slip", SCENES)
def test_wrong_scene_in_python__is_answered(slip):
    """As in a file, except that numbers without a unit are in SI there."""
    text, old, new, place, *_ = SCENES[slip]
    try:
        tables = tomllib.loads(changed(TEXTS[text], old, new))
    except tomllib.TOMLDecodeError:
        return
    for read in (Scene.model_validate, lambda data: Scene(**data)):
        try:
            Mechanics(read(tables))
        except SceneError as refused:
            check(str(refused), place.partition(":")[2].strip(), [])
        else:
            assert new == "50"


def test_wrong_scene_in_python__is_answered_key_by_key():
    drive = {"type": "crank", "pivot": "O", "pni": "A", "length": "50 rpm", "speed": -1.0}
    train = {"type": "gear_train", "wheels": {"a": {"shaft": "i", "teeth": 9}, "b": {"shaft": "j", "teeth": 9}}}
    train |= {"shafts": {"i": {"speed": 1.0}}, "meshes": {"m": {"between": ["a", "b"]}}}
    with pytest.raises(SceneError) as refused:
        Scene(title=3, pionts={}, input=drive, elements={"train": train})
    assert dict(refused.value.problems)["title"] == "expected a text in quotes, got 3"
    assert dict(refused.value.problems)["input.length"] == "expected a length such as '80 mm', got 'rpm'"
    assert dict(refused.value.problems)["pionts"].endswith("did you mean 'points'?")
    # A misspelt key isn't missing, too.
    assert dict(refused.value.problems)["input.pni"].endswith("did you mean 'pin'?")
    assert "input.pin" not in dict(refused.value.problems)
    words = "there is no shaft 'j': add it to shafts, or name one of frame, i"
    assert dict(refused.value.problems)["elements.train.wheels.b.shaft"] == words
