"""A trot in place: diagonal pairs of legs lift in turn, feet land where the speed asks for them."""

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline

from bench.sim2real.legged.legs import UPRIGHT, Legs
from bench.sim2real.legged.postures import GRID, State, home, sines
from bench.sim2real.legged.spec import Array

PAIRS = np.array([0.0, 0.5, 0.5, 0.0])  # phases of FL FR RL RR
START = 1.0  # it stands until then [s]
CAPTURE = 0.12  # a foot lands this much further ahead for each m/s too fast [s]
RETURN = (0.8, 1.0)  # speed back to the origin and ahead [1/s]
LEVEL = 0.6  # of the trunk's tilt, by which legs on the low side are longer
EARLY = 0.85  # share of the flight by which a foot is commanded to be down: legs lag behind
LANDING = 0.1  # of the cycle, over which a foot that landed is commanded to stand
STEPPING = 0.15  # of the cycle, over which a foot's load comes and goes


class Trot:
    """Commands the joints of a quadruped that steps in place."""

    def __init__(self, legs: Legs, seconds: float, rng: np.random.Generator) -> None:
        """Draws frequency, lift and a slow wandering of the trunk."""
        self.legs, self.robot, self.end = legs, legs.robot, seconds
        self.frequency = float(rng.uniform(1.2, 2.0))
        self.lift = float(rng.uniform(0.04, 0.08))
        self.duty = float(rng.uniform(0.56, 0.64))
        base, feet = home(self.robot)
        self._below = feet - base[:3]  # feet under the trunk, in its frame
        time = np.arange(0.0, seconds + GRID, GRID)
        sizes = [0.06, 0.05, 0.012, 0.02, 0.02, 0.15]  # speeds x y, height, roll, pitch, turn
        self._wish = CubicSpline(
            time, np.array([sines(rng, time, [(0.1, 0.4, size)]) for size in sizes]).T
        )
        self._q = legs.solved(UPRIGHT, self.robot.rest.copy(), self._below, steps=15)
        self._offset = np.zeros((4, 2))  # of the feet about their places, level frame [m]
        self._lifted = np.zeros((4, 2))  # the same when the foot left the ground
        self._torque = legs.torque(np.ones(4))
        self._count = 0
        self._before, self._dq = -1.0, np.zeros(self.robot.n)

    def command(self, t: float, state: State) -> Array:
        """Position (n,) that is sent."""
        dt = t - self._before if self._before >= 0.0 else 0.0
        self._before = t
        wish = self._wish(min(t, self.end))
        fade = float(np.clip((t - START) / 1.0, 0.0, 1.0))
        roll, pitch, yaw = angles(state.base[3:])
        c, sn = np.cos(yaw), np.sin(yaw)
        level = np.array([[c, sn], [-sn, c]])  # from the world to ahead and left
        speed = level @ state.velocity[:2]
        asked = fade * wish[:2] - RETURN[0] * (level @ state.base[:2])
        spin = fade * wish[5] - RETURN[1] * yaw
        phase = (self.frequency * max(t - START, 0.0) + PAIRS) % 1.0
        swing = 1.0 - self.duty
        flying = (phase < swing) & (t > START)
        self._place(flying, phase / swing, speed, asked, spin, float(state.omega[2]), dt)
        done = np.clip(phase / swing, 0.0, 1.0)
        flat = self._below + np.column_stack([self._offset, np.zeros(4)])
        down = _seen(flat, fade * wish[3] - LEVEL * roll, fade * wish[4] - LEVEL * pitch)
        down[:, 2] -= fade * wish[2]
        up = _seen(flat, roll, pitch)  # over the ground as it is
        up[:, 2] += self.robot.height - state.base[2]
        s = np.minimum(done / EARLY, 1.0)
        up[:, 2] += fade * self.lift * 6.75 * s * (1.0 - s) ** 2  # quickly up, gently down
        since = np.clip((phase - swing) / LANDING, 0.0, 1.0)
        bears = np.where(flying, np.clip(1.0 - done / 0.3, 0.0, 1.0), since)[:, None]
        bears = np.maximum(bears, 1.0 - fade)
        targets = bears * down + (1.0 - bears) * up
        q = self.legs.towards(self._q, targets)
        self.legs.put(UPRIGHT, q)
        if dt > 0.0:
            self._dq += 0.2 * ((q - self._q) / dt - self._dq)
        self._q = q
        if self._count % 2 == 0:
            share = self._share(phase, swing) if t > START else np.ones(4)
            self._torque += 0.6 * (self.legs.torque(share) - self._torque)
        self._count += 1
        return np.asarray(q + (self._torque + self.robot.kd * self._dq) / self.robot.kp)

    def _place(
        self,
        flying: npt.NDArray[np.bool_],
        done: Array,
        speed: Array,
        asked: Array,
        spin: float,
        turning: float,
        dt: float,
    ) -> None:
        """Moves the feet's offsets on: back with the ground, or ahead to where they land."""
        stance = self.duty / self.frequency
        sideways = np.column_stack([-self._below[:, 1], self._below[:, 0]])
        land = 0.5 * stance * (asked + spin * sideways) + CAPTURE * (
            (speed - asked) + (turning - spin) * sideways
        )
        for k in range(4):
            if flying[k]:
                s = min(1.0, max(0.0, float(done[k])) / EARLY)
                ease = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
                self._offset[k] = self._lifted[k] + ease * (land[k] - self._lifted[k])
            else:
                self._offset[k] -= dt * (asked + spin * sideways[k])
                self._offset[k] = np.clip(self._offset[k], -0.12, 0.12)
                self._lifted[k] = self._offset[k]

    def _share(self, phase: Array, swing: float) -> Array:
        """Share of the weight on a foot: 0 in the air, ramps after landing and before leaving."""
        since, until = (phase - swing) / STEPPING, (1.0 - phase) / STEPPING
        return np.asarray(np.clip(np.minimum(since, until), 0.0, 1.0))


def _seen(points: Array, about_x: float, about_y: float) -> Array:
    """Points (k, 3) of a level frame, from a trunk that is tilted a little."""
    x, y, z = points.T
    return np.asarray(points) + np.column_stack(
        [-about_y * z, about_x * z, about_y * x - about_x * y]
    )


def angles(wxyz: Array) -> tuple[float, float, float]:
    """Roll, pitch and yaw [rad] of a quaternion."""
    w, x, y, z = (float(v) for v in wxyz)
    roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return float(roll), float(pitch), float(yaw)
