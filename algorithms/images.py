"""Reading and writing images: the one place where pictures are decoded and encoded."""

import io
import tempfile
import warnings
from pathlib import Path

import numpy as np
import OpenEXR
from numpy.typing import NDArray
from PIL import Image, ImageOps, UnidentifiedImageError

from algorithms.color import FloatImage, decode_srgb, srgb_digits
from algorithms.deep_images import bits_per_channel, read_deep, size_px, write_radiance
from algorithms.errors import InputError
from algorithms.files import write_atomically

MAX_PIXELS = 100_000_000
"""Larger images are refused before they are decoded."""

_JPEG_QUALITY = 95
_PNG_DEPTH_AT = 24  # after signature, chunk header, width and height
_DISPLAY_SUFFIXES = (".png", ".jpg", ".jpeg")
_TIFF_SUFFIXES = (".tif", ".tiff")
_WRITTEN_SUFFIXES = (*_DISPLAY_SUFFIXES, ".exr", ".hdr")
_READ_SUFFIXES = (*_WRITTEN_SUFFIXES, *_TIFF_SUFFIXES)


def read_image(path: str | Path, max_pixels: int = MAX_PIXELS) -> FloatImage:
    """Read an opaque picture as linear light.

    Parameters
    ----------
    path
        A PNG, JPEG or TIFF file (8 or 16 bits, taken as sRGB; grey, colour or palette), or an
        OpenEXR or Radiance HDR file, or a TIFF of floating-point values (taken as linear).
    max_pixels
        Larger pictures are refused before decoding.

    Returns
    -------
    Linear light, float32 `(height, width, 3)`; 0..1 where the file is sRGB. A single channel is
    repeated. The alpha channel of an OpenEXR file is not read.

    Raises
    ------
    InputError
        If the file is missing, damaged, too large, of another format or partly transparent.
    """
    image, alpha = read_image_and_alpha(path, max_pixels)
    if alpha is not None:
        raise InputError(f"{path}: transparent pixels; an opaque picture is accepted")
    return image


def read_image_and_alpha(
    path: str | Path, max_pixels: int = MAX_PIXELS
) -> tuple[FloatImage, NDArray[np.float32] | None]:
    """Read a picture as linear light, and its alpha channel apart.

    Returns
    -------
    What `read_image` does, and alpha, float32 `(height, width)`, 0..1, by which the colours are not
    multiplied; None where every pixel is opaque.

    Raises
    ------
    InputError
        If the file is missing, damaged, too large or of another format.
    """
    path = Path(path)
    suffix = _suffix(path, _READ_SUFFIXES)
    if suffix == ".exr":
        channels = read_channels(path, max_pixels)
        return np.repeat(channels, 3, axis=2) if channels.shape[2] == 1 else channels, None
    linear = suffix == ".hdr"
    values: NDArray[np.uint8] | NDArray[np.float32]
    if linear or suffix in _TIFF_SUFFIXES:
        _check_size(path, *size_px(path), max_pixels)
        values = read_deep(path)
        linear = linear or bits_per_channel(path) == 32
    else:
        values = _decode(path, max_pixels)
    if values.shape[2] > 4:
        raise InputError(f"{path}: a picture in grey or RGB is accepted")
    colour = values[..., : 1 if values.shape[2] < 3 else 3]
    image = np.asarray(colour, dtype=np.float32) if linear else _decoded(colour)
    if image.shape[2] == 1:
        image = np.repeat(image, 3, axis=2)
    if values.shape[2] in (1, 3):
        return image, None
    alpha = values[..., -1].astype(np.float32)
    if values.dtype == np.uint8:
        alpha /= 255
    return image, None if (alpha == 1).all() else alpha


def require_size(path: Path, found: tuple[int, ...], wanted: tuple[int, ...]) -> None:
    """Refuse a file that has not an image's height and width.

    Raises
    ------
    InputError
        With the file's name and both sizes.
    """
    if found[:2] != wanted[:2]:
        sizes = " x ".join(map(str, found[1::-1])), " x ".join(map(str, wanted[1::-1]))
        raise InputError(f"{path}: {sizes[0]} pixels given, the image's {sizes[1]} accepted")


