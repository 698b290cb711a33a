"""A participant's side of the interface, for tests."""

from dataclasses import dataclass, field
from typing import Any

import httpx

STUDY = "lights-synthetic"
SAID = {"age": 30, "gender": "female", "artistic_background": True}


def consent(**changes: object) -> dict[str, Any]:
    """Return the message that opens a session."""
    return {
        "consent_version": "1",
        "demographics": SAID,
        "screen": {"width_px": 1920, "height_px": 1080, "pixel_ratio": 1.5},
        "device": "a browser",
        "simulated": False,
        **changes,
    }


@dataclass
class Visitor:
    """Someone with an open session."""

    client: httpx.Client
    begun: dict[str, Any] = field(default_factory=dict)

    def begin(self, **changes: object) -> "Visitor":
        reply = self.client.post(f"/api/studies/{STUDY}/sessions", json=consent(**changes))
        assert reply.status_code == 201, reply.text
        self.begun = reply.json()
        return self

    @property
    def session(self) -> str:
        return str(self.begun["session"])

    @property
    def number(self) -> int:
        return int(self.begun["participant_number"])

    @property
    def headers(self) -> dict[str, str]:
        return {"Authorization": f"Bearer {self.begun['token']}"}

    def get(self, path: str = "") -> httpx.Response:
        """Get what lies below the session, or at a full path that the server gave."""
        path = path if path.startswith("/api/") else f"/api/sessions/{self.session}{path}"
        return self.client.get(path, headers=self.headers)

    def post(self, path: str, message: object) -> httpx.Response:
        return self.client.post(
            f"/api/sessions/{self.session}{path}", json=message, headers=self.headers
        )

    def message(
        self, trial_index: int, answer: int | None = 3, **changes: object
    ) -> dict[str, Any]:
        """Return a valid answer's message."""
        return {
            "id": f"{self.session}.{trial_index:04d}",
            "trial_index": trial_index,
            "answer": answer,
            "reaction_time_s": 2.31,
            "onset_requested_s": 10.01,
            "onset_measured_s": 10.02,
            "frame_interval_s": 0.01667,
            "dropped_frames": 0,
            "input": "mouse",
            **changes,
        }

    def answer(self, trial_index: int, answer: int | None = 3, **changes: object) -> httpx.Response:
        return self.post("/answers", self.message(trial_index, answer, **changes))
