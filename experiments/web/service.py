"""What the handlers share: the study that is served, and who is asking."""

import hmac
import secrets
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Header, Request

from experiments.responses import Session
from experiments.store import Store
from experiments.study import Study
from experiments.trials import Assignment, Trial, planned_trials
from experiments.web.errors import ApiError
from experiments.web.exhibits import Exhibits
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
        """The stimulus that the instructions show with its answer."""
        return next(iter(self.stimuli.with_role("example")), None)

    def trials(self, session: Session) -> tuple[Trial, ...]:
        """Return a session's trials."""
        return planned_trials(self.study, self.stimuli, Assignment(session.participant_number))

    def accepts_people(self) -> bool:
        """Whether the study's stopping rule lets another participant begin."""
        if self.pilot:
            return True
        done = [
            session
            for session in self.store.sessions(study=self.study.name)
            if session.completed_at and not session.simulated and not session.pilot
        ]
        return len(done) < self.study.stopping.participants


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


def _service(request: Request) -> Service:
    service = request.app.state.service
    assert isinstance(service, Service)
    return service


Here = Annotated[Service, Depends(_service)]


def _bearer(authorization: Annotated[str, Header()] = "") -> str:
    scheme, _, token = authorization.partition(" ")
    if scheme.lower() != "bearer" or not token:
        raise ApiError(401, "Authorization: a header 'Bearer TOKEN' is needed")
    return token.strip()


Token = Annotated[str, Depends(_bearer)]


def _own_session(session: str, here: Here, token: Token) -> Session:
    found = here.store.authenticate(session, token)
    if found is None:
        raise ApiError(401, "Authorization: the token is not this session's")
    if (found.study_digest, found.stimuli_digest) != (here.study.digest, here.stimuli.digest):
        raise ApiError(409, "session: begun with another version of the study", "study-changed")
    return found


OwnSession = Annotated[Session, Depends(_own_session)]


def _check_study(study: str, here: Here) -> None:
    if study != here.study.name:
        raise ApiError(404, "study: there is no such study here")


def _check_researcher(here: Here, token: Token) -> None:
    if not hmac.compare_digest(token.encode(), researcher_token(here.store).encode()):
        raise ApiError(401, "Authorization: not the researcher's token")


KnownStudy = Depends(_check_study)
Researcher = Depends(_check_researcher)
