"""How a participant comes to a session, for the first time or again, and keeps it to one page."""

import hashlib
import hmac
from collections.abc import Mapping
from typing import Any

from fastapi import APIRouter, Request
from sqlalchemy.engine import Connection

from algorithms.errors import InputError
from experiments.demographics import check_demographics
from experiments.responses import Session
from experiments.screens import screen_faults
from experiments.storage.admission import Closed, closed_in
from experiments.storage.arrivals import Arrival, add_arrival, arrived
from experiments.storage.leases import end_lease, renew_lease
from experiments.storage.store import NewSession
from experiments.study import Study
from experiments.web.errors import ApiError
from experiments.web.messages import LeaseMessage, NewSessionMessage, ReturnMessage
from experiments.web.participant import identity
from experiments.web.service import (
    Here,
    OfSession,
    OfStudy,
    OwnSession,
    Service,
    server_secret,
)

router = APIRouter(prefix="/api")

_REFUSED: Mapping[Closed, str] = {
    "paused": "study: paused; nobody can begin now",
    "full": "study: it has all its participants",
    "busy": "study: as many as are needed are taking part; a place may become free",
}


@router.post("/studies/{study}/sessions", status_code=201)
def begin_session(here: OfStudy, message: NewSessionMessage) -> dict[str, Any]:
    """Open a session for a participant who has agreed to take part; the same for who has one."""
    study = here.study
    if message.consent_version != study.consent.version:
        raise ApiError(409, "consent_version: the text has changed; read it again", "consent")
    arrival = _arrival(here, message)
    if arrival is not None and (earlier := arrived(here.store, study.name, arrival.key)):
        return _opened(earlier, _token(here, arrival))

    def admit(connection: Connection) -> None:
        why = None if here.pilot or message.simulated else closed_in(connection, study)
        if why is not None:
            raise ApiError(409, _REFUSED[why], why)

    def keep(connection: Connection, session: Session) -> None:
        if arrival is not None:
            add_arrival(connection, session, arrival)

    session, token = here.store.begin_session(
        study,
        here.stimuli,
        _new_session(here, message),
        token=None if arrival is None else _token(here, arrival),
        admit=admit,
        on_begun=keep,
    )
    return _opened(session, token)


@router.post("/studies/{study}/return")
def come_back(
    request: Request, site: Here, here: OfStudy, message: ReturnMessage
) -> dict[str, Any]:
    """Give back the session of who comes by the same recruitment link again."""
    arrival = _recruited(here.study, message.recruitment)
    site.refuse_too_many(request)
    earlier = None if arrival is None else arrived(here.store, here.study.name, arrival.key)
    if arrival is None or earlier is None:
        site.count_wrong(request)  # or identifiers could be guessed
        raise ApiError(404, "recruitment: nobody has begun with these")
    return _opened(earlier, _token(here, arrival))


@router.post("/sessions/{session}/lease", status_code=204)
def keep_session(here: OfSession, own: OwnSession, message: LeaseMessage) -> None:
    """Let a page have the session, for a while, if no other page has it."""
    if not renew_lease(here.store, own.id, message.page):
        raise ApiError(409, "session: another page has it open", "open-elsewhere")


@router.post("/sessions/{session}/lease/end", status_code=204)
def leave_session(here: OfSession, own: OwnSession, message: LeaseMessage) -> None:
    """Let the next page have the session soon, unless this one was only reloaded."""
    end_lease(here.store, own.id, message.page)


def _new_session(here: Service, message: NewSessionMessage) -> NewSession:
    faults = screen_faults(here.study.screen, message.screen)
    if faults and here.study.screen.rule == "refuse" and not message.simulated:
        raise ApiError(409, f"screen: falls short in {', '.join(faults)}", "screen")
    return NewSession(
        runner="web",
        device=message.device,
        demographics=check_demographics(here.study, message.demographics),
        screen={**message.screen, "faults": ", ".join(faults)} if faults else message.screen,
        simulated=message.simulated,
        pilot=here.pilot,
    )


def _arrival(here: Service, message: NewSessionMessage) -> Arrival | None:
    """Return what tells a participant from others; None for programs that do not say."""
    recruited = _recruited(here.study, message.recruitment)
    if recruited is not None:
        return recruited
    if here.study.recruitment.parameters and not (message.simulated or here.pilot):
        names = ", ".join(here.study.recruitment.parameters)
        raise ApiError(422, f"recruitment: missing; {names} accepted", "recruitment")
    return None if message.arrival is None else Arrival(f"drawn {message.arrival}")


def _recruited(study: Study, given: Mapping[str, str]) -> Arrival | None:
    declared = study.recruitment.parameters
    for name in given:
        if name not in declared:
            raise InputError(f"recruitment.{name}: {study.name} does not declare it")
    if not declared or not given.get(declared[0]):
        return None
    return Arrival(f"{declared[0]} {given[declared[0]]}", given)


def _token(here: Service, arrival: Arrival) -> str:
    """Return the token of an arrival's session, which the store keeps only as a hash."""
    message = f"{here.study.name}\n{arrival.key}".encode()
    return hmac.new(server_secret(here.store).encode(), message, hashlib.sha256).hexdigest()


def _opened(session: Session, token: str) -> dict[str, Any]:
    return {"token": token, **identity(session)}
