"""
The compiled half of pdoik. Its names are to be had from `pdoik` itself.
"""
from __future__ import annotations
import collections.abc
import numpy
import numpy.typing
import os
import pdoik._addresses
import typing
__all__: list[str] = ['Attachment', 'AugmentedLagrangianOptions', 'BalanceOptions', 'BatchResult', 'Cloud', 'ContactRule', 'Derivatives', 'DhRow', 'Goal', 'Lagrangian', 'LatencyHistogram', 'LbfgsOptions', 'LevenbergMarquardtOptions', 'MotionResult', 'ObstacleClearance', 'Occupancy', 'Options', 'PathEnd', 'PathResult', 'Result', 'Robot', 'Scene', 'Shape', 'ShrinkWrap', 'Solutions', 'Solver', 'TouchOptions', 'Tracker', 'TrackerResult', 'fastest_squares', 'load_srdf_contacts', 'load_srdf_pairs', 'pairs_always_touching', 'pairs_touching_at', 'simd_name', 'voxel_downsample']
class Occupancy:
    """
    What a robot fills: hulls fixed to its links that obstacle points must stay out of.
    
    A sphere keeps obstacle points at least its radius from its centre (Eq. joint_coll_avoid). A spheroid keeps
    the half sum of an obstacle point's distances to its two foci at or above its semi-major axis
    (Eq. link_coll_avoid); its foci may sit on different links.
    
    A capsule is what lies within its radius of a segment, on one link. A link that has any fills these, and its
    spheres and spheroids only say where to look (and are what method "paper" and inner "lbfgs" know): few wide
    hulls for speed, many tight ones for the verdict. Hulls are numbered spheres first, then spheroids, then
    capsules.
    
    Pieces are convex parts of a link itself, which hold it together to their tolerance: where the link's capsules
    touch something, they say whether it does (see Options.exact_contact). They are no hulls, and have no numbers.
    An occupancy does not change.
    """
    @staticmethod
    def load(path_or_text: str | os.PathLike[str]) -> Occupancy:
        """
        Read an occupancy file.
        
        Args:
            path_or_text: A file's path, or YAML text (recognised by a line break or ": ").
        
        Raises:
            LoadError: Names the file, the entry and what is wrong with it.
        """
    def __eq__(self, other: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, *, spheres: collections.abc.Sequence[tuple[str, numpy.typing.ArrayLike, typing.SupportsFloat | typing.SupportsIndex]] = (), spheroids: collections.abc.Sequence[tuple[str, numpy.typing.ArrayLike, str, numpy.typing.ArrayLike, typing.SupportsFloat | typing.SupportsIndex]] = (), capsules: collections.abc.Sequence[tuple[str, numpy.typing.ArrayLike, numpy.typing.ArrayLike, typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex] | tuple[str, numpy.typing.ArrayLike, numpy.typing.ArrayLike, typing.SupportsFloat | typing.SupportsIndex]] = (), pieces: collections.abc.Sequence[tuple[str, numpy.typing.ArrayLike, numpy.typing.ArrayLike, typing.SupportsFloat | typing.SupportsIndex]] = ()) -> None:
        """
        Args:
            spheres: Tuples (link, xyz, radius): centre in the link's frame and radius [m].
            spheroids: Tuples (link_a, xyz_a, link_b, xyz_b, semi_major): each focus in its link's frame and
                semi-major axis [m].
            capsules: Tuples (link, xyz_a, xyz_b, radius) or (link, xyz_a, xyz_b, radius, overhang): the segment's
                ends in the link's frame and radius [m]; and how far its surface stands beyond the link itself at
                most, 0 where nobody knows [m].
            pieces: Tuples (link, vertices, triangles, tolerance) of links that have capsules: vertices (N, 3) in
                the link's frame [m], triangles (T, 3) of a closed and convex surface, counter-clockwise from
                outside; by how much the link's pieces stand beyond it at most [m].
        
        Raises:
            ValueError: A point has not three finite coordinates, or an array another shape. The rest is checked when a robot takes it.
        """
    def __len__(self) -> int:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def save(self, path: str | os.PathLike[str]) -> None:
        """
        Write the YAML file that `load` reads back exactly. Replaces a file only when all is written.
        """
    def to_yaml(self) -> str:
        """
        The text that `load` reads back exactly.
        """
    @property
    def capsules(self) -> list[tuple[str, tuple[float, float, float], tuple[float, float, float], float, float]]:
        """
        Tuples (link, xyz_a, xyz_b, radius, overhang), lengths in metres.
        """
    @property
    def pieces(self) -> list[tuple[str, tuple[tuple[float, float, float], ...], tuple[tuple[int, int, int], ...], float]]:
        """
        Tuples (link, vertices, triangles, tolerance), lengths in metres.
        """
    @property
    def spheres(self) -> list[tuple[str, tuple[float, float, float], float]]:
        """
        Tuples (link, xyz, radius), lengths in metres.
        """
    @property
    def spheroids(self) -> list[tuple[str, tuple[float, float, float], str, tuple[float, float, float], float]]:
        """
        Tuples (link_a, xyz_a, link_b, xyz_b, semi_major), lengths in metres.
        """
