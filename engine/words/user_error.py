"""Errors that a user can mend."""


class UserError(Exception):
    """Wrong input or missing means; the message says what is wrong and how to mend it."""
