"""Runs the code of a notebook from its first cell to its last: notebook.py NOTEBOOK.ipynb"""

import json
import sys

import matplotlib

matplotlib.use("Agg")
with open(sys.argv[1]) as file:
    cells = json.load(file)["cells"]
exec("\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"))
