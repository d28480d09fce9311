"""The chapters of the register: what each part of mechanics declares."""

from engine import on_use

__getattr__ = on_use(__name__)
