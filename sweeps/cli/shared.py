"""What the commands have in common: options, messages, files and threads."""

import json
import re
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import reduce, wraps
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sweeps.cli.waiting import clear_the_line, doing, waiting_told
from sweeps.text.visible import visible

if TYPE_CHECKING:
    from distributed import Client

WRONG_INPUT = 2
ALL_FAILED = 1
NOT_ALL_DONE = 1
DIFFERENT = 1

LONGEST_MESSAGE, LONGEST_WORD = 2900, 200

Command = Callable[..., None]


def tell(text: str, err: bool = False) -> None:
    """Write a text to the terminal as `visible` shows it."""
    clear_the_line()
    click.echo(visible(text), err=err)


def shown_message(message: str) -> str:
    """What a terminal is shown of a message: control characters are spelt out, a long one ends early."""
    message = visible(message)
    if len(message) <= LONGEST_MESSAGE:
        return message
    begin, _, cut_word = message[:LONGEST_MESSAGE].rpartition(" ")
    # Of a word as long as a message, its beginning is told too.
    begin = begin if len(cut_word) <= LONGEST_WORD else f"{begin} {cut_word[:LONGEST_WORD]}"
    return f"{begin.strip()} … (cut: {len(message)} characters)"


def fail(message: str, code: int = WRONG_INPUT) -> None:
    """Say what is wrong on standard error and stop."""
    tell(f"Error: {shown_message(message)}", err=True)
    sys.exit(code)


def errors_as_messages(command: Callable) -> Callable:
    """Turn what a user can cause into a message."""

    @wraps(command)
    def guarded(*args: object, **kwargs: object) -> None:
        try:
            with waiting_told():
                command(*args, **kwargs)
        except Exception as error:
            if not isinstance(error, _foreseen()):
                raise
            fail(str(error), _code_of(error))

    return guarded


def _code_of(error: Exception) -> int:
    from sweeps.run.cluster.cluster_errors import UnfinishedError

    return NOT_ALL_DONE if isinstance(error, UnfinishedError) else WRONG_INPUT


def _foreseen() -> tuple[type[Exception], ...]:
    """Errors whose text is meant for whoever gave the command; imported only when one occurs, as that is slow."""
    from engine import AskError, BalanceError, SceneError, TableError, UnitError
    from sweeps.pictures.picture_error import PictureError
    from sweeps.run.cluster.cluster_errors import ClusterError
    from sweeps.store import StoreError
    from sweeps.synthesis.synthesis_error import SynthesisError
    from sweeps.text.input_files import InputError

    of_engine = (AskError, BalanceError, SceneError, SynthesisError, TableError, UnitError)
    return (InputError, StoreError, *of_engine, PictureError, ClusterError)


CLUSTER = click.option(
    "--cluster",
    metavar="ADDRESS",
    help="Compute on the Dask cluster of this scheduler, tls://node1:8786 or tcp://node1:8786; local:8 starts eight "
    "processes here. Whoever reaches a scheduler at tcp:// can run programs on its workers, and its workers can run "
    "programs as you: name only those that you trust.",
)


def run_options(out: str) -> Callable:
    """Options of what makes a result file."""
    options = (
        click.option("--out", type=click.Path(path_type=Path), help=f"Result file; {out} unless given."),
        click.option("--restart", is_flag=True, help="Compute everything, and throw away an earlier result."),
        click.option("--replace", is_flag=True, help="Keep no former result of an edited study beside the new one."),
        click.option("--jobs", type=click.IntRange(min=1), help="Threads to use; all cores unless given."),
        CLUSTER,
        click.option("--no-plots", is_flag=True, help="Make no pictures."),
        click.option("--quiet", is_flag=True, help="No progress on standard error."),
    )
    return lambda command: reduce(lambda made, option: option(made), reversed(options), command)


SET = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="PATH=VALUE",
    help="A number of the scene, input.length='55 mm'; may be repeated.",
)
POSITIONS = click.option("--positions", type=int, help="Positions of fields over the cycle, an even number.")
ACCURACY = click.option("--accuracy", help="Allowed error of every summary, such as '0.1 %'.")
JSON = click.option("--json", "as_json", is_flag=True, help="Answer with JSON, in SI units.")


