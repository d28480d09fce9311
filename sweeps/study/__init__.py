"""A study: its text, what varies in it, how variants are drawn, what is asked of them and what is searched for."""
