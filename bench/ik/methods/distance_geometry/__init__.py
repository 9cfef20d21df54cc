"""R-TR and R-CG, the distance-geometric baselines (Maric et al. 2021).

Filip Maric, Matthew Giamou, Adam W. Hall, Soroush Khoubyarian, Ivan Petrovic, Jonathan Kelly:
"Riemannian Optimization for Distance-Geometric Inverse Kinematics", IEEE Transactions on Robotics.
Written anew on pymanopt and networkx; each file says where it departs from the paper.
"""

from bench.ik.methods.distance_geometry.solver import (
    RiemannianConjugateGradient,
    RiemannianTrustRegion,
)

__all__ = ["RiemannianConjugateGradient", "RiemannianTrustRegion"]
