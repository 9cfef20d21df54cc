"""MuJoCo without its own warnings, which it prints or writes to a file in the working folder."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def quiet_mujoco() -> Iterator[None]:
    """Nothing is printed or written while this holds; what matters is checked by its callers."""
    import mujoco

    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda text: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
