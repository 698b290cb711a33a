"""From answers to a verdict: statistics, figures and the report."""
