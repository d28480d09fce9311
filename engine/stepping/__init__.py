"""Integration of any system of rates over an angle or time: methods, walks, closed cycles."""

from engine import on_use

__getattr__ = on_use(__name__)
