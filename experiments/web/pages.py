"""The front end's pages, as its build left them."""

from pathlib import Path

from fastapi import APIRouter
from fastapi.responses import FileResponse, RedirectResponse

from experiments.web.errors import ApiError
from experiments.web.service import Here, OfStudy

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
        if len(here.services) > 1:
            raise ApiError(404, "study: several are served here; follow the link to yours")
        return RedirectResponse(f"/s/{next(iter(here.services))}/")

    @router.get("/s/{study}/")
    def show_participant_page(_: OfStudy) -> FileResponse:
        return _page(bundle / "index.html")

    @router.get("/researcher/{study}/")
    def show_researcher_page(_: OfStudy) -> FileResponse:
        return _page(bundle / "researcher.html")

    return router


def _page(path: Path) -> FileResponse:
    if not path.is_file():
        raise ApiError(
            503,
            "the front end is not built; run `pip install --editable .` in the repository",
        )
    return FileResponse(path, media_type="text/html")
