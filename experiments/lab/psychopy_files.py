"""PsychoPy's own CSV and psydat files beside the rows of the store."""

import tempfile
from pathlib import Path

from algorithms.files import make_folder, write_atomically
from experiments.responses import Response, Session
from experiments.study import Study


class PsychoPyFiles:
    """The files of one sitting, written anew after every answer.

    They are called after the session; those of a later sitting of the same session end in
    `.part-2` and so on.

    Parameters
    ----------
    folder
        Where they go; made if it does not exist.
    study, session
        What is run.
    refresh_hz
        The display's measured refresh rate, or None.

    Raises
    ------
    InputError
        If the folder cannot be written to.
    """

    def __init__(
        self, folder: Path, study: Study, session: Session, refresh_hz: float | None
    ) -> None:
        import psychopy
        from psychopy import data

        self._stem = _free_stem(make_folder(folder), session.id)
        self._handler = data.ExperimentHandler(
            name=study.name,
            version=str(study.version),
            extraInfo={
                "date": session.started_at,
                "psychopyVersion": psychopy.__version__,
                "frameRate": refresh_hz,
            },
            originPath="",
            savePickle=False,
            saveWideText=False,
        )

    def add(self, response: Response) -> None:
        """Add an answered trial and write both files.

        Raises
        ------
        InputError
            If they cannot be written.
        """
        for column, value in vars(response).items():
            self._handler.addData(column, " ".join(value) if column == "stimuli" else value)
        self._handler.nextEntry()
        with tempfile.TemporaryDirectory() as temporary:
            stem = Path(temporary) / "trials"
            self._handler.saveAsWideText(f"{stem}.csv", fileCollisionMethod="overwrite")
            self._handler.saveAsPickle(f"{stem}.psydat", fileCollisionMethod="overwrite")
            for suffix in (".csv", ".psydat"):
                content = Path(f"{stem}{suffix}").read_bytes()
                write_atomically(Path(f"{self._stem}{suffix}"), content)


def _free_stem(folder: Path, session: str) -> Path:
    stem, part = folder / session, 1
    while Path(f"{stem}.csv").exists():
        part += 1
        stem = folder / f"{session}.part-{part}"
    return stem
