"""Errors of clusters."""

from engine import UserError


class ClusterError(UserError, RuntimeError):
    """There is no such cluster, or it has no usable worker."""


class UnfinishedError(ClusterError):
    """Some results are missing; the others are kept."""
