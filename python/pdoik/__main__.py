"""python -m pdoik: the command `pdoik`."""

from pdoik.cli import main

main()
