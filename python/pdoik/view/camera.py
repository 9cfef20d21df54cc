"""Where a page's camera begins: farther off on a narrow window, whose panel lies below."""

from __future__ import annotations

import time

import numpy as np
import numpy.typing as npt
import viser

_FARTHEST = 2.2  # times as far
_PATIENCE = 20.0  # with a page that loads slowly [s]
_WIDE = 1.3  # width over height from which nothing is done


def fit_to_window(server: viser.ViserServer) -> None:
    """Do so for each page that is opened."""

    def fit(client: viser.ClientHandle) -> None:
        if client.camera.aspect >= _WIDE:
            return
        first = server.initial_camera
        deadline = time.monotonic() + _PATIENCE
        look(client, first.look_at, first.position)

        def again(camera: viser.CameraHandle) -> None:  # a page that loads slowly may undo it
            nearer = np.allclose(camera.position, first.position, atol=1e-3)
            if nearer and time.monotonic() < deadline:
                look(client, first.look_at, first.position)

        client.camera.on_update(again)

    server.on_client_connect(fit)


def look(client: viser.ClientHandle, look_at: npt.ArrayLike, position: npt.ArrayLike) -> None:
    """Move a page's camera there, (3,) each [m], as its window needs it."""
    camera = client.camera
    target = np.array(look_at, dtype=np.float64)
    way = np.array(position, dtype=np.float64) - target
    if camera.aspect < _WIDE:
        way *= min(_WIDE / camera.aspect, _FARTHEST)
    if camera.aspect < 1.0:
        target[2] -= 0.5 * np.tan(camera.fov / 2) * float(np.linalg.norm(way))
    with client.atomic():
        camera.position = target + way
        camera.look_at = target
