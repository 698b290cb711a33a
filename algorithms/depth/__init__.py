"""Shape from one picture: relief (pixels, larger is nearer) and distance (larger is farther)."""

from algorithms.depth.body import Body, mirrored_body, relief_normals
from algorithms.depth.inflation import contour_normals, silhouette_relief
from algorithms.depth.perceptual import perceptual_relief
from algorithms.depth.planes import (
    distance_of_relief,
    layered_distance,
    receding_distance,
    scaled_distance,
)

__all__ = [
    "Body",
    "contour_normals",
    "distance_of_relief",
    "layered_distance",
    "mirrored_body",
    "perceptual_relief",
    "receding_distance",
    "relief_normals",
    "scaled_distance",
    "silhouette_relief",
]
