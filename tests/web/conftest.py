"""A study that is being served."""

from collections.abc import Iterator

import httpx
import pytest

from experiments.store import Store
from experiments.study import Study
from experiments.web import create_app, running_server
from stimuli.manifest import StimulusSet
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
