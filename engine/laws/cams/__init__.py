"""Laws of cams: motion of the follower, shape of the profile, forces between them."""
