"""The web application of one study, or of several."""

from collections.abc import Sequence
from pathlib import Path

from fastapi import FastAPI
from fastapi.staticfiles import StaticFiles

from algorithms.errors import InputError
from experiments.planning.course import course_of
from experiments.planning.trials import Assignment
from experiments.storage.store import Store
from experiments.study import Study, check_stimuli
from experiments.study_parts import Display
from experiments.web import entrance, participant, researcher
from experiments.web.errors import add_error_handlers
from experiments.web.exhibits import Exhibits
from experiments.web.guard import BodyLimit, SafetyHeaders
from experiments.web.pages import BUNDLE, page_routes
from experiments.web.service import Service, Site, server_secret
from stimuli.manifest import StimulusSet


def create_app(
    study: Study,
    stimuli: StimulusSet,
    store: Store,
    *,
    pilot: bool = False,
    bundle: Path = BUNDLE,
) -> FastAPI:
    """Return the web application that runs a study; as `create_site` with this one alone."""
    return create_site([(study, stimuli)], store, pilot=pilot, bundle=bundle)


def create_site(
    studies: Sequence[tuple[Study, StimulusSet]],
    store: Store,
    *,
    pilot: bool = False,
    bundle: Path = BUNDLE,
) -> FastAPI:
    """Return the web application that runs several studies, each under links of its own.

    Parameters
    ----------
    studies
        What is run, each with its stimuli; they are registered in the store.
    store
        Where the answers go, each durable before it is acknowledged.
    pilot
        Flag every session as a pilot.
    bundle
        The folder of the built front end; without it the API works all the same.

    Raises
    ------
    InputError
        If two studies have one name, stimuli do not fit their study or are no PNG images, a study
        says what the lab alone can do, or the store holds another study of a name and version.
    """
    names = [study.name for study, _ in studies]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"study: {name} is given twice; each needs a name of its own")
    for study, stimuli in studies:
        check_stimuli(study, stimuli)
        _check_for_browsers(study)
        # A design that the stimuli do not allow is refused.
        course_of(study, stimuli, Assignment(1))
        store.register(study, stimuli)
    secret = server_secret(store)
    # No pages that describe the API: they would be one more thing that reaches participants.
    app = FastAPI(title=", ".join(names), docs_url=None, redoc_url=None, openapi_url=None)
    app.state.site = Site(
        store,
        {
            study.name: Service(study, stimuli, store, Exhibits(stimuli, secret), pilot)
            for study, stimuli in studies
        },
    )
    add_error_handlers(app)
    app.add_middleware(BodyLimit)
    app.add_middleware(SafetyHeaders)
    app.include_router(participant.router)
    app.include_router(entrance.router)
    app.include_router(researcher.router)
    app.include_router(page_routes(bundle))
    if (bundle / "assets").is_dir():
        app.mount("/assets", StaticFiles(directory=bundle / "assets"))
    return app


def _check_for_browsers(study: Study) -> None:
    """Refuse what the lab alone can do."""
    if study.display != Display():
        raise InputError("display: given, which the lab alone can do; none accepted on the web")
    if study.task == "free-viewing":
        raise InputError(
            "task: free-viewing records gaze, which no browser can; it is run in the lab"
            " (trompe study run-lab)"
        )
