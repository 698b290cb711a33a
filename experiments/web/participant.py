"""The participant's part of the API: the study, and a session under way."""

import asyncio
from typing import Any

from fastapi import APIRouter, Response
from fastapi.responses import JSONResponse
from starlette.concurrency import run_in_threadpool

from experiments.answers import response_in
from experiments.planning.right_answers import right_answer
from experiments.planning.trials import Answer, Trial
from experiments.responses import Session, response_id
from experiments.storage.arrivals import parameters_of
from experiments.storage.participation import withdraw_session
from experiments.study import CHOOSES
from experiments.web.errors import ApiError
from experiments.web.exhibits import region_runs
from experiments.web.messages import AnswerMessage, EventMessage
from experiments.web.service import KnownSession, OfSession, OfStudy, OwnSession, Service
from stimuli.manifest import Stimulus

router = APIRouter(prefix="/api")

_CACHED = {"Cache-Control": "private, max-age=86400"}


# The first of all routes: it is asked far more often than the others together.
@router.post("/sessions/{session}/answers")
async def record_answer(
    here: OfSession, own: KnownSession, message: AnswerMessage
) -> dict[str, Any]:
    """Store an answer; once this replies, the answer outlives the server."""
    if message.id != response_id(own.id, message.trial_index):
        raise ApiError(403, "id: not the id of this session's trial")
    if here.study.design.is_adaptive:
        return await run_in_threadpool(_record_adaptive, here, own, message)
    answer, trials = message.given(), here.trials(own)
    response = response_in(
        trials, here.study, own, message.trial_index, answer, message.measurement()
    )
    await asyncio.wrap_future(here.store.submit(response))
    trial = trials[message.trial_index]
    return {"stored": True, "feedback": _feedback(here, trial, answer)}


def _record_adaptive(here: Service, own: Session, message: AnswerMessage) -> dict[str, Any]:
    """Store an answer with why its trial was chosen, and tell the trial that follows from it."""
    answer, index = message.given(), message.trial_index
    with here.courses.of(own, index) as course:
        response = response_in(course.trials, here.study, own, index, answer, message.measurement())
        here.store.record(response, course.decision(index))
        course.take(index, answer)
        trial, *following = course.trials[index : index + 2]
    return {
        "stored": True,
        "feedback": _feedback(here, trial, answer),
        "next": _trial(here, own, following[0]) if following else None,
    }


@router.get("/studies/{study}")
def describe_study(here: OfStudy) -> dict[str, Any]:
    """Tell what a participant may know before the first trial."""
    study = here.study
    return {
        "study": study.name,
        "title": study.title,
        "question": study.question,
        "instructions": study.instructions,
        "language": study.language,
        "task": study.task,
        "choices": study.stimuli.choices,
        "consent": study.consent.model_dump(),
        "demographics": study.demographics,
        "screen": study.screen.model_dump(),
        "recruitment": {
            "parameters": study.recruitment.parameters,
            "required": bool(study.recruitment.parameters) and not here.pilot,
        },
        "timing": study.timing.model_dump(),
        "answers": study.answers.model_dump(),
        "example": _example(here),
        "closed": here.refuses(),
    }


@router.get("/studies/{study}/example/image")
def show_example(here: OfStudy) -> Response:
    """Send the example's image."""
    if here.example is None:
        raise ApiError(404, "example: the stimulus set has none")
    return Response(here.exhibits.image(here.example), media_type="image/png", headers=_CACHED)


@router.get("/studies/{study}/example/regions")
def show_example_regions(here: OfStudy) -> JSONResponse:
    """Send the example's regions."""
    if here.example is None or here.example.regions is None:
        raise ApiError(404, "example: the stimulus set has none")
    return JSONResponse(region_runs(here.stimuli.path(here.example.regions)), headers=_CACHED)


@router.get("/sessions/{session}")
def resume_session(here: OfSession, own: OwnSession) -> dict[str, Any]:
    """Tell the trials of a session, and which of them have their answer.

    Of an adaptive design these are the trials that are decided, and `adaptive` tells how many
    there are at most, and all pictures that may come, in an order that says nothing.
    """
    answers = here.store.answers(own.id)
    trials, adaptive = _known_trials(here, own)
    told = {
        trial.index: _feedback(here, trial, answers[trial.index])
        for trial in trials
        if trial.index in answers
    }
    return {
        **identity(own),
        "trials": [_trial(here, own, trial) for trial in trials],
        "adaptive": adaptive,
        "answered": sorted(answers),
        "feedback": {index: feedback for index, feedback in told.items() if feedback},
        "complete": own.completed_at is not None,
        "completion_code": own.completion_code,
        "completion_url": _completion_url(here, own.id, own.completion_code),
    }


