"""Kinematics and kinetostatics of rigid links and of the structural (Assur) groups, one file for each group.

A dyad is two links with three lower pairs and no freedom of its own. Each of the five has a file with its

- position, from the known points and guides it hangs on;
- rates, a linear system that serves velocities and accelerations alike: differentiating the closure of the loop once
  or twice by the generalised coordinate q leaves the same two equations with another right-hand side, the `gap`;
- reactions in its pairs: a dyad is statically determinate, and from everything that acts on its two links, inertia
  forces included (d'Alembert), six equations of equilibrium give the six unknowns of its three pairs;
- closure: what a computed position misses of lengths, guides and directions, as a share of a length.

Conventions
-----------
A, D are known outer joints and B is the inner joint; u is the unit vector of a guide and n = k × u its left normal;
`mode` is the assembly mode, +1 or −1. Lengths in m, rates per unit of q. Where a group can't be assembled its position
is NaN; where it is singular (dead centre, change point) the position stays finite, and rates and reactions are infinite
or NaN. `sine` is the quality of force transmission, 1 at best and 0 in a singular position; its sign is that of `mode`.

The load on a link is a force (fx, fy) [N] and a moment m [N·m] about the link's origin: the outer joint of a link of
RRR, of the rod of RRP, of the block and of the rocker; the joint of a slider; the crossing of slot and guide for the
sliding link of RPP. It is all that acts on the link but the pairs of its own group.

Reactions of an outer pair act on the group's link, from what carries the pair; those of the inner pair act on the
first link, from the second. A revolute pair has a force. A prismatic pair has a normal force, positive along the left
normal n = k × u of its direction u, on a line through the link's origin, and a moment: together one force N on a
line at the distance moment/N. Pairs are without friction; masses and forces enter linearly.

Source: any course of the theory of mechanisms, chapters on the kinematics and the kinetostatics of Assur groups of
class II, e.g. I. I. Artobolevsky, Theory of Mechanisms and Machines.
"""

from engine import on_use

__getattr__ = on_use(__name__)
