"""Where and with what a measurement was made."""

from __future__ import annotations

import os
import platform
import subprocess
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from bench.common.peer_library import ROOT
from pdoik.reports import this_build


def provenance(folder: Path) -> dict[str, str]:
    """Machine, load, compiler, flags, versions and commit.

    Args:
        folder: CMake's folder, which knows the compiler and its flags.
    """
    cache, build = _cmake_cache(folder), this_build()
    load = os.getloadavg()[0]
    return {
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "processor": build["processor"],
        "processors": str(os.cpu_count()),
        "load before": f"{load:.2f}"
        + (" (other programs were running: times are noisy)" if load > 0.5 else ""),
        "system": f"{_system()}, Linux {platform.release()}",
        "compiler": _first_line(cache.get("CMAKE_CXX_COMPILER", "c++"), "--version"),
        "build": cache.get("CMAKE_BUILD_TYPE", "Release") or "Release",
        "flags": cache.get("CMAKE_CXX_FLAGS_RELEASE", ""),
        "kernels": build["simd"],
        "python": build["python"],
        **{name: _version(name) for name in ("pdoik", "pin", "numpy")},
        "liborocos-kdl-dev": _first_line(
            "dpkg-query", "-W", "-f", "${Version}", "liborocos-kdl-dev"
        ),
        "commit": _first_line("git", "-C", str(ROOT), "describe", "--always", "--dirty"),
    }


def _cmake_cache(build: Path) -> dict[str, str]:
    path = build / "CMakeCache.txt"
    lines = path.read_text().splitlines() if path.is_file() else []
    entries = (line.split("=", 1) for line in lines if ":" in line and "=" in line)
    return {name.split(":")[0]: value for name, value in entries}


def _system() -> str:
    return platform.freedesktop_os_release().get("PRETTY_NAME", platform.system())


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "none"


def _first_line(*command: str) -> str:
    try:
        output = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    except OSError:
        return "unknown"
    return output.splitlines()[0].strip() if output.strip() else "unknown"
