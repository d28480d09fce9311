"""The notebooks of the gallery run, cell by cell, and come to the answer that their text claims."""

import json
from pathlib import Path

import numpy as np

GALLERY = Path(__file__).parents[3] / "results" / "gallery"


def run(name):
    """Run the cells of a notebook, and return its names."""
    notebook = json.loads((GALLERY / name).read_text(encoding="utf8"))
    names = {}
    for number, cell in enumerate(notebook["cells"]):
        if cell["cell_type"] == "code":
            # Outputs are made when it is opened; kept, they would differ from machine to machine.
            assert cell["outputs"] == []
            exec(compile("".join(cell["source"]), f"{name}, cell {number}", "exec"), names)
    return names


def test_hacksaw__has_stroke_and_ratio_with_every_rod(capsys):
    names = run("hacksaw.ipynb")
    summaries = names["outcome"].summaries
    assert (names["outcome"].status == 0).all()
    # Both are known to rounding by the closed form and by the ends of the stroke as measured.
    np.testing.assert_allclose(summaries["saw.stroke"], 0.150, rtol=1e-12)
    np.testing.assert_allclose(summaries["saw.stroke_time_ratio"], 1.4, rtol=1e-11)
    found = [m.least_transmission for m in names["machines"]]
    np.testing.assert_allclose(summaries["drive.transmission_angle"], found, rtol=1e-11)
    assert capsys.readouterr().out == "rod 175 mm: flywheel of 6.4 kg m²\n"


def test_every_notebook__has_a_test():
    assert [path.name for path in GALLERY.glob("*.ipynb")] == ["hacksaw.ipynb"]
