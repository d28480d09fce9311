"""Shared by the commands: options, messages, files and threads."""

import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import reduce, wraps
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING

import click

import engine
from sweeps.cli import needed
from sweeps.cli.waiting import clear_the_line, doing, status_line
from sweeps.text.input_files import InputError, files_read, read_text
from sweeps.text.versions import own_version
from sweeps.text.visible import visible

if TYPE_CHECKING:
    from distributed import Client

    from sweeps.report.sweep_result import SweepResult

WRONG_INPUT = 2
NO_ANSWER = 1
NOT_ALL_DONE = 1
DIFFERENT = 1
DAMAGED = 1

LONGEST_MESSAGE, LONGEST_WORD = 2900, 200

Command = Callable[..., None]


def tell(text: str, err: bool = False) -> None:
    """Print a text with `visible` control characters."""
    clear_the_line()
    click.echo(visible(text), err=err)


def shown_message(message: str) -> str:
    """A message for the terminal: control characters spelled out, long messages cut."""
    message = visible(message)
    if len(message) <= LONGEST_MESSAGE:
        return message
    begin, _, cut_word = message[:LONGEST_MESSAGE].rpartition(" ")
    # A single word of this length is cut, not dropped.
    begin = begin if len(cut_word) <= LONGEST_WORD else f"{begin} {cut_word[:LONGEST_WORD]}"
    return f"{begin.strip()} … (cut: {len(message)} characters)"


class Commands(click.Group):
    """A group of commands that turns user errors into messages."""

    def make_context(self, *args: object, **extra: object) -> click.Context:
        """Parse the options before the command."""
        with _legible():
            return super().make_context(*args, **extra)

    def invoke(self, ctx: click.Context) -> object:
        """Run the command of a command line."""
        with files_read() as files:
            try:
                with status_line(), _legible():
                    return super().invoke(ctx)
            except engine.UserError as error:
                print_on_stderr(f"Error: {shown_message(str(_in_its_file(error, files)))}")
                sys.exit(NOT_ALL_DONE if isinstance(error, needed.UnfinishedError) else WRONG_INPUT)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands with their whole first sentences."""
        commands = {name: self.get_command(ctx, name) for name in self.list_commands(ctx)}
        with formatter.section("Commands"):
            formatter.write_dl([(name, command.get_short_help_str(sys.maxsize)) for name, command in commands.items()])

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command that a command line names; an unknown name fails with the list of commands."""
        if args and self.get_command(ctx, args[0]) is None:
            names = self.list_commands(ctx)
            ctx.fail(engine.unknown_name_message(args[0], names, f"{args[0]!r} is not a command"))
        return super().resolve_command(ctx, args)


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(own_version(), message="sweeps %(version)s", help="Version.")
def main() -> None:
    """Evaluate planar machines over many design variants: kinematics, reduced inertia and torque, flywheels.

    Start with `sweeps list`, then `sweeps run crank_press`; `sweeps new slider_crank` writes a scene of your own.

    \b
    The Tab key completes commands and options after this line in the shell's start-up file:
      ~/.bashrc                   eval "$(_SWEEPS_COMPLETE=bash_source sweeps)"
      ~/.zshrc                    eval "$(_SWEEPS_COMPLETE=zsh_source sweeps)"
      ~/.config/fish/config.fish  _SWEEPS_COMPLETE=fish_source sweeps | source
    Editors complete scenes and studies after `sweeps schema`.
    """  # noqa: D301


def joints_by_letter(command: Command) -> Command:
    """Accept the letter of a joint as the name of its force in the command's options, `A.reaction.peak`."""

    @wraps(command)
    def asked(file: str | Path, **options: object) -> None:
        for name in ("where", "sort", "columns", "x", "y", "colour"):
            if ".reaction" in str(options.get(name)):
                options[name] = needed.with_full_joint_names(str(file), options[name])
        command(file=file, **options)

    return asked


class Options(SimpleNamespace):
    """The argument and options of a command, by their names."""


def in_options(command: Command) -> Command:
    """Pass a command its argument and options as one record."""

    @wraps(command)
    def gathered(**asked: object) -> None:
        command(Options(**asked))

    return gathered


@contextmanager
def _legible() -> Iterator[None]:
    """Show click's own errors, which quote the command line, as `shown_message` does."""
    try:
        yield
    except click.UsageError as error:
        error.message = shown_message(error.message)
        raise


