"""Ray queries: against brute force in exact arithmetic, for every layout of arrays."""

import math
from fractions import Fraction

import numpy as np
import pytest

import spherule


@pytest.fixture
def spheres():
    rng = np.random.default_rng(2)
    return rng.random((300, 3), dtype=np.float32), rng.uniform(0.01, 0.05, 300).astype(np.float32)


@pytest.fixture
def rays():
    rng = np.random.default_rng(3)
    return (rng.random((5000, 3), dtype=np.float32) * 3 - 1), rng.normal(size=(5000, 3)).astype(np.float32)


def exact_hit(positions, radius, origin, direction):
    """The sphere that a ray hits first, decided on fractions; distances are compared by their quadratics' roots."""
    best = None
    # Rays that miss by far are not worth their fractions: doubles err by far less than this.
    from_centers = origin.astype(np.float64) - positions
    along = from_centers @ direction.astype(np.float64)
    square = (direction.astype(np.float64) ** 2).sum()
    inside = along**2 - square * ((from_centers**2).sum(axis=1) - radius.astype(np.float64) ** 2)
    o, d = ([Fraction(float(value)) for value in row] for row in (origin, direction))
    a = sum(x * x for x in d)
    for row in np.flatnonzero(inside > -1e-9 * square):
        center, r = positions[row], radius[row]
        c = [x - Fraction(float(y)) for x, y in zip(o, center)]
        b = sum(x * y for x, y in zip(c, d))
        q = sum(x * x for x in c) - Fraction(float(r)) ** 2
        disc = b * b - a * q
        if disc < 0:
            continue
        # Roots to 200 bits are apart enough for random spheres.
        scale = 1 << 400
        root = Fraction(math.isqrt(int(disc * scale)), 1 << 200)
        for t in ((-b - root) / a, (-b + root) / a):
            if t > 0:
                if best is None or t < best[0]:
                    best = (t, row)
                break
    return best


def test_hits_are_those_of_exact_arithmetic(spheres, rays):
    positions, radius = spheres
    origins, directions = rays[0][:600], rays[1][:600]
    hits = spherule.SphereTree(positions, radius).intersect(origins, directions)
    found = 0
    for row in range(600):
        expected = exact_hit(positions, radius, origins[row], directions[row])
        if expected is None:
            assert hits.sphere[row] == spherule.NOTHING and hits.t[row] == np.inf
        else:
            found += 1
            assert hits.sphere[row] == expected[1]
            assert hits.t[row] == float(expected[0]), "the nearest double"
    assert found > 20


def test_layouts_and_threads_do_not_matter(spheres, rays):
    positions, radius = spheres
    tree = spherule.SphereTree(positions, radius)
    expected = tree.intersect(*rays, surface=True)
    columns = [tuple(np.ascontiguousarray(table[:, axis]) for axis in range(3)) for table in rays]
    for origins, directions in (
        (np.asfortranarray(rays[0]), np.asfortranarray(rays[1])),
        columns,
        (rays[0].astype(np.float64), rays[1].tolist()),
        (np.repeat(rays[0], 2, axis=0)[::2], rays[1][::-1].copy()[::-1]),
    ):
        for threads in (1, 3):
            hits = tree.intersect(origins, directions, surface=True, threads=threads)
            assert all(np.array_equal(a, b, equal_nan=a.dtype.kind == "f") for a, b in zip(expected, hits))
    other = spherule.SphereTree(tuple(positions.T), np.repeat(radius, 2)[::2])
    assert np.array_equal(other.intersect(*rays).t, expected.t)
    assert np.array_equal(expected.hit, tree.occluded(*rays))
    assert tree.count(*rays) == np.count_nonzero(expected.hit) > 100


def test_points_are_on_spheres_and_misses_are_nan(spheres, rays):
    positions, radius = spheres
    hits = spherule.SphereTree(positions, radius).intersect(*rays, surface=True)
    hit, rows = hits.hit, hits.sphere[hits.hit]
    distance = np.linalg.norm(hits.points[hit] - positions[rows], axis=1)
    assert np.allclose(distance, radius[rows], rtol=1e-12)
    assert np.allclose(np.linalg.norm(hits.normals[hit], axis=1), 1, rtol=1e-12)
    assert np.isnan(hits.points[~hit]).all() and np.isnan(hits.normals[~hit]).all()


def test_bounds_end_searches(spheres, rays):
    tree = spherule.SphereTree(*spheres)
    hits = tree.intersect(*rays)
    far = np.flatnonzero(hits.hit)[:10]
    bound = np.full(5000, np.inf)
    # A distance may be rounded up to the bound: the double below is nearer.
    bound[far] = np.nextafter(hits.t[far], 0)
    again = tree.intersect(*rays, t_max=bound)
    assert not again.hit[far].any() and np.isinf(again.t[far]).all()
    assert np.array_equal(np.delete(again.sphere, far), np.delete(hits.sphere, far))
    assert tree.count(*rays, t_max=0.0) == 0


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: spherule.SphereTree([[0, 0, 0]], [1, 2]), "`radius` has the shape (2,), but must have (1,)"),
        (lambda: spherule.SphereTree([[0, 0, 0]], -1), "radius[0] is -1, but must be finite and greater than 0"),
        (lambda: spherule.SphereTree([[0, 0, 0]], 1e300), "radius[0] is 1e+300, which is too large for single precision"),
        (lambda: spherule.SphereTree([[0, np.nan, 0]], 1), "positions[0, 1] is NaN, but must be finite"),
        (lambda: tree().intersect([[0, 0]], [[0, 0, 1]]), "`origins` has the shape (1, 2), but must have (n, 3)"),
        (lambda: tree().occluded(np.zeros((3, 3)), np.zeros((2, 3))), "`directions` has 2 rows, but must have 3"),
        (
            lambda: tree().count([[0, 0, 0]], [[0, 0, 1]], t_max=[1, 2]),
            "`t_max` has the shape (2,), but must have (1,)",
        ),
    ],
)
def test_what_is_wrong_is_named(call, text):
    with pytest.raises(spherule.Error) as refused:
        call()
    assert text in str(refused.value)


def tree():
    return spherule.SphereTree([[0, 0, 0]], 1)


def test_empty_batches_and_trees_are_fine():
    assert tree().intersect(np.zeros((0, 3)), np.zeros((0, 3))).t.shape == (0,)
    nothing = spherule.SphereTree(np.zeros((0, 3)), 1)
    assert len(nothing) == 0 and nothing.count([[0, 0, 0]], [[0, 0, 1]]) == 0
    invalid = tree().intersect([[0, 0, np.nan], [0, 0, 5]], [[0, 0, 1], [0, 0, 0]])
    assert not invalid.hit.any()
