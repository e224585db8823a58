"""Pictures: arrays of linear radiance that display and save themselves."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from . import _values
from ._errors import Error, from_call

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


class Picture:
    """A rendered picture.

    Attributes:
        pixels: (height, width, 3) float32, linear RGB with the primaries of sRGB, from the top left, 0 or more; with a
            transparent background (height, width, 4), with alpha from 0 to 1, and colors premultiplied by it. The
            memory is the renderer's own; what is changed is saved and displayed.
        layers: By name, the layers that were asked for: ``albedo``, ``normal`` and ``variance`` (height, width, 3)
            float32; ``depth`` and ``coverage`` (height, width) float32; ``id`` and ``samples`` (height, width) uint32.
            An ``id`` is a row of the arrays that the scene is made of, also after selections, slices and copies;
            spheres of sections follow. Or it is :data:`spherule.NOTHING` or :data:`spherule.GROUND`.
        error: The measured relative error of the picture, or None; ``error_bound`` holds with 95 % confidence.
        denoised: Whether it is denoised.
        complete: False if the render was interrupted: then it is not denoised, and has no outlines, depth cue or
            layers of camera rays.
        spp: The least and the greatest number of samples of a pixel.
        sampled: The share of pixels that have samples: less than 1 if the render was interrupted before each had one. The
            others show the background.
        samples, rays, seconds: Samples and rays of all pixels, and the time of the render.
        dpi: Pixels per inch on paper, which PNG, TIFF, JPEG and EXR files store; None if it is not known.
        exposure, tone: How it is displayed and saved: stops, and ``"linear"`` or ``"filmic"``.
        title: The title of the scene.
    """

    pixels: npt.NDArray[np.float32]
    layers: dict[str, npt.NDArray[Any]]
    error: float | None
    error_bound: float | None
    denoised: bool
    complete: bool
    spp: tuple[int, int]
    sampled: float
    samples: int
    rays: int
    seconds: float
    dpi: int | None
    exposure: float
    tone: str
    title: str

    def __init__(self, table: Mapping[str, Any]) -> None:
        for name, value in table.items():
            if name not in ("matte", "drawn", "warnings"):
                setattr(self, name, value)
        self._matte, self._drawn = table["matte"], table["drawn"]

    def __getstate__(self) -> dict[str, Any]:
        # A copy elsewhere has the annotations as pixels.
        return {**self.__dict__, "_drawn": None}

    @property
    def width(self) -> int:
        """Pixels of a row."""
        return int(self.pixels.shape[1])

    @property
    def height(self) -> int:
        """Number of rows."""
        return int(self.pixels.shape[0])

    def __repr__(self) -> str:
        least, most = self.spp
        facts = [f"{self.width} x {self.height} pixels", f"{least} to {most} samples" if least < most else f"{most} samples"]
        if self.error is not None:
            facts.append(f"error {100 * self.error:.2g} %")
        if not self.complete:
            facts.append("interrupted")
        if self.sampled < 1:
            facts.append(f"{100 * self.sampled:.1f} % of pixels sampled")
        return f"<spherule.Picture: {', '.join(facts)}>"

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> npt.NDArray[Any]:
        if copy or (dtype is not None and dtype != self.pixels.dtype):
            if copy is False:
                raise ValueError("another type needs a copy")
            return self.pixels.astype(dtype or self.pixels.dtype)
        return self.pixels

    @from_call
    def srgb(self) -> npt.NDArray[np.uint8]:
        """The picture as a display shows it: exposed, by its tone curve, sRGB.

        Returns:
            (height, width, 3) uint8, as ``matplotlib.pyplot.imshow`` takes it; a transparent background is black.

        Raises:
            Error: An exposure out of range.

        Example:
            >>> import spherule
            >>> spherule.render([[0, 0, 0]], radius=1, size=(40, 30), spp=4).srgb().dtype
            dtype('uint8')
        """
        from . import _native

        return _native.display_codes(self._floats(), float(self.exposure), self._filmic())

    @from_call
    def encode(self, format: str = "png", *, bits: int = 8, quality: int | None = None) -> bytes:
        """The bytes of a file.

        Args:
            format: ``"png"``, ``"exr"``, ``"jpg"``, ``"tiff"``, ``"webp"``, ``"pfm"``, ``"ppm"``, ``"pdf"`` or ``"svg"``;
                the last two are pages with the picture and its annotations as vectors.
            bits: 8 or 16 per channel, for PNG, TIFF and PPM.
            quality: 1 to 100, for JPEG.

        Raises:
            Error: An unknown format, or one that cannot store the picture.

        Example:
            >>> import spherule
            >>> spherule.render([[0, 0, 0]], radius=1, size=(40, 30), spp=4).encode()[1:4]
            b'PNG'
        """
        return self._encoded(f"picture.{_values.text('format', format).lstrip('.')}", bits, quality)

    def _encoded(self, path: str, bits: Any, quality: Any) -> bytes:
        """The bytes of a file of this name."""
        from . import _native

        bits = _values.integer("bits", bits)
        if bits not in (8, 16):
            raise Error(f"`bits` is {bits}, but must be 8 or 16")
        if quality is not None:
            quality = _values.integer("quality", quality, 1, 100)
        metadata = [("Software", "spherule " + _version())]
        if self.title:
            metadata.append(("Title", self.title))
        table = {
            "path": path,
            "exposure": float(self.exposure),
            "filmic": self._filmic(),
            "bits": bits,
            "quality": quality,
            "dpi": None if self.dpi is None else _values.integer("dpi", self.dpi, 1, 65535),
            "metadata": metadata,
        }
        return _native.encode(self._floats(), self._matte, self._drawn, table)

    @from_call
    def save(self, path: str | os.PathLike[str], *, bits: int = 8, quality: int | None = None) -> None:
        """Writes a file in the format that its name ends in: PNG, EXR, JPEG, TIFF, WebP, PFM, PPM, PDF or SVG.

        Args:
            path: The file, which is replaced once the new one is complete.
            bits, quality: As for :meth:`encode`.

        Raises:
            Error: As :meth:`encode`.
            OSError: The file cannot be written.

        Example:
            >>> import pathlib, spherule, tempfile
            >>> path = pathlib.Path(tempfile.mkdtemp()) / "ball.png"
            >>> spherule.render([[0, 0, 0]], radius=1, size=(40, 30), spp=4).save(path)
            >>> path.stat().st_size > 0
            True
        """
        name = _values.path("path", path)
        if is_page(name):
            raise Error(f'{name}: a page names the particles of its scene: scene.save("{os.path.basename(name)}")')
        write_whole(name, self._encoded(name, bits, quality))

    def _floats(self) -> npt.NDArray[np.float32]:
        import numpy as np

        pixels = np.asarray(self.pixels, np.float32)
        if pixels.ndim != 3 or pixels.shape[2] not in (3, 4):
            raise Error(f"`pixels` has the shape {pixels.shape}, but must have (height, width, 3 or 4)")
        return pixels

    def _filmic(self) -> bool:
        if self.tone not in ("linear", "filmic"):
            raise Error(f"`tone` is {self.tone!r}, but must be linear or filmic")
        return self.tone == "filmic"

    def _repr_png_(self) -> bytes:
        return self.encode()


def is_page(name: str) -> bool:
    """Whether a name is that of a page of HTML."""
    return os.path.splitext(name)[1].lower() in (".html", ".htm")


def write_whole(name: str, data: bytes) -> None:
    """Writes a file, which is replaced once the new one is complete."""
    import tempfile

    folder = os.path.dirname(os.path.abspath(name))
    descriptor, beside = tempfile.mkstemp(prefix=".spherule-", dir=folder)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(beside, 0o666 & ~mask)
        os.replace(beside, name)
    except BaseException:
        os.unlink(beside)
        raise


def _version() -> str:
    from . import __version__

    return __version__
