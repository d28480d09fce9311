"""A result as one page for a browser: what it says, drawn, told and looked up, in a file that needs no other."""
