"""The front end's pages, as its build left them."""

from pathlib import Path

from fastapi import APIRouter
from fastapi.responses import FileResponse, RedirectResponse

from experiments.web.errors import ApiError
from experiments.web.service import Here, KnownStudy

BUNDLE = Path(__file__).parent / "bundle"


def page_routes(bundle: Path) -> APIRouter:
    """Return the routes of the participant's and the researcher's page.

    Parameters
    ----------
    bundle
        The folder with `index.html` and `researcher.html`.
    """
    router = APIRouter()

    @router.get("/")
    def show_root(here: Here) -> RedirectResponse:
        return RedirectResponse(f"/s/{here.study.name}/")

    @router.get("/s/{study}/", dependencies=[KnownStudy])
    def show_participant_page() -> FileResponse:
        return _page(bundle / "index.html")

    @router.get("/researcher/{study}/", dependencies=[KnownStudy])
    def show_researcher_page() -> FileResponse:
        return _page(bundle / "researcher.html")

    return router


def _page(path: Path) -> FileResponse:
    if not path.is_file():
        raise ApiError(
            503,
            "the front end is not built; run `pip install --editable .` in the repository",
        )
    return FileResponse(path, media_type="text/html")
