"""Simulated participants who take a study through the real HTTP interface."""

import hashlib
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import httpx
import numpy as np

from algorithms.errors import InputError
from experiments.demographics import GENDERS
from experiments.planning.trials import Answer, Assignment, Trial, planned_trials
from experiments.responses import response_id
from experiments.simulated.simulation import AnyObserver, answer_trial, device_of, person_of
from experiments.study import Study
from experiments.web.exhibits import shown_png
from stimuli.manifest import StimulusSet

_TIMEOUT_S = 60.0


def simulate_over_http(
    url: str,
    participants: int,
    observer: AnyObserver,
    study: Study,
    stimuli: StimulusSet,
    generator: np.random.Generator,
    *,
    concurrency: int = 4,
    images: int = 1,
    on_completed: Callable[[str], None] | None = None,
) -> list[str]:
    """Let simulated participants take a study that is being served.

    They know what is odd from the stimulus set on disk and from the number that the server gave
    them (of an adaptive design: from the images), never from what the server says. Every answer is
    flagged `simulated`. The answers depend on the generator and the participants' numbers alone,
    not on who comes first; of active pairs on what others have answered, too.

    Parameters
    ----------
    url
        The server's base URL, such as `http://127.0.0.1:8000`.
    participants
        How many, 1 or more.
    observer
        How they answer: an `ItemObserver` in comparisons and judgements.
    study, stimuli
        What is being served.
    generator
        Where chance comes from.
    concurrency
        How many take part at the same time.
    images
        How many of its images each participant fetches and compares with the set on disk.
    on_completed
        Called with each session that is complete.

    Returns
    -------
    The ids of the sessions, in the order of the participants' numbers.

    Raises
    ------
    InputError
        If the server cannot be reached, refuses something, or serves another study or set.
    """
    for name, value in (("participants", participants), ("concurrency", concurrency)):
        if value < 1:
            raise InputError(f"{name}: {value} given, 1 or more accepted")
    seed = int(generator.integers(2**63))
    pictures = _pictures(stimuli) if study.design.is_adaptive else {}

    def take_part(client: httpx.Client) -> tuple[int, str]:
        visit = _Visit(client, observer, study, stimuli, seed, images, pictures)
        number, session = visit.take_part()
        if on_completed is not None:
            on_completed(session)
        return number, session

    with _client(url) as client, ThreadPoolExecutor(concurrency) as pool:
        finished = list(pool.map(take_part, [client] * participants))
    return [session for _, session in sorted(finished)]


def _pictures(stimuli: StimulusSet) -> dict[str, str]:
    """Return the stimuli's ids by the SHA-256 of their images as they are sent."""
    return {
        hashlib.sha256(shown_png(stimuli.path(each.file).read_bytes())).hexdigest(): each.id
        for each in stimuli.stimuli
    }


def _client(url: str) -> httpx.Client:
    try:
        return httpx.Client(base_url=url, timeout=_TIMEOUT_S)
    except httpx.InvalidURL as error:
        raise InputError(f"url: {url!r} is not an address ({error})") from None


@dataclass(frozen=True)
class _Visit:
    """One simulated participant."""

    client: httpx.Client
    observer: AnyObserver
    study: Study
    stimuli: StimulusSet
    seed: int
    images: int
    pictures: Mapping[str, str]

    def take_part(self) -> tuple[int, str]:
        """Take the study from consent to completion; return the number and the session."""
        begun = self._begin()
        session, number = str(begun["session"]), int(begun["participant_number"])
        token, base = str(begun["token"]), f"/api/sessions/{session}"
        person, generator = person_of(self.observer, self.seed, number)
        told = self._call("GET", base, token).json()["trials"]

        def take(trial: Trial) -> dict[str, Any]:
            answered = answer_trial(person, self.study, self.stimuli, trial, generator)
            message = self._answer(session, trial, *answered)
            reply: dict[str, Any] = self._call("POST", f"{base}/answers", token, message).json()
            return reply

        if self.study.design.is_adaptive:
            self._follow(told[0], token, take)
        else:
            trials = planned_trials(self.study, self.stimuli, Assignment(number))
            self._compare_images(trials, told, token)
            for trial in trials:
                take(trial)
        self._call("POST", f"{base}/complete", token)
        return number, session

    def _follow(
        self, first: dict[str, Any], token: str, take: Callable[[Trial], dict[str, Any]]
    ) -> None:
        """Take one trial after the other as the server decides them, known by their images."""
        told: dict[str, Any] | None = first
        known: dict[str, str] = {}
        while told is not None:
            addresses = [picture["image"] for picture in told["pictures"]]
            for address in addresses:
                if address not in known:
                    known[address] = self._recognised(self._call("GET", address, token).content)
            shown = tuple(known[address] for address in addresses)
            told = take(Trial(told["index"], told["phase"], shown))["next"]

    def _recognised(self, image: bytes) -> str:
        """Return the id of the stimulus whose image this is."""
        found = self.pictures.get(hashlib.sha256(image).hexdigest())
        if found is None:
            raise InputError("url: the server shows other images than the set given here")
        return found

    def _begin(self) -> dict[str, Any]:
        # Nobody has an age or a gender here; the study may ask for them all the same.
        said = {"age": 30, "gender": GENDERS[-1], "artistic_background": False}
        message = {
            "consent_version": self.study.consent.version,
            "demographics": {key: said[key] for key in self.study.demographics},
            "screen": {},
            "device": device_of(self.observer, self.seed),
            "simulated": True,
        }
        path = f"/api/studies/{self.study.name}/sessions"
        begun: dict[str, Any] = self._call("POST", path, None, message).json()
        return begun

    def _compare_images(
        self, trials: tuple[Trial, ...], told: list[dict[str, Any]], token: str
    ) -> None:
        if len(told) != len(trials):
            raise InputError(
                f"url: the server has {len(told)} trials, the study and set here {len(trials)}"
            )
        for trial, seen in list(zip(trials, told, strict=True))[: self.images]:
            for identifier, picture in zip(trial.stimuli, seen["pictures"], strict=True):
                path = self.stimuli.path(self.stimuli[identifier].file)
                shown = self._call("GET", picture["image"], token).content
                if shown != shown_png(path.read_bytes()):
                    raise InputError("url: the server shows other images than the set given here")

    def _answer(
        self, session: str, trial: Trial, answer: Answer, reaction_time_s: float
    ) -> dict[str, Any]:
        return {
            "id": response_id(session, trial.index),
            "trial_index": trial.index,
            "answer": answer,
            "reaction_time_s": reaction_time_s,
            "onset_requested_s": None,
            "onset_measured_s": None,
            "frame_interval_s": None,
            "dropped_frames": None,
            "input": "none",
        }

    def _call(
        self, method: str, path: str, token: str | None, message: object = None
    ) -> httpx.Response:
        headers = {} if token is None else {"Authorization": f"Bearer {token}"}
        try:
            reply = self.client.request(method, path, json=message, headers=headers)
        except httpx.HTTPError as error:
            raise InputError(f"url: {self.client.base_url} does not answer ({error})") from error
        if reply.is_error:
            raise InputError(f"url: the server refused {method} {path}: {_reason(reply)}")
        return reply


def _reason(reply: httpx.Response) -> str:
    try:
        return str(reply.json()["error"]["message"])
    except (ValueError, KeyError, TypeError):
        return f"status {reply.status_code}"
