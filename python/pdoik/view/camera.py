"""Where a page's camera begins: farther off on a narrow window, whose panel lies below."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import viser

FloatArray = npt.NDArray[np.float64]
View = tuple[FloatArray, FloatArray]  # looked at, and from where, (3,) each [m]

_FARTHEST = 2.2  # times as far
_WIDE = 1.3  # width over height from which nothing is done
_SAME = 1e-3  # [m]


class FittedCamera:
    """The view that pages begin with, fitted to each page's window until a hand moves it.

    The server's `initial_camera` is set, which is for a wide window.

    Args:
        server: Of the pages.
        look_at: What is in the middle, (3,) [m].
        position: Of the camera, (3,) [m].
        fov: Height of what it sees [rad].
    """

    def __init__(
        self,
        server: viser.ViserServer,
        look_at: npt.ArrayLike,
        position: npt.ArrayLike,
        fov: float,
    ) -> None:
        self._server, self._fov = server, fov
        self._placed: dict[int, View] = {}  # by the client's number
        server.initial_camera.fov = fov
        self._first = self._begin_with(look_at, position)
        server.on_client_connect(self._follow)
        server.on_client_disconnect(lambda client: self._forget(client.client_id))

    def go_to(self, look_at: npt.ArrayLike, position: npt.ArrayLike) -> None:
        """Move every page's camera there, and begin there from now on."""
        self._first = self._begin_with(look_at, position)
        for client in self._server.get_clients().values():
            self._place(client)

    def _begin_with(self, look_at: npt.ArrayLike, position: npt.ArrayLike) -> View:
        first = self._server.initial_camera
        first.look_at, first.position = np.array(look_at), np.array(position)
        return first.look_at, first.position

    def _follow(self, client: viser.ClientHandle) -> None:
        self._place(client)
        client.camera.on_update(lambda _: self._look_again(client))

    def _forget(self, client: int) -> None:
        self._placed.pop(client, None)

    def _look_again(self, client: viser.ClientHandle) -> None:
        """The window has another shape, or a page that loads slowly undid what was placed."""
        seen = client.camera.look_at, client.camera.position
        ours = self._first, self._placed.get(client.client_id, self._first)
        if any(np.allclose(seen, each, atol=_SAME) for each in ours):
            self._place(client)

    def _place(self, client: viser.ClientHandle) -> None:
        camera: Any = client.camera
        look_at, position = fitted(*self._first, self._fov, camera.aspect)
        self._placed[client.client_id] = look_at, position
        with client.atomic():
            camera.position = position
            camera.look_at = look_at


def fitted(look_at: FloatArray, position: FloatArray, fov: float, aspect: float) -> View:
    """The view of a picture of that width over height."""
    target, offset = look_at.astype(np.float64), position - look_at
    if aspect < _WIDE:
        offset = offset * min(_WIDE / aspect, _FARTHEST)
    return target, target + offset