def study_options(command: Command) -> Command:
    """Options of what reads a study: numbers of its scene, its positions, its accuracy."""
    return SET(POSITIONS(ACCURACY(command)))


def tell_data(data: object) -> None:
    """Answer with JSON."""
    text = json.dumps(data, ensure_ascii=False, indent=2)
    # In JSON these have no short names.
    tell(re.sub("[\x7f-\x9f]", lambda found: f"\\u{ord(found[0]):04x}", text))


def stop_if_all_failed(status: Iterable[int]) -> None:
    """End with an exit code of its own where no variant has a result."""
    if all(status):
        sys.exit(ALL_FAILED)


def tell_version(context: click.Context, _: click.Parameter, asked: bool) -> None:
    """Say which version this is, and stop."""
    if asked:
        from sweeps.text.versions import own_version

        tell(f"sweeps, version {own_version()}")
        context.exit()


def tell_aside(sentence: str) -> None:
    """Say something on standard error that isn't what was asked for."""
    tell(sentence, err=True)


def tell_altered(file: Path | str) -> None:
    """Warn of texts of a result file that aren't as they were written."""
    from sweeps.report.sweep_result import SweepResult

    for sentence in SweepResult(Path(file)).altered:
        tell_aside(f"Warning: {sentence}")


def tell_files(made: list[Path], started: float) -> None:
    """Name the files made since an instant of `time.perf_counter`."""
    tell(f"Files ({time.perf_counter() - started:.1f} s):")
    tell("\n".join(f"  {path}" for path in made))


def plots_of(result: object) -> list[Path]:
    """Make the pictures of a result; what can't be drawn is said on standard error."""
    from sweeps.pictures.picture_error import PictureError
    from sweeps.pictures.sweep import result_pictures

    try:
        with doing("Drawing the pictures"):
            return result_pictures.result_pictures(result)
    except PictureError as error:
        tell(f"No picture: {error}", err=True)
        return []


def names_in(text: str) -> tuple[str, ...]:
    """Names separated by commas."""
    return tuple(n.strip() for n in text.split(",") if n.strip())


def use_threads(jobs: int | None) -> None:
    """Let kernels use so many threads; all cores unless given."""
    if jobs is not None:
        from engine import set_threads

        set_threads(jobs)


@contextmanager
def cluster_client(address: str | None, jobs: int | None = None) -> Iterator["Client | None"]:
    """A client of the cluster that a command is to compute on; None without one.

    Raises
    ------
    ClusterError
        There is no such cluster, or it isn't for this command to say how many threads it uses.
    """
    if address is None:
        yield None
        return
    from sweeps.run.cluster.cluster_errors import ClusterError
    from sweeps.run.cluster.connecting import connected

    if jobs is not None and not address.startswith("local"):
        raise ClusterError("--jobs: workers use the threads they were started with, `dask worker --nthreads 8`")
    with connected(address) as client:
        yield client


def workers_text(client: "Client | None") -> str:
    """How many workers of a cluster compute for this program; nothing without one, or where that can't be had."""
    if client is None:
        return ""
    try:
        count = sum(any(key in client.futures for key in keys) for keys in client.processing().values())
    except OSError:
        # That the scheduler is lost is told where something is asked of it.
        return ""
    return f"{count} worker{'' if count == 1 else 's'}"


def make_folder(path: Path) -> None:
    """Make the folder that a file goes to.

    Raises
    ------
    InputError
        It can't be made.
    """
    from sweeps.text.input_files import InputError

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(str(path.parent), [(None, "", f"can't be made: {error.strerror}")]) from None


def write_text(path: Path, text: str) -> None:
    """Write a text file, but not over one that is there, which a person may have written.

    Raises
    ------
    InputError
        There is one, or it can't be written.
    """
    from sweeps.text.input_files import InputError
    from sweeps.text.whole_files import whole_file

    if path.exists():
        raise InputError(str(path), [(None, "", "exists already; name another file with --out")])
    make_folder(path)
    try:
        with whole_file(path) as draft:
            draft.write_text(text, encoding="utf8")
    except OSError as error:
        raise InputError(str(path), [(None, "", f"can't be written: {error.strerror}")]) from None
