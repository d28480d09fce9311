"""What can go wrong with a picture, apart from the libraries that draw it."""


class PictureError(ValueError):
    """A picture that can't be made as asked."""
