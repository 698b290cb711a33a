import struct
import zlib
from pathlib import Path

import numpy as np
import OpenEXR
import OpenImageIO
import pytest
import tifffile
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from PIL import Image

from algorithms.color import decode_srgb
from algorithms.errors import InputError
from algorithms.images import (
    read_channels,
    read_image,
    read_image_and_alpha,
    read_labels,
    write_channels,
    write_image,
    write_labels,
    write_picture,
)


@pytest.fixture
def image() -> NDArray[np.float32]:
    """Linear light, a little beyond what a display shows."""
    return np.random.default_rng(1).uniform(-0.1, 1.2, (7, 5, 3)).astype(np.float32)


def test_png_keeps_values_to_half_a_step(tmp_path: Path, image: NDArray[np.float32]) -> None:
    # Theory: 8 bits round the sRGB value by half of 1/255 at most.
    write_image(tmp_path / "image.png", image)
    found = read_image(tmp_path / "image.png")
    assert found.dtype == np.float32
    slope = 1.055 * 1.0 ** (1 / 2.4) / 2.4  # of the curve at white, where it is least
    assert np.abs(found - np.clip(image, 0, 1)).max() <= 0.5 / 255 / slope + 1e-6


def test_png_holds_the_srgb_digits(tmp_path: Path) -> None:
    # Another implementation: Pillow reads the digits; the curve is IEC 61966-2-1.
    digits = np.arange(240, dtype=np.uint8).reshape(8, 10, 3)
    write_image(tmp_path / "image.png", decode_srgb(digits / 255).astype(np.float32))
    with Image.open(tmp_path / "image.png") as picture:
        assert (np.asarray(picture) == digits).all()


def test_jpeg_is_close(tmp_path: Path) -> None:
    rows = np.linspace(0.1, 0.9, 32, dtype=np.float32)
    image = np.broadcast_to(rows[:, None, None], (32, 40, 3))
    write_image(tmp_path / "image.jpg", image)
    assert_allclose(read_image(tmp_path / "image.jpg"), image, atol=0.02)


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".exr"])
def test_same_values_same_bytes(tmp_path: Path, image: NDArray[np.float32], suffix: str) -> None:
    paths = [tmp_path / f"{name}{suffix}" for name in ("one", "two")]
    for path in paths:
        write_image(path, image)
    assert paths[0].read_bytes() == paths[1].read_bytes()
    assert b"one" not in paths[0].read_bytes()


def test_png_has_no_metadata(tmp_path: Path, image: NDArray[np.float32]) -> None:
    write_image(tmp_path / "image.png", image)
    with Image.open(tmp_path / "image.png") as picture:
        assert picture.info == {}


def test_exr_keeps_every_bit(tmp_path: Path, image: NDArray[np.float32]) -> None:
    image[0, 0] = (1e-30, 60_000, 1e30)
    write_image(tmp_path / "image.exr", image)
    assert (read_image(tmp_path / "image.exr") == image).all()


def test_exr_keeps_the_distance_of_nothing(tmp_path: Path) -> None:
    distance = np.array([[9.5, np.inf]], np.float32)
    write_channels(tmp_path / "distance.exr", distance)
    assert (read_channels(tmp_path / "distance.exr")[..., 0] == distance).all()


def test_exr_keeps_half_precision(tmp_path: Path, image: NDArray[np.float32]) -> None:
    half = image.astype(np.float16)
    for name, values in (("half", half), ("whole", image)):
        write_channels(tmp_path / f"{name}.exr", values)
    assert (read_channels(tmp_path / "half.exr") == half).all()
    assert (tmp_path / "half.exr").stat().st_size < (tmp_path / "whole.exr").stat().st_size


def test_single_channel_is_repeated(tmp_path: Path) -> None:
    values = np.array([[0.25, 4.0]], np.float32)
    write_image(tmp_path / "grey.exr", values)
    assert (read_image(tmp_path / "grey.exr") == values[..., None]).all()


@pytest.mark.parametrize(
    ("mode", "digit", "expected"),
    [("L", 128, 128 / 255), ("I;16", 32896, 32896 / 65535), ("P", 3, 3 / 255), ("1", 1, 1.0)],
)
def test_grey_pictures_of_every_depth(
    tmp_path: Path, mode: str, digit: int, expected: float
) -> None:
    picture = Image.new(mode, (2, 1), digit)
    if mode == "P":
        picture.putpalette([level for level in range(256) for _ in "RGB"])
    picture.save(tmp_path / "grey.png")
    found = read_image(tmp_path / "grey.png")
    assert found.shape == (1, 2, 3)
    assert_allclose(found, decode_srgb(np.array(expected)), rtol=1e-6)


