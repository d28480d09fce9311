"""The structural groups, each put together in a file of its own."""

from engine.mechanism.groups.prp import add_prp
from engine.mechanism.groups.rpp import add_rpp
from engine.mechanism.groups.rpr import add_rpr
from engine.mechanism.groups.rrp import add_rrp
from engine.mechanism.groups.rrr import add_rrr

# What adds a group of each type to a mechanism.
GROUPS = {"RRR": add_rrr, "RRP": add_rrp, "RPR": add_rpr, "PRP": add_prp, "RPP": add_rpp}
