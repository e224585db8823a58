use super::*;
use crate::integrator::elisions::Elisions;
use crate::integrator::workspace::Workspace;
use crate::scene::generate::default_scene;

/// Returns a workspace with distinct rays, whose hits `hit` returns, sorted into queues.
fn sorted(world: &World, count: usize, hit: impl Fn(u32) -> u32) -> Workspace {
    let mut work = Workspace::new(world, Elisions::ALL);
    work.start_paths(count);
    let mut draw = 1_u32;
    for row in 0..count {
        draw = draw.wrapping_mul(747_796_405).wrapping_add(1);
        work.hits.sphere[row] = hit(draw >> 16);
        work.rays.direction.x[row] = row as f32;
        work.surface.point.y[row] = 2.0 * row as f32;
        work.states.set_path(row, 5 * row as u32);
    }
    work.sort(world);
    work
}

fn check(world: &World, work: &Workspace, kind: MaterialKind) {
    let is_of = |hit| hit != MISS && world.material(hit).kind() == kind;
    let expected: Vec<usize> =
        (0..work.len()).filter(|&row| is_of(work.hits.sphere[row])).collect();
    let Some(queue) = work.queues.of(kind) else { return assert!(expected.is_empty()) };
    assert_eq!(queue.ray_rows().collect::<Vec<_>>(), expected);
    for (i, &row) in expected.iter().enumerate() {
        assert_eq!(queue.columns.vector(DIRECTION, i).x, row as f32);
        assert_eq!(queue.columns.vector(POINT, i).y, 2.0 * row as f32);
        assert_eq!((queue.states.path(i), queue.hit(i)), (5 * row, work.hits.sphere[row]));
    }
}

#[test]
fn every_hit_is_in_the_queue_of_its_material_in_order() {
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
            for kind in MaterialKind::ALL {
                check(&world, &work, kind);
            }
        }
    }
}

#[test]
fn inside_bits_stay_with_their_rows() {
    let world = World::build(&default_scene(3)).unwrap();
    let mut work = sorted(&world, 100, |draw| draw % 400);
    for row in (0..100).step_by(3) {
        work.surface.flip_inside(row);
    }
    work.sort(&world);
    for kind in MaterialKind::ALL.into_iter().filter(|&kind| kind != MaterialKind::Dielectric) {
        let Some(queue) = work.queues.of(kind) else { continue };
        for rows in queue.rows() {
            for lane in set_bits(rows.lanes) {
                let inside = queue.inside(rows.first) >> lane & 1 == 1;
                assert_eq!(inside, queue.ray(rows.first + lane) % 3 == 0);
            }
        }
    }
}

/// The features of the world still count the removed spheres.
#[test]
fn a_world_without_its_spheres_has_no_hits() {
    let mut world = World::build(&default_scene(3)).unwrap();
    world.appearance.material = Column::Rows(Vec::new());
    let work = sorted(&world, 3, |_| MISS);
    assert_eq!((work.len(), work.queues.hit_count()), (3, 0));
}
