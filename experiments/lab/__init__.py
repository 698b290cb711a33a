"""The same study in a PsychoPy window."""
