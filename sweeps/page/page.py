"""The report page: its parts, their order, and the file."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from engine import Verdict, counted
from sweeps.optimising.optimum import is_search, optimum_text
from sweeps.page import page_tables
from sweeps.page.digest import Digest
from sweeps.page.page_pictures import drawn_pictures, machines_data, variants_data
from sweeps.page.page_text import page_text
from sweeps.report.answers.unmet_conditions import no_answer_text
from sweeps.report.regime_words import MOTION_VERDICTS, failure_text
from sweeps.report.result_report import blame_lines, no_goal_text, tie_text, value_text
from sweeps.report.variant_warnings import result_warnings
from sweeps.text.whole_files import write_whole_text


def write_page(path: Path, out: Path) -> None:
    """Write the report of a result as one self-contained HTML page.

    It replaces an earlier page only when complete.

    Parameters
    ----------
    path : Path
        Result file, read in parts to bound memory.
    out : Path

    Raises
    ------
    InputError
        Jinja2 isn't installed, or the page can't be written.
    StoreError
        The result can't be read.
    """
    write_whole_text(out, page_text(_parts(Digest(path))))


def _parts(digest: Digest) -> dict[str, Any]:
    """Data for the template."""
    result, pictures = digest.result, drawn_pictures(digest)
    motion = machines_data(digest) if pictures.machine else None
    attributes = result.file.attributes
    return {
        "title": result.file.title,
        "question": result.question,
        "answer": _answer(digest),
        "remark": _remark(digest),
        "warnings": [*_warnings(digest), *pictures.complaints],
        "values": _filled(page_tables.value_tables(digest)),
        "words": optimum_text(result) if is_search(result) else "",
        "drawn": "The machine" if digest.is_one else f"The machine of variant {digest.drawn}",
        "drawings": pictures.machine,
        "limits": _filled(page_tables.limit_tables(digest)),
        "sensitivity": _filled(page_tables.sensitivity_tables(digest)),
        "sample": _sample_words(digest, len(motion["machines"]) if motion else 0),
        "still": pictures.variants,
        "motion": motion,
        "linked": None if digest.is_one else variants_data(digest),
        "leaders": None if digest.is_one else page_tables.leaders_table(digest),
        "errors": page_tables.errors_table(digest),
        "verdicts": page_tables.verdicts_table(digest),
        "provenance": page_tables.provenance_table(digest),
        "sources": [("Study", attributes.get("study", "")), ("Scene", attributes.get("scene", ""))],
    }


def _filled(tables: Iterable[tuple[str, page_tables.PageTable]]) -> list[tuple[str, page_tables.PageTable]]:
    """Captioned tables without the empty ones."""
    return [(words, table) for words, table in tables if table.rows]


# The answer


def _answer(digest: Digest) -> str:
    result, aim = digest.result, digest.aim
    if digest.is_one:
        verdict = next(iter(result.verdict_counts))
        if verdict in MOTION_VERDICTS:
            return failure_text(result.scene_of(0), verdict)
        if verdict == Verdict.OK:
            return "A single machine; its numbers are below."
        return f"No result: {': '.join([*blame_lines(result, verdict), verdict.sentence])}"
    if aim is None:
        return no_goal_text(result)
    condition = f" where {aim.condition}" if aim.where else ""
    if digest.best is None:
        return no_answer_text(result)
    value = value_text(result, aim.goal, digest.best)
    return f"{aim.word.capitalize()} {aim.goal}{condition}: {value}, variant {digest.best}."


def _remark(digest: Digest) -> str:
    if digest.is_one:
        return ""
    result = digest.result
    text = f"{result.verdict_counts[Verdict.OK]} of {result.file.variants} variants work."
    return f"{text} {result.count_meeting(digest.where)} meet the condition." if digest.where else text


def _sample_words(digest: Digest, moving: int) -> str:
    works, shown = digest.result.verdict_counts[Verdict.OK], digest.shown.size
    kinds = []
    if digest.leaders.size:
        met = " that meet the condition" if digest.aim.where else ""
        kinds.append(f"the best {digest.leaders.size}{met}")
    kinds += ["the front"] if digest.front.size else []
    text = f"{shown} of {works} variants that work: {', '.join([*kinds, ''])}{'and ' if kinds else ''}a random sample."
    if shown == works:
        text = f"All {works} variants that work."
    return f"{text} {moving} of them can be shown in motion." if moving else text


def _warnings(digest: Digest) -> list[str]:
    result, counts = digest.result, digest.result.verdict_counts
    best = [0] if digest.is_one else [] if digest.best is None else [digest.best]
    found = [*result.altered, *result_warnings(result, best)]
    if waiting := counts[Verdict.NOT_COMPUTED]:
        found.append(f"{counted(waiting, 'variant')} not computed yet: run the study again to resume.")
    if undecided := result.undecided(digest.where):
        found.append(f"For {counted(undecided, 'variant')} the condition is undecided within error estimates.")
    if digest.best is not None and (rivals := result.rivals(digest.best, digest.aim)):
        found.append(tie_text(rivals))
    failed = result.file.variants - sum(counts[v] for v in (Verdict.OK, Verdict.DROPPED, Verdict.NOT_COMPUTED))
    if failed and result.file.variants > 1:
        found.append(f"{counted(failed, 'variant')} without a result; see the verdicts.")
    coarse = [name for name, share in digest.worst_errors.items() if share > (result.accuracy or 0.01)]
    if coarse:
        share = "the requested accuracy" if result.accuracy else "1 %"
        found.append(f"Error estimates exceed {share} of the value in: {', '.join(coarse)}.")
    return found
