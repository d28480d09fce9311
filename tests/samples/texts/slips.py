"""Tables of slips in texts: what to change, into what, and what is said of it."""


def changed(text: str, old: str, new: str) -> str:
    """A text with the first of some words replaced, which must be there."""
    assert old in text, old
    return text.replace(old, new, 1)


def cases(table: str) -> dict[str, list[str]]:
    """Cells of a table by its first column; \\n stands for a line break, a line that begins with a bar goes on."""
    lines = table.strip().replace("\n    | ", " | ").splitlines()
    cells = ([cell.replace("\\n", "\n") for cell in line.split(" | ")] for line in lines)
    return {name: rest for name, *rest in cells}