def test_photographs_stand_upright(tmp_path: Path) -> None:
    # EXIF: orientation 6 means that the camera was turned; the first row belongs on the right.
    exif = Image.Exif()
    exif[0x0112] = 6
    Image.new("RGB", (40, 16)).save(tmp_path / "turned.jpg", exif=exif)
    assert read_image(tmp_path / "turned.jpg").shape == (40, 16, 3)


def test_opaque_alpha_is_dropped_and_transparency_refused(tmp_path: Path) -> None:
    for alpha in (255, 254):
        Image.new("RGBA", (2, 2), (255, 255, 255, alpha)).save(tmp_path / f"{alpha}.png")
    assert (read_image(tmp_path / "255.png") == 1).all()
    with pytest.raises(InputError, match="transparent pixels; an opaque picture is accepted"):
        read_image(tmp_path / "254.png")
    palette = Image.new("P", (2, 2), 0)
    palette.save(tmp_path / "palette.png", transparency=0)
    with pytest.raises(InputError, match="transparent pixels"):
        read_image(tmp_path / "palette.png")


def test_labels_round_trip(tmp_path: Path) -> None:
    labels = np.arange(256, dtype=np.uint8).reshape(16, 16)
    write_labels(tmp_path / "labels.png", labels)
    assert (read_labels(tmp_path / "labels.png") == labels).all()


@pytest.mark.parametrize("mode", ["RGB", "P", "RGBA", "I;16", "1"])
def test_refuses_labels_that_are_not_8_bit_grey(tmp_path: Path, mode: str) -> None:
    Image.new(mode, (2, 2)).save(tmp_path / "labels.png")
    with pytest.raises(InputError, match="an 8-bit grey PNG is accepted"):
        read_labels(tmp_path / "labels.png")


