"""python -m pdoik.cli."""

from pdoik.cli import main

main()
