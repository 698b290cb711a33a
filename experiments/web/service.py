"""What the handlers share: the studies that are served, and who is asking."""

import hmac
import math
import secrets
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Annotated

from fastapi import Depends, Header, Request

from experiments.planning.trials import Assignment, Trial, planned_trials
from experiments.responses import Session
from experiments.storage.admission import Closed, closed
from experiments.storage.store import Store
from experiments.study import CHOOSES, Study
from experiments.web.courses import Courses
from experiments.web.errors import ApiError
from experiments.web.exhibits import Exhibits
from experiments.web.known_sessions import KnownSessions, WrongTokens
from stimuli.manifest import Stimulus, StimulusSet


@dataclass(frozen=True)
class Service:
    """One study, served with one stimulus set into one store."""

    study: Study
    stimuli: StimulusSet
    store: Store
    exhibits: Exhibits
    pilot: bool

    @property
    def example(self) -> Stimulus | None:
        """The stimulus that the instructions show with its answer, where objects are chosen."""
        if self.study.task not in CHOOSES:
            return None
        return next(iter(self.stimuli.with_role("example")), None)

    @cached_property
    def courses(self) -> Courses:
        """The sessions under way, of an adaptive design."""
        return Courses(self.study, self.stimuli, self.store)

    def trials(self, session: Session) -> tuple[Trial, ...]:
        """Return a session's trials, of a fixed design."""
        return self._planned(session.participant_number)

    @cached_property
    def _planned(self) -> Callable[[int], tuple[Trial, ...]]:
        """What a participant's number plans, kept: every answer asks for it."""

        @lru_cache(maxsize=2000)
        def planned(number: int) -> tuple[Trial, ...]:
            return planned_trials(self.study, self.stimuli, Assignment(number))

        return planned

    @cached_property
    def digests(self) -> tuple[str, str]:
        """What is served, exactly: the digests of study and set."""
        return self.study.digest, self.stimuli.digest

    def refuses(self) -> Closed | None:
        """Return why no person may begin the study now, or None where they may."""
        return None if self.pilot else closed(self.store, self.study)


@dataclass(frozen=True)
class Site:
    """All studies that are served from one store, by their names."""

    store: Store
    services: Mapping[str, Service]
    wrong_tokens: WrongTokens = field(default_factory=WrongTokens)

    @cached_property
    def known_sessions(self) -> KnownSessions:
        """The sessions that were seen before."""
        return KnownSessions(self.store)

    def refuse_too_many(self, request: Request) -> None:
        """Refuse who has told too many wrong tokens.

        Raises
        ------
        ApiError
            With 429, and how long to wait.
        """
        wait_s = math.ceil(self.wrong_tokens.wait_s(_address(request)))
        if wait_s > 0:
            message = f"Authorization: too many wrong tokens from here; try again in {wait_s} s"
            raise ApiError(429, message, headers={"Retry-After": str(wait_s)})

    def count_wrong(self, request: Request) -> None:
        """Count a wrong token."""
        self.wrong_tokens.add(_address(request))


def researcher_token(store: Store) -> str:
    """Return the secret that opens the researcher's page; it is the store's own for good."""
    return store.setting("researcher_token", lambda: secrets.token_urlsafe(24))


def links(url: str, study: Study, store: Store) -> dict[str, str]:
    """Return the participants' and the researcher's link to a study.

    The researcher's token stands behind the `#`, which browsers keep to themselves: it reaches
    neither the server's logs nor those on the way.
    """
    return {
        "participants": f"{url}/s/{study.name}/",
        "researcher": f"{url}/researcher/{study.name}/#{researcher_token(store)}",
    }


def server_secret(store: Store) -> str:
    """Return the secret from which opaque ids are made; it is the store's own for good."""
    return store.setting("server_secret", lambda: secrets.token_hex(32))


# Dependencies are asynchronous: others would each wait for a thread of their own.


async def _site(request: Request) -> Site:
    site = request.app.state.site
    assert isinstance(site, Site)
    return site


Here = Annotated[Site, Depends(_site)]


async def _of_study(study: str, here: Here) -> Service:
    found = here.services.get(study)
    if found is None:
        raise ApiError(404, "study: there is no such study here")
    return found


OfStudy = Annotated[Service, Depends(_of_study)]
"""The study that the address names."""


async def _of_session(session: str, here: Here) -> Service:
    # A session's id begins with its study's name, in which there is no dot.
    found = here.services.get(session.partition(".")[0])
    if found is None:
        raise ApiError(401, "session: there is no such session here")
    return found


OfSession = Annotated[Service, Depends(_of_session)]
"""The study of the session that the address names."""


async def _bearer(authorization: Annotated[str, Header()] = "") -> str:
    scheme, _, token = authorization.partition(" ")
    if scheme.lower() != "bearer" or not token:
        raise ApiError(401, "Authorization: a header 'Bearer TOKEN' is needed")
    return token.strip()


Token = Annotated[str, Depends(_bearer)]


async def _known_session(
    request: Request, session: str, here: Here, served: OfSession, token: Token
) -> Session:
    found = here.known_sessions.get(session, token)
    if found is None:
        here.refuse_too_many(request)
        found = await here.known_sessions.authenticate(session, token)
    if found is None:
        here.count_wrong(request)
        raise ApiError(401, "Authorization: the token is not this session's")
    if found.withdrawn_at is not None:
        raise ApiError(410, "session: withdrawn; nothing more is stored of it", "withdrawn")
    if (found.study_digest, found.stimuli_digest) != served.digests:
        raise ApiError(409, "session: begun with another version of the study", "study-changed")
    return found


KnownSession = Annotated[Session, Depends(_known_session)]
"""The session of who asks, as it was when it was first seen: for what never changes of it."""


def _own_session(here: Here, known: KnownSession) -> Session:
    found = here.store.session(known.id)
    if found is None or found.withdrawn_at is not None:
        raise ApiError(410, "session: withdrawn; nothing more is stored of it", "withdrawn")
    return found


OwnSession = Annotated[Session, Depends(_own_session)]
"""The session of who asks, as it is now."""


def _check_researcher(request: Request, here: Here, token: Token) -> None:
    here.refuse_too_many(request)
    if not hmac.compare_digest(token.encode(), researcher_token(here.store).encode()):
        here.count_wrong(request)
        raise ApiError(401, "Authorization: not the researcher's token")


Researcher = Depends(_check_researcher)


def _address(request: Request) -> str:
    return request.client.host if request.client else ""
