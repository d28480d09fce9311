"""Steps of any system of rates along an angle or along time: methods, walks, cycles that close."""

from engine import on_use

__getattr__ = on_use(__name__)