def _in_its_file(error: Exception, files: Iterable[Path]) -> Exception:
    """An error, with file and line if a scene turns out to be invalid only when it is computed."""
    # Only a wrong scene has loaded the slow class.
    if isinstance(error, InputError) or not isinstance(error, engine.SceneError):
        return error
    texts = {path: read_text(path) for path in [*files] if path.suffix == ".toml"}
    if not texts:
        return error
    scenes = [path for path, text in texts.items() if needed.is_scene(needed.parse_toml(text, path.name))]
    if len(scenes) > 1:
        # Any of them may be at fault.
        return error
    path, prefix = (scenes[0], ()) if scenes else (next(iter(texts)), ("scene",))
    return InputError(path.name, needed.problems_in(texts[path], error.problems, prefix))


CLUSTER = click.option(
    "--cluster",
    metavar="ADDRESS",
    help="Compute on the Dask cluster of this scheduler, tls://node1:8786 or tcp://node1:8786; local:8 starts eight "
    "processes here. Anyone who can reach a tcp:// scheduler can run programs on its workers, and they can run "
    "programs as you: use only clusters you trust.",
)


class WholeNumber(click.ParamType):
    """Whole numbers within limits.

    Parameters
    ----------
    least : int
    most : int, optional
    """

    name = "number"

    def __init__(self, least: int, most: int | None = None) -> None:
        self.least, self.most = least, most

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """The number; otherwise click's error."""
        text = str(value).strip()
        number = int(text) if re.fullmatch("-?[0-9]{1,18}", text) else None
        if number is None or number < self.least or (self.most is not None and number > self.most):
            limits = f"of at least {self.least}" if self.most is None else f"from {self.least} to {self.most}"
            self.fail(f"{text!r} is not a whole number {limits}", param, ctx)
        return number


def with_options(*options: Callable) -> Callable:
    """Several options as one decorator."""
    return lambda command: reduce(lambda made, option: option(made), reversed(options), command)


def run_options(out: str) -> Callable:
    """Options of commands that make a result file."""
    return with_options(
        click.option("--out", type=click.Path(path_type=Path), help=f"Result file (default: {out})."),
        click.option("--restart", is_flag=True, help="Discard earlier results and compute everything."),
        click.option("--replace", is_flag=True, help="Replace the former result of an edited study."),
        click.option("--jobs", type=WholeNumber(1), help="Threads to use (default: all cores)."),
        CLUSTER,
        click.option("--no-plots", is_flag=True, help="Skip the plots."),
        click.option("--quiet", is_flag=True, help="Hide progress."),
    )


SET = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="PATH=VALUE",
    help="Set a number of the scene, input.length='55 mm'; repeatable.",
)
WHERE = click.option(
    "--where",
    multiple=True,
    metavar="CONDITION",
    help="Only variants of a result that meet this condition, such as 'wheel_mass < 900 kg and input.length > 40 mm'; "
    "repeatable.",
)


def _ascending(_: click.Context, __: click.Parameter, column: str | None) -> str | None:
    if column and column.startswith("-"):
        raise click.BadParameter(f"{column!r}: for the largest first, --sort {column[1:]} --descending")
    return column


def _sorted(context: click.Context, _: click.Parameter, descending: bool) -> bool:
    if descending and not context.params.get("sort"):
        raise click.BadParameter("needs a column to sort by, such as --sort required_power")
    return descending


ORDER = with_options(
    click.option("--sort", help="Column to sort by.", callback=_ascending, is_eager=True),
    click.option("--descending", is_flag=True, help="Descending order.", callback=_sorted),
)
POSITIONS = click.option("--positions", type=WholeNumber(0), help="Number of field positions per cycle, even.")
ACCURACY = click.option("--accuracy", help="Tolerance of every summary, such as '0.1 %'.")
# Of commands that read a study.
study_options = with_options(SET, POSITIONS, ACCURACY)


ERRORS = click.option(
    "--errors",
    is_flag=True,
    expose_value=False,
    callback=lambda _, __, every: engine.show_errors(every),
    help="Show all error estimates, not only those that matter (above 1e-6 of the value, or deciding a condition or a "
    "tie).",
)
ALL = click.option(
    "--all", "every", is_flag=True, help="Show all results: also further ones, checks, and derived helper numbers."
)
JSON = click.option("--json", "as_json", is_flag=True, help="JSON output in SI units.")


