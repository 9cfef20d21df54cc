"""Small problem sets in the layouts that others publish, written by the tests."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import yaml

PANDA_JOINTS = [f"panda_joint{k}" for k in range(1, 8)]
READY = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]


def collision_object(name: str, kind: Any, dimensions: list[float], at: list[float]) -> Any:
    """A moveit_msgs/CollisionObject of one primitive."""
    return {
        "header": {"frame_id": "panda_link0"},
        "id": name,
        "primitives": [{"type": kind, "dimensions": dimensions}],
        "primitive_poses": [{"position": at, "orientation": [0, 0, 0, 1]}],
    }


def planning_scene() -> dict[str, Any]:
    """A box, a can by its number, a sphere, a cone, a mesh in two poses, and a plane."""
    tetrahedron = {
        "vertices": [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]],
        "triangles": [
            {"vertex_indices": corners} for corners in ([0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3])
        ],
    }
    return {
        "name": "scene",
        "robot_model_name": "panda",
        "fixed_frame_transforms": [
            {
                "header": {"frame_id": "world"},
                "child_frame_id": "table_frame",
                "transform": {"translation": [0, 0, 0.5], "rotation": [0, 0, 0, 1]},
            }
        ],
        "allowed_collision_matrix": {
            "entry_names": ["panda_hand", "panda_link7", "shelf"],
            "entry_values": [[False, True, True], [True, False, False], [True, False, False]],
        },
        "world": {
            "collision_objects": [
                collision_object("shelf", "box", [0.4, 0.6, 0.04], [0.8, 0, 0.3]),
                collision_object("can", 3, [0.14, 0.03], [0.7, 0, 0.4]),
                collision_object("ball", "SPHERE", [0.05], [0.7, 0.2, 0.4]),
                collision_object("cone", 4, [0.2, 0.05], [0.7, -0.2, 0.4]),
                {
                    "header": {"frame_id": "table_frame"},
                    "id": "table",
                    "pose": {"position": {"x": 1, "y": 0, "z": 0}, "orientation": [0, 0, 0, 1]},
                    "primitives": [{"type": 1, "dimensions": [0.2, 0.2, 0.2]}],
                    "primitive_poses": [{"position": [0, 0, 0.1]}],
                },
                {
                    "id": "chips",
                    "meshes": [tetrahedron, tetrahedron],
                    "mesh_poses": [{"position": [0.9, 0, 0.8]}, {"position": [0.9, 0.3, 0.8]}],
                },
                {"id": "floor", "planes": [{"coef": [0, 0, 2, 2]}]},
            ]
        },
    }


def request(q: list[float] | None = None) -> dict[str, Any]:
    """A moveit_msgs/MotionPlanRequest whose goal is a configuration."""
    return {
        "group_name": "panda_arm",
        "start_state": {"joint_state": {"name": PANDA_JOINTS, "position": [0.0] * 7}},
        "goal_constraints": [
            {
                "joint_constraints": [
                    {"joint_name": name, "position": value, "weight": 1}
                    for name, value in zip(PANDA_JOINTS, q or READY, strict=True)
                ]
            }
        ],
    }


def write_moveit(folder: Path, scene: Any, asked: Any, number: int = 1) -> Path:
    """scene0001.yaml and request0001.yaml in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"scene{number:04d}.yaml").write_text(yaml.safe_dump(scene))
    (folder / f"request{number:04d}.yaml").write_text(yaml.safe_dump(asked))
    return folder


def vamp_sets() -> dict[str, Any]:
    """VAMP's problems of one robot."""
    turned = [0.0, 0.0, float(np.sin(0.3)), float(np.cos(0.3))]
    return {
        "robot": "panda",
        "joints": PANDA_JOINTS,
        "problems": {
            "box": [
                {
                    "index": 1,
                    "problem": "box",
                    "valid": True,
                    "start": [0.0] * 7,
                    "goals": [READY],
                    "sphere": [{"name": "ball", "radius": 0.1, "position": [1, 0, 0]}],
                    "cylinder": [
                        {
                            "name": "can",
                            "radius": 0.03,
                            "length": 0.14,
                            "position": [0.7, 0, 0.2],
                            "orientation_euler_xyz": [0.0, 0.0, 0.6],
                        }
                    ],
                    "box": [
                        {
                            "name": "wall",
                            "half_extents": [0.1, 0.2, 0.3],
                            "position": [0.9, 0, 0.3],
                            "orientation_euler_xyz": [9.0, 9.0, 9.0],
                            "orientation_quat_xyzw": turned,
                        }
                    ],
                }
            ]
        },
    }


def write_vamp(path: Path) -> Path:
    """problems.json."""
    path.write_text(json.dumps(vamp_sets()))
    return path


def write_pcd(path: Path, rows: list[list[float]], fields: str) -> Path:
    """An ASCII point cloud with these fields."""
    names = fields.split()
    header = [
        "# .PCD v0.7 - Point Cloud Data file format",
        "VERSION 0.7",
        f"FIELDS {fields}",
        "SIZE" + " 4" * len(names),
        "TYPE" + " F" * len(names),
        "COUNT" + " 1" * len(names),
        f"WIDTH {len(rows)}",
        "HEIGHT 1",
        "VIEWPOINT 0 0 0 1 0 0 0",
        f"POINTS {len(rows)}",
        "DATA ascii",
    ]
    lines = [" ".join(f"{value:.8g}" for value in row) for row in rows]
    path.write_text("\n".join([*header, *lines]) + "\n")
    return path
