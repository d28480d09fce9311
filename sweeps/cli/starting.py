"""Commands to start with: list, new, guide."""

from pathlib import Path

import click

from sweeps.cli.shared import errors_as_messages, tell, write_text


@click.command("list")
@errors_as_messages
def list_command() -> None:
    """List the bundled studies and the templates for scenes."""
    from sweeps.study.bundled import questions
    from sweeps.text.tables import table
    from sweeps.text.templates import templates

    tell("Studies (sweeps run NAME):")
    tell(table(list(questions().items()), "  "))
    tell("Templates (sweeps new NAME):")
    tell(table(list(templates().items()), "  "))


@click.command()
@click.argument("template")
@click.option("--out", type=click.Path(path_type=Path), help="File to write; TEMPLATE.toml unless given.")
@errors_as_messages
def new(template: str, out: Path | None) -> None:
    """Write a commented scene to start from."""
    from sweeps.text.templates import template_text

    text = template_text(template)
    out = out or Path(f"{template}.toml")
    write_text(out, text)
    tell(f"Wrote {out}. Edit it, then: sweeps check {out}; sweeps plot {out}; sweeps run {out}")


@click.command("guide")
@click.argument("chapter", required=False)
@errors_as_messages
def guide_command(chapter: str | None) -> None:
    """Show a chapter of the guide, or list them all."""
    from sweeps.guide.chapters import chapter_text, chapters_text

    tell(chapters_text() if chapter is None else chapter_text(chapter))
