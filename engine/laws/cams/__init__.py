"""Cams: motion of the follower, geometry of the profile, contact pressure."""
