"""The same study in a browser: server, store and front end."""

from experiments.web.app import create_app, create_site
from experiments.web.server import base_url, listen, running_server, serve
from experiments.web.service import links, researcher_token

__all__ = [
    "base_url",
    "create_app",
    "create_site",
    "links",
    "listen",
    "researcher_token",
    "running_server",
    "serve",
]
