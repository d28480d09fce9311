"""Moving parts of a drawing: links, slotted links and blocks, sliders, springs, joints."""

import math
from functools import lru_cache

import numpy as np

from engine import FRAME
from sweeps.pictures.drawing.frame import bush_at
from sweeps.pictures.drawing.guides import rails_of
from sweeps.pictures.drawing.higher_pairs import cam_shapes, pitch_curves, planet_circles
from sweeps.pictures.drawing.motion import DrawnMotion, Slider
from sweeps.pictures.drawing.racks import rack_shapes
from sweeps.pictures.drawing.symbols import (
    HALF_HEIGHT,
    HALF_LENGTH,
    Primitive,
    box,
    half_length,
    line,
    link_shape,
    of_link,
    slider_shape,
    weld,
    zigzag,
)


def plates_and_bars(m: DrawnMotion, k: int) -> tuple[list[Primitive], list[Primitive]]:
    """Links, sliders and hinges at a node: plates first, then lines and hinges."""
    r, scene = m.radius, m.scene
    under, plates, over = [], [], []
    carriers = {scene.guides[s.guide].link for s in m.sliders}
    carriers |= {g.second.link for g in scene.groups.values() if g.type in ("RPR", "RPP")}
    for link in m.links[:-1]:
        shape = of_link(link, *link_shape([m.axes[link][0][k], *(m.points[n][k] for n in m.members(link))], r))
        is_plate = bool(shape) and shape[0].kind == "polygon"
        (under if link in carriers else plates if is_plate else over).extend(shape)
    for name, group in scene.groups.items():
        if group.type in ("RPR", "RPP"):
            under += _slotted(m, name, k)
    for slider in m.sliders:
        if scene.guides[slider.guide].link != FRAME:
            under += _moving_guide(m, slider, k)
    blocks = [p for s in m.sliders for p in slider_body(m, s, k)]
    spans = [tuple(m.points[end][k] for end in s.between) for s in scene.springs.values()]
    springs = [zigzag(a, b, r) for a, b in spans if abs(b - a) > r]
    touching = [*planet_circles(m, k), *cam_shapes(m, k), *rack_shapes(m, k), *pitch_curves(m, k)]
    return [*under, *blocks, *plates], [*touching, *over, *springs, *joints(m, k)]


def slider_body(m: DrawnMotion, slider: Slider, k: int) -> list[Primitive]:
    """A slider, its tool away from the rest of the machine, its upper side up."""
    half = rails_of(m, slider).half if m.scene.guides[slider.guide].link == FRAME else HALF_HEIGHT * m.radius
    along = complex(m.guides[slider.guide][1][k])
    front, up = (sign * along for sign in _sides(m, slider))
    shape = slider_shape(slider.link, complex(m.axes[slider.link][0][k]), front, up, half, m.radius)
    return of_link(slider.link, *shape)


@lru_cache(64)
def _sides(m: DrawnMotion, slider: Slider) -> tuple[complex, complex]:
    """Front and upper side of a slider in the axes of its guide, the same at all positions."""
    along = m.guides[slider.guide][1][0]
    inward = np.mean([np.nanmean(points) for points in m.points.values()]) - np.nanmean(m.axes[slider.link][0])
    return math.copysign(1.0, -(inward / along).real), 1j if along.real > -1e-9 else -1j


def _slotted(m: DrawnMotion, name: str, k: int) -> list[Primitive]:
    """Slotted link and block of RPR or RPP."""
    r, group = m.radius, m.scene.groups[name]
    slotted, sliding = group.second.link, group.first.link
    origin, u = m.axes[slotted][0][k], m.axes[sliding][1][k]
    pin = m.points[group.first.joint][k]
    low, high = m.range_of(sliding)
    foot = origin + m.slides[sliding][k] * u
    block = of_link(sliding, line(foot, pin), box(foot, u, HALF_LENGTH * r, HALF_HEIGHT * r))
    margin = (HALF_LENGTH + 1.5) * r
    if group.type == "RPR":
        return [*of_link(slotted, line(*_rod(m, name, k))), *block]
    slot = box(origin + (low + high) / 2 * u, u, (high - low) / 2 + margin, HALF_HEIGHT * r, "paper")
    along = m.axes[slotted][1][k]
    start = origin + HALF_HEIGHT * r / abs((u / along).imag) * along
    held = m.guides[group.second.guide][0][k] + (bush_at(m, group) + 4 * r) * along
    tip = held + (m.slides[slotted][k] - m.range_of(slotted)[0] + 1.5 * r) * along
    carrier = m.scene.guides[group.second.guide].link
    held_by = [] if carrier == FRAME else of_link(carrier, box(held - 4 * r * along, along, 4 * r, 1.2 * r))
    return [*of_link(slotted, line(start, tip), *weld(start, along, u, r), slot), *block[1:], *held_by]


def _rod(m: DrawnMotion, name: str, k: int) -> tuple[complex, complex]:
    """Ends of the rod that forms the slot of an RPR rocker."""
    group = m.scene.groups[name]
    origin, u = (values[k] for values in m.axes[group.second.link])
    low, high = m.range_of(group.first.link)
    margin = (HALF_LENGTH + 1.5) * m.radius
    return origin + min(low - margin, 0) * u, origin + max(high + margin, 0) * u


def _moving_guide(m: DrawnMotion, slider: Slider, k: int) -> list[Primitive]:
    """Guide rod of a slider on a moving link, joined to the link's origin."""
    r = m.radius
    place, u = (values[k] for values in m.guides[slider.guide])
    place = place + 1j * slider.offset * u
    carrier = m.scene.guides[slider.guide].link
    origin = m.axes[carrier][0][k]
    low, high = np.add(m.range_of(slider.link), (half_length(slider.link) + 2) * r * np.array([-1, 1]))
    apart = (origin - place) / u
    if abs(apart.imag) < 0.5 * r:
        return of_link(carrier, line(place + min(low, apart.real) * u, place + max(high, apart.real) * u))
    foot = place + min(max(low, apart.real), high) * u
    arm = (origin - foot) / abs(origin - foot)
    return of_link(carrier, line(place + low * u, place + high * u), line(origin, foot), *weld(foot, arm, u, r))


def joints(m: DrawnMotion, k: int) -> list[Primitive]:
    """Hinges, dots at other points, and a stroke through a hinge where a link continues beyond it."""
    r, hinges = m.radius, m.hinges
    rest = {n for n, p in m.scene.points.items() if p.link == FRAME}
    looks = {n: (r, "paper") if n in hinges else (0.55 * r, "solid") for n in m.points if n in hinges or n not in rest}
    found = [Primitive("joints", "circle", (complex(m.points[n][k]),), *look, n) for n, look in looks.items()]
    rods = {g.second.link: _rod(m, name, k) for name, g in m.scene.groups.items() if g.type == "RPR"}
    for link in m.links[:-1]:
        names = m.members(link)
        shape = link_shape([*rods.get(link, ()), *(m.points[n][k] for n in names)], r)
        if shape and shape[0].kind == "line":
            a, b = shape[0].points
            u = r * (b - a) / abs(b - a)
            inside = [m.points[n][k] for n in names if n in hinges]
            through = [line(p - u, p + u, layer="joints") for p in inside if min(abs(p - a), abs(p - b)) > r]
            found += of_link(link, *through)
    return found
