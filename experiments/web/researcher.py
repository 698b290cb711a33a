"""The researcher's part of the API: live counts, and the responses as a table."""

from typing import Any

from fastapi import APIRouter, Response

from experiments.export import table_text
from experiments.web.progress import study_progress
from experiments.web.service import Here, KnownStudy, Researcher

router = APIRouter(prefix="/api/researcher", dependencies=[KnownStudy, Researcher])


@router.get("/{study}")
def show_progress(here: Here) -> dict[str, Any]:
    """Tell how far the study has come."""
    return study_progress(here.store, here.study, here.stimuli)


@router.get("/{study}/responses.csv")
def download_responses(here: Here) -> Response:
    """Send all responses of the study."""
    content = table_text(here.store, "responses", here.study.name)
    name = f"{here.study.name}-responses.csv"
    headers = {"Content-Disposition": f'attachment; filename="{name}"'}
    return Response(content, media_type="text/csv", headers=headers)
