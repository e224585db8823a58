"""Ray queries without a picture: free paths and open directions in a random packing.

From random points in the pores, rays in random directions give the distribution of free paths, whose mean is 4 V / S
for any arrangement of convex grains (the law of Cauchy; here S and V are those of pores between spheres that do not
overlap). The rays also tell the porosity, from inside or outside of which sphere each starts. It writes
pores_queries.png, and checks the law.
"""

import time
from pathlib import Path

import numpy as np
import numpy.typing as npt

import spherule

RADIUS, EDGE, COUNT = 0.5, 40.0, 24_000


def packing() -> npt.NDArray[np.float32]:
    """Centers in a periodic cube at random such that no two spheres overlap, by cells as large as a diameter."""
    rng = np.random.default_rng(11)
    side = int(EDGE / (2 * RADIUS))
    cells: dict[tuple[int, int, int], list[npt.NDArray[np.float64]]] = {}
    centers: list[npt.NDArray[np.float64]] = []
    near = [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)]
    while len(centers) < COUNT:
        point = rng.random(3) * EDGE
        x, y, z = (int(value / (2 * RADIUS)) for value in point)
        places = (((x + i) % side, (y + j) % side, (z + k) % side) for i, j, k in near)
        others = [other for place in places for other in cells.get(place, ())]
        apart = ((point - other + EDGE / 2) % EDGE - EDGE / 2 for other in others)
        if all((offset**2).sum() >= (2 * RADIUS) ** 2 for offset in apart):
            cells.setdefault((x, y, z), []).append(point)
            centers.append(point)
    # Around the origin, where single precision is finest.
    return (np.array(centers) - EDGE / 2).astype(np.float32)


def main() -> None:
    """Traces four million rays, and draws what they found."""
    centers = packing()
    # The cube and its 26 images, so that rays from the middle see no end.
    shifts = np.array([(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)], np.float32) * np.float32(
        EDGE
    )
    tree = spherule.SphereTree((centers[None] + shifts[:, None]).reshape(-1, 3), RADIUS)
    rng = np.random.default_rng(13)
    count = 2_000_000

    def directions(rows: int) -> npt.NDArray[np.float32]:
        vectors = rng.normal(size=(3, rows)).astype(np.float32)
        unit: npt.NDArray[np.float32] = (vectors / np.sqrt((vectors**2).sum(axis=0))).T
        return unit

    # A ray from a point in a sphere leaves it from inside: the normal points along the ray.
    origins = ((rng.random((3, count), dtype=np.float32) - np.float32(0.5)) * np.float32(EDGE)).T
    toward = directions(count)
    start = time.perf_counter()
    hits = tree.intersect(origins, toward, surface=True)
    seconds = time.perf_counter() - start
    assert hits.normals is not None
    outside = hits.hit & ((hits.normals * toward).sum(axis=1) < 0)
    porosity = 1 - len(centers) * 4 / 3 * np.pi * RADIUS**3 / EDGE**3
    print(f"{count / seconds / 1e6:.1f} million rays a second, with points and normals")
    print(f"porosity: {outside.mean():.4f} by rays, {porosity:.4f} by volume")

    # Chords of pores begin at surfaces with cosine-weighted directions; their mean is 4 V / S.
    grains = rng.integers(0, len(centers), count)
    normals = directions(count)
    surface = centers[grains] + normals * np.float32(RADIUS * (1 + 4e-5))
    aim = normals + directions(count)
    aim /= np.sqrt((aim**2).sum(axis=1))[:, None]
    chords = tree.intersect(surface, np.asfortranarray(aim)).t
    law = 4 * porosity * EDGE**3 / (len(centers) * 4 * np.pi * RADIUS**2)
    mean = chords[np.isfinite(chords)].mean()
    print(f"mean chord of pores: {mean:.4f} by rays, {law:.4f} by the law of Cauchy")
    assert abs(mean / law - 1) < 0.01 and abs(outside.mean() / porosity - 1) < 0.01

    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    # The packing itself, colored by how far its surface sees: the mean chord that begins at each grain.
    seen = np.isfinite(chords)
    count_of = np.bincount(grains[seen], minlength=len(centers))
    mean_of = np.bincount(grains[seen], chords[seen], len(centers)) / np.maximum(count_of, 1)
    picture = spherule.render(
        centers,
        radius=RADIUS,
        values=mean_of,
        label_of_values="mean chord",
        color_map="viridis",
        color_range=(1.5, 4),
        color_bar="right",
        slices=["x > 50%", "z > 75%"],
        slice_mode="remove",
        view="iso",
        size=(640, 480),
        spp=48,
        denoise="on",
    )
    figure, (left, axis) = plt.subplots(1, 2, figsize=(11, 4.2), width_ratios=[1.25, 1], layout="constrained")
    left.imshow(picture.srgb())
    left.set_axis_off()
    axis.hist(chords[chords < 8], 160, density=True, color="#3b7f8c")
    axis.axvline(law, color="tab:red", label="4 V / S")
    axis.set(yscale="log", xlabel="chord of a pore, in diameters", ylabel="density")
    axis.legend()
    figure.savefig(Path(__file__).with_suffix(".png"), dpi=100)


if __name__ == "__main__":
    main()
