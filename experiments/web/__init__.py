"""The same study in a browser: server, store and front end."""

from experiments.web.app import create_app
from experiments.web.server import listen, running_server, serve
from experiments.web.service import researcher_token

__all__ = ["create_app", "listen", "researcher_token", "running_server", "serve"]
