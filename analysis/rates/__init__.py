"""Hit rates and times, what they depend on, and which objects draw the eye."""
