"""Which methods can be made on this computer."""

from collections.abc import Sequence
from pathlib import Path

from bench.common.commands import console
from bench.common.peer_library import build_peers
from bench.ik.experiment import Arm
from bench.ik.methods import COMPILED, Terms, make_method


def available(names: Sequence[str], build: Path) -> tuple[list[str], str]:
    """Those methods that can be made here, and where the compiled peers are.

    There is a line for each other method. The peers are built in CMake's folder `build`.
    """
    with console.status("building the peers"):
        libraries = build_peers(build)
    found = []
    for name in names:
        try:
            make_method(name, Arm.builtin("panda"), Terms(goal="pose"), libraries)
        except ImportError as error:
            console.print(f"without {name}: {error}", highlight=False)
            if name in COMPILED:
                raise
        else:
            found.append(name)
    return found, str(libraries)
