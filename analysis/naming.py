"""What things are called in sentences, tables and figures."""

from experiments.study import Study


def level_name(study: Study) -> str:
    """Return a study's level in words, such as `divergence`."""
    level, unit = study.stimuli.level or "level", study.stimuli.level_unit
    return level.removesuffix(f"_{unit}").replace("_", " ")