class Cloud:
    """
    Obstacle points that are taken in once, for any number of solves and solvers.
    
    The points are put in the order of the cells that they lie in, with boxes around neighbours, so that a solve
    among a million looks at few of them. Give it as `obstacles` wherever points go.
    
    A solve sees the cloud as it is when it begins, for an update makes another one beside it: no solve waits for an
    update and no update for a solve. Any number of threads may solve and update at once; updates take turns. A cloud
    that has been updated takes twice the memory, and once more for each older one that is still solved among.
    
    >>> import numpy as np
    >>> import pdoik
    >>> rng = np.random.default_rng(0)
    >>> cloud = pdoik.Cloud(rng.uniform(-1, 1, (100_000, 3)) + [0, 0, 3])
    >>> robot = pdoik.Robot.builtin("panda")
    >>> solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
    >>> solver.solve(robot.fk(robot.mid_configuration()), obstacles=cloud).success
    True
    >>> cloud.remove([[-1, -1, 2], [1, 1, 3]]) > 40_000
    True
    """
    @staticmethod
    def from_depth(image: numpy.typing.ArrayLike, K: numpy.typing.ArrayLike, T_base_camera: numpy.typing.ArrayLike | None = None, max_range: float | None = None, *, scale: float | None = None, leaf: float | None = None, radii: bool = False, solid: bool = False) -> Cloud:
        """
        Make a cloud of what a depth camera has seen.
        
        Args:
            image: Depths along the optical axis, shape (H, W). Floats are metres and whole numbers
                millimetres, unless scale says otherwise; 0, NaN and infinity where nothing was seen.
            K: The camera's matrix, shape (3, 3), or fx, fy, cx, cy, shape (4,) [pixels].
            T_base_camera: Its optical frame, x to the right of the image, y down, z forward, in the
                base frame, shape (4, 4) [m]. None for the base frame itself.
            max_range: What is farther along the axis is left out [m]. None for nothing.
            scale: The metres of one unit of the image.
            leaf: As for `Cloud`.
            radii: As there.
            solid: As there; the cloud is seen from the camera.
        
        Returns:
            The cloud; without points where all that was seen is beyond max_range.
        
        Raises:
            ValueError: Names what is wrong: a shape, a matrix that is no camera's or of another image
                size, units that cannot be, an image in which nothing was seen.
        """
    def __init__(self, points: numpy.typing.ArrayLike, leaf: typing.SupportsFloat | typing.SupportsIndex | None = None, radii: bool = False, solid: bool = False, viewpoint: numpy.typing.ArrayLike | None = None) -> None:
        """
        Take points in.
        
        Args:
            points: x y z, or x y z radius, in the base frame, shape (N, 3) or (N, 4) [m]. Float32 and float64 are
                read without a conversion where a row's numbers lie side by side. With no rows: a cloud to be updated.
                Or as a depth camera has them, (H, W, 3): pixels with NaN or infinity are left out, but not all.
            leaf: Thin the points out first: one, the mean, for each cell of a grid with this edge [m], see
                voxel_downsample; rows with NaN or infinity are then left out, but not all of them. None keeps all.
            radii: Give each kept point the radius of a ball such that the balls hold every point there was.
            solid: The points are the surface of solid things: sink these balls into them, see voxel_downsample.
            viewpoint: Of a solid cloud, where it was seen from, shape (3,), or (N, 3) for each point [m].
        
        Raises:
            ValueError: The shape is wrong, a number is NaN, infinite or beyond 1e6, a radius is negative (naming the
                row), there are more than 33,554,432 points, or nothing is left of them to thin out.
        """
    def __len__(self) -> int:
        ...
    def __repr__(self) -> str:
        ...
    def remove(self, region: numpy.typing.ArrayLike) -> int:
        """
        Take out the points in a region, as in `update`.
        
        Returns:
            How many there were.
        
        Raises:
            ValueError: A region that is inside out or no number, or leaves out a part of a solid cloud.
        """
    def update(self, points: numpy.typing.ArrayLike, region: numpy.typing.ArrayLike, viewpoint: numpy.typing.ArrayLike | None = None) -> int:
        """
        Put points in place of all those in a region, at twice the cost of what changes.
        
        The first time, where much changes, and while an older one is still solved among, it copies all.
        
        Args:
            points: As in the constructor, thinned out as the cloud was; all within the region. No ball of a
                solid cloud sinks out of it.
            region: An axis-aligned box, shape (2, 3): its lowest and its highest x, y, z [m].
            viewpoint: Of a solid cloud, as in the constructor.
        
        Returns:
            How many points there were in the region.
        
        Raises:
            ValueError: As the constructor; a region that is inside out or no number, or leaves out a part of a solid
                cloud, whose balls are not where its points are; a point outside of it. The cloud is then as before.
        """
    @property
    def ids(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        What results call each of `points`, shape (N,).
        
        A point's row when it was taken in, numbered on with each update.
        """
    @property
    def nbytes(self) -> int:
        """
        The memory that the points take, with those of older ones that are kept [bytes].
        """
    @property
    def points(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 4]"]:
        """
        A copy of the points, x y z radius, shape (N, 4) [m], in the cloud's own order.
        """
class Shape:
    """
    A solid, or a surface, that the robot has to keep off, beside points. It does not change.
    """
    @staticmethod
    def box(name: str, size: numpy.typing.ArrayLike, T_base_shape: numpy.typing.ArrayLike | None = None) -> Shape:
        """
        A box along its frame's axes, with the origin in its middle.
        
        Args:
            name: What results call it.
            size: The lengths of its edges, shape (3,) [m].
            T_base_shape: Its frame in the base frame, shape (4, 4); None for the base frame itself.
        
        Raises:
            ValueError: Names the shape and what is wrong with it.
        """
    @staticmethod
    def boxes(name: str, low: numpy.typing.ArrayLike, high: numpy.typing.ArrayLike, T_base_shape: numpy.typing.ArrayLike | None = None) -> Shape:
        """
        Several boxes along its frame's axes, under one name.
        
        Args:
            name: What results call it.
            low: The lowest corner of each, shape (N, 3) [m].
            high: The highest, shape (N, 3) [m].
            T_base_shape: Its frame in the base frame, shape (4, 4); None for the base frame itself.
        
        Raises:
            ValueError: Names the shape and what is wrong with it.
        """
    @staticmethod
    def capsule(name: str, radius: typing.SupportsFloat | typing.SupportsIndex, length: typing.SupportsFloat | typing.SupportsIndex, T_base_shape: numpy.typing.ArrayLike | None = None) -> Shape:
        """
        A cylinder between two half balls, about its frame's z axis.
        
        Args:
            name: What results call it.
            radius: [m].
            length: Without the half balls [m].
            T_base_shape: Its frame in the base frame, shape (4, 4); None for the base frame itself.
        
        Raises:
            ValueError: Names the shape and what is wrong with it.
        """
    @staticmethod
    def convex_mesh(name: str, vertices: numpy.typing.ArrayLike, T_base_shape: numpy.typing.ArrayLike | None = None, triangles: collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], "FixedSize(3)"]] | None = None) -> Shape:
        """
        A convex solid by its corners.
        
        Args:
            name: What results call it.
            vertices: In its frame, shape (N, 3) [m].
            triangles: Its surface, closed and convex, each three places in `vertices`, counter-clockwise
                seen from outside, shape (T, 3). None for the convex hull of the vertices.
            T_base_shape: Its frame in the base frame, shape (4, 4); None for the base frame itself.
        
        Raises:
            ValueError: Names the shape and what is wrong with it.
        """
    @staticmethod
    def cylinder(name: str, radius: typing.SupportsFloat | typing.SupportsIndex, length: typing.SupportsFloat | typing.SupportsIndex, T_base_shape: numpy.typing.ArrayLike | None = None) -> Shape:
        """
        A cylinder about its frame's z axis, with the origin in its middle.
        
        Args:
            name: What results call it.
            radius: [m].
            length: [m].
            T_base_shape: Its frame in the base frame, shape (4, 4); None for the base frame itself.
        
        Raises:
            ValueError: Names the shape and what is wrong with it.
        """
    @staticmethod
    def distance_field(name: str, values: numpy.typing.ArrayLike, cell: typing.SupportsFloat | typing.SupportsIndex, T_base_shape: numpy.typing.ArrayLike | None = None, truncation: typing.SupportsFloat | typing.SupportsIndex | None = None, unknown: typing.Literal['free', 'occupied'] = 'free') -> Shape:
        """
        What signed distances on a grid are at most 0 in: nvblox, voxblox, Open3D, distance transforms.
        
        The robot keeps off by the values along its hulls' axes, interpolated between the cells' middles. That
        is exact beside what is flat, and off by 0.87 cells at most: at edges, and in gaps of a cell. Distances
        that were truncated or not known follow from the others, to a cell more. Outside of the grid nothing is
        in the way. A field is made ready once and shared by all scenes and threads: some 0.1 s for 200^3 cells,
        1 s where distances have to be found.
        
        Args:
            name: What results call it.
            values: Signed distances, positive outside of what is solid, floats of shape (X, Y, Z) [m]. Value
                (i, j, k) is that of the middle of its cell, which goes from cell (i, j, k) to
                cell (i + 1, j + 1, k + 1) in the shape's frame, as in `grid`. Not known is what is NaN or
                infinite, and one number that is farther from all others than the grid is wide, such as 1000.
            cell: The edge of a cell [m].
            T_base_shape: Its frame in the base frame, shape (4, 4); None for the base frame itself.
            truncation: Values of this size and more say "at least so far" [m]; math.inf if none does. None to
                tell from the values: the largest, if a tenth of the known ones are that.
            unknown: What cells hold whose distance is not known: "free" for nothing, "occupied" for something.
        
        Raises:
            ValueError: Names the shape and what is wrong with it: no array of floats (X, Y, Z) with two cells
                along each axis, none that is known, a cell that is not positive, or values that cannot be
                distances in metres, since they change faster or slower than cells lie apart.
        """
    @staticmethod
    def grid(name: str, taken: numpy.typing.ArrayLike, edge: typing.SupportsFloat | typing.SupportsIndex, T_base_shape: numpy.typing.ArrayLike | None = None) -> Shape:
        """
        The cells of a grid that are taken, put together to few boxes: an occupancy grid, voxels.
        
        Args:
            name: What results call it.
            taken: Bool, shape (I, J, K). Cell (i, j, k) goes from edge (i, j, k) to edge (i + 1, j + 1, k + 1)
                in its frame.
            edge: Of a cell [m].
            T_base_shape: Its frame in the base frame, shape (4, 4); None for the base frame itself.
        
        Raises:
            ValueError: Names the shape and what is wrong with it.
        """
    @staticmethod
    def half_space(name: str, normal: numpy.typing.ArrayLike, point: numpy.typing.ArrayLike) -> Shape:
        """
        All behind a plane: a table, a floor, a wall.
        
        Args:
            name: What results call it.
            normal: Out of the solid, of any length, shape (3,).
            point: On the plane, shape (3,) [m].
        
        Raises:
            ValueError: Names the shape and what is wrong with it.
        """
    @staticmethod
    def height_field(name: str, heights: numpy.typing.ArrayLike, cell: numpy.typing.ArrayLike, T_base_shape: numpy.typing.ArrayLike | None = None, *, bottom: float | None = None) -> Shape:
        """
        Make ground of its heights over a grid: a closed mesh, solid down to its bottom.
        
        Args:
            name: What results call it.
            heights: heights[i, j] stands at x = i cell, y = j cell in its frame, shape (I, J) [m].
            cell: From one height to the next [m], one number or two, along x and y.
            T_base_shape: Its frame in the base frame, shape (4, 4); None for the base frame itself.
            bottom: Height of its underside [m]. None for as far below the lowest as the field is long.
        
        Raises:
            ValueError: Names the shape and what is wrong with it, such as a height that is NaN.
        """
    @staticmethod
    def mesh(name: str, vertices: numpy.typing.ArrayLike, triangles: numpy.typing.ArrayLike, T_base_shape: numpy.typing.ArrayLike | None = None) -> Shape:
        """
        A surface of triangles of any form, such as a part, a bin or a scanned room.
        
        Where it is closed what is inside counts too, by the winding number: of what has a radius of a
        fortieth of its longest side everywhere inside, of thinner parts of a robot where they come near the
        surface. It is made ready whenever a Scene is made of it: a second for some 400,000 triangles.
        
        Args:
            name: What results call it.
            vertices: In its frame, shape (N, 3) [m]. Those at one place count as one.
            triangles: Each three places in `vertices`, shape (T, 3); of a closed mesh all clockwise or all
                counter-clockwise seen from outside.
            T_base_shape: Its frame in the base frame, shape (4, 4); None for the base frame itself.
        
        Raises:
            ValueError: Names the shape and what is wrong with it.
        
        Warns:
            ObstacleWarning: It is not closed: its surface alone is kept off.
        """
    @staticmethod
    def octomap(name: str, path: str | os.PathLike[str], T_base_shape: numpy.typing.ArrayLike | None = None, *, unknown: bool = False, region: numpy.typing.ArrayLike | None = None) -> Shape:
        """
        Read an OctoMap: its occupied cells, joined to few boxes.
        
        Args:
            name: What results call it.
            path: A file that OctoMap wrote: .bt, or .ot, whose leaves are occupied from even odds on.
            T_base_shape: The map's frame in the base frame, shape (4, 4) [m]; None for the base frame
                itself.
            unknown: Whether cells that the map does not know are occupied, too: in the region, or
                without one in the smallest box that holds all it knows. Otherwise they are free.
            region: The lowest and the highest x, y, z of what counts, in the map's frame, shape
                (2, 3) [m]. None for all of it.
        
        Raises:
            LoadError: The file cannot be read, or nothing in it is occupied.
            ValueError: Names the shape and what is wrong with it.
        """
    @staticmethod
    def sphere(name: str, center: numpy.typing.ArrayLike, radius: typing.SupportsFloat | typing.SupportsIndex) -> Shape:
        """
        A ball.
        
        Args:
            name: What results call it.
            center: In the base frame, shape (3,) [m].
            radius: [m].
        
        Raises:
            ValueError: Names the shape and what is wrong with it.
        """
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def moved(self, T_base_shape: numpy.typing.ArrayLike) -> Shape:
        """
        The same solid with its frame elsewhere, shape (4, 4) [m].
        """
    @property
    def T_base_shape(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[4, 4]"]:
        """
        Its frame in the base frame, shape (4, 4) [m].
        """
    @property
    def cell(self) -> float | None:
        """
        The edge of a distance field's cells [m]; None of others.
        """
    @property
    def kind(self) -> typing.Literal['sphere', 'box', 'cylinder', 'capsule', 'half_space', 'convex_mesh', 'mesh', 'boxes', 'distance_field']:
        """
        What it is, by the name of what makes it.
        """
    @property
    def name(self) -> str:
        """
        What results call it.
        """
    @property
    def size(self) -> list[float]:
        """
        Edges of a box; radius, and length if it has one [m]. Else empty.
        """
    @property
    def triangles(self) -> typing.Annotated[numpy.typing.NDArray[numpy.int32], "[m, 3]"]:
        """
        Of a mesh, shape (T, 3); else empty.
        """
    @property
    def values(self) -> numpy.typing.NDArray[numpy.float32]:
        """
        Of a distance field, as it uses them, shape (X, Y, Z) [m], read-only; else empty.
        """
    @property
    def vertices(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 3]"]:
        """
        Of a mesh, shape (N, 3) [m]; of boxes the lowest and the highest corner of each; else empty.
        """
class ContactRule:
    """
    How near two things may come to each other.
    
    Things are links of the robot, shapes of a scene, what links carry, and "points" for all points. All pairs of which
    no rule speaks keep Options.clearance, or Options.self_clearance among links and what they carry. Each side is a name
    or a pattern in which `*` stands for any characters and `?` for one; a name also means the pieces of an object,
    NAME/1, NAME/2 and so on. Of several rules that speak of a pair those with more exact names count before those with
    patterns, and of these the last. Links that are joined, or that no joint moves against each other, are no pairs
    whatever rules say; nor are two shapes.
    """
    def __eq__(self, arg0: typing.Any) -> bool:
        ...
    def __getstate__(self) -> tuple[str, str, float | None, bool]:
        ...
    def __hash__(self) -> int:
        ...
    def __init__(self, one: str, other: str, *, allowed: bool | typing.SupportsFloat | typing.SupportsIndex | None = None, clearance: typing.SupportsFloat | typing.SupportsIndex | None = None, optional: bool = False) -> None:
        """
        Say it of two things, whichever comes first.
        
        Args:
            one: A name or a pattern.
            other: The same.
            allowed: True, which it is without anything else: contact does not count. A depth: so deep they may be in each
                other [m]. False: as the options say, whatever other rules do.
            clearance: In place of that, the least distance that is wanted of the two [m]; 0 for contact and no deeper,
                negative for a depth.
            optional: Whether there may be nothing of these names; else that is an error where a solver takes the rule.
        
        Raises:
            ValueError: A name is empty, both are given, or a length is NaN, too large or a negative depth.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[str, str, typing.SupportsFloat | typing.SupportsIndex | None, bool]) -> None:
        ...
    @property
    def clearance(self) -> float | None:
        """
        Least distance that is wanted [m]; negative for a depth, minus infinity if contact does not count, None for as the options say.
        """
    @property
    def one(self) -> str:
        """
        A name or a pattern.
        """
    @property
    def optional(self) -> bool:
        """
        Whether there may be nothing of these names.
        """
    @property
    def other(self) -> str:
        """
        A name or a pattern.
        """
class Attachment:
    """
    Solids that links carry, see Solver.attach: an object in a hand, or one between two hands.
    """
    def __getstate__(self) -> tuple[list[str], list[Shape], list[ContactRule]]:
        ...
    def __init__(self, link: str | collections.abc.Sequence[str], shapes: collections.abc.Sequence[Shape], may_touch: collections.abc.Sequence[str] = (), contacts: collections.abc.Sequence[ContactRule] = ()) -> None:
        """
        What `Solver.attach` takes, for `Solver.attach_all`.
        """
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[collections.abc.Sequence[str], collections.abc.Sequence[Shape], collections.abc.Sequence[ContactRule]]) -> None:
        ...
    @property
    def contacts(self) -> list[ContactRule]:
        """
        Rules that count while they are carried, those of `may_touch` among them.
        """
    @property
    def links(self) -> list[str]:
        """
        That hold them; they move with the first.
        """
    @property
    def shapes(self) -> list[Shape]:
        """
        Their poses are in the first link's frame.
        """
