"""Studies: their design, the answers people give, and the runners that collect them."""

from experiments.course import next_trial
from experiments.responses import Response, load_responses
from experiments.study import Study, load_study
from experiments.trials import Assignment, Trial, planned_trials

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
