"""Nothing that reaches a participant tells what a stimulus is, or which answer is right."""

import json
import re
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from algorithms.files import sha256_of
from experiments.planning.trials import Assignment, planned_trials
from experiments.storage.store import Store
from experiments.study import Study
from experiments.web import create_app, running_server
from experiments.web.pages import BUNDLE
from stimuli.manifest import StimulusSet
from tests.conftest import require
from tests.web.visitor import STUDY, Visitor


@dataclass(frozen=True)
class Visit:
    """Everything that a whole session has received."""

    replies: list[httpx.Response]
    visitor: Visitor

    def of(self, part: str) -> list[httpx.Response]:
        return [reply for reply in self.replies if part in reply.url.path]

    def text(self) -> str:
        """Every byte received: addresses, headers and bodies (latin-1 keeps each byte)."""
        return "\n".join(
            f"{reply.url}\n{reply.headers}\n{reply.content.decode('latin-1')}"
            for reply in self.replies
        )


@pytest.fixture(scope="module")
def described_set(drawn_set: StimulusSet, tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """The drawn set, but each image tells its stimulus in its metadata."""
    folder: Path = tmp_path_factory.mktemp("described")
    shutil.copytree(drawn_set.folder, folder, dirs_exist_ok=True)
    for stimulus in drawn_set.stimuli:
        notes = PngInfo()
        notes.add_text("Title", stimulus.id)
        notes.add_itxt("Comment", json.dumps(dict(stimulus.factors)))
        exif = Image.Exif()
        exif[0x010E] = f"answer {stimulus.answer}"
        with Image.open(folder / stimulus.file) as image:
            image.save(folder / stimulus.file, pnginfo=notes, exif=exif)
    files = {name: sha256_of(folder / name) for name in drawn_set.files}
    return drawn_set.model_validate({**drawn_set.model_dump(), "files": files}).write(folder)


@pytest.fixture(scope="module")
def visit(
    study: Study, described_set: StimulusSet, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Visit]:
    """A session from the first page to the completion code, every other answer right."""
    folder: Path = tmp_path_factory.mktemp("visit")
    received: list[httpx.Response] = []
    with (
        Store.open(folder / "responses.sqlite") as store,
        running_server(create_app(study, described_set, store)) as url,
        httpx.Client(base_url=url, event_hooks={"response": [received.append]}) as client,
    ):
        yield Visit(received, take_everything(Visitor(client), study, described_set))


def take_everything(visitor: Visitor, study: Study, stimuli: StimulusSet) -> Visitor:
    """Request all that a browser can request on the way through a study."""
    client = visitor.client
    client.get("/", follow_redirects=True)
    for asset in sorted(BUNDLE.glob("assets/*")):
        client.get(f"/assets/{asset.name}")
    example = client.get(f"/api/studies/{STUDY}").json()["example"]
    client.get(example["image"])
    client.get(example["regions"])
    told = visitor.begin().get().json()["trials"]
    for trial in told:
        (picture,) = trial["pictures"]
        visitor.get(picture["image"])
        visitor.get(picture["regions"])
    planned = planned_trials(study, stimuli, Assignment(visitor.number))
    for trial in planned:
        truth = stimuli[trial.stimuli[0]].answer or 1
        assert isinstance(truth, int)
        wrong = truth % study.choices + 1
        visitor.answer(trial.index, truth if trial.index % 2 else wrong)
    visitor.answer(planned[-1].index, 8, id="another")
    visitor.post("/events", {"kind": "blur"})
    visitor.get()
    assert visitor.post("/complete", None).status_code == 200
    return visitor


def test_no_name_number_or_digest_of_a_stimulus_is_in_any_byte(
    visit: Visit, described_set: StimulusSet, study: Study
) -> None:
    secrets = {
        *(stimulus.id for stimulus in described_set.stimuli),
        *described_set.files,
        *described_set.files.values(),
        described_set.name,
        described_set.generator,
        described_set.digest,
        study.digest,
        *(str(path) for path in (described_set.folder, described_set.folder.name)),
    }
    text = visit.text()
    assert [secret for secret in sorted(secrets) if secret in text] == []


def test_no_factor_or_level_is_in_any_reply_of_the_interface(
    visit: Visit, described_set: StimulusSet, study: Study
) -> None:
    words = {factor for stimulus in described_set.stimuli for factor in stimulus.factors}
    words |= {
        level
        for stimulus in described_set.stimuli
        for level in stimulus.factors.values()
        if isinstance(level, str) and len(level) > 1
    }
    words |= {"divergence", *study.design.model_dump()}
    texts = [
        f"{reply.url}\n{reply.headers}\n{reply.text}"
        for reply in visit.of("/api/")
        if reply.headers.get("content-type") != "image/png"
    ]
    found = [
        word
        for word in sorted(words)
        for text in texts
        if re.search(rf"(?<![\w-]){re.escape(word)}(?![\w-])", text, re.IGNORECASE)
    ]
    assert found == []


def test_trials_differ_in_nothing_but_number_phase_and_opaque_image(visit: Visit) -> None:
    (told, *_) = [
        reply.json()["trials"] for reply in visit.of("/api/sessions/") if "trials" in reply.text
    ]
    main = [trial for trial in told if trial["phase"] == "main"]
    images = [trial["pictures"][0].pop("image") for trial in main]
    assert len(set(images)) == len(main)
    base = re.escape(f"/api/sessions/{visit.visitor.session}/images/")
    assert all(re.fullmatch(base + "[0-9a-f]{32}", image) for image in images)
    assert [trial.pop("index") for trial in main] == list(range(3, 3 + len(main)))
    assert {json.dumps(trial, sort_keys=True) for trial in main} == {
        json.dumps(main[0], sort_keys=True)
    }


def test_replies_to_main_answers_are_the_same_right_or_wrong(visit: Visit) -> None:
    replies = [
        reply
        for reply in visit.of("/answers")
        if reply.is_success and json.loads(reply.request.content)["trial_index"] >= 3
    ]
    assert len(replies) > 20
    seen = {
        (reply.content, *sorted((k, v) for k, v in reply.headers.items() if k != "date"))
        for reply in replies
    }
    assert len(seen) == 1


def test_images_carry_pixels_and_no_description(visit: Visit, described_set: StimulusSet) -> None:
    assert b"Title" in described_set.path(described_set.stimuli[0].file).read_bytes()
    for reply in visit.of("image"):
        kinds = re.findall(rb"tEXt|zTXt|iTXt|eXIf|tIME", reply.content)
        assert kinds == []


def test_headers_of_images_differ_only_in_length(visit: Visit) -> None:
    headers = [dict(reply.headers) for reply in visit.of("/images/")]
    for header in headers:
        del header["content-length"], header["date"]
        assert {"etag", "last-modified"}.isdisjoint(header)
    assert all(header == headers[0] for header in headers)
    assert headers[0]["cache-control"].startswith("private")


def test_every_reply_carries_the_safety_headers(visit: Visit) -> None:
    for reply in visit.replies:
        assert reply.headers["x-content-type-options"] == "nosniff"
        assert reply.headers["referrer-policy"] == "no-referrer"
        policy = reply.headers["content-security-policy"]
        assert "frame-ancestors 'none'" in policy
        assert "unsafe" not in policy
        assert "server" not in reply.headers


def test_the_built_front_end_is_part_of_what_is_searched(visit: Visit) -> None:
    require(BUNDLE.is_dir(), "needs the built front end")
    scripts = [reply for reply in visit.of("/assets/") if reply.url.path.endswith(".js")]
    pages = visit.of(f"/s/{STUDY}/")
    assert scripts
    assert all(reply.status_code == 200 for reply in (*scripts, *pages))
