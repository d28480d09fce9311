"""What may go wrong with a cluster, told in a sentence."""


class ClusterError(RuntimeError):
    """There is no such cluster, or none of its workers can take part."""


class UnfinishedError(ClusterError):
    """Not everything could be computed; what could be is kept."""
