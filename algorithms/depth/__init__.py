"""Shape from one picture: relief (pixels, larger is nearer) and distance (larger is farther)."""

from algorithms.depth.body import Body, mirrored_body, relief_normals
from algorithms.depth.inflation import contour_normals, silhouette_relief
from algorithms.depth.perceptual import perceptual_relief

__all__ = [
    "Body",
    "contour_normals",
    "mirrored_body",
    "perceptual_relief",
    "relief_normals",
    "silhouette_relief",
]
