"""What things are called in sentences, tables and figures."""

import math

from experiments.study import Study


def level_name(study: Study) -> str:
    """Return a study's level in words, such as `divergence`."""
    level, unit = study.stimuli.level or "level", study.stimuli.level_unit
    return level.removesuffix(f"_{unit}").replace("_", " ")


def p_text(p_value: float) -> str:
    """Return a p-value as it stands in a sentence.

    >>> p_text(0.0321), p_text(0.00001), p_text(1.0)
    ('= 0.032', '< 0.001', '= 1.000')
    """
    if math.isnan(p_value):
        return "none"
    if p_value < 0.001:
        return "< 0.001"
    return f"= {p_value:.3f}"
