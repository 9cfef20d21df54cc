"""A diagnosis on the page: the robot as recorded and as simulated, residuals as colours.

Comes in: the folder that `pdoik diagnose` wrote. Goes out: a page. `report.py` reads the folder,
`drawn_robot.py` makes links that can be coloured of the study's robot, `robot_copy.py` draws one of
the three robots, `viewer.py` is the page.
"""
