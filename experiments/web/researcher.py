"""The researcher's part of the API: live counts, tables, exclusion and withdrawal."""

from typing import Annotated, Any

from fastapi import APIRouter, Depends, Response

from experiments.export import FORMS, Form, Table, table_bytes
from experiments.participation import exclude_session, withdraw_session
from experiments.web.errors import ApiError
from experiments.web.messages import ExclusionMessage
from experiments.web.progress import study_progress
from experiments.web.service import Here, KnownStudy, Researcher

router = APIRouter(prefix="/api/researcher", dependencies=[KnownStudy, Researcher])


@router.get("/{study}")
def show_progress(here: Here) -> dict[str, Any]:
    """Tell how far the study has come."""
    return study_progress(here.store, here.study, here.stimuli)


@router.get("/{study}/{table}.{form}")
def download_table(here: Here, table: Table, form: Form) -> Response:
    """Send the study's responses, sessions or events."""
    content = table_bytes(here.store, table, here.study.name, form)
    headers = {"Content-Disposition": f'attachment; filename="{here.study.name}-{table}.{form}"'}
    return Response(content, media_type=FORMS[form], headers=headers)


def _of_study(here: Here, session: str) -> str:
    found = here.store.session(session)
    if found is None or found.study != here.study.name:
        raise ApiError(404, "session: there is no such session of this study")
    return session


OfStudy = Annotated[str, Depends(_of_study)]


@router.post("/{study}/sessions/{session}/exclusion", status_code=204)
def exclude(here: Here, session: OfStudy, message: ExclusionMessage) -> None:
    """Leave a session out of the analysis; nothing of it is deleted."""
    exclude_session(here.store, session, message.reason)


@router.post("/{study}/sessions/{session}/withdrawal", status_code=204)
def withdraw(here: Here, session: OfStudy) -> None:
    """Erase what a participant who withdraws has left."""
    withdraw_session(here.store, session)