class Scene:
    """
    Solids and points that are obstacles together, for `obstacles=`.
    
    It does not change, but its cloud may. Any number of solvers may share it.
    """
    def __init__(self, shapes: collections.abc.Sequence[Shape] = (), *, cloud: numpy.typing.ArrayLike | Cloud | Scene | collections.abc.Sequence[Shape] | None = None, allowed: collections.abc.Sequence[tuple[str, str] | tuple[str, str, typing.SupportsFloat | typing.SupportsIndex]] = (), contacts: collections.abc.Sequence[ContactRule] = ()) -> None:
        """
        Put shapes and points together.
        
        Args:
            shapes: Of different names.
            cloud: A Cloud, which is shared and not copied; or points as Cloud takes them.
            allowed: What may touch, (link, shape) by name or (link, shape, depth): the table that the base stands
                on, what the hand is to hold. Each is a ContactRule of these names, to any depth or to this one [m].
            contacts: Rules of contact, which count after `allowed`.
        
        Raises:
            ValueError: Two shapes have one name, or a depth is negative. Names that are neither a link's, nor a shape's, nor
                of what a link carries come out when a solver takes the scene.
        """
    def __repr__(self) -> str:
        ...
    @property
    def allowed(self) -> list[tuple[str, str] | tuple[str, str, float]]:
        """
        Of the rules those that allow contact, as (one, other), or as (one, other, depth) where it is to a depth [m].
        """
    @property
    def cloud(self) -> Cloud | None:
        """
        The points, which share what they are; None if there are none.
        """
    @property
    def contacts(self) -> list[ContactRule]:
        """
        The rules of contact, those of `allowed` first.
        """
    @property
    def shapes(self) -> list[Shape]:
        """
        The solids, in the order they were given.
        """
class DhRow:
    """
    A row of a proximal Denavit-Hartenberg table (Craig; Eq. DH_matrix).
    
    T = Rx(alpha) Tx(a) Rz(theta + theta_offset) Tz(d); for a prismatic row the variable adds to d.
    """
    def __init__(self, *, alpha: typing.SupportsFloat | typing.SupportsIndex = 0.0, a: typing.SupportsFloat | typing.SupportsIndex = 0.0, d: typing.SupportsFloat | typing.SupportsIndex = 0.0, theta_offset: typing.SupportsFloat | typing.SupportsIndex = 0.0, lower: typing.SupportsFloat | typing.SupportsIndex = ..., upper: typing.SupportsFloat | typing.SupportsIndex = ..., prismatic: bool = False) -> None:
        """
        Metres and radians; without limits a revolute row is continuous.
        """
    def __repr__(self) -> str:
        ...
    @property
    def a(self) -> float:
        """
        [m]
        """
    @property
    def alpha(self) -> float:
        """
        [rad]
        """
    @property
    def d(self) -> float:
        """
        [m]
        """
    @property
    def lower(self) -> float:
        """
        [rad] or [m]
        """
    @property
    def prismatic(self) -> bool:
        ...
    @property
    def theta_offset(self) -> float:
        """
        [rad]
        """
    @property
    def upper(self) -> float:
        """
        [rad] or [m]
        """
