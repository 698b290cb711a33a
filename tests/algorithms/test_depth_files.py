from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PIL import Image
from skimage.data import stereo_motorcycle

from algorithms.depth.files import Stereo, read_distance, read_relief
from algorithms.errors import InputError
from algorithms.images import write_channels

DEPTH = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], np.float32)


def test_every_format_holds_the_same_distances(tmp_path: Path) -> None:
    # Other implementations (Pillow, NumPy) wrote all files but the OpenEXR file.
    Image.fromarray((DEPTH * 10).astype(np.uint8)).save(tmp_path / "eight.png")
    Image.fromarray((DEPTH * 1000).astype(np.uint16)).save(tmp_path / "sixteen.png")
    write_channels(tmp_path / "depth.exr", DEPTH)
    np.save(tmp_path / "depth.npy", DEPTH)
    np.savez(tmp_path / "depth.npz", DEPTH)
    for name, scale in (
        ("eight.png", 0.1),
        ("sixteen.png", 0.001),
        ("depth.exr", 1.0),
        ("depth.npy", 1.0),
        ("depth.npz", 1.0),
    ):
        assert_allclose(read_distance(tmp_path / name, scale=scale), DEPTH, rtol=1e-6)


def test_unknown_distances_are_those_of_the_nearest_pixel(tmp_path: Path) -> None:
    values = DEPTH.copy()
    values[0] = [np.nan, 2.0, np.inf]
    values[1] = [4.0, 0.0, -1.0]
    write_channels(tmp_path / "depth.exr", values)
    found = read_distance(tmp_path / "depth.exr")
    assert found[0, 1] == 2
    assert found[0, 2] == np.inf
    assert found[1, 0] == 4
    assert found[0, 0] in (2, 4)
    assert found[1, 1] in (2, 4)
    assert found[1, 2] == np.inf


def test_disparity_becomes_distance(tmp_path: Path) -> None:
    # Published calibration: Scharstein et al. 2014, "Motorcycle" at a quarter of its size. Its
    # scene is between two and five metres deep.
    disparity = stereo_motorcycle()[2]
    np.savez(tmp_path / "disparity.npz", disparity)
    stereo = Stereo(focal_px=994.978, baseline=0.193001, offset_px=31.086)
    distance = read_distance(tmp_path / "disparity.npz", stereo=stereo)
    row, column = np.argwhere(np.isfinite(disparity))[1000]
    expected = 0.193001 * 994.978 / (disparity[row, column] + 31.086)
    assert distance[row, column] == pytest.approx(expected, rel=1e-6)
    assert np.isfinite(distance).all()
    assert 1.5 < np.quantile(distance, 0.02) < np.quantile(distance, 0.98) < 6


def test_relief_keeps_what_is_unknown(tmp_path: Path) -> None:
    np.savez(tmp_path / "relief.npz", np.array([[np.nan, 1.5]]))
    found = read_relief(tmp_path / "relief.npz", scale=-2)
    assert np.isnan(found[0, 0])
    assert found[0, 1] == -3


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ([DEPTH, DEPTH], "a file of one array is accepted, not of arr_0, arr_1"),
        ([np.zeros((2, 2, 3))], "one channel is accepted"),
        ([np.zeros((2, 2), complex)], "real numbers are accepted"),
        ([np.zeros((2, 2))], "no pixel has a distance"),
        ([np.full((2, 2), np.nan)], "no pixel has a distance"),
    ],
)
def test_refuses_arrays(tmp_path: Path, arrays: list[np.ndarray], message: str) -> None:
    path = tmp_path / "depth.npz"
    np.savez(path, *arrays)
    with pytest.raises(InputError, match=message):
        read_distance(path)


def test_refuses_files(tmp_path: Path) -> None:
    (tmp_path / "depth.npz").write_bytes(b"nothing")
    Image.new("RGB", (2, 2)).save(tmp_path / "colour.png")
    for name, message in (
        ("depth.npz", "not a readable NumPy file"),
        ("absent.npy", "no such file"),
        ("depth.txt", r"a file ending in \.png, "),
        ("colour.png", "one channel is accepted"),
    ):
        with pytest.raises(InputError, match=message):
            read_distance(tmp_path / name)
    with pytest.raises(InputError, match="focal_px: a finite number of more than 0"):
        Stereo(0, 1)
    with pytest.raises(InputError, match="scale: "):
        read_distance(tmp_path / "colour.png", scale=0)
    with pytest.raises(InputError, match="scale: "):
        read_relief(tmp_path / "colour.png", scale=np.inf)
