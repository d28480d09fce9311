"""Kinematics and kinetostatics of rigid links and of the structural (Assur) groups, one file for each group.

A dyad is two links with three lower pairs and no degree of freedom. Each of the five has a file with its

- position, from the known points and guides it is attached to;
- rates, a linear system for velocities and accelerations alike: differentiating the loop closure once or twice by the
  generalised coordinate q gives the same two equations with different right-hand sides, the `gap`;
- reactions in its pairs: a dyad is statically determinate. All forces on its two links, including inertia forces
  (d'Alembert), enter six equations of equilibrium for the six unknowns of its three pairs;
- closure: residual of a computed position in lengths, guides and directions, relative to a length.

Conventions: A, D are known outer joints and B is the inner joint; u is the unit vector of a guide and n = k × u its
left normal; `mode` is the assembly mode, +1 or −1. Lengths in m, rates per unit of q. The position of a group that
can't be assembled is NaN. In a singular position (dead centre, change point) the position stays finite, and rates and
reactions are infinite or NaN. `sine` measures force transmission like the sine of the transmission angle, 1 at best and
0 in a singular position; its sign is that of `mode`.

The load on a link is a force (fx, fy) [N] and a moment m [N·m] about the link's origin: the outer joint for a link of
RRR, for the rod of RRP, for the block and for the rocker; the joint for a slider; the crossing of slot and guide for
the sliding link of RPP. It comprises everything that acts on the link except the pairs of its own group.

Reactions of an outer pair act on the group's link, from the link that carries the pair; those of the inner pair act on
the first link, from the second. A revolute pair has a force. A prismatic pair has a normal force, positive along the
left normal n = k × u of its direction u, on a line through the link's origin, and a moment: together one force N on a
line at the distance moment/N. Pairs are frictionless; masses and forces enter linearly.

Source: any course of the theory of mechanisms, chapters on the kinematics and the kinetostatics of Assur groups of
class II, e.g. I. I. Artobolevsky, Theory of Mechanisms and Machines.
"""

from engine import on_use

__getattr__ = on_use(__name__)
