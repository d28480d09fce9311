"""What static replacement masses miss over random slider-cranks and crank-rockers, and that dynamic ones miss nothing.

Every machine is computed twice at uniform input speed, once with its bodies and once with point masses in their
place of the link in general plane motion, the rod of the slider-crank or the coupler of the four-bar. Run from the
repository's root:

    python results/accuracy/replacement_masses.py

writes replacement_masses.md and replacement_masses.png beside this file.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from engine import Machine, Scene, Verdict

HERE = Path(__file__).parent
DRAWN = 4000
POSITIONS = 360
# What is compared: the words for it, and the fields that are its components.
COMPARED = {
    "input moment": ("input_moment",),
    "reaction in A": ("g.first.reaction_x", "g.first.reaction_y"),
    "reaction in B": ("g.inner.reaction_x", "g.inner.reaction_y"),
    "reaction on the frame": ("g.second.reaction_x", "g.second.reaction_y"),
}
STATIC = "static, the two joints"
# Points beside the line of the joints, in lengths of the link.
BESIDE = {"third": (0.5, 0.3), "fourth": (0.8, -0.25)}
REPLACEMENTS = {
    STATIC: {"type": "static", "at": ["A", "B"]},
    "static, a joint and two points beside": {"type": "static", "at": ["A", "third", "fourth"]},
    "dynamic, a joint and its conjugate": {"type": "dynamic", "at": ["A"]},
    "dynamic, a third of the mass at a joint, and two": {"type": "dynamic", "at": ["A", "third"], "mass": 1 / 3},
    "dynamic, the joints and the centre": {"type": "dynamic", "at": ["A", "centre", "B"]},
    "dynamic, four points": {"type": "dynamic", "at": ["A", "B", "third", "fourth"]},
}


class Case(NamedTuple):
    """Random machines of one kind.

    Attributes
    ----------
    scene : dict
    body : str
        The body that is replaced; its link has the same name, and the joints A and B.
    varied : dict of str to ndarray
    ratio : ndarray
        ab/k² of that body, a and b from its centre of mass to the joints.
    """

    scene: dict
    body: str
    varied: dict[str, np.ndarray]
    ratio: np.ndarray


def bar(rng: np.random.Generator, body: str, length: np.ndarray) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """A link of 1 kg on average: centre at 25 to 60 % of its length, radius of gyration of 25 to 45 % of it.

    Returns its numbers by path, those of the points beside it among them, and ab/k².
    """
    share, gyration = rng.uniform(0.25, 0.6, DRAWN), rng.uniform(0.25, 0.45, DRAWN)
    mass = rng.uniform(0.5, 1.5, DRAWN)
    numbers = {"x": share * length, "mass": mass, "inertia": mass * (gyration * length) ** 2}
    found = {f"bodies.{body}.{key}": v for key, v in numbers.items()}
    for name, at in BESIDE.items():
        found |= {f"points.{name}_{body}.{axis}": v * length for axis, v in zip("xy", at, strict=True)}
    return found, share * (1 - share) / gyration**2


def beside(*links: str) -> dict[str, dict]:
    """The points beside links, at places that `bar` varies."""
    return {f"{name}_{link}": {"link": link, "x": x, "y": y} for link in links for name, (x, y) in BESIDE.items()}


def slider_crank(rng: np.random.Generator) -> Case:
    """Rod of 1.5 to 6 cranks, slider of up to twice the rod's mass, offset up to 0.3 cranks."""
    rod = np.exp(rng.uniform(np.log(1.5), np.log(6.0), DRAWN))
    numbers, ratio = bar(rng, "rod", rod)
    scene = {
        "points": {"O": {"x": 0, "y": 0}, **beside("rod")},
        "guides": {"way": {}},
        "input": {"type": "crank", "pivot": "O", "pin": "A", "length": 1.0, "speed": 10.0},
        "groups": {
            "g": {
                "type": "RRP",
                "inner": "B",
                "first": {"link": "rod", "joint": "A", "length": 3.0},
                "second": {"link": "slider", "guide": "way"},
            }
        },
        "bodies": {
            "rod": {"link": "rod", "mass": 1.0, "x": 1.0, "inertia": 1.0},
            "slider": {"link": "slider", "mass": 1.0},
        },
    }
    varied = {
        "groups.g.first.length": rod,
        "groups.g.second.offset": rng.uniform(-0.3, 0.3, DRAWN),
        "bodies.slider.mass": rng.uniform(0.0, 2.0, DRAWN),
        **numbers,
    }
    return Case(scene, "rod", varied, ratio)


def four_bar(rng: np.random.Generator) -> Case:
    """Crank-rockers on a frame of 1 m, lengths drawn until the sum of shortest and longest is the lesser."""
    drawn = rng.uniform([0.1, 0.5, 0.3], [0.4, 1.5, 1.2], (100 * DRAWN, 3))
    crank, coupler, rocker = drawn.T
    others = np.sort(np.stack([coupler, rocker, np.ones_like(crank)]), axis=0)
    turns = (crank < 0.95 * others[0]) & (crank + others[2] < 0.95 * (others[0] + others[1]))
    crank, coupler, rocker = drawn[turns][:DRAWN].T
    numbers, ratio = bar(rng, "coupler", coupler)
    more, _ = bar(rng, "rocker", rocker)
    scene = {
        "points": {"O": {"x": 0, "y": 0}, "D": {"x": 1.0, "y": 0}, **beside("coupler", "rocker")},
        "input": {"type": "crank", "pivot": "O", "pin": "A", "length": 0.2, "speed": 10.0},
        "groups": {
            "g": {
                "type": "RRR",
                "inner": "B",
                "first": {"link": "coupler", "joint": "A", "length": 1.0},
                "second": {"link": "rocker", "joint": "D", "length": 1.0},
            }
        },
        "bodies": {name: {"link": name, "mass": 1.0, "x": 0.4, "inertia": 1.0} for name in ("coupler", "rocker")},
    }
    varied = {"input.length": crank, "groups.g.first.length": coupler, "groups.g.second.length": rocker}
    return Case(scene, "coupler", {**varied, **numbers, **more}, ratio)


