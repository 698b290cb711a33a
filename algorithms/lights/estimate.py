"""What light detection finds."""

from dataclasses import asdict, dataclass
from typing import Any, Literal

from algorithms.light import Light

Method = Literal["fitting", "voting"]


@dataclass(frozen=True)
class LightEstimate:
    """The lights that shine on one object.

    Attributes
    ----------
    lights
        The strongest first. As the object's albedo is unknown, an intensity is the luminance that
        the object's surface would have if it faced that light, in the image's unit: only ratios
        tell of the lights. A distance counts in radii of the object, from its centre.
    ambient
        Luminance of the surface under the light that comes from everywhere, in the same unit.
    residual
        What the lights leave unexplained along the outline: the root mean square, as a share of
        the outline's largest luminance.
    confidence
        0..1: the share of the luminance's variance, along the outline and inside, that the lights
        explain. Low where texture, gloss, shadows or other shapes rule.
    method
        Which found them.
    remarks
        What was left out or assumed, a sentence each.
    """

    lights: tuple[Light, ...]
    ambient: float
    residual: float
    confidence: float
    method: Method
    remarks: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON takes it."""
        return asdict(self)
