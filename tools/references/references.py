"""Long renders that are kept in target/references, so that they need not be repeated."""

import errors
from renderers import LONG
from scene_file import fingerprint, read_pfm, write_pfm
from scenes import FOLDER


def kept(path, name, count, render, size=None):
    """Returns a long render of independent images of a scene file, and renders those that are not there.

    `name` says the renderer and its settings; `render` returns the image of a seed. `size` is that of the image if the scene file's
    does not count.
    """
    shown = f"{path.stem}-{size}" if size else path.stem
    folder = FOLDER / "kept" / f"{shown}-{name}-{fingerprint(path)}"
    folder.mkdir(parents=True, exist_ok=True)
    images = []
    for seed in range(LONG, LONG + count):
        file = folder / f"{seed}.pfm"
        if not file.exists():
            part = file.with_suffix(".part")
            write_pfm(part, render(seed))
            part.rename(file)
        images.append(read_pfm(file))
    return errors.LongRender(images)


def halves(long):
    """Returns the mean FLIP of the two halves of a long render, which is more than that of the whole render and the truth."""
    middle = long.count // 2
    return errors.flip(errors.mean(long.images[:middle]), errors.mean(long.images[middle:]))
