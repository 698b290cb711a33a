"""A study that is being served, and a browser in front of it."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser

from experiments.storage.store import Store
from experiments.study import Study
from experiments.web import create_app, running_server
from experiments.web.pages import BUNDLE
from stimuli.manifest import StimulusSet
from tests.conftest import require
from tests.drawn_set import draw_set
from tests.web.browser import DESKTOP, OpenPage, Participant, changed, open_chromium
from tests.web.visitor import Visitor


@pytest.fixture
def client(study: Study, drawn_set: StimulusSet, store: Store) -> Iterator[httpx.Client]:
    """A client of a real server."""
    with (
        running_server(create_app(study, drawn_set, store)) as url,
        httpx.Client(base_url=url) as opened,
    ):
        yield opened


@pytest.fixture
def visitor(client: httpx.Client) -> Visitor:
    """A participant who has agreed to take part."""
    return Visitor(client).begin()


@pytest.fixture(scope="module")
def browser(chromium: str) -> Iterator[Browser]:
    """A Chromium; not for the whole run, since its event loop would be in the way of others."""
    require((BUNDLE / "index.html").is_file(), "needs the built front end (pip install -e .)")
    with open_chromium(chromium) as opened:
        yield opened


@pytest.fixture(scope="module")
def small_set(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """Three practice and six main images."""
    return draw_set(tmp_path_factory.mktemp("small"), levels_deg=(0, 40, 90), placements=("front",))


@pytest.fixture(scope="module")
def brief(study: Study) -> Study:
    """The ready-made study with short blanks, for any window."""
    return changed(study, timing={"blank_s": 0.05}, screen={})


@pytest.fixture
def open_page(browser: Browser, brief: Study, small_set: StimulusSet, store: Store) -> OpenPage:
    """Serve a study and sit a participant in front of it; no page may complain of anything."""
    usual = store

    @contextmanager
    def opened(
        study: Study = brief,
        stimuli: StimulusSet = small_set,
        window: Mapping[str, Any] = DESKTOP,
        store: Store = usual,
    ) -> Iterator[Participant]:
        with running_server(create_app(study, stimuli, store)) as url:
            context = browser.new_context(**window)
            participant = Participant(context, f"{url}/s/{study.name}/")
            try:
                yield participant
            finally:
                context.close()
            assert participant.complaints == []

    return opened
