import json
import os
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

from tests.export.conftest import write_notebook

SHOW = (
    "from ipykernel.connect import get_connection_info\nprint(get_connection_info(unpack=True)['transport'])"
)


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="sockets in files")
def test_test_kernel_uses_ipc_instead_of_a_port(tmp_path: Path) -> None:
    path = write_notebook(tmp_path / "a.ipynb", [SHOW])
    notebook = nbformat.reads(path.read_text(), 4)
    NotebookClient(notebook).execute()
    assert "ipc" in json.dumps(notebook.cells[0].outputs)
