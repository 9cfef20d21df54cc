"""Where a page's camera begins: farther off on a narrow window, whose panel lies below."""

from __future__ import annotations

import numpy as np
import viser

_WIDE = 1.3  # width over height from which nothing is done


def fit_to_window(server: viser.ViserServer) -> None:
    """Do so for each page that is opened."""

    def fit(client: viser.ClientHandle) -> None:
        camera, first = client.camera, server.initial_camera
        if camera.aspect >= _WIDE:
            return
        look_at = np.asarray(first.look_at, dtype=np.float64)
        way = np.asarray(first.position, dtype=np.float64) - look_at
        way *= min(_WIDE / camera.aspect, 2.2)
        down = 0.5 * np.tan(camera.fov / 2) * float(np.linalg.norm(way))
        shift = np.array([0.0, 0.0, -down if camera.aspect < 1.0 else 0.0])
        with client.atomic():
            camera.position = look_at + way + shift
            camera.look_at = look_at + shift

    server.on_client_connect(fit)
