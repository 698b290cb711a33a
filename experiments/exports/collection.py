"""All that was collected in a study: from a store, or from a bundle that left it."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final, TypeVar

from pydantic import ValidationError

from algorithms.errors import InputError
from algorithms.files import make_folder, sha256_of, write_atomically
from experiments.responses import Event, Response, Session
from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet, first_fault

BUNDLE_NAME: Final = "bundle.json"
_FORMAT: Final = 1

Row = TypeVar("Row", Response, Session, Event)


@dataclass(frozen=True)
class Collection:
    """A study with everything that was collected in it.

    Attributes
    ----------
    study, stimuli
        The newest version that has sessions, and the manifest of its set.
    sessions, responses, events
        Of all versions of the study.
    """

    study: Study
    stimuli: StimulusSet
    sessions: Sequence[Session]
    responses: Sequence[Response]
    events: Sequence[Event]


def load_collection(source: str | Path, study: str | None = None) -> Collection:
    """Load what was collected in a study.

    Parameters
    ----------
    source
        A bundle's folder, a SQLite file, or the SQLAlchemy URL of a store.
    study
        The study's name, or None if the source holds only one.

    Raises
    ------
    InputError
        If there is no such source or study, or a bundle was altered.
    """
    if Path(source).is_dir():
        return _read_bundle(Path(source), study)
    with Store.open(source, must_exist=True) as store:
        chosen, stimuli = newest_study(store, study)
        return Collection(
            chosen,
            stimuli,
            store.sessions(study=chosen.name),
            store.responses(study=chosen.name),
            store.events(study=chosen.name),
        )


def write_bundle(collection: Collection, folder: Path) -> Path:
    """Write a collection as a folder of JSON files that can be analysed anywhere.

    Parameters
    ----------
    collection
        What leaves: study, manifest with the images' SHA-256, sessions, answers and events. The
        images themselves stay.
    folder
        New or empty.

    Returns
    -------
    The path of its `bundle.json`, which holds the SHA-256 of every other file.

    Raises
    ------
    InputError
        If the folder holds something, or cannot be written to.
    """
    make_folder(folder)
    if any(folder.iterdir()):
        raise InputError(f"{folder}: holds other files; choose a new or empty folder")
    parts: Mapping[str, Any] = {
        "study": collection.study.model_dump(mode="json"),
        "manifest": collection.stimuli.model_dump(mode="json"),
        "sessions": [asdict(row) for row in collection.sessions],
        "responses": [asdict(row) for row in collection.responses],
        "events": [asdict(row) for row in collection.events],
    }
    for name, content in parts.items():
        write_atomically(folder / f"{name}.json", _json(content))
    digests = {name: sha256_of(folder / f"{name}.json") for name in parts}
    write_atomically(folder / BUNDLE_NAME, _json({"format": _FORMAT, "sha256": digests}))
    return folder / BUNDLE_NAME


def _read_bundle(folder: Path, study: str | None) -> Collection:
    index = _parse(folder / BUNDLE_NAME)
    if not isinstance(index, dict) or index.get("format") != _FORMAT:
        raise InputError(f"{folder / BUNDLE_NAME}: a bundle of format {_FORMAT} is accepted")
    parts = {}
    for name, digest in index["sha256"].items():
        path = folder / f"{name}.json"
        if sha256_of(path) != digest:
            raise InputError(f"{path}: altered since the bundle was made (its SHA-256 differs)")
        parts[name] = _parse(path)
    try:
        loaded = Study.model_validate(parts["study"])
        stimuli = StimulusSet.model_validate(parts["manifest"])
    except ValidationError as error:
        raise InputError(f"{folder}: {first_fault(error)}") from error
    if study not in (None, loaded.name):
        raise InputError(f"study: {study!r} given, the bundle holds {loaded.name}")
    return Collection(
        loaded,
        stimuli,
        _rows(Session, parts["sessions"]),
        _rows(Response, parts["responses"]),
        _rows(Event, parts["events"]),
    )


def _rows(kind: type[Row], values: Sequence[Mapping[str, Any]]) -> list[Row]:
    return [kind(**{name: _plain(value) for name, value in row.items()}) for row in values]


def _plain(value: Any) -> Any:  # noqa: ANN401  # any JSON
    return tuple(value) if isinstance(value, list) else value


def _json(content: object) -> bytes:
    return json.dumps(content, indent=1).encode() + b"\n"


def _parse(path: Path) -> Any:  # noqa: ANN401  # any JSON
    try:
        return json.loads(path.read_bytes())
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    except ValueError as error:
        raise InputError(f"{path}: not a JSON file") from error


def newest_study(store: Store, name: str | None) -> tuple[Study, StimulusSet]:
    """Return the newest version of a study that has sessions, or the newest if none has."""
    known = store.registered(name)
    if not known:
        names = sorted({study.name for study, _ in store.registered()})
        if name is None or not names:
            raise InputError("study: nothing to analyse yet, the store holds no study")
        raise InputError(f"study: {name!r} given, the store holds: {', '.join(names)}")
    names = sorted({study.name for study, _ in known})
    if len(names) > 1:
        raise InputError(f"study: the store holds {', '.join(names)}; name one of them")
    used = {(one.study_digest, one.stimuli_digest) for one in store.sessions(study=names[0])}
    with_sessions = [pair for pair in known if (pair[0].digest, pair[1].digest) in used]
    return (with_sessions or known)[-1]
