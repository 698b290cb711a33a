import hashlib
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from algorithms.errors import InputError
from algorithms.files import make_folder, sha256_of, write_atomically


@contextmanager
def largest_file(size: int) -> Iterator[None]:
    """Let writing fail half-way, as on a full disk."""
    old = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, old[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)


def test_writes_and_replaces(tmp_path: Path) -> None:
    path = tmp_path / "file"
    for content in (b"first", b"second"):
        write_atomically(path, content)
        assert path.read_bytes() == content
    assert list(tmp_path.iterdir()) == [path]


def test_file_may_be_read_by_others(tmp_path: Path) -> None:
    # A temporary file is private; a web server under another account must read the result.
    write_atomically(tmp_path / "file", b"")
    assert (tmp_path / "file").stat().st_mode & 0o777 == 0o644


def test_failure_half_way_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "file"
    write_atomically(path, b"old")
    with largest_file(1000), pytest.raises(InputError, match="cannot be written") as raised:
        write_atomically(path, bytes(5000))
    assert str(path) in str(raised.value)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_failed_renaming_leaves_nothing_behind(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    (folder / "inside").mkdir(parents=True)
    with pytest.raises(InputError, match="cannot be written"):
        write_atomically(folder, b"content")
    assert list(tmp_path.iterdir()) == [folder]


def test_refuses_a_folder_that_is_none(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.touch()
    with pytest.raises(InputError, match=r"cannot be written \(Not a directory\)"):
        write_atomically(file / "inside", b"")
    for path in (file, file / "inside"):
        with pytest.raises(InputError, match="not a folder that can be written to"):
            make_folder(path)


def test_makes_folders_with_their_parents(tmp_path: Path) -> None:
    folder = tmp_path / "one" / "two"
    assert make_folder(folder) == make_folder(folder) == folder
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize("content", [b"", b"abc", bytes(range(256)) * 10_000])
def test_digest_is_that_of_the_bytes(tmp_path: Path, content: bytes) -> None:
    # Another implementation: hashlib over the whole content at once.
    path = tmp_path / "file"
    path.write_bytes(content)
    assert sha256_of(path) == hashlib.sha256(content).hexdigest()


def test_published_digest(tmp_path: Path) -> None:
    # FIPS 180-2, appendix B.1: the digest of "abc".
    path = tmp_path / "abc"
    path.write_bytes(b"abc")
    assert sha256_of(path).startswith("ba7816bf8f01cfea414140de5dae2223b00361a3")


def test_digest_of_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"absent: cannot be read \(No such file"):
        sha256_of(tmp_path / "absent")