def with_masses(case: Case, replacement: dict) -> dict:
    """The scene with point masses for the body."""
    names = {name: f"{name}_{case.body}" for name in BESIDE}
    at = [names.get(place, place) for place in replacement["at"]]
    body = case.scene["bodies"][case.body] | {"replace": replacement | {"at": at}}
    return case.scene | {"bodies": case.scene["bodies"] | {case.body: body}}


def rows(case: Case, scene: dict) -> dict[str, np.ndarray]:
    """What is compared, (components, machines, positions), of all machines that can be assembled and replaced."""
    fields = [name for names in COMPARED.values() for name in names]
    machine = Machine(Scene.model_validate(scene), fields=fields, varied=case.varied, positions=POSITIONS)
    outcome = machine.evaluate(case.varied)
    keep = np.where(outcome.status == Verdict.OK, 1.0, np.nan)[:, None]
    return {what: keep * np.stack([outcome.fields[n] for n in names]) for what, names in COMPARED.items()}


def size(vectors: np.ndarray) -> np.ndarray:
    """Greatest length over the cycle of vectors (components, machines, positions), for every machine."""
    return np.linalg.norm(vectors, axis=0).max(axis=1)


def measure(case: Case) -> dict[str, dict[str, np.ndarray]]:
    """Greatest error over the cycle relative to the peak, of every machine, by replacement and what is compared."""
    true = rows(case, case.scene)
    found = {}
    for name, replacement in REPLACEMENTS.items():
        masses = rows(case, with_masses(case, replacement))
        found[name] = {what: size(masses[what] - true[what]) / size(true[what]) for what in COMPARED}
    return found


def table(errors: dict[str, dict[str, np.ndarray]]) -> list[str]:
    """Median, 95th percentile and greatest error of every replacement."""
    lines = ["| replacement | machines | " + " | ".join(COMPARED) + " |", "|---|" + "---|" * (1 + len(COMPARED))]
    for name, of in errors.items():
        kept = [e[np.isfinite(e)] for e in of.values()]
        cells = [f"{np.median(e):.0e} · {np.quantile(e, 0.95):.0e} · {e.max():.0e}" for e in kept]
        lines.append(f"| {name} | {kept[0].size} | " + " | ".join(cells) + " |")
    return lines


def draw(cases: dict[str, tuple[Case, dict]]) -> Figure:
    """Static errors over the ratio of moments of inertia, and the distribution of all errors."""
    figure = Figure(figsize=(9.2, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    for (title, (case, errors)), colour in zip(cases.items(), ("C0", "C1"), strict=True):
        left.plot(case.ratio, errors[STATIC]["input moment"], ".", ms=2, alpha=0.4, color=colour, label=title)
        for name, of in errors.items():
            e = np.sort(of["input moment"][np.isfinite(of["input moment"])])
            style = {"s": "-", "d": ":"}[name[0]]
            share = (np.arange(e.size) + 1) / e.size
            right.semilogx(np.maximum(e, 1e-17), share, style, color=colour, lw=1)
    left.set(
        xlabel="ab/k²: moment of inertia of the masses / the link's own",
        ylabel="error of the input moment / its peak",
        title="Static, masses in the joints",
    )
    left.legend(markerscale=6)
    right.plot([], [], "k-", lw=1, label="static")
    right.plot([], [], "k:", lw=1, label="dynamic")
    right.set(xlabel="error of the input moment / its peak", ylabel="share of machines", title="All replacements")
    right.legend(loc="center")
    for ax in (left, right):
        ax.grid(alpha=0.3)
    return figure


def main() -> None:
    """Measure, write the table and the plot."""
    rng = np.random.default_rng(2024)
    cases = {"slider-cranks": slider_crank(rng), "crank-rockers": four_bar(rng)}
    measured = {title: (case, measure(case)) for title, case in cases.items()}
    lines = [
        "# Error of replacement masses",
        "",
        f"{DRAWN} random machines of each kind, {POSITIONS} positions: the greatest error over the cycle relative to",
        "the peak, against the same machine with its bodies: median · 95th percentile · greatest. Reactions are",
        "vectors; that on the frame is the guide's or the one in the rocker's pivot. Made by",
        "`python results/accuracy/replacement_masses.py`.",
        "",
        "A static replacement changes the link's moment of inertia from J_S to Σ mᵢRᵢ²; for masses in the two joints",
        "to m·a·b. It is exact where ab = k², that is where one joint is the conjugate point of the other. A dynamic",
        "one changes nothing but roundings; they grow where the chosen mass leaves little for the other two to turn",
        "about, so that their masses are large and of opposite signs.",
        "",
    ]
    for title, (_, errors) in measured.items():
        lines += [f"## {title.capitalize()}", "", *table(errors), ""]
    (HERE / "replacement_masses.md").write_text("\n".join(lines), encoding="utf8")
    draw(measured).savefig(HERE / "replacement_masses.png", dpi=150)
    print("\n".join(lines))


if __name__ == "__main__":
    main()