@router.get("/sessions/{session}/images/{opaque}")
def show_image(here: OfSession, own: KnownSession, opaque: str) -> Response:
    """Send an image of one of the session's trials."""
    content = here.exhibits.find_image(own.id, opaque)
    if content is None:
        raise ApiError(404, "image: this session has no such image")
    return Response(content, media_type="image/png", headers=_CACHED)


@router.get("/sessions/{session}/regions/{opaque}")
def show_regions(here: OfSession, own: KnownSession, opaque: str) -> JSONResponse:
    """Send the regions of one of the session's trials."""
    path = here.exhibits.find_regions(own.id, opaque)
    if path is None:
        raise ApiError(404, "regions: this session has no such region map")
    return JSONResponse(region_runs(path), headers=_CACHED)


@router.post("/sessions/{session}/events", status_code=204)
def record_event(here: OfSession, own: OwnSession, message: EventMessage) -> None:
    """Store something that happened besides answers."""
    here.store.add_event(own.id, message.kind, message.detail)


@router.post("/sessions/{session}/withdrawal", status_code=204)
def withdraw(here: OfSession, own: OwnSession) -> None:
    """Erase everything that the participant has left."""
    withdraw_session(here.store, own.id)


@router.post("/sessions/{session}/complete")
def complete_session(here: OfSession, own: OwnSession) -> dict[str, str | None]:
    """Give the completion code, and where to go with it, if every trial has its answer."""
    estimates = None
    if here.study.design.is_adaptive:
        with here.courses.of(own) as course:
            missing = [] if course.next is None else [course.next.index]
            estimates = course.estimates()
    else:
        answers = here.store.answers(own.id)
        missing = [trial.index for trial in here.trials(own) if trial.index not in answers]
    if missing:
        message = f"session: {len(missing)} trials have no answer yet"
        raise ApiError(409, message, "incomplete", missing=missing)
    code = here.store.complete(own.id, estimates)
    return {"completion_code": code, "completion_url": _completion_url(here, own.id, code)}


def _completion_url(here: Service, session: str, code: str | None) -> str | None:
    if code is None:
        return None
    return here.study.recruitment.completed_at(parameters_of(here.store, session), code)


def _known_trials(here: Service, own: Session) -> tuple[tuple[Trial, ...], dict[str, Any] | None]:
    if not here.study.design.is_adaptive:
        return here.trials(own), None
    with here.courses.of(own) as course:
        possible = [_picture(here, own, here.stimuli[each]) for each in course.possible]
        pictures = sorted(possible, key=lambda picture: str(picture["image"]))
        told = {"limit": course.limit, "practice": course.practice, "pictures": pictures}
        return course.trials, told


def _example(here: Service) -> dict[str, Any] | None:
    if here.example is None:
        return None
    base = f"/api/studies/{here.study.name}/example"
    width_px, height_px = here.exhibits.size_px(here.example)
    return {
        "image": f"{base}/image",
        "width_px": width_px,
        "height_px": height_px,
        "regions": f"{base}/regions",
        "answer": right_answer(here.study, here.stimuli, Trial(0, "practice", (here.example.id,))),
    }


def identity(session: Session) -> dict[str, Any]:
    """Return what tells a session from others."""
    return {
        "session": session.id,
        "participant": session.participant,
        "participant_number": session.participant_number,
    }


def _trial(here: Service, session: Session, trial: Trial) -> dict[str, Any]:
    shown = [here.stimuli[identifier] for identifier in trial.stimuli]
    return {
        "index": trial.index,
        # Who knows which trials only test their attention pays it to those alone.
        "phase": "main" if trial.phase == "catch" else trial.phase,
        "pictures": [_picture(here, session, stimulus) for stimulus in shown],
        "feedback": trial.feedback and right_answer(here.study, here.stimuli, trial) is not None,
    }


def _picture(here: Service, session: Session, stimulus: Stimulus) -> dict[str, Any]:
    width_px, height_px = here.exhibits.size_px(stimulus)
    base, regions = f"/api/sessions/{session.id}", None
    if here.study.task in CHOOSES:
        regions = f"{base}/regions/{here.exhibits.regions_id(session.id, stimulus)}"
    return {
        "image": f"{base}/images/{here.exhibits.image_id(session.id, stimulus)}",
        "width_px": width_px,
        "height_px": height_px,
        "regions": regions,
    }


def _feedback(here: Service, trial: Trial, answer: Answer) -> dict[str, Any] | None:
    right = right_answer(here.study, here.stimuli, trial)
    if not trial.feedback or right is None:
        return None
    return {"correct": answer == right, "answer": right}
