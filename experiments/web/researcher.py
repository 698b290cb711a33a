"""The researcher's part of the API: live counts, tables, pause, exclusion and withdrawal."""

from typing import Annotated, Any

from fastapi import APIRouter, Depends, Response

from experiments.exports.export import FORMS, Form, Table, table_bytes
from experiments.storage.admission import pause, resume
from experiments.storage.participation import exclude_session, withdraw_session
from experiments.web.errors import ApiError
from experiments.web.messages import ExclusionMessage
from experiments.web.progress import study_progress
from experiments.web.service import OfStudy, Researcher

router = APIRouter(prefix="/api/researcher", dependencies=[Researcher])


@router.get("/{study}")
def show_progress(here: OfStudy) -> dict[str, Any]:
    """Tell how far the study has come."""
    return study_progress(here.store, here.study, here.stimuli)


@router.get("/{study}/{table}.{form}")
def download_table(here: OfStudy, table: Table, form: Form) -> Response:
    """Send the study's responses, sessions or events."""
    content = table_bytes(here.store, table, here.study.name, form)
    headers = {"Content-Disposition": f'attachment; filename="{here.study.name}-{table}.{form}"'}
    return Response(content, media_type=FORMS[form], headers=headers)


@router.post("/{study}/pause", status_code=204)
def pause_study(here: OfStudy) -> None:
    """Let nobody begin; those who have begun go on."""
    pause(here.store, here.study.name)


@router.post("/{study}/resume", status_code=204)
def resume_study(here: OfStudy) -> None:
    """Let people begin again."""
    resume(here.store, here.study.name)


def _session_of_study(here: OfStudy, session: str) -> str:
    found = here.store.session(session)
    if found is None or found.study != here.study.name:
        raise ApiError(404, "session: there is no such session of this study")
    return session


SessionOfStudy = Annotated[str, Depends(_session_of_study)]


@router.post("/{study}/sessions/{session}/exclusion", status_code=204)
def exclude(here: OfStudy, session: SessionOfStudy, message: ExclusionMessage) -> None:
    """Leave a session out of the analysis; nothing of it is deleted."""
    exclude_session(here.store, session, message.reason)


@router.post("/{study}/sessions/{session}/withdrawal", status_code=204)
def withdraw(here: OfStudy, session: SessionOfStudy) -> None:
    """Erase what a participant who withdraws has left."""
    withdraw_session(here.store, session)
