"""Cams: motion of the follower, geometry of the profile."""
