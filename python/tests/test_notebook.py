import json
import os
from pathlib import Path

import pytest

nbclient = pytest.importorskip("nbclient", reason="no nbclient (pip install 'cede[notebook]')")
pytest.importorskip("ipykernel", reason="no ipykernel (pip install 'cede[notebook]')")
pytest.importorskip("matplotlib", reason="no matplotlib (pip install 'cede[notebook]')")
import nbformat

PAPER = Path(__file__).parents[1] / "examples" / "paper.ipynb"


def run(folder):
    """The notebook after its run, with the recordings in `folder`."""
    environment = {**os.environ, "CEDE_INTERACTION_DIR": str(folder)}
    notebook = nbformat.read(PAPER, as_version=4)
    client = nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3")
    client.execute(env=environment)
    return notebook


def text(notebook):
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    return json.dumps(outputs)


def test_the_notebook_is_kept_without_outputs():
    cells = json.loads(PAPER.read_text())["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert all(not cell["outputs"] and cell["execution_count"] is None for cell in code)


def test_the_notebook_runs_without_recordings_and_says_so(tmp_path):
    said = text(run(tmp_path / "none"))
    assert "these are synthetic encounters" in said
    assert "image/png" in said


def test_the_notebook_runs_on_recordings():
    from test_data import recorded

    said = text(run(recorded()))
    assert "synthetic" not in said
    # The paper's 215 encounters.
    assert "215" in said
