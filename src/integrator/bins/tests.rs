use super::*;
use crate::integrator::skips::Skips;
use crate::integrator::workspace::Workspace;
use crate::scene::generate::default_scene;

/// Rays of which every one is another, and which hit what `hit` says.
fn sorted(world: &World, count: usize, hit: impl Fn(u32) -> u32) -> Workspace {
    let mut work = Workspace::new(world, Skips::ALL);
    work.begin(count);
    let mut draw = 1_u32;
    for row in 0..count {
        draw = draw.wrapping_mul(747_796_405).wrapping_add(1);
        work.hits.sphere[row] = hit(draw >> 16);
        work.rays.direction.x[row] = row as f32;
        work.surface.point.y[row] = 2.0 * row as f32;
        work.carried.set_place(row, 5 * row as u32);
    }
    work.sort(world);
    work
}

fn check(world: &World, work: &Workspace, kind: Kind) {
    let is_of = |hit| hit != MISS && world.material(hit).kind() == kind;
    let expected: Vec<usize> =
        (0..work.len()).filter(|&row| is_of(work.hits.sphere[row])).collect();
    let Some(bin) = work.bins.of(kind) else { return assert!(expected.is_empty()) };
    assert_eq!(bin.each().collect::<Vec<_>>(), expected);
    for (i, &row) in expected.iter().enumerate() {
        assert_eq!(bin.columns.vector(DIRECTION, i).x, row as f32);
        assert_eq!(bin.columns.vector(POINT, i).y, 2.0 * row as f32);
        assert_eq!((bin.carried.place(i), bin.hit(i)), (5 * row, work.hits.sphere[row]));
    }
}

#[test]
fn every_row_is_in_the_bin_of_what_it_hits_and_in_order() {
    let mut scene = default_scene(3);
    let many = World::build(&scene).unwrap();
    let mut keep = vec![false; scene.spheres.len()];
    keep[..14].fill(true);
    scene.spheres.retain(&keep);
    for world in [many, World::build(&scene).unwrap()] {
        let spheres = world.spheres.len() as u32;
        let hit = |draw| match draw {
            x if x % 5 == 0 => MISS,
            x if x % 5 == 1 && world.ground.is_some() => GROUND,
            x => x % spheres,
        };
        for count in [0, 1, 127, 128, 129, 1000, 300] {
            let work = sorted(&world, count, hit);
            for kind in Kind::ALL {
                check(&world, &work, kind);
            }
        }
    }
}

#[test]
fn what_is_seen_from_inside_stays_with_its_row() {
    let world = World::build(&default_scene(3)).unwrap();
    let mut work = sorted(&world, 100, |draw| draw % 400);
    for row in (0..100).step_by(3) {
        work.surface.turn(row);
    }
    work.sort(&world);
    for kind in Kind::ALL.into_iter().filter(|&kind| kind != Kind::Dielectric) {
        let Some(bin) = work.bins.of(kind) else { continue };
        for (start, lanes) in bin.rows() {
            for lane in set_bits(lanes) {
                let inside = bin.inside(start) >> lane & 1 == 1;
                assert_eq!(inside, bin.ray(start + lane) % 3 == 0);
            }
        }
    }
}

/// The world keeps the census of what was taken out.
#[test]
fn where_the_spheres_were_taken_out_nothing_is_hit() {
    let mut world = World::build(&default_scene(3)).unwrap();
    world.appearance.material = Column::Rows(Vec::new());
    let work = sorted(&world, 3, |_| MISS);
    assert_eq!((work.len(), work.bins.scattered()), (3, 0));
}
