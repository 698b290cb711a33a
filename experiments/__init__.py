"""Studies: their design, the answers people give, and the runners that collect them."""

from experiments.planning.course import next_trial
from experiments.planning.trials import Assignment, Trial, planned_trials
from experiments.responses import Response, load_responses
from experiments.study import Study, load_study

__all__ = [
    "Assignment",
    "Response",
    "Study",
    "Trial",
    "load_responses",
    "load_study",
    "next_trial",
    "planned_trials",
]
