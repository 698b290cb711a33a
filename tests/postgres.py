"""A PostgreSQL cluster of the tests' own: in a temporary folder, run by a user without rights."""

import os
import pwd
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path

import psycopg


@dataclass(frozen=True)
class Cluster:
    """A running PostgreSQL that only this machine's own sockets reach."""

    folder: Path
    _numbers: Iterator[int] = field(default_factory=lambda: count(1))

    def new_database(self) -> str:
        """Make an empty database and return its URL."""
        name = f"store{next(self._numbers)}"
        with psycopg.connect(self.url("postgres"), autocommit=True) as connection:
            connection.execute(f"CREATE DATABASE {name}")
        return self.url(name)

    def url(self, database: str) -> str:
        return f"postgresql://postgres@/{database}?host={self.folder}"


def programs() -> Path | None:
    """Return the folder of `initdb` and `pg_ctl`, or None where PostgreSQL is not installed."""
    found = shutil.which("initdb")
    if found is not None:
        return Path(found).resolve().parent
    installed = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"))
    return installed[-1].parent if installed else None


@contextmanager
def running_cluster(bin_folder: Path) -> Iterator[Cluster]:
    """Make a cluster, run it while the block runs, and remove it."""
    # Under /tmp, since the path of a socket may have no more than 107 characters.
    with tempfile.TemporaryDirectory(prefix="trompe-pg-", dir="/tmp") as temporary:
        folder, data = Path(temporary), Path(temporary) / "data"
        owner = _owner()
        os.chown(folder, owner.pw_uid, owner.pw_gid)

        def run(program: str, *arguments: str) -> None:
            subprocess.run(
                [bin_folder / program, *arguments],
                check=True,
                cwd=folder,
                stdout=subprocess.DEVNULL,
                # None leaves the user as it is.
                user=owner.pw_uid if os.geteuid() == 0 else None,
                group=owner.pw_gid if os.geteuid() == 0 else None,
                extra_groups=() if os.geteuid() == 0 else None,
            )

        run("initdb", "--pgdata", str(data), "--username=postgres", "--auth=trust", "--no-sync")
        options = f"-k {folder} -c listen_addresses=''"
        log = str(folder / "log")
        run("pg_ctl", "start", "--wait", "--pgdata", str(data), "--log", log, "-o", options)
        try:
            yield Cluster(folder)
        finally:
            run("pg_ctl", "stop", "--mode=immediate", "--pgdata", str(data))


def _owner() -> pwd.struct_passwd:
    """Return who runs the cluster: PostgreSQL refuses to be run by root."""
    return pwd.getpwnam("nobody") if os.geteuid() == 0 else pwd.getpwuid(os.geteuid())