def write_image(
    path: str | Path, image: NDArray[np.float32], alpha: NDArray[np.float32] | None = None
) -> None:
    """Write linear light as a picture, the same bytes for the same values.

    Parameters
    ----------
    path
        Ends in .png, .jpg or .jpeg (sRGB, 8 bits, clipped to 0..1, without metadata), .hdr, or
        .exr.
    image
        Linear light, `(height, width, 3)`; for .exr also `(height, width)` or one channel.
    alpha
        `(height, width)`, 0..1, for .png alone.

    Raises
    ------
    InputError
        If the shape or the suffix is not accepted, a value is not finite, or the folder cannot be
        written to.
    """
    path = Path(path)
    suffix = _suffix(path, _WRITTEN_SUFFIXES)
    if alpha is not None and suffix != ".png":
        raise InputError(f"{path}: a file ending in .png is accepted for a picture with alpha")
    if not np.isfinite(image).all():
        raise InputError("image: finite values are accepted")
    if suffix == ".exr":
        write_channels(path, image)
        return
    if image.ndim != 3 or image.shape[2] != 3:
        raise InputError(f"image: (height, width, 3) is accepted, not {image.shape}")
    if suffix == ".hdr":
        write_radiance(path, image)
        return
    encoded = srgb_digits(image)
    if alpha is not None:
        opacity = np.round(np.clip(alpha, 0, 1) * 255).astype(np.uint8)
        encoded = np.concatenate([encoded, opacity[..., None]], axis=2)
    write_picture(path, Image.fromarray(encoded))


def read_labels(path: str | Path, max_pixels: int = MAX_PIXELS) -> NDArray[np.uint8]:
    """Read a label image: uint8 `(height, width)`, 0 = background.

    Raises
    ------
    InputError
        If the file is missing, damaged, too large or not an 8-bit grey PNG.
    """
    path = Path(path)
    with _opened(path, max_pixels) as picture:
        if picture.format != "PNG" or picture.mode != "L":
            raise InputError(f"{path}: an 8-bit grey PNG is accepted as a label image")
        return np.array(picture)


def write_labels(path: str | Path, labels: NDArray[np.uint8]) -> None:
    """Write a label image, uint8 `(height, width)`, as an 8-bit grey PNG.

    Raises
    ------
    InputError
        If the labels are not uint8 in two dimensions, or the folder cannot be written to.
    """
    if labels.ndim != 2 or labels.dtype != np.uint8:
        raise InputError(f"labels: uint8 (height, width) is accepted, not {labels.dtype}")
    write_picture(Path(path), Image.fromarray(labels))


