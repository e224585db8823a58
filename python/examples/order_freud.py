"""Local order by freud: a crystal that melts from one side, colored by the bond order of each particle.

The order parameter is that of Steinhardt, with l = 6, averaged over neighbors: some 0.5 in the crystal, 0.2 in the melt. Run it with freud
(freud-analysis) installed; it writes order_freud.png.
"""

from pathlib import Path

import freud
import numpy as np

import spherule


def main() -> None:
    """Renders the system."""
    box, points = freud.data.UnitCell.fcc().generate_system((16, 8, 8))
    rng = np.random.default_rng(3)
    # Particles are the farther from their sites, the more they are to the right.
    disorder = 0.25 / (1 + np.exp(-0.8 * points[:, :1]))
    points = box.wrap(points + rng.normal(size=points.shape) * disorder)
    order = freud.order.Steinhardt(l=6, average=True)
    order.compute((box, points), neighbors={"num_neighbors": 12})
    edges = np.asarray(box.to_matrix()).T
    picture = spherule.render(
        points,
        radius=0.33,
        values=order.particle_order,
        label_of_values="q_6",
        color_map="viridis",
        color_range=(0, 0.6),
        color_bar="right",
        # The box of freud is centered at the origin.
        cell=edges,
        origin=-edges.sum(axis=0) / 2,
        show_cell=True,
        view=(-65, 20),
        size=(800, 420),
        spp=24,
        denoise="on",
    )
    picture.save(Path(__file__).with_suffix(".png"))


if __name__ == "__main__":
    main()
