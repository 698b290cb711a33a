"""Simulated participants without a server: straight into a store."""

from collections.abc import Callable, Iterator

import numpy as np

from algorithms.errors import InputError
from experiments.answers import Measurement, response_in
from experiments.planning.course import Course, Detail, course_of
from experiments.planning.presentations import Answer, Assignment, Trial
from experiments.responses import POOL, Response, Session, now
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.observers import Observer
from experiments.storage.pool import assignment_of, needs_pool, pool_of
from experiments.storage.store import NewSession, Store
from experiments.study import Study
from stimuli.manifest import StimulusSet

AnyObserver = Observer | ItemObserver


def answer_trial(
    observer: AnyObserver,
    study: Study,
    stimuli: StimulusSet,
    trial: Trial,
    generator: np.random.Generator,
) -> tuple[Answer, float]:
    """Return an observer's answer to a trial, and the seconds that it took."""
    shown = [stimuli[identifier] for identifier in trial.stimuli]
    if isinstance(observer, Observer):
        return observer.after(trial.index).answer(study, shown[0], generator)
    items = [str(each.factors.get(study.stimuli.item or "")) for each in shown]
    return observer.after(trial.index).answer(study, items, generator)


def person_of(
    observer: AnyObserver, seed: int, number: int
) -> tuple[AnyObserver, np.random.Generator]:
    """Return the participant of a number, and where the chance in their answers comes from.

    Both depend on seed and number alone: the same participant answers alike through the web's
    interface and without it.
    """
    generator = np.random.default_rng([seed, number])
    if isinstance(observer, ItemObserver):
        observer = observer.participant(generator)
    return observer, generator


def device_of(observer: AnyObserver, seed: int) -> str:
    """Return what the rows keep as the device of a simulated participant."""
    return f"{observer.describe()}; seed {seed}"


def simulate_in_process(
    study: Study,
    stimuli: StimulusSet,
    store: Store,
    observer: AnyObserver,
    participants: int,
    generator: np.random.Generator,
    on_completed: Callable[[str], None] | None = None,
) -> list[Session]:
    """Let simulated participants take a study, one after the other, straight into a store.

    Parameters
    ----------
    study, stimuli
        What they take; both are registered in the store.
    store
        Where their answers go, every row flagged `simulated`.
    observer
        How they answer: an `ItemObserver` in comparisons and judgements.
    participants
        How many, 1 or more.
    generator
        Where chance comes from.
    on_completed
        Called with each session that is complete.

    Returns
    -------
    Their sessions, all completed.

    Raises
    ------
    InputError
        If the observer cannot answer the study's task, or has no value for what is shown.
    """
    if participants < 1:
        raise InputError(f"participants: {participants} given, 1 or more accepted")
    store.register(study, stimuli)
    seed = int(generator.integers(2**63))
    sessions = []
    for _ in range(participants):
        sessions.append(_take(study, stimuli, store, observer, seed))
        if on_completed is not None:
            on_completed(sessions[-1].id)
    return sessions


def simulate_rows(
    study: Study,
    stimuli: StimulusSet,
    observer: AnyObserver,
    participants: int,
    generator: np.random.Generator,
) -> list[Response]:
    """Return what simulated participants answer, without a store: nothing is kept.

    Parameters and errors as of `simulate_in_process`; the answers are those that an empty store
    would have.
    """
    seed = int(generator.integers(2**63))
    rows: list[Response] = []
    for number in range(1, participants + 1):
        name, said = f"P{number:04d}", device_of(observer, seed)
        session = Session(
            id=f"{study.name}.{name}.1",
            study=study.name,
            study_digest=study.digest,
            stimuli_digest=stimuli.digest,
            participant=name,
            participant_number=number,
            consent_version=study.consent.version,
            demographics={},
            screen={},
            device=said,
            runner="simulation",
            simulated=True,
            pilot=False,
            started_at=now(),
        )
        pool = pool_of(rows) if needs_pool(study) else ()
        course = course_of(study, stimuli, Assignment(number, pool))
        taken = _answers(study, stimuli, session, course, person_of(observer, seed, number))
        rows += [response for response, _ in taken]
    return rows


def _answers(
    study: Study,
    stimuli: StimulusSet,
    session: Session,
    course: Course,
    person: tuple[AnyObserver, np.random.Generator],
) -> Iterator[tuple[Response, Detail | None]]:
    """Yield a participant's answers from the first trial to the last, and why each was asked."""
    while (trial := course.next) is not None:
        answer, time_s = answer_trial(person[0], study, stimuli, trial, person[1])
        measured = Measurement(time_s, None, None, None, None, "none")
        response = response_in(course.trials, study, session, trial.index, answer, measured)
        yield response, course.decision(trial.index)
        course.take(trial.index, answer)


def _take(
    study: Study, stimuli: StimulusSet, store: Store, observer: AnyObserver, seed: int
) -> Session:
    new = NewSession("simulation", device_of(observer, seed), {}, {}, simulated=True)
    session, _ = store.begin_session(study, stimuli, new)
    events = store.events(session=session.id, kind=POOL)
    course = course_of(study, stimuli, assignment_of(session, events))
    person = person_of(observer, seed, session.participant_number)
    answers = list(_answers(study, stimuli, session, course, person))  # stored in few commits
    stored = [store.submit(response, decision) for response, decision in answers]
    for each in stored:
        each.result()
    store.complete(session.id, course.estimates())
    completed = store.session(session.id)
    assert completed is not None
    return completed