class Robot:
    """
    A tree of links and joints seen from a chosen base link.
    
    Nothing but its occupancy and ignored pairs can be changed.
    """
    @staticmethod
    def builtin(name: str, base_link: str | None = None, tip_link: str | collections.abc.Sequence[str] | None = None, *, T_world_base: numpy.typing.ArrayLike | None = None, floating_base: tuple[numpy.typing.ArrayLike, numpy.typing.ArrayLike] | None = None) -> Robot:
        """
        A robot shipped with the library, with its occupancy and ignored pairs.
        
        Args:
            name: panda, ur10, iiwa14 or h1 (see `builtin_names`).
            base_link: As for `from_urdf`, like the others.
            tip_link: By default the arms' tool flange, and H1's ankles and elbows.
            T_world_base: Where the base link stands.
            floating_base: Bounds on where it may go.
        
        Raises:
            ValueError: There is no such robot.
            LoadError: There is no such link.
        """
    @staticmethod
    def builtin_names() -> list[str]:
        """
        The robots that `builtin` knows.
        """
    @staticmethod
    def from_description(name: str, base_link: str | None = None, tip_link: str | collections.abc.Sequence[str] | None = None, *, T_world_base: numpy.typing.ArrayLike | None = None, floating_base: tuple[numpy.typing.ArrayLike, numpy.typing.ArrayLike] | None = None, srdf: str | os.PathLike[str] | None = None, hulls: bool = True, arguments: collections.abc.Mapping[str, str] | None = None, packages: pdoik._addresses.Packages = tuple()) -> Robot:
        """
        Read a shipped robot, or a description that another package brings, by its name.
        
        Args:
            name: Such as "panda" (shipped); "ur5", "xarm7" (package example-robot-data); "ur10e",
                "panda_mj_description" (robot_descriptions); "unitree_g1" (mujoco-menagerie). The last
                two get their files from the network the first time.
            base_link: As for `from_urdf`, like the others.
            tip_link: As there.
            T_world_base: As there.
            floating_base: As there.
            srdf: As there.
            hulls: As there, but fitted by default. Shipped robots have theirs.
            arguments: Of a xacro file, in addition to those that the description has.
            packages: As there.
        
        Raises:
            LoadError: As there; or no robot has this name, or its package cannot get the files.
        """
    @staticmethod
    def from_dh(rows: collections.abc.Sequence[DhRow], T_last_tool: numpy.typing.ArrayLike | None = None) -> Robot:
        """
        A serial arm from DH rows: links link0 ... linkM and `tool`, joints joint1 ... jointM.
        
        Args:
            rows: One per joint.
            T_last_tool: Pose of `tool` in the last link's frame, shape (4, 4). None for the identity.
        """
    @staticmethod
    def from_mjcf(path: str | os.PathLike[str], base_link: str | None = None, tip_link: str | collections.abc.Sequence[str] | None = None, *, T_world_base: numpy.typing.ArrayLike | None = None, floating_base: tuple[numpy.typing.ArrayLike, numpy.typing.ArrayLike] | None = None, srdf: str | os.PathLike[str] | None = None, hulls: bool = False) -> Robot:
        """
        Read a model of MuJoCo, by the package `mujoco`.
        
        Bodies are links, and a joint's value is its `qpos`. Ball joints are refused; a body that floats
        stands where the model has it; joint equalities that are lines become mimic joints, and other
        equalities are left out, so closed loops are open. Speeds are without limit.
        
        Args:
            path: A file's path.
            base_link: As for `from_urdf`, like the others. The root is the link "world".
            tip_link: As there.
            T_world_base: As there.
            floating_base: As there.
            srdf: As there.
            hulls: As there; of the geometry that can touch.
        
        Raises:
            LoadError: As there; or MuJoCo is not installed or refuses the file, or a joint is a ball.
        """
    @staticmethod
    def from_urdf(path_or_xml: str | os.PathLike[str], base_link: str | None = None, tip_link: str | collections.abc.Sequence[str] | None = None, *, T_world_base: numpy.typing.ArrayLike | None = None, floating_base: tuple[numpy.typing.ArrayLike, numpy.typing.ArrayLike] | None = None, srdf: str | os.PathLike[str] | None = None, hulls: bool = False, arguments: collections.abc.Mapping[str, str] | None = None, packages: pdoik._addresses.Packages = tuple()) -> Robot:
        """
        Read a URDF, or a xacro file, which the package `xacro` expands.
        
        Args:
            path_or_xml: A file's path, or the XML text of a URDF itself (recognised by its leading
                "<").
            base_link: Any link of the tree, which becomes the base frame. None takes the description's
                root.
            tip_link: The link that goals are given for, or several. None takes every leaf.
            T_world_base: Where the base link stands, shape (4, 4) [m]: targets, obstacles and centre of
                mass are then in the frame of a link "world" that is put under it.
            floating_base: Instead, how far the base link may go in the world: lower and upper bounds of
                x, y, z [m], yaw, pitch and roll [rad], each of shape (6,). They are the first six
                joints, base_x to base_roll.
            srdf: The robot's SRDF, as a path or as text: its pairs become `ignored_pairs`, and solvers
                keep the robot's hulls off one another unless their options say otherwise.
            hulls: Fit hulls to its collision geometry, which takes a minute or two for an arm. They are
                kept in the user's cache (`PDOIK_CACHE`), and taken from there the next time.
            arguments: Of a xacro file.
            packages: Folders by the name of the package, for `package://NAME/...` and `$(find NAME)`;
                or folders that hold packages. See `pdoik.urdf_text` for where else they are looked for.
        
        Raises:
            LoadError: A file cannot be read, the XML or the tree is malformed, a link is missing,
                limits are out of order, an axis is zero, a mesh is missing that hulls are asked for.
        
        Warns:
            RobotWarning: Oddities that do not stop kinematics, such as missing velocity limits, which
                are taken as none, and inertias no body can have.
        """
    @staticmethod
    def from_xacro(path: str | os.PathLike[str], base_link: str | None = None, tip_link: str | collections.abc.Sequence[str] | None = None, *, T_world_base: numpy.typing.ArrayLike | None = None, floating_base: tuple[numpy.typing.ArrayLike, numpy.typing.ArrayLike] | None = None, srdf: str | os.PathLike[str] | None = None, hulls: bool = False, arguments: collections.abc.Mapping[str, str] | None = None, packages: pdoik._addresses.Packages = tuple()) -> Robot:
        """
        Read a xacro file, by the package `xacro`.
        
        Args:
            path: A file's path.
            base_link: As for `from_urdf`, like the others.
            tip_link: As there.
            T_world_base: As there.
            floating_base: As there.
            srdf: As there.
            hulls: As there.
            arguments: What `xacro FILE NAME:=VALUE` takes.
            packages: As there.
        
        Raises:
            LoadError: As there; or xacro refuses the file.
            MissingExtraError: The package xacro is not installed.
        """
    def __copy__(self) -> Robot:
        ...
    def __deepcopy__(self, memo: typing.Any) -> Robot:
        ...
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    def center_of_mass(self, q: numpy.typing.ArrayLike) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        Of all links by their masses, the base's included, in the base frame.
        
        Args:
            q: Joint positions, shape (n,) [rad] or [m].
        
        Returns:
            Shape (3,) [m].
        
        Raises:
            ValueError: q has another shape or holds NaN or infinity, or the links have no mass.
        """
    def center_of_mass_jacobian(self, q: numpy.typing.ArrayLike) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, n]"]:
        """
        Derivative of the centre of mass by q.
        
        Args:
            q: Joint positions, shape (n,) [rad] or [m].
        
        Returns:
            Shape (3, n), in the base frame's axes.
        
        Raises:
            ValueError: As `center_of_mass`.
        """
    def fk(self, q: numpy.typing.ArrayLike, link: str | None = None) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[4, 4]"]:
        """
        Pose of a link in the base frame.
        
        Args:
            q: Joint positions, shape (n,) [rad] or [m]; limits are not enforced.
            link: A link's name. None for the tip, if there is one only.
        
        Returns:
            T_base_link, shape (4, 4) [m].
        
        Raises:
            ValueError: q has another shape or holds NaN or infinity, or there is no such link.
        """
    def jacobian(self, q: numpy.typing.ArrayLike, link: str | None = None) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[6, n]"]:
        """
        Geometric Jacobian of a link's origin.
        
        Args:
            q: Joint positions, shape (n,) [rad] or [m].
            link: A link's name. None for the tip, if there is one only.
        
        Returns:
            Shape (6, n): three linear rows, then three angular ones, both in the base frame's axes (Pinocchio's
            LOCAL_WORLD_ALIGNED).
        
        Raises:
            ValueError: q has another shape or holds NaN or infinity, or there is no such link.
        """
    def mid_configuration(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        The middle of each joint's range, 0 for joints without limits, shape (n,).
        """
    @typing.overload
    def self_filter(self, cloud: Cloud, q: numpy.typing.ArrayLike, *, padding: typing.SupportsFloat | typing.SupportsIndex = 0.0) -> int:
        """
        Take the robot's own surface out of a cloud: points in its hulls, or within a distance of them.
        
        Args:
            cloud: Changed in place.
            q: Where the robot was when the camera saw it, shape (n,) [rad] or [m].
            padding: For what noise and calibration hide [m].
        
        Returns:
            How many points were taken out.
        
        Raises:
            ValueError: q has another shape or holds NaN or infinity, padding is negative, or the robot has no
                occupancy.
        """
    @typing.overload
    def self_filter(self, points: numpy.typing.ArrayLike, q: numpy.typing.ArrayLike, *, padding: typing.SupportsFloat | typing.SupportsIndex = 0.0) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        The same for an array of points, shape (N, 3) or (N, 4) [m]; gives those that are left, in order.
        """
    @property
    def base_link(self) -> str:
        """
        The link whose frame is the base frame.
        """
    @property
    def dof(self) -> int:
        """
        n, the number of joints that a configuration has entries for.
        """
    @property
    def effort(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Effort limits, shape (n,) [N m] or [N]; inf where the description gives none.
        """
    @property
    def ignored_pairs(self) -> list[tuple[str, str]]:
        """
        Pairs of links whose hulls may touch, besides links that are joined.
        
        Solvers made afterwards keep to it. See `load_srdf_pairs`, `pairs_always_touching` and `pairs_touching_at`.
        
        Raises:
            ValueError: On setting: a link is unknown.
        """
    @ignored_pairs.setter
    def ignored_pairs(self, arg1: collections.abc.Sequence[tuple[str, str]]) -> None:
        ...
    @property
    def joint_names(self) -> list[str]:
        """
        The n joints, depth first from the base, siblings by name; without fixed and mimic ones.
        """
    @property
    def joint_types(self) -> list[typing.Literal['fixed', 'revolute', 'continuous', 'prismatic']]:
        """
        Of the n joints.
        """
    @property
    def link_centers_of_mass(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        In the links' frames, shape (L, 3), ordered as link_names [m].
        """
    @property
    def link_masses(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Shape (L,), ordered as link_names [kg].
        """
    @property
    def link_names(self) -> list[str]:
        """
        All links, depth first from the base.
        """
    @property
    def lower(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Shape (n,) [rad] or [m]; -inf for continuous joints.
        """
    @property
    def name(self) -> str:
        ...
    @property
    def occupancy(self) -> Occupancy:
        """
        What the robot fills. Solvers made afterwards keep to it.
        
        Raises:
            ValueError: On setting: a link is unknown, a radius is not positive and finite, or a semi-major axis is
                not longer than half the distance between its foci on one link.
        """
    @occupancy.setter
    def occupancy(self, arg1: Occupancy) -> None:
        ...
    @property
    def tip_links(self) -> list[str]:
        """
        The links that goals may be given for.
        """
    @property
    def total_mass(self) -> float:
        """
        Of all links, the base's included [kg].
        """
    @property
    def upper(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Shape (n,) [rad] or [m]; inf for continuous joints.
        """
    @property
    def velocity(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Speed limits, shape (n,) [rad/s] or [m/s]; inf where the description gives none.
        """
    @property
    def warnings(self) -> list[str]:
        """
        What RobotWarning was issued for.
        """
class LbfgsOptions:
    """
    The C++ struct, which pdoik.Options fills.
    """
    def __init__(self) -> None:
        ...
    @property
    def armijo(self) -> float:
        ...
    @armijo.setter
    def armijo(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def curvature(self) -> float:
        ...
    @curvature.setter
    def curvature(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def first_step(self) -> float:
        ...
    @first_step.setter
    def first_step(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def gradient_tolerance(self) -> float:
        ...
    @gradient_tolerance.setter
    def gradient_tolerance(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def max_iterations(self) -> int:
        ...
    @max_iterations.setter
    def max_iterations(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def max_line_search(self) -> int:
        ...
    @max_line_search.setter
    def max_line_search(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def max_step(self) -> float:
        ...
    @max_step.setter
    def max_step(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def memory(self) -> int:
        ...
    @memory.setter
    def memory(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def relative_decrease(self) -> float:
        ...
    @relative_decrease.setter
    def relative_decrease(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
class AugmentedLagrangianOptions:
    """
    The C++ struct, which pdoik.Options fills.
    """
    form: str
    def __init__(self) -> None:
        ...
    @property
    def beta(self) -> float:
        ...
    @beta.setter
    def beta(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def constraint_tolerance(self) -> float:
        ...
    @constraint_tolerance.setter
    def constraint_tolerance(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def max_outer_iterations(self) -> int:
        ...
    @max_outer_iterations.setter
    def max_outer_iterations(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def rho(self) -> float:
        ...
    @rho.setter
    def rho(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def rho_growth(self) -> float:
        ...
    @rho_growth.setter
    def rho_growth(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def rho_max(self) -> float:
        ...
    @rho_max.setter
    def rho_max(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
class LevenbergMarquardtOptions:
    """
    The C++ struct, which pdoik.Options fills.
    """
    def __init__(self) -> None:
        ...
    @property
    def damping_decrease(self) -> float:
        ...
    @damping_decrease.setter
    def damping_decrease(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def damping_increase(self) -> float:
        ...
    @damping_increase.setter
    def damping_increase(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def first_damping(self) -> float:
        ...
    @first_damping.setter
    def first_damping(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def max_damping(self) -> float:
        ...
    @max_damping.setter
    def max_damping(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def max_iterations(self) -> int:
        ...
    @max_iterations.setter
    def max_iterations(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def stall_ratio(self) -> float:
        ...
    @stall_ratio.setter
    def stall_ratio(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def stall_window(self) -> int:
        ...
    @stall_window.setter
    def stall_window(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
class BalanceOptions:
    """
    The C++ struct, which pdoik.Options fills.
    """
    def __init__(self) -> None:
        ...
    @property
    def com_lower(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        ...
    @com_lower.setter
    def com_lower(self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
    @property
    def com_upper(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        ...
    @com_upper.setter
    def com_upper(self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
    @property
    def contacts(self) -> dict[str, list[typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]]]:
        ...
    @contacts.setter
    def contacts(self, arg1: collections.abc.Mapping[str, collections.abc.Sequence[typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]]]) -> None:
        ...
    @property
    def support_margin(self) -> float:
        ...
    @support_margin.setter
    def support_margin(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def up(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        ...
    @up.setter
    def up(self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
class TouchOptions:
    """
    The C++ struct, which pdoik.Options fills.
    """
    def __init__(self) -> None:
        ...
    @property
    def depth(self) -> float:
        ...
    @depth.setter
    def depth(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def links(self) -> list[str]:
        ...
    @links.setter
    def links(self, arg0: collections.abc.Sequence[str]) -> None:
        ...
    @property
    def radius(self) -> float:
        ...
    @radius.setter
    def radius(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
class Options:
    """
    The C++ struct, which pdoik.Options fills.
    """
    augmented_lagrangian: AugmentedLagrangianOptions
    balance: BalanceOptions
    base_collision: bool
    exact_contact: bool
    goal: str
    ignore_obstacles_without_hulls: bool
    inner: str
    lbfgs: LbfgsOptions
    levenberg_marquardt: LevenbergMarquardtOptions
    method: str
    prefer: str
    priority: str
    self_collision: bool | None
    touch: TouchOptions
    def __init__(self) -> None:
        ...
    def keeps_off_itself(self, robot: Robot) -> bool:
        ...
    @property
    def T_tip_tool(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[4, 4]"]:
        ...
    @T_tip_tool.setter
    def T_tip_tool(self, arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[4, 4]"]) -> None:
        ...
    @property
    def clearance(self) -> float:
        ...
    @clearance.setter
    def clearance(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def clearance_tolerance(self) -> float:
        ...
    @clearance_tolerance.setter
    def clearance_tolerance(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def collision_weight(self) -> float:
        ...
    @collision_weight.setter
    def collision_weight(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def goal_axis(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        ...
    @goal_axis.setter
    def goal_axis(self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[3, 1]"]) -> None:
        ...
    @property
    def joint_weights(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        ...
    @joint_weights.setter
    def joint_weights(self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> None:
        ...
    @property
    def max_obstacles(self) -> int:
        ...
    @max_obstacles.setter
    def max_obstacles(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def max_restarts(self) -> int:
        ...
    @max_restarts.setter
    def max_restarts(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def max_time(self) -> float:
        ...
    @max_time.setter
    def max_time(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def point_distance(self) -> float:
        ...
    @point_distance.setter
    def point_distance(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def position_tolerance(self) -> float:
        ...
    @position_tolerance.setter
    def position_tolerance(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def posture_weight(self) -> float:
        ...
    @posture_weight.setter
    def posture_weight(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def report_clearance(self) -> float:
        ...
    @report_clearance.setter
    def report_clearance(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def rotation_tolerance(self) -> float:
        ...
    @rotation_tolerance.setter
    def rotation_tolerance(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def rotation_weight(self) -> float:
        ...
    @rotation_weight.setter
    def rotation_weight(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def seed(self) -> int:
        ...
    @seed.setter
    def seed(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> None:
        ...
    @property
    def self_clearance(self) -> float:
        ...
    @self_clearance.setter
    def self_clearance(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    @property
    def start_inset(self) -> float:
        ...
    @start_inset.setter
    def start_inset(self, arg0: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
class Goal:
    """
    One requirement: of a tip, or of the centre of mass.
    
    A solve takes one, a list of them, or a dict of them by tip. A target given as a bare array is a goal of the
    options' type, with no slack and weight 1.
    
    >>> import numpy as np
    >>> import pdoik
    >>> robot = pdoik.Robot.builtin("panda")
    >>> T = robot.fk(robot.mid_configuration())
    >>> tilted = pdoik.Goal(T, type="axis", axis="z", rotation_slack=[0.1] * 3)  # free about z, 0.1 rad of tilt
    >>> seam = pdoik.Goal.region(T, position=([-0.2, 0, 0], [0.2, 0, 0]))  # anywhere on a line of 0.4 m
    >>> look = pdoik.Goal.look_at([0.6, 0.0, 0.2], soft=True)  # and, as far as that lets it, facing this
    >>> pdoik.Solver(robot).solve([seam, look]).success
    True
    """
    @staticmethod
    def center_of_mass(lower: numpy.typing.ArrayLike, upper: numpy.typing.ArrayLike) -> Goal:
        """
        A goal that the centre of mass of all that has mass is in a box along the base's axes.
        
        Args:
            lower: Its lower corner, shape (3,) [m]; minus infinity for none.
            upper: Its upper corner.
        """
    @staticmethod
    def look_at(point: typing.Any, *, axis: typing.Any = 'z', cone: typing.SupportsFloat | typing.SupportsIndex = 0.0, weight: typing.SupportsFloat | typing.SupportsIndex = 1.0, stands: bool = False, relative_to: str | None = None, tip: str | None = None, T_tip_tool: numpy.typing.ArrayLike | None = None, soft: bool = False, rotation_tolerance: typing.SupportsFloat | typing.SupportsIndex = 0.0) -> Goal:
        """
        A goal that an axis of the tip points at a point from wherever it is.
        
        Args:
            point: In the base frame, or in that of `relative_to`, shape (3,) [m].
            axis: Of the tool: a letter or a vector.
            cone: How far off it may point [rad].
            weight: As all that follows, as of a Goal.
        """
    @staticmethod
    def region(T_base_tip: typing.Any, *, position: typing.Any | None = None, rotation: typing.Any | None = None, type: str | None = None, axis: typing.Any | None = None, weight: typing.SupportsFloat | typing.SupportsIndex = 1.0, stands: bool = False, relative_to: str | None = None, tip: str | None = None, T_tip_tool: numpy.typing.ArrayLike | None = None, soft: bool = False, priority: str | None = None, position_tolerance: typing.SupportsFloat | typing.SupportsIndex = 0.0, rotation_tolerance: typing.SupportsFloat | typing.SupportsIndex = 0.0) -> Goal:
        """
        A goal that is met anywhere in a box about a target: a task-space region.
        
        Args:
            T_base_tip: The frame of the box, as of a Goal.
            position: Its lower and upper corner, shape (2, 3), along the frame's axes [m]; infinity frees an axis on
                one side or both. None for the frame's origin alone.
            rotation: How far the tip may be turned about the frame's axes, from and to, shape (2, 3) [rad], counted
                as components of the rotation vector from the middle of the two; -pi and pi free an axis. None for not
                at all.
            **rest: As of a Goal.
        
        Raises:
            ValueError: A lower bound is above its upper one; as for a Goal.
        """
    def __init__(self, T_base_tip: typing.Any, *, type: str | None = None, axis: typing.Any | None = None, weight: typing.SupportsFloat | typing.SupportsIndex = 1.0, position_slack: numpy.typing.ArrayLike | None = None, rotation_slack: numpy.typing.ArrayLike | None = None, stands: bool = False, relative_to: str | None = None, tip: str | None = None, T_tip_tool: numpy.typing.ArrayLike | None = None, soft: bool = False, priority: str | None = None, position_tolerance: typing.SupportsFloat | typing.SupportsIndex = 0.0, rotation_tolerance: typing.SupportsFloat | typing.SupportsIndex = 0.0) -> None:
        """
        A target and what of it counts.
        
        Args:
            T_base_tip: The target, which takes tip points to the base frame, shape (4, 4) [m]; of "position" and
                "look_at" goals the position will do, shape (3,).
            type: "pose", "axis" (position, and the direction of one axis), "position", "look_at" (that one axis
                points at the target's origin from wherever the tip is) or "center_of_mass"; None for the options'
                `goal`.
            axis: In the tool's frame, for "axis" and "look_at": a letter or a vector. None for the options'
                `goal_axis`.
            weight: Of its squared errors against the other goals', where not all can be met.
            position_slack: How far the tip may be off along each axis of the target frame, shape (3,) [m];
                infinity frees it. None for not at all.
            rotation_slack: How far it may be turned about each axis of the target frame, as components of the
                rotation vector from target to tip, shape (3,) [rad]; pi frees an axis. Of "axis" and "look_at" goals
                the largest is half the angle of a cone.
            stands: Whether a Tracker gives nothing of it up for goals that do not stand: a foot on the ground
                whatever the hands are asked. Where it is met it stays so, to 0.05 mm, else it is left no farther.
                A Solver weighs all goals alike. Not for trackers with `max_acceleration`.
            relative_to: Another tip's link, in whose frame the target then is instead of the base's: two hands
                on one box, wherever the box is. It is the link's frame, whatever tool it has. That tip may have a
                goal of its own, with slack.
            tip: Whose it is, where it stands in a list; None for the only tip.
            T_tip_tool: What of the tip has to be at the target, in the tip link's frame, shape (4, 4) [m]: a tool on
                the flange. None for that of the call, or the options'.
            soft: Whether it is a wish: what is hard is met first, and then this as nearly as that lets it be, going
                downhill from the first solution; with `prefer="nearest"` from all. Success does not look at it.
            priority: "position": the position is met and the orientation as near as can be, with the status
                "nearest" where that is not all of it. None for that of the call, or the options'.
            position_tolerance: Largest error of a success [m]; 0 for the options'.
            rotation_tolerance: Largest error of a success [rad]; 0 for the options'.
        
        Raises:
            ValueError: A shape is wrong, a str is not one of its choices, or something is NaN.
        
        Warns:
            GoalWarning: A rotation is off by rounding, and the nearest one is taken; an angle is beyond pi.
        """
    def __repr__(self) -> str:
        ...
    @property
    def T_base_tip(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[4, 4]"]:
        """
        Of a region the middle.
        """
    @property
    def T_tip_tool(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[4, 4]"] | None:
        ...
    @property
    def axis(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"] | None:
        ...
    @property
    def position_slack(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        ...
    @property
    def position_tolerance(self) -> float:
        ...
    @property
    def priority(self) -> str | None:
        ...
    @property
    def relative_to(self) -> str | None:
        ...
    @property
    def rotation_slack(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        ...
    @property
    def rotation_tolerance(self) -> float:
        ...
    @property
    def soft(self) -> bool:
        ...
    @property
    def stands(self) -> bool:
        ...
    @property
    def tip(self) -> str | None:
        ...
    @property
    def type(self) -> str | None:
        ...
    @property
    def weight(self) -> float:
        ...
class Result:
    """
    The outcome of one solve.
    
    Every error is recomputed from q alone, so that a success can be judged without trusting the solver.
    """
    def __getstate__(self) -> tuple[typing.Any, ...]:
        ...
    def __repr__(self) -> str:
        ...
    def __setstate__(self, arg0: tuple[typing.Any, ...]) -> None:
        ...
    @property
    def balance_violation(self) -> float:
        """
        How far the centre of mass is outside its region, 0 inside [m].
        """
    @property
    def center_of_mass(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        In the base frame, shape (3,) [m]; zero where balance is not asked for.
        """
    @property
    def clearance(self) -> float:
        """
        Least distance from an obstacle (a point less its radius, a shape) to a hull or what is carried, but for contact that does not count: negative inside, infinite without obstacles or hulls [m].
        """
    @property
    def dq_dT(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"] | None:
        """
        How q follows its targets, shape (n, 6) a goal: see Derivatives. None unless `derivatives=True`.
        """
    @property
    def evaluations(self) -> int:
        """
        Forward kinematics computed, in all.
        """
    @property
    def goal_index(self) -> int:
        """
        Which of the goals of `solve_any` it meets, or comes nearest to.
        """
    @property
    def intake(self) -> float:
        """
        Of that, what taking the obstacles in took: it is not in max_time [s].
        """
    @property
    def iterations(self) -> int:
        """
        Of the inner minimisers, in all.
        """
    @property
    def late_evaluations(self) -> int:
        """
        Evaluations and looks at all obstacles begun after max_time had struck: the verdict takes one.
        """
    @property
    def limit_violation(self) -> float:
        """
        Largest over the joints [rad] or [m].
        """
    @property
    def manipulability(self) -> float | None:
        """
        See Derivatives. None unless `derivatives=True`.
        """
    @property
    def message(self) -> str:
        """
        How it went, in words: what gave, by how much, and what its tolerance is; '' of `judge` and steps.
        """
    @property
    def position_error(self) -> float:
        """
        Largest over the goals [m].
        """
    @property
    def q(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Joint positions, shape (n,) [rad] or [m].
        """
    @property
    def restarts(self) -> int:
        """
        Starts beyond the first.
        """
    @property
    def room(self) -> float:
        """
        Least of what distances from obstacles are beyond what is wanted of each pair, negative where one is nearer: without rules of contact clearance less Options.clearance [m].
        """
    @property
    def rotation_error(self) -> float:
        """
        Largest over the goals [rad]; of the axis for axis goals, 0 for position goals.
        """
    @property
    def self_distance(self) -> float:
        """
        Least distance between hulls of links that are not adjacent, where self_collision is asked for: of the capsules that hold them, never more than that of the hulls [m].
        """
    @property
    def self_room(self) -> float:
        """
        The same of what self_distance is of [m].
        """
    @property
    def singular_distance(self) -> float | None:
        """
        See Derivatives [m]. None unless `derivatives=True`.
        """
    @property
    def status(self) -> typing.Literal['solved', 'time_limit', 'exhausted', 'out_of_reach', 'base_collision', 'blocked', 'nearest']:
        """
        Why the solve ended.
        
        `solved`; `time_limit`: max_time struck first; `exhausted`: every start ended in a local minimum;
        `out_of_reach`: the target lies farther from the arm's root than its links stretch, or no joint moves its
        tip; `base_collision`: an obstacle lies in a hull that no joint moves, and no answer exists; `blocked`: what is
        rigid to the tip is in an obstacle at the target, and no answer exists, or some fifty starts that reached the
        target all ended with the same hull in the same obstacle, and none is likely; `nearest`: position and all
        constraints hold, and of a goal whose position comes first the orientation is as near as was found. In all but
        the first, q is the best found.
        """
    @property
    def success(self) -> bool:
        """
        Goal, limits and clearance hold to their tolerances.
        """
    @property
    def time(self) -> float:
        """
        Of the solve, taking in the obstacles included [s].
        """
    @property
    def worst_constraint(self) -> str:
        """
        What is missed by most, or comes nearest to that.
        """
    @property
    def worst_violation(self) -> float:
        """
        By how much the worst constraint is missed beyond its tolerance, at most 0 if it holds [m] or [rad].
        """
class Solutions:
    """
    The distinct solutions of one request: a sequence of Result, the nearest first.
    """
    def __getitem__(self, index: typing.SupportsInt | typing.SupportsIndex) -> Result:
        ...
    def __iter__(self) -> collections.abc.Iterator[Result]:
        ...
    def __len__(self) -> int:
        ...
    def __repr__(self) -> str:
        ...
    @property
    def complete(self) -> bool:
        """
        Whether it is known that there are no others: of six joints whose geometry is solved in closed form, away from singularities.
        """
    @property
    def coverage(self) -> float:
        """
        How likely it is that one more start that meets the goals comes to what was found already, clear or not; 1 where it is complete.
        """
    @property
    def q(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        Joint positions, shape (K, n) [rad] or [m].
        """
    @property
    def restarts(self) -> int:
        """
        Starts beyond the first.
        """
    @property
    def status(self) -> typing.Literal['solved', 'time_limit', 'exhausted', 'out_of_reach', 'base_collision', 'blocked', 'nearest']:
        """
        'solved' if there are any, else why not.
        """
    @property
    def time(self) -> float:
        """
        [s].
        """
    @property
    def turns(self) -> list[int]:
        """
        In how many ways whole turns of joints leave each inside limits, 1 if in none but itself, K ints.
        """
class Derivatives:
    """
    How a configuration follows its targets, and how near it is to a singularity.
    """
    @property
    def dq_dT(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        Of q by each hard goal's target: its shift [m] and turn [rad] along the base frame's axes, shape (n, 6 a goal). Joints at limits and contact stay as they are; of all that remains the least motion.
        """
    @property
    def manipulability(self) -> float:
        """
        Product of the singular values of the goals' Jacobian.
        """
    @property
    def singular_distance(self) -> float:
        """
        The least of them, turns in metres by Options.rotation_weight [m].
        """
class BatchResult:
    """
    The outcomes of a batch: a sequence of Result whose fields are columns too.
    
    A column is a new array each time it is asked for.
    """
    def __getitem__(self, index: typing.SupportsInt | typing.SupportsIndex) -> Result:
        ...
    def __iter__(self) -> collections.abc.Iterator[Result]:
        ...
    def __len__(self) -> int:
        ...
    def __repr__(self) -> str:
        ...
    @property
    def balance_violation(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Shape (B,) [m].
        """
    @property
    def clearance(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Shape (B,) [m].
        """
    @property
    def evaluations(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        Shape (B,).
        """
    @property
    def iterations(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        Shape (B,).
        """
    @property
    def late_evaluations(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        Shape (B,).
        """
    @property
    def limit_violation(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Shape (B,) [rad] or [m].
        """
    @property
    def message(self) -> numpy.typing.NDArray[numpy.str_]:
        """
        Shape (B,).
        """
    @property
    def position_error(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Shape (B,) [m].
        """
    @property
    def q(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        Joint positions, shape (B, n) [rad] or [m].
        """
    @property
    def restarts(self) -> numpy.typing.NDArray[numpy.int32]:
        """
        Shape (B,).
        """
    @property
    def rotation_error(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Shape (B,) [rad].
        """
    @property
    def self_distance(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Shape (B,) [m].
        """
    @property
    def status(self) -> numpy.typing.NDArray[numpy.str_]:
        """
        Shape (B,).
        """
    @property
    def success(self) -> numpy.typing.NDArray[numpy.bool]:
        """
        Shape (B,).
        """
    @property
    def time(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Shape (B,) [s].
        """
    @property
    def worst_constraint(self) -> numpy.typing.NDArray[numpy.str_]:
        """
        Shape (B,).
        """
    @property
    def worst_violation(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        Shape (B,) [rad] or [m].
        """
class ObstacleClearance:
    """
    How near the robot, and what it carries, is to one obstacle: see Solver.clearances.
    """
    def __repr__(self) -> str:
        ...
    @property
    def distance(self) -> float:
        """
        Negative by how deep it is; infinite where nothing is to keep off it [m].
        """
    @property
    def obstacle(self) -> str:
        """
        The shape's name, or 'points'.
        """
    @property
    def part(self) -> str:
        """
        The nearest hull, or what is carried; '' where nothing is to keep off it.
        """
    @property
    def point(self) -> int | None:
        """
        The nearest point's row, of points.
        """
class Solver:
    def __init__(self, robot: Robot, options: Options) -> None:
        ...
    def _reach_poses(self, T_base_tip: numpy.typing.ArrayLike, obstacles: numpy.typing.ArrayLike | Cloud | Scene | collections.abc.Sequence[Shape] | None = None, threads: typing.SupportsInt | typing.SupportsIndex = 0) -> tuple[numpy.typing.NDArray[numpy.uint8], numpy.typing.NDArray[numpy.float32]]:
        """
        Statuses, shape (B,), and q, shape (B, n), NaN where there is none: for reachability.
        """
    def attach(self, link: str | collections.abc.Sequence[str], shapes: collections.abc.Sequence[Shape], may_touch: collections.abc.Sequence[str] = (), contacts: collections.abc.Sequence[ContactRule] = ()) -> None:
        """
        Let a link carry solids from now on: they keep off points, shapes and the robot's other links.
        
        They count beside what links carry already, in all calls that follow. Parts of the same body, and fingers
        after it, may touch them.
        
        Args:
            link: By name; a joint must move it. Or several that hold them: they move with the first, and all of them, with
                what is rigid to them and their fingers, may touch them. That the others stay where they hold them is for
                goals to say (Goal.relative_to).
            shapes: Their poses are in the (first) link's frame. No half-spaces; meshes as convex pieces.
            may_touch: Links of the robot, shapes of scenes, what else is carried, and "points", by name or pattern, that
                they may touch. They need not be there.
            contacts: Rules of contact that count while they are carried, after a scene's. Their names need not be there.
        
        Raises:
            ValueError: There is no such link or no joint moves it, a shape is a half-space, or its name is that of
                something carried already.
        """
    def attach_all(self, things: collections.abc.Sequence[Attachment]) -> None:
        """
        `attach` for several at once: all of them, or none if any cannot be carried.
        
        Args:
            things: What each call would get; `carried` of another solver, say.
        
        Raises:
            ValueError: As `attach`.
        """
    def clearances(self, q: numpy.typing.ArrayLike, obstacles: numpy.typing.ArrayLike | Cloud | Scene | collections.abc.Sequence[Shape] | None = None) -> list[ObstacleClearance]:
        """
        How near each shape, and the points if there are any, is at a configuration.
        
        The least of them is the clearance that `judge` gives, but for what Options.touch lets touch: that depends on the
        target, which is not asked for here.
        
        Args:
            q: Joint positions, shape (n,) [rad] or [m].
            obstacles: As in `solve`.
        
        Raises:
            ValueError: As in `solve`.
        """
    def derivatives(self, T_base_tip: numpy.typing.ArrayLike | Goal | collections.abc.Sequence[Goal] | collections.abc.Mapping[str, numpy.typing.ArrayLike | Goal | collections.abc.Sequence[Goal]], q: numpy.typing.ArrayLike, obstacles: numpy.typing.ArrayLike | Cloud | Scene | collections.abc.Sequence[Shape] | None = None, *, T_tip_tool: typing.Any | None = None) -> Derivatives:
        """
        How a configuration follows its targets, and how near it is to a singularity.
        
        Args:
            T_base_tip: As in `solve`.
            q: Joint positions that meet it, shape (n,) [rad] or [m].
            obstacles: As in `solve`: what touches stays as far.
        
        Raises:
            ValueError: As in `solve`.
        """
    def detach(self, name: str | None = None) -> None:
        """
        Let a link carry nothing any more, or nobody carry an object any more, or nobody anything.
        
        Args:
            name: Of a link: what moves with another link that holds it too stays with that. Or of what is carried, of
                an object with all its pieces. None for everything.
        
        Raises:
            ValueError: Nothing has this name.
        """
    def judge(self, T_base_tip: numpy.typing.ArrayLike | Goal | collections.abc.Sequence[Goal] | collections.abc.Mapping[str, numpy.typing.ArrayLike | Goal | collections.abc.Sequence[Goal]], q: numpy.typing.ArrayLike, obstacles: numpy.typing.ArrayLike | Cloud | Scene | collections.abc.Sequence[Shape] | None = None, *, T_tip_tool: typing.Any | None = None) -> Result:
        """
        Errors, clearance, limits and verdict of a configuration, by plain forward kinematics.
        
        Args:
            T_base_tip: As in `solve`.
            q: Joint positions, shape (n,) [rad] or [m].
            obstacles: As in `solve`.
        
        Raises:
            ValueError: As in `solve`.
        """
    def plan_motion(self, q_from: numpy.typing.ArrayLike, goals: typing.Any | None = None, q_to: numpy.typing.ArrayLike | None = None, obstacles: numpy.typing.ArrayLike | Cloud | Scene | collections.abc.Sequence[Shape] | None = None, *, lock: typing.Any | None = None, T_tip_tool: typing.Any | None = None, max_time: typing.SupportsFloat | typing.SupportsIndex = 1.0, goal_count: typing.SupportsInt | typing.SupportsIndex = 16, shorten: bool = True) -> MotionResult:
        """
        Move from a configuration to another, or to any of some goals, clear of everything all along.
        
        Two trees grow towards each other (RRT-Connect, Kuffner and LaValle) on ways that are swept by intervals, then detours
        are taken out.
        
        Args:
            q_from: Where joints are, shape (n,) [rad] or [m].
            goals: One as in `solve`, or many as in `solve_any`: whichever can be had.
            q_to: Instead of goals: where joints are to be, shape (n,).
            obstacles: As in `solve`.
            lock: As in `solve`.
            T_tip_tool: As in `solve`.
            max_time: [s].
            goal_count: So many configurations that meet goals are led to, at most.
            shorten: Whether detours are taken out.
        
        Raises:
            ValueError: As in `solve_any`; neither or both of goals and q_to; an option is out of range.
        """
    def solve(self, T_base_tip: numpy.typing.ArrayLike | Goal | collections.abc.Sequence[Goal] | collections.abc.Mapping[str, numpy.typing.ArrayLike | Goal | collections.abc.Sequence[Goal]], q0: numpy.typing.ArrayLike | None = None, obstacles: numpy.typing.ArrayLike | Cloud | Scene | collections.abc.Sequence[Shape] | None = None, posture: numpy.typing.ArrayLike | None = None, max_step: numpy.typing.ArrayLike | None = None, *, lock: typing.Any | None = None, T_tip_tool: typing.Any | None = None, priority: str | None = None, derivatives: bool = False) -> Result:
        """
        Find q so that the tips meet their goals, inside joint limits, clear of obstacles.
        
        Balance and distance from itself are kept where the options ask for them.
        
        Args:
            T_base_tip: The target, which takes tip points to the base frame: shape (4, 4), rigid to 1e-6 [m]; or a
                Goal, or a list of them that say whose they are; or for several tips a dict of such by tip link. Tips
                without a goal are free.
            q0: Where to start, shape (n,) [rad] or [m], moved inside the limits; answers near it are preferred.
                None for the middle of the ranges (method "paper": omega = 0), and any answer. Continuous joints'
                answers are within pi of it.
            obstacles: A Cloud; a list of Shapes; a Scene of both; or points x y z, or x y z radius, in the base frame,
                shape (N, 3) or (N, 4) [m], taken in by each call anew. Float64 in C order is read without a
                conversion. None or empty: there are none, whatever the call before had.
            posture: A configuration that the answer comes as near to as goals and constraints let it, downhill from
                the first solution found, shape (n,) [rad] or [m].
            max_step: Hard bounds on |q - q0| of each joint, shape (n,) [rad] or [m]: speed times period. Infinity
                for none.
            lock: Joints that keep a position, by name [rad] or [m].
            T_tip_tool: What of the tip has to be at the target, in the tip link's frame, shape (4, 4) [m], or by tip
                link: a tool on the flange. Of goals that do not say it themselves; None for the options'.
            priority: "position": the position first, then the orientation as near as can be, with the status
                "nearest". Of goals that do not say it themselves; None for the options'.
            derivatives: Whether the result tells how q follows the target, as `dq_dT`.
        
        Returns:
            The result; not being able to is a status, not an exception.
        
        Raises:
            ValueError: A shape is wrong, a target is not rigid, a link is no tip, a radius or step is negative,
                something is NaN or infinite, or there are more than 33,554,432 points. There are obstacles, or the robot
                carries something, and it has no hulls: see Options.ignore_obstacles_without_hulls.
            RuntimeError: A signal's handler asks the very solver that it has interrupted.
        
        Warns:
            ObstacleWarning: Points are so far away, once for each solver, that they are in millimetres most likely.
            GoalWarning: q0 is outside limits; a rotation is off by rounding.
        """
    def solve_all(self, T_base_tip: numpy.typing.ArrayLike | Goal | collections.abc.Sequence[Goal] | collections.abc.Mapping[str, numpy.typing.ArrayLike | Goal | collections.abc.Sequence[Goal]], limit: typing.SupportsInt | typing.SupportsIndex | None = None, q0: numpy.typing.ArrayLike | None = None, obstacles: numpy.typing.ArrayLike | Cloud | Scene | collections.abc.Sequence[Shape] | None = None, *, distinct: typing.SupportsFloat | typing.SupportsIndex | None = None, posture: numpy.typing.ArrayLike | None = None, max_step: numpy.typing.ArrayLike | None = None, lock: typing.Any | None = None, T_tip_tool: typing.Any | None = None) -> Solutions:
        """
        Find all distinct solutions, the nearest first.
        
        Of arms of six joints with a wrist whose axes meet behind two parallel axes, or with three parallel axes
        (most industrial arms, UR), all that there are, by closed form and confirmed, and `complete` says so. Of others
        those that starts find until there are `limit`, max_time strikes or nothing new comes.
        
        Args:
            T_base_tip: As in `solve`.
            limit: No more than this many. None for no limit: for redundant arms max_time is one.
            q0: What they are sorted by the distance to, as in `solve`.
            obstacles: As in `solve`; solutions are clear of them.
            distinct: Two differ if a joint does by more than this [rad] or [m]. None for 0.001 where they are known in
                closed form and 0.1 else.
            posture: What they are sorted by instead of q0, as all that follows as in `solve`.
        
        Raises:
            ValueError: As in `solve`; limit or distinct is out of range.
        """
    def solve_any(self, goals: typing.Any, costs: numpy.typing.ArrayLike | None = None, q0: numpy.typing.ArrayLike | None = None, obstacles: numpy.typing.ArrayLike | Cloud | Scene | collections.abc.Sequence[Shape] | None = None, *, posture: numpy.typing.ArrayLike | None = None, max_step: numpy.typing.ArrayLike | None = None, lock: typing.Any | None = None, T_tip_tool: typing.Any | None = None, priority: str | None = None, derivatives: bool = False) -> Result:
        """
        Find q for any one of many goals, a grasp set: `result.goal_index` says which.
        
        Starts are shared among the goals. It is the first that is found; with Options.prefer "nearest" the nearest of
        all to the posture or q0; with costs the cheapest that can be met.
        
        Args:
            goals: Targets, shape (N, 4, 4) [m], or a list of whatever `solve` takes, as many as you like.
            costs: What each costs, shape (N,). None for all alike.
            q0: As all that follows, as in `solve`.
        
        Raises:
            ValueError: As in `solve`, naming which; there is no goal.
        """
    def solve_batch(self, T_base_tip: numpy.typing.ArrayLike | collections.abc.Mapping[str, numpy.typing.ArrayLike] | collections.abc.Sequence[typing.Any], q0: numpy.typing.ArrayLike | None = None, obstacles: numpy.typing.ArrayLike | Cloud | Scene | collections.abc.Sequence[Shape] | None = None, threads: typing.SupportsInt | typing.SupportsIndex = 0, *, posture: numpy.typing.ArrayLike | None = None, max_step: numpy.typing.ArrayLike | None = None, lock: typing.Any | None = None, T_tip_tool: typing.Any | None = None, priority: str | None = None) -> BatchResult:
        """
        Solve many targets among the same obstacles, on several threads, each as `solve` does.
        
        The answers are the same on any number of threads, but for those that max_time strikes. Ctrl-C ends it
        between targets.
        
        Args:
            T_base_tip: The targets, shape (B, 4, 4) [m], or a dict of such by tip link; or a list of B of whatever
                `solve` takes, of any kinds.
            q0: One start for all, shape (n,), or one each, shape (B, n). None as in `solve`.
            obstacles: As in `solve`.
            threads: 0 for one per processor.
            posture: As in `solve`, one for all or one each, shape (B, n).
            max_step: As in `solve`, one for all or one each, shape (B, n).
            lock: As in `solve`, one dict for all or a list of B.
            T_tip_tool: As in `solve`, for all.
            priority: As in `solve`, for all.
        
        Raises:
            ValueError: As in `solve`.
        """
    def solve_path(self, stations: numpy.typing.ArrayLike | collections.abc.Mapping[str, numpy.typing.ArrayLike] | collections.abc.Sequence[typing.Any], obstacles: numpy.typing.ArrayLike | Cloud | Scene | collections.abc.Sequence[Shape] | None = None, *, start: numpy.typing.ArrayLike | None = None, end: numpy.typing.ArrayLike | None = None, closed: bool = False, lock: typing.Any | None = None, T_tip_tool: typing.Any | None = None, max_time: typing.SupportsFloat | typing.SupportsIndex = 10.0, position_tolerance: typing.SupportsFloat | typing.SupportsIndex = 0.0001, rotation_tolerance: typing.SupportsFloat | typing.SupportsIndex = 0.001, max_joint_step: typing.SupportsFloat | typing.SupportsIndex = 0.12, costs: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex] | None = None, reconfigure: bool = True) -> PathResult:
        """
        Follow a whole path: a seam, a spray path, a scan.
        
        One motion meets all stations one after the other and the straight way between them, turning evenly, clear of
        everything all along; the shortest that is found. Where there is none, `ends` says where it breaks and why, and the
        answer is as few pieces as can be found, with clear moves between them.
        
        Args:
            stations: Shape (N, 4, 4) [m], or a list of whatever `solve` takes, all of the same kind: poses, regions with a
                free axis, a hand in the frame of the other. At least two, none soft, no two alike in a row.
            obstacles: As in `solve`.
            start: Joints at the first station, shape (n,) [rad] or [m]. None: any.
            end: Joints at the last station, shape (n,). None: any.
            closed: Whether it goes on from the last station to the first, and ends where it began.
            lock: As in `solve`.
            T_tip_tool: As in `solve`.
            max_time: For all of it [s].
            position_tolerance: How far the tool may be off between stations [m]. At stations the goals' own hold.
            rotation_tolerance: The same of how it is turned [rad].
            max_joint_step: Largest step of a joint from one row of the answer to the next [rad] or [m].
            costs: What is least of all whole paths that are found: weights of `motion` (1), `limits`, `obstacles`,
                `singularities` (0), and `room`, from which on contact and singularities are far [m].
            reconfigure: Whether what cannot be one motion may be several.
        
        Raises:
            ValueError: As in `solve`, naming the station; fewer than two stations, two alike in a row or of different kinds;
                a start or end outside limits or that does not meet its station; an option is out of range.
        """
    @property
    def carried(self) -> list[Attachment]:
        """
        What links carry, as it was attached.
        """
    @property
    def robot(self) -> Robot:
        """
        A copy of the robot this solver was made for, as it was then.
        """
class PathEnd:
    """
    Where a motion along a path ends, and against what.
    """
    def __repr__(self) -> str:
        ...
    @property
    def at(self) -> float:
        """
        Where on the path, in stations; or the first of some stations without a solution.
        """
    @property
    def q(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        The last configuration on it, or what comes nearest to that station, shape (n,).
        """
    @property
    def reason(self) -> str:
        """
        What a step further runs into.
        """
class PathResult:
    """
    The outcome of a whole path: see Solver.solve_path.
    """
    def __repr__(self) -> str:
        ...
    @property
    def at(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Where on the path each row is: 2.5 is half way from station 2 to 3, shape (m,).
        """
    @property
    def clearance(self) -> float:
        """
        Least of all rows; beyond 0.6 m it is told as that much [m].
        """
    @property
    def complete(self) -> bool:
        """
        Of a path that is not whole: whether all solutions where it breaks are known.
        """
    @property
    def ends(self) -> list[PathEnd]:
        """
        Where it breaks: how far motions get at the place that fewest get beyond, and what ends them, one for each reason.
        """
    @property
    def largest_step(self) -> float:
        """
        Of a joint, from one station to the next [rad] or [m].
        """
    @property
    def length(self) -> float:
        """
        How far joints go: the sum of the norms of the steps from row to row [rad] or [m].
        """
    @property
    def message(self) -> str:
        """
        How it went, for people.
        """
    @property
    def moves(self) -> list[typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]]:
        """
        Clear moves from each piece to the next, corners joined by straight lines, shape (k, n) each; without rows where none was found.
        """
    @property
    def pieces(self) -> list[tuple[int, int]]:
        """
        The rows of each piece, [first, end): one, if the path is whole.
        """
    @property
    def position_error(self) -> float:
        """
        Largest at stations [m].
        """
    @property
    def q(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        Configurations one after the other, joined by straight lines, shape (m, n) [rad] or [m]. Of several pieces all.
        """
    @property
    def rotation_error(self) -> float:
        """
        Largest at stations [rad].
        """
    @property
    def self_distance(self) -> float:
        """
        The same of links among themselves [m].
        """
    @property
    def status(self) -> typing.Literal['whole', 'pieces', 'impossible', 'not_found', 'time_limit']:
        """
        What became of it.
        
        `whole`: one motion; `pieces`: several, with moves between them where these were found; `impossible`: none, since all
        solutions of the stations are known and none goes on; `not_found`; `time_limit`.
        """
    @property
    def success(self) -> bool:
        """
        Whether one motion meets all of the path.
        """
    @property
    def time(self) -> float:
        """
        Taking in the obstacles included [s].
        """
    @property
    def unsolved(self) -> list[int]:
        """
        Stations for which no solution was found.
        """
class MotionResult:
    """
    The outcome of a move: see Solver.plan_motion.
    """
    def __repr__(self) -> str:
        ...
    @property
    def checks(self) -> int:
        """
        Looks at a configuration.
        """
    @property
    def goal_index(self) -> int | None:
        """
        Which of the goals it ends at, or None.
        """
    @property
    def length(self) -> float:
        """
        How far joints go: the sum of the norms of its steps [rad] or [m].
        """
    @property
    def q(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        Corners of the way, joined by straight lines, shape (m, n) [rad] or [m].
        """
    @property
    def reason(self) -> str:
        """
        What blocks its start or its goals, or ''.
        """
    @property
    def status(self) -> typing.Literal['solved', 'blocked_start', 'blocked_goal', 'time_limit']:
        """
        What became of it.
        
        `solved`; `blocked_start`: it would begin in something or outside limits; `blocked_goal`: no configuration that meets a
        goal is clear; `time_limit`: none was found.
        """
    @property
    def success(self) -> bool:
        """
        Whether it is there.
        """
    @property
    def time(self) -> float:
        """
        Taking in the obstacles included [s].
        """
class LatencyHistogram:
    """
    How long steps took: counts in bins that are a twelfth of an octave wide.
    """
    def __repr__(self) -> str:
        ...
    def quantile(self, share: typing.SupportsFloat | typing.SupportsIndex) -> float:
        """
        The time that a share (0 to 1) of all steps took at most, to 6 % [s].
        """
    @property
    def count(self) -> int:
        """
        The number of steps.
        """
    @property
    def counts(self) -> numpy.typing.NDArray[numpy.uint64]:
        """
        Steps in each bin, shape (B,).
        """
    @property
    def max(self) -> float:
        """
        The longest [s].
        """
    @property
    def upper_edges(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        The bins' upper ends, shape (B,) [s].
        """
class TrackerResult(Result):
    """
    The outcome of one step of a Tracker.
    """
    @property
    def complaint(self) -> str:
        """
        Why the input was refused, or ''.
        """
    @property
    def step_limited(self) -> str | None:
        """
        The first joint that its step limit holds back, or None.
        """
    @property
    def stopped_hard(self) -> bool:
        """
        Whether it stops harder than max_acceleration allows: braking only so hard would be deeper in something or leave the limits of a joint, or the input was refused.
        """
    @property
    def tracking(self) -> typing.Literal['tracking', 'infeasible', 'deadline_struck', 'invalid_input']:
        """
        What became of the step.
        
        `tracking`: goals, limits and all constraints hold; `infeasible`: they cannot be met within the step, and
        `worst_constraint` names what gives; `deadline_struck`: q is the last answer if that still solves, else the
        best so far; `invalid_input`: q is the last answer, and `complaint` says why.
        """
class Tracker:
    def __init__(self, robot: Robot, options: Options, *, period: typing.SupportsFloat | typing.SupportsIndex, max_time: typing.SupportsFloat | typing.SupportsIndex, speed_share: typing.SupportsFloat | typing.SupportsIndex, max_speed: numpy.typing.ArrayLike | None, max_acceleration: numpy.typing.ArrayLike | None, posture_weight: typing.SupportsFloat | typing.SupportsIndex, smoothness: typing.SupportsFloat | typing.SupportsIndex) -> None:
        ...
    def attach(self, link: str | collections.abc.Sequence[str], shapes: collections.abc.Sequence[Shape], may_touch: collections.abc.Sequence[str] = (), contacts: collections.abc.Sequence[ContactRule] = ()) -> None:
        """
        As Solver.attach, for the steps that follow.
        """
    def attach_all(self, things: collections.abc.Sequence[Attachment]) -> None:
        """
        As Solver.attach_all.
        """
    def clear_latency(self) -> None:
        ...
    def detach(self, name: str | None = None) -> None:
        """
        As Solver.detach.
        """
    def reset(self, q: numpy.typing.ArrayLike, velocity: numpy.typing.ArrayLike | None = None) -> None:
        """
        Where the next step starts from: the measured configuration, most often.
        
        Args:
            q: Joint positions, shape (n,) [rad] or [m]; moved inside the limits.
            velocity: How fast it moves, which counts where acceleration is limited, shape (n,) [rad/s] or [m/s]; None for
                at rest.
        
        Raises:
            ValueError: Either has another shape or holds NaN or infinity.
        """
    def set_posture(self, posture: numpy.typing.ArrayLike | None) -> None:
        """
        A posture to stay near from now on, shape (n,); None for none.
        
        Raises:
            ValueError: It has another shape or holds NaN or infinity.
        """
    def step(self, T_base_tip: numpy.typing.ArrayLike | Goal | collections.abc.Sequence[Goal] | collections.abc.Mapping[str, numpy.typing.ArrayLike | Goal | collections.abc.Sequence[Goal]], obstacles: numpy.typing.ArrayLike | Cloud | Scene | collections.abc.Sequence[Shape] | None = ..., obstacle_velocity: numpy.typing.ArrayLike | None = None) -> TrackerResult:
        """
        One step towards the goals, by the deadline. Raises nothing for bad numbers.
        
        Args:
            T_base_tip: Goals as in Solver.solve.
            obstacles: As in Solver.solve, an array with at most Options.max_obstacles rows. None or empty: there are
                none. Left out: those of the step before stay; of a Cloud its updates are seen. A cloud that makes no
                sense is refused: steps then hold the last answer until a good one comes. So do steps of a robot without
                hulls among obstacles, see Options.ignore_obstacles_without_hulls.
            obstacle_velocity: How fast these move, if they are an array of points or a list of shapes: shape (3,) for all
                or (N, 3), one for each [m/s]. They are then kept off where they are and where they will be when the step
                ends; those that move count twice in Options.max_obstacles. None: they stand still.
        
        Returns:
            Whatever the status: never farther from the last answer than the step limits, and by the scene as it is no deeper in
            anything than standing still would be, nor than contact.
        
        Raises:
            TypeError: Something is no array of numbers.
        
        Warns:
            ObstacleWarning: As in Solver.solve.
        """
    @property
    def carried(self) -> list[Attachment]:
        """
        What links carry, as it was attached.
        """
    @property
    def latency(self) -> LatencyHistogram:
        """
        Of all steps so far, in C++.
        """
    @property
    def q(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        The last answer, shape (n,).
        """
    @property
    def robot(self) -> Robot:
        ...
    @property
    def velocity(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Its speed in the last step where acceleration is limited, shape (n,); 0 else.
        """
class Lagrangian:
    def __call__(self, x: numpy.typing.ArrayLike, rho: typing.SupportsFloat | typing.SupportsIndex) -> tuple[float, typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]]:
        """
        Eq. AL and its gradient, with the multipliers as they are.
        
        Args:
            x: Variables, shape (size,).
            rho: Penalty weight.
        
        Returns:
            The value [m^2] and the gradient, shape (size,).
        
        Raises:
            ValueError: x has another shape or holds NaN or infinity, or rho is not positive.
        """
    def __init__(self, robot: Robot, options: Options, variables: str) -> None:
        ...
    def max_constraint(self, x: numpy.typing.ArrayLike) -> float:
        """
        The largest violation at x, at least 0 [m]; of a spheroid twice the depth, as in the paper.
        """
    def positions(self, x: numpy.typing.ArrayLike) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Joint positions at x, shape (n,) [rad] or [m].
        """
    def reset_multipliers(self) -> None:
        """
        Set all multipliers to zero.
        """
    def set_goals(self, goals: numpy.typing.ArrayLike | Goal | collections.abc.Sequence[Goal] | collections.abc.Mapping[str, numpy.typing.ArrayLike | Goal | collections.abc.Sequence[Goal]]) -> None:
        """
        Take goals as Solver.solve does, without slack, and forget the multipliers.
        
        Raises:
            ValueError: As in Solver.solve, or a goal has slack.
        """
    def set_obstacles(self, points: numpy.typing.ArrayLike | None) -> None:
        """
        Take points x y z, or x y z radius, shape (N, 3) or (N, 4) [m], and forget the multipliers.
        
        Raises:
            ValueError: A shape is wrong, a radius is negative, or something is NaN or infinite.
        """
    def set_target(self, T_base_tip: numpy.typing.ArrayLike) -> None:
        """
        Take a target, shape (4, 4) [m], and forget the multipliers.
        
        Raises:
            ValueError: It is not rigid to 1e-6.
        """
    def update_multipliers(self, x: numpy.typing.ArrayLike, rho: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        Algorithm IK, line 9, at x.
        """
    def variables(self, q: numpy.typing.ArrayLike) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        The variables at q, shape (size,); as slack, q is first moved a little inside its limits.
        
        Args:
            q: Joint positions, shape (n,) [rad] or [m].
        
        Raises:
            ValueError: q has another shape or holds NaN or infinity.
        """
    @property
    def last_max_constraint(self) -> float:
        """
        The largest violation there, at least 0 [m].
        """
    @property
    def last_position_error(self) -> float:
        """
        Of the tip where the value was last asked for [m].
        """
    @property
    def last_rotation_error(self) -> float:
        """
        Of the tip, or of its axis, there [rad].
        """
    @property
    def size(self) -> int:
        """
        The number of variables.
        """
class ShrinkWrap:
    """
    Moves capsules so that they hold points and what sticks out of a solid is least.
    
    Descends by Adam on an augmented Lagrangian of
        min  integral over the union, outside the solid, of f(distance)
        such that no point is outside the union,
    f = 1 + (distance / worst)^6, which punishes what sticks out farthest. The integral's derivative is cheap
    (Reynolds): where the union's free surface moves outwards by dn it grows by f dn dA. Capsules are rows of
    their ends a and b and their radius, (K, 7) [m]. The same input gives the same result.
    """
    def __init__(self, *, depth: numpy.typing.ArrayLike, origin: numpy.typing.ArrayLike, edge: typing.SupportsFloat | typing.SupportsIndex, points: numpy.typing.ArrayLike, worst: typing.SupportsFloat | typing.SupportsIndex) -> None:
        """
        Args:
            depth: Of a grid's places below the surface, < 0 outside, (X, Y, Z) [m].
            origin: The first place [m].
            edge: Between neighbours [m].
            points: What is to be held, (P, 3) [m].
            worst: The distance from where f grows fast [m].
        
        Raises:
            ValueError: A shape is wrong, an edge or worst is not positive, or something is NaN or infinite.
        """
    def lack(self, capsules: numpy.typing.ArrayLike, multiplier: typing.SupportsFloat | typing.SupportsIndex, rho: typing.SupportsFloat | typing.SupportsIndex) -> tuple[float, typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 7]"]]:
        """
        The points' part of the Lagrangian, and its gradient, (K, 7): the sum over points of
        
            (max(0, multiplier + rho g)^2 - multiplier^2) / (2 rho),
        
        g being how far each is outside the nearest capsule [m].
        """
    def move(self, capsules: numpy.typing.ArrayLike, steps: typing.SupportsInt | typing.SupportsIndex) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 7]"]:
        """
        The capsules after so many steps, (K, 7), which leave points outside by some tenths of a millimetre.
        
        Raises:
            ValueError: A capsule is not finite or a radius not positive, as what follows does.
        """
    def outside_gradient(self, capsules: numpy.typing.ArrayLike, turn: typing.SupportsFloat | typing.SupportsIndex = 0.0) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 7]"]:
        """
        The integral's derivative, (K, 7) [m^2], from 64 points on each capsule, which `turn` in [0, 1) shifts.
        """
def fastest_squares(s: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"], a: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"], b: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"], most: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
    """
    The fastest way from rest to rest along a grid.
    
    With x the square of ds/dt and u = x'/2, at both ends of each cell, on which u is constant,
    
        \\|a u + b x\\| <= 1,    0 <= x <= most
    
    Args:
        s: Rising, shape (m,).
        a: One column a constraint, shape (m, k).
        b: The same.
        most: Positive, shape (m,).
    
    Returns:
        x, shape (m,), 0 at both ends.
    
    Raises:
        ValueError: Shapes do not belong together, or s does not rise.
    """
def load_srdf_contacts(path_or_xml: str | os.PathLike[str]) -> list[ContactRule]:
    """
    What an SRDF says of collisions as rules of contact, for a Scene: `load_srdf_pairs` for more than links.
    
    A link whose collisions it disables by default may then touch shapes, points and what is carried as well. All rules
    are optional: an SRDF may be of a description with more links.
    
    Args:
        path_or_xml: A file's path, or the XML text itself (recognised by its leading "<").
    
    Raises:
        LoadError: The file cannot be read.
    """
def load_srdf_pairs(path_or_xml: str | os.PathLike[str], robot: Robot | None = None) -> list[tuple[str, str]]:
    """
    The pairs of links that an SRDF file, MoveIt's companion of a URDF, disables collisions for.
    
    Args:
        path_or_xml: A file's path, or the XML text itself (recognised by its leading "<").
        robot: Leave out pairs of links that this robot has not; None for all pairs. A file with
            `<disable_default_collisions>`, which means pairs with all links, needs it.
    
    Raises:
        LoadError: The file cannot be read, or says what pairs cannot.
    """
def pairs_always_touching(robot: Robot, samples: typing.SupportsInt | typing.SupportsIndex = 2000, seed: typing.SupportsInt | typing.SupportsIndex = 0, share: typing.SupportsFloat | typing.SupportsIndex = 0.95) -> list[tuple[str, str]]:
    """
    Pairs of links that touch in at least a share of random configurations.
    
    As MoveIt's Setup Assistant finds them: links that are close but not joined, whose overlap says nothing.
    
    Args:
        robot: Its occupancy counts.
        samples: Configurations, uniform within limits.
        seed: The same seed gives the same answer.
        share: In (0, 1].
    
    Raises:
        ValueError: A number is out of range.
    """
def pairs_touching_at(robot: Robot, q: numpy.typing.ArrayLike) -> list[tuple[str, str]]:
    """
    Pairs of links that touch at a configuration which is known to be free.
    
    Args:
        robot: Its occupancy counts.
        q: Joint positions, shape (n,) [rad] or [m].
    
    Raises:
        ValueError: q has another shape or holds NaN or infinity.
    """
def simd_name() -> str:
    """
    The instructions that this process's kernels use: "avx512", "avx2" or "baseline".
    
    The best that the processor has, or what the environment variable PDOIK_SIMD names if that is less.
    """
def voxel_downsample(points: numpy.typing.ArrayLike, leaf: typing.SupportsFloat | typing.SupportsIndex, radii: bool = False, solid: bool = False, viewpoint: numpy.typing.ArrayLike | None = None) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
    """
    Replace the points of each occupied cell of a grid by their mean (PCL's VoxelGrid).
    
    The cells are cubes, one with a corner at the origin. PCL computes in float32: means are off by up to about
    1 um per metre of the largest coordinate, and a point as near to a cell's wall may count for the neighbour.
    
    Args:
        points: Shape (N, 3) [m]. Rows with NaN or infinity, as depth cameras give, are left out. Float64 in C
            order is read in place.
        leaf: Edge of the cells [m].
        radii: Also give each kept point the radius of a ball such that the balls hold every point of the cloud.
            Clearance is then kept to the cloud as it was, not only to the means.
        solid: The points are the surface of solid things. Each ball is sunk into them, by up to two leaves along
            the normal (PCL's, of the points within a leaf), and made large enough to hold the same points: of a
            flat surface it then stands an eighth of a leaf out, not seven tenths. Whatever is made of the cloud, its points
            stay in balls. A ball stays where it is where the normal is uncertain, or where nothing is won: thin
            sheets, sharp edges, single points.
        viewpoint: Of a solid cloud, where it was seen from, shape (3,), or (N, 3) for each point [m]. What lies
            behind a seen surface counts as solid. None: inside is what the cloud encloses, at cells of half a
            leaf. Its points should be no more than a third of a leaf apart, and what is open, like a box
            that nobody saw from below, encloses nothing and stays as it is.
    
    Returns:
        The means, shape (K, 3) with K <= N, or (K, 4) with a radius in the fourth column [m]; of a solid cloud
        the balls' centres.
    
    Raises:
        ValueError: The shape is wrong, leaf is not positive and finite, the cloud is so wide that the grid
            would have more than 2^31 cells, or viewpoint is NaN, of another shape, or given without solid.
    """