def png_of_size(width_px: int, height_px: int) -> bytes:
    """Return a PNG that states a size and breaks off: whoever decodes it, fails otherwise."""
    header = b"IHDR" + struct.pack(">IIBBBBB", width_px, height_px, 8, 2, 0, 0, 0)
    data = b"IDAT" + zlib.compress(b"\0")
    chunks = [
        struct.pack(">I", len(part) - 4) + part + struct.pack(">I", zlib.crc32(part))
        for part in (header, data)
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


@pytest.mark.parametrize("size_px", [(20_000, 10_000), (2**31 - 1, 2**31 - 1)])
def test_refuses_too_many_pixels_before_decoding(tmp_path: Path, size_px: tuple[int, int]) -> None:
    path = tmp_path / "bomb.png"
    path.write_bytes(png_of_size(*size_px))
    for read in (read_image, read_labels):
        with pytest.raises(InputError, match="at most 100000000 pixels are accepted"):
            read(path)


def test_refuses_an_exr_with_too_many_pixels(tmp_path: Path) -> None:
    write_channels(tmp_path / "wide.exr", np.zeros((2, 6), np.float32))
    with pytest.raises(InputError, match="6 x 2 pixels; at most 11 pixels are accepted"):
        read_image(tmp_path / "wide.exr", max_pixels=11)


@pytest.mark.parametrize("name", ["absent.png", "absent.jpg", "absent.exr"])
def test_refuses_a_missing_file(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=f"{name}: no such file"):
        read_image(tmp_path / name)


@pytest.mark.parametrize("suffix", [".png", ".exr", ".hdr"])
def test_refuses_a_damaged_file(tmp_path: Path, image: NDArray[np.float32], suffix: str) -> None:
    whole = tmp_path / f"whole{suffix}"
    write_image(whole, image)
    cut = tmp_path / f"cut{suffix}"
    for length in (0, 10, len(whole.read_bytes()) - 60):
        cut.write_bytes(whole.read_bytes()[:length])
        with pytest.raises(InputError, match=f"cut{suffix}: not a readable"):
            read_image(cut)


def test_refuses_other_formats(tmp_path: Path) -> None:
    Image.new("L", (2, 2)).save(tmp_path / "gif.png", format="GIF")
    Image.new("CMYK", (8, 8)).save(tmp_path / "cmyk.jpg")
    for name in ("gif.png", "cmyk.jpg"):
        with pytest.raises(InputError, match="a PNG or JPEG in grey or RGB is accepted"):
            read_image(tmp_path / name)
    with pytest.raises(InputError, match=r"a file ending in \.png, \.jpg, \.jpeg, \.exr, \.hdr"):
        read_image(tmp_path / "image.bmp")
    with pytest.raises(InputError, match=r"a file ending in \.png, .*, \.hdr is accepted"):
        write_image(tmp_path / "image.tif", np.zeros((2, 2, 3), np.float32))


def test_refuses_an_exr_with_other_channels(tmp_path: Path) -> None:
    pixels = np.zeros((2, 2), np.float32)
    with OpenEXR.File({}, {"U": pixels, "V": pixels}) as file:
        file.write(str(tmp_path / "flow.exr"))
    with pytest.raises(InputError, match="channels R, G, B or a single one are accepted"):
        read_image(tmp_path / "flow.exr")


def test_refuses_to_write(tmp_path: Path, image: NDArray[np.float32]) -> None:
    nothing = np.full((2, 2, 3), np.nan, np.float32)
    for suffix in (".png", ".exr"):
        with pytest.raises(InputError, match="image: finite values are accepted"):
            write_image(tmp_path / f"image{suffix}", nothing)
    with pytest.raises(InputError, match=r"image: \(height, width, 3\) is accepted"):
        write_image(tmp_path / "image.png", image[..., 0])
    with pytest.raises(InputError, match="image: one or three channels are accepted"):
        write_image(tmp_path / "image.exr", image[..., :2])
    with pytest.raises(InputError, match=r"a file ending in \.png"):
        write_image(tmp_path / "image.webp", image)
    with pytest.raises(InputError, match=r"a file ending in \.png, \.jpg, \.jpeg is accepted"):
        write_picture(tmp_path / "image.exr", Image.new("L", (2, 2)))
    with pytest.raises(InputError, match=r"labels: uint8 \(height, width\) is accepted"):
        write_labels(tmp_path / "labels.png", np.zeros((2, 2), np.int64))
    assert list(tmp_path.iterdir()) == []


def test_radiance_hdr_keeps_one_hundredth_of_the_largest(
    tmp_path: Path, image: NDArray[np.float32]
) -> None:
    # Theory: three mantissas of 8 bits share the exponent of the largest channel.
    bright = np.maximum(image, 0) * np.float32(300)
    write_image(tmp_path / "image.hdr", bright)
    found = read_image(tmp_path / "image.hdr")
    assert (np.abs(found - bright) <= bright.max(axis=2, keepdims=True) / 100).all()


def test_sixteen_bits_are_read_as_such(tmp_path: Path) -> None:
    # Another implementation wrote the files: 60,000 / 65,535 lies between two steps of 8 bits.
    values = np.full((4, 5, 3), 60_000, np.uint16)
    tifffile.imwrite(tmp_path / "deep.tif", values, photometric="rgb")
    file = OpenImageIO.ImageOutput.create("deep.png")
    assert file is not None
    file.open(str(tmp_path / "deep.png"), OpenImageIO.ImageSpec(5, 4, 3, "uint16"))
    file.write_image(values)
    file.close()
    for name in ("deep.tif", "deep.png"):
        assert_allclose(read_image(tmp_path / name), decode_srgb(values / 65535), rtol=1e-5)


def test_tiff_of_floating_point_is_linear(tmp_path: Path, image: NDArray[np.float32]) -> None:
    tifffile.imwrite(tmp_path / "linear.tif", image, photometric="rgb")
    assert_allclose(read_image(tmp_path / "linear.tif"), image)


def test_palette_is_read_as_its_colours(tmp_path: Path) -> None:
    digits = np.repeat(np.arange(0, 240, 30, dtype=np.uint8).reshape(2, 4, 1), 3, axis=2)
    Image.fromarray(digits).quantize(8).save(tmp_path / "palette.png")
    assert_allclose(read_image(tmp_path / "palette.png"), decode_srgb(digits / 255), rtol=1e-6)


def test_alpha_is_read_and_written_apart(tmp_path: Path, image: NDArray[np.float32]) -> None:
    alpha = np.linspace(0, 1, 35, dtype=np.float32).reshape(7, 5)
    write_image(tmp_path / "image.png", image, alpha)
    found, found_alpha = read_image_and_alpha(tmp_path / "image.png")
    assert found_alpha is not None
    assert_allclose(found_alpha, alpha, atol=0.5 / 255)
    write_image(tmp_path / "opaque.png", image)
    opaque, none = read_image_and_alpha(tmp_path / "opaque.png")
    assert none is None
    assert_allclose(found, opaque)  # colours are not multiplied by alpha
    with pytest.raises(InputError, match=r"a file ending in \.png is accepted for a picture with"):
        write_image(tmp_path / "image.jpg", image, alpha)
