"""The tab with the robot, its tip, its hulls, the cloud and the scene, from files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import viser

import pdoik

if TYPE_CHECKING:
    from ..page import Page

EVERY_LEAF, SEVERAL = "all end links", "several"


class FilesTab:
    """Robots shipped and uploaded, tip, hulls (read or fitted), clouds, scenes."""

    def __init__(self, gui: viser.GuiApi, page: Page) -> None:
        self._page = page
        builtin = pdoik.Robot.builtin_names()
        self.robot: Any = gui.add_dropdown("Robot", ("from a file", *builtin))
        self.robot.on_update(self._robot_chosen)
        self.urdf = gui.add_upload_button("Robot (.urdf)", icon=viser.Icon.UPLOAD)
        self.urdf.on_upload(lambda event: page.take_urdf(event.target.value))
        self.tip: Any = gui.add_dropdown("Tip link", (EVERY_LEAF,))
        self.tip.on_update(self._tip_chosen)
        self.hulls = gui.add_upload_button("Collision model (.yaml)", icon=viser.Icon.UPLOAD)
        self.hulls.on_upload(lambda event: page.take_hulls(event.target.value))
        self.fit = gui.add_button(
            "Fit collision model",
            hint="Around the URDF's geometry; takes a while",
            visible=False,
        )
        self.fit.on_click(lambda _: page.fit_hulls())
        self.cloud = gui.add_upload_button("Point cloud (.pcd .ply ...)", icon=viser.Icon.UPLOAD)
        self.cloud.on_upload(lambda event: page.take_cloud(event.target.value))
        self.no_cloud = gui.add_button("Remove point cloud")
        self.no_cloud.on_click(lambda _: page.drop_cloud())
        self.scene = gui.add_upload_button(
            "Scene (.yaml .scene .xml .sdf .bt)", icon=viser.Icon.UPLOAD
        )
        self.scene.on_upload(lambda event: page.take_scene(event.target.value))
        self.no_shapes = gui.add_button("Remove shapes")
        self.no_shapes.on_click(lambda _: page.drop_shapes())

    def show(self, robot: pdoik.Robot, *, from_file: bool) -> None:
        """Follow the robot that is there now."""
        self.robot.value = "from a file" if from_file else robot.name
        links = tuple(robot.link_names[1:]) if from_file else tuple(robot.tip_links)
        many = EVERY_LEAF if from_file else SEVERAL
        self.tip.options = (many, *links)
        self.tip.value = many if len(robot.tip_links) > 1 else robot.tip_links[0]
        self.tip.disabled = not from_file
        self.fit.visible = from_file and not len(robot.occupancy)

    def _robot_chosen(self, event: viser.GuiEvent[Any]) -> None:
        if event.client is not None:  # a hand, not `show`
            self._page.take_builtin(self.robot.value)

    def _tip_chosen(self, event: viser.GuiEvent[Any]) -> None:
        if event.client is not None:
            self._page.take_tip(None if self.tip.value == EVERY_LEAF else self.tip.value)
