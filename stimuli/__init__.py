"""Controlled stimuli with exact ground truth."""

from stimuli.manifest import Stimulus, StimulusSet, load

__all__ = ["Stimulus", "StimulusSet", "load"]
