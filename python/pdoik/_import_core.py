"""Imports the compiled module, or says which Debian package a missing library is in."""

import re

# The libraries that _core loads, and the Debian 12 packages they are in (third_party/README.md).
_DEBIAN_PACKAGES = {
    "libpcl_common.so.1.13": "libpcl-common1.13",
    "libpcl_filters.so.1.13": "libpcl-filters1.13",
    "libpcl_kdtree.so.1.13": "libpcl-kdtree1.13",
    "liburdfdom_model.so.3.0": "liburdfdom-model3.0",
    "libconsole_bridge.so.1.0": "libconsole-bridge1.0",
    "libyaml-cpp.so.0.7": "libyaml-cpp0.7",
}


def _explain(error: ImportError) -> ImportError:
    """The error with what to install; the same error when no shared library is its cause."""
    missing = re.match(r"(lib\S+\.so[.\d]*): cannot open shared object file", str(error))
    if missing is None:
        return error
    library = missing[1]
    package = _DEBIAN_PACKAGES.get(library)
    cause = f"is in the Debian package {package}" if package else "is needed by pdoik's libraries"
    command = f"apt install {' '.join(sorted(_DEBIAN_PACKAGES.values()))}"
    return ImportError(
        f"{library} is missing; it {cause}. Everything pdoik loads, on Debian 12: {command}",
        name=error.name,
        path=error.path,
    )


try:
    from pdoik import _core  # noqa: F401
except ImportError as error:
    explained = _explain(error)
    if explained is error:
        raise
    raise explained from error
