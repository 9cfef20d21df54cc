"""Pictures of solutions: the arm, what it holds, what is around, where the tip is and should be."""

from pdoik._extras import asks_for

with asks_for("plot"):
    from pdoik.picture.solution import draw_solution

__all__ = ["draw_solution"]
