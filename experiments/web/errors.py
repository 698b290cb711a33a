"""One shape for every error the server answers with."""

from collections.abc import Mapping

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from starlette.exceptions import HTTPException

from algorithms.errors import InputError
from experiments.storage.store import ConflictError, WithdrawnError

_CODES = {
    400: "malformed",
    401: "unauthorized",
    403: "forbidden",
    404: "not-found",
    405: "method-not-allowed",
    409: "conflict",
    410: "gone",
    413: "too-large",
    422: "invalid",
    429: "too-many",
    503: "unavailable",
}

_LONGEST_MESSAGE = 300


class ApiError(Exception):
    """An error that the server answers with; everything else is turned into one.

    Parameters
    ----------
    status
        The HTTP status.
    message
        One line that says what is wrong and what is accepted.
    code
        A short word for programs, by default that of the status.
    headers
        What else the head of the reply says.
    more
        What else the reply carries beside `error`.
    """

    def __init__(
        self,
        status: int,
        message: str,
        code: str | None = None,
        headers: Mapping[str, str] | None = None,
        **more: object,
    ) -> None:
        super().__init__(message)
        self.status = status
        # What a client sent may be quoted in it: of any length, with line ends, no valid Unicode.
        self.message = message[:_LONGEST_MESSAGE].encode("unicode_escape").decode()
        self.code = code or _CODES.get(status, "error")
        self.headers = headers
        self.more = more

    def reply(self) -> JSONResponse:
        """Return the HTTP response: `{"error": {"code": ..., "message": ...}}`."""
        error = {"code": self.code, "message": self.message}
        return JSONResponse({"error": error, **self.more}, self.status, self.headers)


def add_error_handlers(app: FastAPI) -> None:
    """Turn every exception of a handler into a reply of the one shape."""
    app.add_exception_handler(ApiError, _reply)
    app.add_exception_handler(HTTPException, _reply)
    app.add_exception_handler(RequestValidationError, _reply)
    app.add_exception_handler(InputError, _reply)
    app.add_exception_handler(Exception, _reply)


async def _reply(_: Request, error: Exception) -> JSONResponse:
    return _as_api_error(error).reply()


def _as_api_error(error: Exception) -> ApiError:
    match error:
        case ApiError():
            return error
        case HTTPException():
            return ApiError(error.status_code, str(error.detail), headers=error.headers)
        case RequestValidationError():
            return ApiError(422, _first_fault(error))
        case ConflictError():
            return ApiError(409, str(error))
        case WithdrawnError():
            return ApiError(410, str(error), "withdrawn")
        case InputError():
            return ApiError(422, str(error))
        case _:
            return ApiError(500, "the server failed; what was acknowledged is stored", "internal")


def _first_fault(error: RequestValidationError) -> str:
    fault = error.errors()[0]
    place = ".".join(str(part) for part in fault["loc"][1:]) or "body"
    return f"{place}: {fault['msg']}"
