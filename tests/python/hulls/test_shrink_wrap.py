"""Laws of the capsules' descent: its gradients are those of what it lowers, and it lowers it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from pdoik._core import ShrinkWrap
from pdoik.occupancy_fit import Solid

SEED = 20250611
WORST = 0.015
Array = NDArray[np.float64]


def far_from_all(depth: float = -WORST) -> ShrinkWrap:
    """Of a solid that is as far from everywhere, and of random points."""
    points = np.random.default_rng(SEED).uniform(-0.1, 0.1, (500, 3))
    grid = np.full((4, 5, 6), depth)
    return ShrinkWrap(depth=grid, origin=[-0.2] * 3, edge=0.1, points=points, worst=WORST)


def gaps(capsules: Array, points: Array) -> Array:
    """How far each point is outside all capsules, (P,) [m]."""
    a, b, radius = capsules[:, :3], capsules[:, 3:6], capsules[:, 6]
    along = b - a
    length2 = np.maximum((along**2).sum(axis=1), 1e-18)
    t = np.clip(((points[:, None] - a) * along).sum(axis=2) / length2, 0, 1)
    away = points[:, None] - a - t[:, :, None] * along
    return np.asarray((np.linalg.norm(away, axis=2) - radius).min(axis=1))


def random_capsules(count: int) -> Array:
    rng = np.random.default_rng(SEED + 1)
    ends = rng.uniform(-0.1, 0.1, (count, 6))
    ends[0, 3:] = ends[0, :3]  # a ball
    return np.column_stack([ends, rng.uniform(0.005, 0.02, count)])


@pytest.mark.parametrize("multiplier", [0.0, 0.01])
def test_the_pull_of_points_is_the_gradient_of_their_part_of_the_lagrangian(
    multiplier: float,
) -> None:
    wrap, capsules, rho, h = far_from_all(), random_capsules(7), 2.0, 3e-5
    value, gradient = wrap.lack(capsules, multiplier, rho)
    points = np.random.default_rng(SEED).uniform(-0.1, 0.1, (500, 3))
    force = np.maximum(multiplier + rho * gaps(capsules, points), 0)
    assert value == pytest.approx(((force**2 - multiplier**2) / (2 * rho)).sum(), rel=1e-5)
    for k, i in np.ndindex(7, 7):
        of_ball = k == 0 and i < 6  # whose two ends move together
        steps = np.array([i % 3, i % 3 + 3] if of_ball else [i])
        step = np.zeros_like(capsules)
        step[k, steps] = h
        ahead, behind = (wrap.lack(capsules + sign * step, multiplier, rho)[0] for sign in (1, -1))
        expected = (ahead - behind) / (2 * h)
        assert gradient[k, steps].sum() == pytest.approx(
            expected, abs=2e-3 * np.abs(gradient).max()
        )


def test_the_integral_outside_grows_as_the_volume_of_two_balls_does() -> None:
    """Where every place is as far outside as the worst, the integrand is 2."""
    wrap, r, apart = far_from_all(), 0.05, 0.06
    balls = np.zeros((2, 7))
    balls[1, [0, 3]], balls[:, 6] = apart, r
    turns = np.linspace(0, 1, 64, endpoint=False)
    gradient = np.mean([wrap.outside_gradient(balls, turn) for turn in turns], axis=0)

    def volume(r: float, apart: float) -> float:
        lens = np.pi * (4 * r + apart) * (2 * r - apart) ** 2 / 12
        return float(8 / 3 * np.pi * r**3 - lens)

    h = 1e-6
    by_radius = (volume(r + h, apart) - volume(r - h, apart)) / (2 * h)
    by_place = (volume(r, apart + h) - volume(r, apart - h)) / (2 * h)
    assert gradient[:, 6].sum() == pytest.approx(2 * by_radius, rel=0.01)
    assert gradient[1, 0] + gradient[1, 3] == pytest.approx(2 * by_place, rel=0.02)
    assert gradient[0, 0] + gradient[0, 3] == pytest.approx(-2 * by_place, rel=0.02)
    assert np.abs(gradient[:, [1, 2, 4, 5]]).max() < 0.02 * by_place


def test_the_integral_outside_grows_as_a_capsule_does() -> None:
    wrap, length, r = far_from_all(), 0.1, 0.02
    gradient = wrap.outside_gradient(np.array([[0.0, 0, 0, 0, length, 0, r]]))[0]
    assert gradient[6] == pytest.approx(2 * (2 * np.pi * r * length + 4 * np.pi * r**2), rel=1e-5)
    assert gradient[4] == pytest.approx(2 * np.pi * r**2, rel=0.05)  # an end moves outwards
    assert gradient[1] == pytest.approx(-2 * np.pi * r**2, rel=0.05)


def test_what_is_inside_the_solid_costs_nothing() -> None:
    assert not far_from_all(depth=0.01).outside_gradient(random_capsules(5)).any()


def test_a_ball_becomes_a_rod_that_holds_a_bars_points_and_sticks_out_less() -> None:
    axis = np.stack([np.linspace(-0.1, 0.1, 400), np.zeros(400), np.zeros(400)], axis=1)
    angle = 2.4 * np.arange(400)
    points = axis + 0.02 * np.stack([0 * angle, np.cos(angle), np.sin(angle)], axis=1)
    x, y, z = np.meshgrid(*[np.arange(-0.2, 0.2, 5e-3)] * 3, indexing="ij")
    depth = np.minimum(0.02 - np.hypot(y, z), 0.1 - np.abs(x))
    wrap = ShrinkWrap(depth=depth, origin=[-0.2] * 3, edge=5e-3, points=points, worst=WORST)
    start = np.array([[-0.04, 0.01, 0, 0.04, 0, 0.01, 0.06]])
    moved = wrap.move(start, 400)
    assert gaps(moved, points).max() < 5e-4
    np.testing.assert_allclose(moved[0, 6], 0.022, atol=3e-3)
    np.testing.assert_array_equal(moved, wrap.move(start, 400))


def test_points_far_from_the_origin_are_held_as_closely() -> None:
    corners = np.array([[0.0, 0, 0], [0.08, 0, 0], [0, 0.05, 0], [0, 0, 0.04]])
    triangles = corners[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]
    start, away = random_capsules(4), np.array([30.0, -20.0, 10.0])
    found = []
    for shift in (np.zeros(3), away):
        solid = Solid.of(triangles)
        points = solid.landmarks(300)
        wrap = ShrinkWrap(
            depth=solid.depth,
            origin=solid.origin + shift,
            edge=solid.edge,
            points=points + shift,
            worst=WORST,
        )
        begun = start + np.concatenate([shift, shift, [0.0]])
        moved = wrap.move(begun, 5) - np.concatenate([shift, shift, [0.0]])
        found.append(moved)
    np.testing.assert_allclose(found[0], found[1], atol=1e-4)


def test_no_capsules_and_no_points_stay_as_they_are() -> None:
    assert far_from_all().move(np.zeros((0, 7)), 3).shape == (0, 7)
    bare = ShrinkWrap(
        depth=np.zeros((2, 2, 2)), origin=[0.0] * 3, edge=0.1, points=np.zeros((0, 3)), worst=WORST
    )
    np.testing.assert_array_equal(bare.move(random_capsules(3), 5), random_capsules(3))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"depth": np.zeros((3, 3))}, "depth has another shape"),
        ({"depth": np.zeros((1, 3, 3))}, "depth has 9 entries"),
        ({"edge": 0.0}, "edge is 0"),
        ({"worst": -1.0}, "worst -1"),
        ({"points": np.full((5, 3), np.nan)}, "must be finite"),
        ({"points": np.zeros((5, 4))}, "points has another shape"),
    ],
)
def test_bad_arguments_are_refused_by_name(arguments: dict[str, object], message: str) -> None:
    given: dict[str, object] = {
        "depth": np.zeros((3, 3, 3)),
        "origin": [0.0] * 3,
        "edge": 0.1,
        "points": np.zeros((5, 3)),
        "worst": WORST,
    }
    with pytest.raises(ValueError, match=message):
        ShrinkWrap(**(given | arguments))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "capsules", [np.zeros((3, 6)), np.zeros((2, 7)), np.full((1, 7), np.nan), np.full((1, 7), 1j)]
)
def test_bad_capsules_are_refused(capsules: NDArray[np.generic]) -> None:
    with pytest.raises((ValueError, TypeError), match="capsules"):
        far_from_all().move(capsules, 1)
