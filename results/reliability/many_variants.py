"""A study of very many variants: its peak memory, from the start of Python to the answer."""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

from sweeps.text.templates import template_text

_STUDY = """scene = "scene.toml"

[vary]
"input.length" = {{ from = "30 mm", to = "60 mm", count = {count} }}
"groups.drive.first.length" = {{ from = "150 mm", to = "300 mm", count = {count} }}

[outputs]
summaries = ["piston.stroke"]

[best]
maximise = "piston.stroke"
"""
# Interval between readings of the memory [s]; the system records the peak.
_LOOK = 0.05


def most_memory(variants: int) -> dict[str, float]:
    """Run a study of about `variants` variants; returns their number, the time [s] and peak memory [MB].

    Parameters
    ----------
    variants : int
        A file of 47 bytes each is made in the folder for temporary files, and removed.
    """
    count = round(variants**0.5)
    with tempfile.TemporaryDirectory(prefix="many-") as folder:
        Path(folder, "scene.toml").write_text(template_text("slider_crank"), encoding="utf8")
        Path(folder, "study.toml").write_text(_STUDY.format(count=count), encoding="utf8")
        line = [sys.executable, "-m", "sweeps", "run", "study.toml", "--no-plots", "--quiet"]
        begun, most = time.monotonic(), 0
        running = subprocess.Popen(line, cwd=folder, stdout=subprocess.PIPE, text=True)
        while running.poll() is None:
            most = max(most, _most_so_far(running.pid))
            time.sleep(_LOOK)
        said = running.stdout.read()
        if running.returncode or "Answer: " not in said:
            raise RuntimeError(f"the study of {variants} variants ended with {running.returncode}: {said}")
        megabytes = round(most * 1024 / 1e6)
        return {"variants": count**2, "seconds": round(time.monotonic() - begun), "megabytes": megabytes}


def _most_so_far(process: int) -> int:
    """Peak memory of a process so far [kB]."""
    try:
        lines = Path(f"/proc/{process}/status").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in lines if line.startswith("VmHWM")), 0)
