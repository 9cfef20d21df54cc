"""python -m pdoik.cli."""

from pdoik.cli import app

app(prog_name="pdoik")
