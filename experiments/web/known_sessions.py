"""Who is asking: sessions whose token was right before, and a limit on wrong tokens."""

import time
from collections import OrderedDict, deque
from collections.abc import Callable
from typing import Final

from starlette.concurrency import run_in_threadpool

from experiments.responses import Session
from experiments.storage.store import Store

MOST_WRONG: Final = 30
WITHIN_S: Final = 60.0
_MOST_KNOWN: Final = 20_000
_MOST_ADDRESSES: Final = 10_000


class KnownSessions:
    """Sessions by their id and token, so that not every answer asks the database for them.

    What is told of a session is as it was when the token was first seen: rely on nothing that
    changes, such as its completion. That nobody answers after a withdrawal is the database's rule.

    Parameters
    ----------
    store
        Where a session is looked up the first time.
    """

    def __init__(self, store: Store) -> None:
        self._store = store
        self._sessions: OrderedDict[tuple[str, str], Session] = OrderedDict()

    def get(self, identifier: str, token: str) -> Session | None:
        """Return a session that was seen before with this token, or None."""
        return self._sessions.get((identifier, token))

    async def authenticate(self, identifier: str, token: str) -> Session | None:
        """Return the session if the token is its own, else None."""
        known = self.get(identifier, token)
        if known is not None:
            return known
        found = await run_in_threadpool(self._store.authenticate, identifier, token)
        if found is not None and found.withdrawn_at is None:
            self._sessions[identifier, token] = found
            if len(self._sessions) > _MOST_KNOWN:
                self._sessions.popitem(last=False)
        return found


class WrongTokens:
    """Counts wrong tokens by the address they came from: after too many, no more are looked at.

    Parameters
    ----------
    most, within_s
        How many are borne from one address, and in which time.
    clock
        Seconds that only go forward.
    """

    def __init__(
        self,
        most: int = MOST_WRONG,
        within_s: float = WITHIN_S,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._most = most
        self._within_s = within_s
        self._clock = clock
        self._times: OrderedDict[str, deque[float]] = OrderedDict()

    def wait_s(self, address: str) -> float:
        """Return how long an address has to wait before its next try; 0: not at all."""
        times = self._recent(address)
        if len(times) < self._most:
            return 0.0
        return times[0] + self._within_s - self._clock()

    def add(self, address: str) -> None:
        """Count a wrong token."""
        times = self._times.setdefault(address, deque(maxlen=self._most))
        times.append(self._clock())
        self._times.move_to_end(address)
        if len(self._times) > _MOST_ADDRESSES:
            self._times.popitem(last=False)

    def _recent(self, address: str) -> deque[float]:
        times = self._times.get(address, deque())
        while times and times[0] + self._within_s <= self._clock():
            times.popleft()
        return times