def read_channels(path: str | Path, max_pixels: int = MAX_PIXELS) -> NDArray[np.float32]:
    """Read the channels of an OpenEXR file without interpretation (depth, normals, radiance).

    Returns
    -------
    float32 `(height, width, channels)`: 3 channels where the file has R, G and B, else 1.

    Raises
    ------
    InputError
        If the file is missing, damaged, too large or has other channels.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    try:
        with OpenEXR.File(str(path), header_only=True) as header:
            low, high = header.header()["dataWindow"]
        width_px, height_px = (int(extent) for extent in np.asarray(high) - low + 1)
        _check_size(path, width_px, height_px, max_pixels)
        with OpenEXR.File(str(path), separate_channels=True) as file:
            pixels = {name: channel.pixels for name, channel in file.channels().items()}
    except InputError:
        raise
    except (RuntimeError, ValueError) as error:
        raise InputError(f"{path}: not a readable OpenEXR file") from error
    names = ("R", "G", "B") if {"R", "G", "B"} <= pixels.keys() else tuple(pixels)[:1]
    if len(names) == 1 and len(pixels) > 1:
        raise InputError(f"{path}: channels R, G, B or a single one are accepted")
    return np.stack([np.asarray(pixels[name], dtype=np.float32) for name in names], axis=2)


def write_channels(path: str | Path, values: NDArray[np.float32 | np.float16]) -> None:
    """Write one or three channels as an OpenEXR file (lossless, ZIP).

    Parameters
    ----------
    path
        Ends in .exr.
    values
        `(height, width)` or `(height, width, 1)`, written as channel Y, or `(height, width, 3)`,
        written as R, G, B; float16 as such, anything else as float32. Infinite values are
        allowed, such as the background's distance.

    Raises
    ------
    InputError
        If the shape is not accepted or the folder cannot be written to.
    """
    if values.ndim == 2:
        values = values[..., None]
    if values.ndim != 3 or values.shape[2] not in (1, 3):
        raise InputError(f"image: one or three channels are accepted, not {values.shape}")
    names = "RGB" if values.shape[2] == 3 else "Y"
    kind = np.float16 if values.dtype == np.float16 else np.float32
    channels = {
        name: np.ascontiguousarray(values[..., index], dtype=kind)
        for index, name in enumerate(names)
    }
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    try:
        with tempfile.TemporaryDirectory() as folder:
            temporary = Path(folder, "image.exr")
            with OpenEXR.File(header, channels) as file:
                file.write(str(temporary))
            content = temporary.read_bytes()
    except (OSError, RuntimeError) as error:
        raise InputError(f"{path}: cannot be written (no space for temporary files?)") from error
    write_atomically(Path(path), content)


def _suffix(path: Path, accepted: tuple[str, ...]) -> str:
    suffix = path.suffix.lower()
    if suffix not in accepted:
        raise InputError(f"{path}: a file ending in {', '.join(accepted)} is accepted")
    return suffix


def _check_size(path: Path, width_px: int, height_px: int, max_pixels: int) -> None:
    if width_px * height_px > max_pixels:
        raise InputError(
            f"{path}: {width_px} x {height_px} pixels; at most {max_pixels} pixels are accepted"
        )


def _opened(path: Path, max_pixels: int) -> Image.Image:
    try:
        with path.open("rb") as stream, warnings.catch_warnings():
            # Pillow's own limit warns or fails before ours can name the file.
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            picture = Image.open(stream)
            _check_size(path, *picture.size, max_pixels)
            picture.load()
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file") from error
    except Image.DecompressionBombError as error:
        raise InputError(f"{path}: at most {max_pixels} pixels are accepted") from error
    except (UnidentifiedImageError, OSError, SyntaxError) as error:
        raise InputError(f"{path}: not a readable picture") from error
    return picture


def _decoded(encoded: NDArray[np.uint8] | NDArray[np.float32]) -> NDArray[np.float32]:
    """Decode sRGB values, of 0..255 or 0..1."""
    if encoded.dtype != np.uint8:
        return decode_srgb(encoded.astype(np.float32)).astype(np.float32)
    curve = decode_srgb(np.arange(256) / 255).astype(np.float32)
    return np.asarray(curve[encoded.astype(np.uint8)])


def _decode(path: Path, max_pixels: int) -> NDArray[np.uint8] | NDArray[np.float32]:
    """Return the encoded values of a PNG or JPEG, 0..255 or 0..1, with alpha or without."""
    with _opened(path, max_pixels) as picture:
        if picture.format not in ("PNG", "JPEG") or picture.mode == "CMYK":
            raise InputError(f"{path}: a PNG or JPEG in grey or RGB is accepted")
        if picture.format == "PNG" and _bits_of_png(path) == 16:
            return read_deep(path)  # Pillow drops the lower 8 bits of colours
        upright = ImageOps.exif_transpose(picture)
        mode = "RGBA" if upright.has_transparency_data else "RGB"
        return np.array(upright.convert(mode))


def _bits_of_png(path: Path) -> int:
    """Return the bit depth that the header of a PNG states."""
    with path.open("rb") as stream:
        return stream.read(_PNG_DEPTH_AT + 1)[_PNG_DEPTH_AT]


def write_picture(path: Path, picture: Image.Image) -> None:
    """Write an encoded picture as PNG or JPEG, without metadata, the same bytes for the same one.

    Raises
    ------
    InputError
        If the suffix is another one, or the folder cannot be written to.
    """
    suffix = _suffix(path, _DISPLAY_SUFFIXES)
    stream = io.BytesIO()
    if suffix == ".png":
        picture.save(stream, format="PNG", compress_level=6)
    else:
        picture.save(stream, format="JPEG", quality=_JPEG_QUALITY, subsampling=0)
    write_atomically(path, stream.getvalue())
