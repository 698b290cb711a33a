"""Which view shows which task in the window."""

from collections.abc import Mapping
from typing import Any

from experiments.lab.free_viewing import FreeViewingView
from experiments.lab.odd_one_out import OddOneOutView
from experiments.lab.pick import PickView
from experiments.lab.ranking import RankingView
from experiments.lab.task_view import TaskView
from experiments.lab.two_alternative import TwoAlternativeView
from experiments.lab.window import LabWindow
from experiments.lab.yes_no import YesNoView
from experiments.study import Study, Task
from stimuli.manifest import StimulusSet

_VIEWS: Mapping[Task, type[TaskView[Any]]] = {
    "odd-one-out": OddOneOutView,
    "two-alternative": TwoAlternativeView,
    "yes-no": YesNoView,
    "ranking": RankingView,
    "pick": PickView,
    "free-viewing": FreeViewingView,
}


def view_of(window: LabWindow, study: Study, stimuli: StimulusSet) -> TaskView[Any]:
    """Return what shows the trials of a study's task."""
    return _VIEWS[study.task](window, study, stimuli)
