"""Sessions of adaptive designs that are under way, each as far as this server knows it."""

import threading
from collections import OrderedDict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Final

from experiments.planning.course import Course, course_of
from experiments.responses import POOL, Session
from experiments.storage.pool import assignment_of
from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet

_MOST_KEPT: Final = 2000


@dataclass
class _Kept:
    course: Course | None = None
    lock: threading.Lock = field(default_factory=threading.Lock)


class Courses:
    """The courses of sessions, kept between answers.

    The store decides: a course that another server process has led on is made anew from what is
    stored, and is the same then.

    Parameters
    ----------
    study, stimuli, store
        What is served.
    """

    def __init__(self, study: Study, stimuli: StimulusSet, store: Store) -> None:
        self._study, self._stimuli, self._store = study, stimuli, store
        self._kept: OrderedDict[str, _Kept] = OrderedDict()
        self._lock = threading.Lock()

    @contextmanager
    def of(self, session: Session, trial_index: int | None = None) -> Iterator[Course]:
        """Yield a session's course, to nobody else meanwhile.

        Parameters
        ----------
        session
            Which.
        trial_index
            The trial that must be decided; None: the course as it is stored now.
        """
        with self._lock:
            kept = self._kept.setdefault(session.id, _Kept())
            self._kept.move_to_end(session.id)
            if len(self._kept) > _MOST_KEPT:
                self._kept.popitem(last=False)
        with kept.lock:
            known = kept.course
            if known is None or trial_index is None or trial_index >= len(known.trials):
                kept.course = known = self._stored(session)
            yield known

    def _stored(self, session: Session) -> Course:
        events = self._store.events(session=session.id, kind=POOL)
        assignment = assignment_of(session, events)
        return course_of(self._study, self._stimuli, assignment, self._store.answers(session.id))
