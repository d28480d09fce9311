"""Commands ended at random moments: by kill −9, and by the signals that ask a program to end."""

import os
import signal
import time

from bench import Bench, jobs

# Maximum time from a signal to the end [s], times the number of processes per core.
AT_ONCE = 1.0
# Share of kills after which the command runs to its end; else the next kill hits the resumed command.
LEFT_ALONE = 0.5


def load() -> float:
    """Number of processes ready to run per core, at least 1."""
    with open("/proc/loadavg") as file:
        running = int(file.read().split()[3].partition("/")[0])
    return max(running / (os.cpu_count() or 1), 1.0)


def kill(bench: Bench) -> None:
    """One kill −9: flagged blocks must be right and aren't recomputed; the final file equals that without a kill."""
    name = bench.dice.choice(list(jobs(bench)))
    job, wrong = jobs(bench)[name](), []
    bench.ready(job)
    before, _ = bench.done(job), bench.written(job)
    child = bench.begin(*job.arguments)
    time.sleep(bench.dice.uniform(0, 0.9 * bench.whole[job.name]))
    os.kill(child.pid, signal.SIGKILL)
    ended = child.end()
    wrong += bench.computed_twice(job, before)
    if (bench.work / job.result).exists():
        way = "after the end" if ended.code == 0 else "at the end, file complete"
        wrong += [] if bench.is_whole(job) else ["finished file differs"]
        bench.clear(job)
    else:
        way = "between blocks" if (bench.work / job.part).exists() else "before the file"
        if way == "between blocks" and not bench.is_left_right(job):
            wrong.append("a block flagged as done differs")
        if bench.dice.random() < LEFT_ALONE:
            wrong += bench.resumed(job)
            way += ", then resumed to the end"
    bench.note(f"kill −9: {name}", way, "; ".join(wrong))


def interrupt(bench: Bench) -> None:
    """SIGINT or SIGTERM, from Python's start to the last picture: one sentence and the exit code, at once."""
    names = ["run", "kept fields", "motion", "accuracy", "search", "report"]
    job, wrong = jobs(bench)[name := bench.dice.choice(names)](), []
    bench.ready(job)
    number, code = bench.dice.choice(((signal.SIGINT, 130), (signal.SIGTERM, 143)))
    # With pictures, which take about two seconds.
    line = tuple(word for word in job.arguments if word != "--no-plots")
    whole = bench.whole[job.name] + 2.0 * (name != "report")
    if own := bench.dice.random() < 0.2:
        child, whole = bench.process(*line), whole + 3.0
    else:
        child = bench.begin(*line)
    time.sleep(bench.dice.uniform(0, whole))
    alive, listens, busy = child.alive, child.alive and child.listens, load()
    used, begun = child.cpu, time.monotonic()
    os.kill(child.pid, number)
    ended = child.end()
    took, spent = time.monotonic() - begun, ended.cpu - used
    told = [text for text in ended.err.splitlines() if text.startswith("Interrupted: ")]
    if not alive:
        way = "after the end"
    elif ended.code == 0 and (bench.work / job.result).exists():
        way = "while Python ended, all done"
    elif not listens and ended.code in (-number, 1, 99):
        way = "before the program's first line"
    else:
        way = f"exit code {ended.code}"
        bench.most["longest from signal to end, s"] = max(bench.most["longest from signal to end, s"], took)
        bench.most["most processor time in it, s"] = max(bench.most["most processor time in it, s"], spent)
        limit = AT_ONCE * max(busy, load())
        if ended.code != code or len(told) != 1 or "Traceback" in ended.err or took > limit:
            wrong.append(f"exit code {ended.code} in {took:.2f} s, load {busy:.1f}: {ended.err[-200:]!r}")
        elif shown := [path.name for path in bench.work.glob(".*")]:
            wrong.append(f"drafts are left: {shown}")
    if (bench.work / job.part).exists() and not bench.is_left_right(job):
        wrong.append("a block flagged as done differs")
    if (bench.work / job.result).exists():
        wrong += [] if bench.is_whole(job) else ["finished file differs"]
        bench.clear(job)
    bench.note(f"SIGINT, SIGTERM{' from the start of Python on' if own else ''}", way, "; ".join(wrong))
