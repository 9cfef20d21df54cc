"""What a fit costs: the empty volume that each hull adds, and how far capsules stick out."""

from __future__ import annotations

from dataclasses import dataclass

from .overhang import Overhang


@dataclass(frozen=True, slots=True, kw_only=True)
class HullReport:
    """One hull together with what it holds."""

    link: str
    kind: str  # "sphere" or "spheroid"
    geometry_volume: float  # of the convex hull of the part it holds, [m^3]
    hull_volume: float  # [m^3]

    @property
    def empty_volume(self) -> float:
        """Hull minus the geometry it holds, [m^3]."""
        return self.hull_volume - self.geometry_volume

    @property
    def factor(self) -> float:
        return self.hull_volume / self.geometry_volume if self.geometry_volume else float("inf")


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkReport:
    """One link: its hulls overlap, so their union is what the robot loses."""

    link: str
    n_hulls: int
    geometry_volume: float  # of the convex hull of the link's whole geometry, [m^3]
    covered_volume: float  # of the union of its hulls, [m^3]
    n_capsules: int = 0
    mean_overhang: float = 0.0  # from the capsules' outer surface to the geometry, [m]
    worst_overhang: float = 0.0  # [m]
    n_pieces: int = 0  # 0: capsules alone say what it touches

    @property
    def overhang(self) -> Overhang:
        return Overhang(self.mean_overhang, self.worst_overhang)

    @property
    def factor(self) -> float:
        """Below 1 where the hulls follow a link that bends away from its convex hull."""
        return self.covered_volume / self.geometry_volume if self.geometry_volume else float("inf")


@dataclass(frozen=True, slots=True, kw_only=True)
class FitReport:
    """One row per hull, one per link, and the links that have none."""

    hulls: tuple[HullReport, ...]
    links: tuple[LinkReport, ...]
    skipped: tuple[str, ...]  # links without collision geometry
    left_out: tuple[str, ...] = ()  # links with it, not between the base and the tip asked for

    @property
    def factor(self) -> float:
        """Covered volume of all links over the volume of their convex hulls."""
        geometry = sum(row.geometry_volume for row in self.links)
        return sum(row.covered_volume for row in self.links) / geometry

    def __str__(self) -> str:
        lines = [f"{'link':24}{'hulls':>6}{'geometry l':>12}{'covered l':>12}{'factor':>8}"]
        for row in self.links:
            volumes = f"{1e3 * row.geometry_volume:12.3f}{1e3 * row.covered_volume:12.3f}"
            lines.append(f"{row.link:24}{row.n_hulls:6}{volumes}{row.factor:8.2f}")
        geometry = 1e3 * sum(row.geometry_volume for row in self.links)
        covered = 1e3 * sum(row.covered_volume for row in self.links)
        total = f"{geometry:12.3f}{covered:12.3f}{self.factor:8.2f}"
        lines.append(f"{'all':24}{len(self.hulls):6}{total}")
        if any(row.n_capsules for row in self.links):
            lines.append(
                f"{'link':24}{'capsules':>9}{'overhang: mean':>17}{'worst':>7} [mm]{'pieces':>8}"
            )
            for row in self.links:
                out = f"{1e3 * row.mean_overhang:17.2f}{1e3 * row.worst_overhang:7.2f}"
                lines.append(f"{row.link:24}{row.n_capsules:9}{out}{row.n_pieces:13}")
            lines.append(f"{'all':24}{sum(row.n_capsules for row in self.links):9}")
        lines += [f"{link:24} no collision geometry, skipped" for link in self.skipped]
        lines += [f"{link:24} not between base and tip, left out" for link in self.left_out]
        return "\n".join(lines)
