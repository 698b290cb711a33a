"""A study's data for others: the folder layout of Psych-DS, and PsychoPy's wide table.

Psych-DS 1 (psych-ds.github.io) wants `dataset_description.json` and CSV files under `data/` whose
names are made of keywords and end in `_data.csv`; every column is described.
"""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from algorithms.errors import InputError
from algorithms.files import make_folder, write_atomically
from experiments.exports.collection import Collection
from experiments.exports.data_dictionary import Column, described
from experiments.exports.export import Table, csv_bytes, session_rows, tidy
from experiments.planning.right_answers import is_right
from experiments.planning.trials import Trial
from experiments.responses import Response, Session, response_id

# What could tell who a participant is, and nobody needs who was not there.
_NOT_PUBLISHED: Final = ("device", "completion_code")
_README: Final = """# {title}

{n_sessions} sessions and {n_responses} answers of the study `{name}`, version {version}. Every
column is described in `dataset_description.json`; `materials/` holds the study itself and the
manifest of its stimuli with the SHA-256 of every image. Rows with `simulated` true are of programs,
rows with `pilot` true of trying the study out. Participants appear under their numbers.
"""


def write_psych_ds(collection: Collection, folder: Path) -> Path:
    """Write what was collected as a Psych-DS folder that can be published.

    Participants appear under their numbers, whatever code they had; what they used and their
    completion codes are left out.

    Parameters
    ----------
    collection
        From `load_collection`.
    folder
        New or empty.

    Returns
    -------
    The path of its `dataset_description.json`.

    Raises
    ------
    InputError
        If the folder holds something, or cannot be written to.
    """
    make_folder(folder)
    if any(folder.iterdir()):
        raise InputError(f"{folder}: holds other files; choose a new or empty folder")
    published = _under_numbers(collection)
    parts: Mapping[Table, Sequence[Mapping[str, Any]]] = {
        "responses": [vars(row) for row in published.responses],
        "sessions": session_rows(published.sessions, published.events),
    }
    study, columns = collection.study, list[Column]()
    make_folder(folder / "data")
    for table, rows in parts.items():
        names, flat = tidy(table, rows)
        names = [name for name in names if name not in _NOT_PUBLISHED]
        # A value of a keyword is made of letters and digits alone.
        stem = f"study-{re.sub('[^A-Za-z0-9]', '', study.name)}_description-{table}"
        write_atomically(folder / "data" / f"{stem}_data.csv", csv_bytes(names, flat))
        columns += described(table, names)
    for name, content in (("study", study), ("manifest", collection.stimuli)):
        make_folder(folder / "materials")
        written = json.dumps(content.model_dump(mode="json"), indent=1).encode()
        write_atomically(folder / "materials" / f"{name}.json", written)
    readme = _README.format(
        title=study.title,
        name=study.name,
        version=study.version,
        n_sessions=len(published.sessions),
        n_responses=len(published.responses),
    )
    write_atomically(folder / "README.md", readme.encode())
    path = folder / "dataset_description.json"
    write_atomically(path, json.dumps(_description(collection, columns), indent=1).encode())
    return path


def wide_table(collection: Collection) -> tuple[list[str], list[dict[str, Any]]]:
    """Return one row a trial as PsychoPy's wide text files have them.

    Columns are the factors of the images shown (numbered where several are shown at once),
    `trials.thisN` and `trials.thisIndex`, `response.answer`, `response.rt` and `response.corr`
    (1 or 0; empty where no answer is right), then what PsychoPy keeps of the session: what the
    participant said, `participant`, `session`, `date`, `expName`, `frameRate` (1/s).
    """
    sessions = {one.id: one for one in collection.sessions}
    rows = [_wide(collection, sessions[row.session], row) for row in collection.responses]
    return list(dict.fromkeys(name for row in rows for name in row)), rows


def _wide(collection: Collection, session: Session, response: Response) -> dict[str, Any]:
    shown = [collection.stimuli[identifier] for identifier in response.stimuli]
    factors = {
        f"{name}_{place}" if len(shown) > 1 else name: level
        for place, stimulus in enumerate(shown, start=1)
        for name, level in {"stimulus": stimulus.id, **stimulus.factors}.items()
    }
    trial = Trial(response.trial_index, response.phase, response.stimuli)
    right = is_right(collection.study, collection.stimuli, trial, response.answer)
    interval_s = response.frame_interval_s
    return {
        **factors,
        "phase": response.phase,
        "trials.thisN": response.trial_index,
        "trials.thisIndex": response.trial_index,
        "response.answer": response.answer,
        "response.rt": response.reaction_time_s,
        "response.corr": None if right is None else int(right),
        "response.started": response.onset_measured_s,
        **session.demographics,
        "participant": session.participant,
        "session": session.id,
        "date": session.started_at,
        "expName": session.study,
        "frameRate": 1 / interval_s if interval_s else None,
        "simulated": session.simulated,
        "pilot": session.pilot,
    }


def _under_numbers(collection: Collection) -> Collection:
    """Return the collection with numbers in place of the codes that participants had."""
    code = {one.id: f"P{one.participant_number:04d}" for one in collection.sessions}
    new = {old: f"{collection.study.name}.{code[old]}.1" for old in code}
    return replace(
        collection,
        sessions=[
            replace(one, id=new[one.id], participant=code[one.id]) for one in collection.sessions
        ],
        responses=[
            replace(
                row,
                id=response_id(new[row.session], row.trial_index),
                session=new[row.session],
                participant=code[row.session],
            )
            for row in collection.responses
        ],
        events=[replace(event, session=new[event.session]) for event in collection.events],
    )


def _description(collection: Collection, columns: Sequence[Column]) -> dict[str, Any]:
    study = collection.study
    unique = {column.name: column for column in columns}
    return {
        "@context": "https://schema.org/",
        "@type": "Dataset",
        "name": study.name,
        "description": study.title,
        "version": str(study.version),
        "schemaVersion": "Psych-DS 0.4.0",
        "variableMeasured": [_variable(column) for column in unique.values()],
    }


def _variable(column: Column) -> dict[str, Any]:
    return {
        "@type": "PropertyValue",
        "name": column.name,
        "description": column.description,
        **({"unitText": column.unit} if column.unit else {}),
        **({"valueReference": list(column.levels)} if column.levels else {}),
    }