def tell_data(data: object) -> None:
    """Print JSON."""
    text = json.dumps(data, ensure_ascii=False, indent=2)
    # Their str() would be ambiguous in JSON.
    tell(re.sub("[\x7f-\x9f]", lambda found: f"\\u{ord(found[0]):04x}", text))


def stop_without_answer(result: "SweepResult") -> None:
    """Exit with a special code if no variant has a result, or none meets the conditions of the question."""
    works = result.verdict_counts[engine.Verdict.OK]
    if not works or (result.aim is not None and result.file.variants > 1 and result.best(result.aim) is None):
        sys.exit(NO_ANSWER)


def print_on_stderr(sentence: str) -> None:
    """Print a remark on standard error."""
    tell(sentence, err=True)


def tell_altered(file: Path | str) -> None:
    """Warn of modified texts in a result file."""
    for sentence in needed.SweepResult(Path(file)).altered:
        print_on_stderr(f"Warning: {sentence}")


def warnings_of(result: "SweepResult") -> list[str]:
    """Warnings on the variants that answer the question of a result."""
    return needed.result_warnings(result, needed.answering(result))


def tell_warnings(result: "SweepResult") -> None:
    """Print the warnings on the answer of a result."""
    for warning in warnings_of(result):
        tell(f"Warning: {warning}")


def pictures_beside(out: Path) -> list[Path]:
    """Pictures and pages of a result."""
    others = [file.stem for file in out.parent.glob("*.h5") if file.stem.startswith(f"{out.stem}_")]
    return [
        file
        for file in sorted(out.parent.iterdir())
        if file.suffix in (".html", ".png", ".svg", ".pdf", ".gif")
        and f"{file.stem}_".startswith(f"{out.stem}_")
        and not any(f"{file.stem}_".startswith(f"{other}_") for other in others)
    ]


def tell_outdated(out: Path, made: list[Path]) -> None:
    """Report pictures and pages of a result that are older than its numbers."""
    older = [f for f in pictures_beside(out) if f not in made and f.stat().st_mtime < out.stat().st_mtime]
    if older:
        names = ", ".join(file.name for file in older)
        print_on_stderr(f"Older than {out}: {names}; `sweeps plot` and `sweeps report` remake them.")


def plots_of(result: "SweepResult", study: Path) -> list[Path]:
    """Plot a result, unless its plots are newer than it and its study; report on standard error what can't be drawn."""
    # The plot of the sweep, or of the only machine, is drawn last.
    last, newest = result.path.with_suffix(".png"), max(file.stat().st_mtime for file in (result.path, study))
    if last.exists() and last.stat().st_mtime > newest:
        return [
            file for file in pictures_beside(result.path) if file.suffix == ".png" and file.stat().st_mtime > newest
        ]
    try:
        with doing("Drawing the pictures"):
            return needed.result_pictures(result)
    except needed.PictureError as error:
        tell(f"No plot: {error}", err=True)
        return []


def names_in(text: str) -> tuple[str, ...]:
    """Names separated by commas."""
    return tuple(n.strip() for n in text.split(",") if n.strip())


@contextmanager
def cluster_client(address: str | None, jobs: int | None = None) -> Iterator["Client | None"]:
    """Client of the command's cluster, or None.

    Raises
    ------
    ClusterError
        There is no such cluster, or --jobs was given with it.
    """
    if address is None:
        yield None
        return
    if jobs is not None and not address.startswith("local"):
        raise needed.ClusterError("--jobs: workers use the threads they were started with, `dask worker --nthreads 8`")
    with needed.connected(address) as client:
        yield client


def workers_text(client: "Client | None") -> str:
    """Number of workers, as a text; "" if unknown or without a cluster."""
    if client is None:
        return ""
    try:
        count = sum(any(key in client.futures for key in keys) for keys in client.processing().values())
    except OSError:
        # A lost scheduler is reported where it is used.
        return ""
    return engine.counted(count, "worker")


def write_text(path: Path, text: str, replace: bool = False, mend: str = "name another file with --out") -> None:
    """Write a text file.

    Parameters
    ----------
    path : Path
    text : str
    replace : bool
        Whether an existing file is overwritten; a person may have written it.
    mend : str
        What to do where it isn't.

    Raises
    ------
    InputError
        The file exists or can't be written.
    """
    if path.exists() and not replace:
        raise InputError.of(str(path), f"exists already; {mend}")
    needed.write_whole_text(path, text)
