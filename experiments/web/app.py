"""The web application of one study."""

from pathlib import Path

from fastapi import FastAPI
from fastapi.staticfiles import StaticFiles

from algorithms.errors import InputError
from experiments.course import course_of
from experiments.store import Store
from experiments.study import Study, check_stimuli
from experiments.study_parts import Display
from experiments.trials import Assignment
from experiments.web import participant, researcher
from experiments.web.errors import add_error_handlers
from experiments.web.exhibits import Exhibits
from experiments.web.guard import BodyLimit, SafetyHeaders
from experiments.web.pages import BUNDLE, page_routes
from experiments.web.service import Service, server_secret
from stimuli.manifest import StimulusSet


def create_app(
    study: Study,
    stimuli: StimulusSet,
    store: Store,
    *,
    pilot: bool = False,
    bundle: Path = BUNDLE,
) -> FastAPI:
    """Return the web application that runs a study.

    Parameters
    ----------
    study, stimuli
        What is run; they are registered in the store.
    store
        Where the answers go, each durable before it is acknowledged.
    pilot
        Flag every session as a pilot.
    bundle
        The folder of the built front end; without it the API works all the same.

    Raises
    ------
    InputError
        If the stimuli do not fit the study, are no PNG images, or the store holds another study
        of this name and version.
    """
    check_stimuli(study, stimuli)
    if study.display != Display():
        raise InputError("display: given, which the lab alone can do; none accepted on the web")
    course_of(study, stimuli, Assignment(1))  # a design that the stimuli do not allow is refused
    store.register(study, stimuli)
    exhibits = Exhibits(stimuli, server_secret(store))
    # No pages that describe the API: they would be one more thing that reaches participants.
    app = FastAPI(title=study.title, docs_url=None, redoc_url=None, openapi_url=None)
    app.state.service = Service(study, stimuli, store, exhibits, pilot)
    add_error_handlers(app)
    app.add_middleware(BodyLimit)
    app.add_middleware(SafetyHeaders)
    app.include_router(participant.router)
    app.include_router(researcher.router)
    app.include_router(page_routes(bundle))
    if (bundle / "assets").is_dir():
        app.mount("/assets", StaticFiles(directory=bundle / "assets"))
    return app
