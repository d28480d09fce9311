"""Higher pairs of a mechanism: cams, gear meshes, racks, non-circular wheels; and second inputs."""

from engine import on_use

__getattr__ = on_use(__name__)
