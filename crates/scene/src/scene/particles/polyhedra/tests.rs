use super::*;
use crate::scene::particles::{
    Bonds, Boundary, Cell, Codes, Element, Kind, Outside, ParticleStyle, SelectedStyle,
};
use crate::scene::{Rgb, Scene};

/// Perovskite in a cell of edge 4: a titanium atom on the corner, and oxygen atoms on the middles of the edges.
fn perovskite() -> Particles {
    let mut particles = Particles { has_crystal_cell: true, ..Particles::default() };
    let vectors = DVec3::AXES.map(|axis| axis * 4.0);
    particles.frame.cell = Some(Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] });
    particles.spheres.push(DVec3::ZERO, 0.5, 0, Rgb::X);
    for axis in DVec3::AXES {
        particles.spheres.push(axis * 2.0, 0.4, 0, Rgb::Y);
    }
    for name in ["Ti", "O"] {
        let element = Element::from_symbol(name);
        let name = format!("{name}1");
        particles.frame.kinds.table.push(Kind { name, element, ..Kind::default() });
    }
    particles.frame.kinds.codes = Codes::Bytes(vec![0, 1, 1, 1]);
    particles
}

fn find(particles: &mut Particles, rules: &str) -> Result<Vec<Coordination>, String> {
    let rules: Polyhedra = rules.parse().expect(rules);
    let found = super::find(&[&rules], Path::new("file"), particles, false);
    found.map_err(|error| error.to_string())
}

#[test]
fn octahedra_are_found_by_distance_and_by_bonds() {
    let mut particles = perovskite();
    let found = find(&mut particles, "Ti-O<2.1").expect("neighbors");
    assert_eq!((found.len(), found[0].neighbors.len(), found[0].center), (1, 6, 0));
    assert_eq!((found[0].hull.triangles.len(), found[0].hull.edges.len()), (8, 12));
    assert!(find(&mut particles, "Ti-O").is_err_and(|error| error.contains("bonds")));
    let shift = (0..6).map(|bond| {
        let edge = if bond % 2 == 0 { 0 } else { -1 };
        [0, 1, 2].map(|axis| if axis == bond / 2 { edge } else { 0 })
    });
    particles.frame.bonds = Some(Bonds {
        first: vec![0; 6],
        second: vec![1, 1, 2, 2, 3, 3],
        shift: shift.collect(),
        ..Bonds::default()
    });
    assert_eq!(find(&mut particles, "Ti1-O1").expect("neighbors"), found);
    assert_eq!(find(&mut particles, "Ti-O,*-O<2.1").expect("neighbors"), found);
    assert!(particles.frame.warnings.pop().is_some_and(|text| text.contains("3 of 4 centers")));
}

#[test]
fn polyhedra_have_their_corners_unless_nothing_outside_is_drawn() {
    for (complete, outside, spheres, polyhedra) in [
        (true, None, 8 + 12 + 24, 8),
        (true, Some(Outside::None), 8 + 12, 0),
        (false, None, 4 + 3, 1),
        (false, Some(Outside::None), 4, 0),
    ] {
        let mut particles = perovskite();
        let found = find(&mut particles, "Ti-O<2.1").expect("neighbors");
        let boundary = Boundary { complete: Some(complete), outside };
        particles.draw_boundary(boundary, &found).expect("images");
        assert_eq!(particles.added.polyhedra.len(), polyhedra, "{complete} {outside:?}");
        assert_eq!(particles.spheres.len(), spheres, "{complete} {outside:?}");
        let scene = Scene::of_particles(particles, "");
        assert_eq!((scene.triangles.len(), scene.sticks.len()), (8 * polyhedra, 12 * polyhedra));
        if polyhedra > 0 {
            let face = &scene.materials[scene.triangles.material[0] as usize];
            assert_eq!((face.material.opacity(), scene.triangles.color[0]), (OPACITY, Rgb::X));
            assert_eq!(scene.materials[scene.sticks.material[0] as usize].material.opacity(), 1.0);
        }
    }
}

#[test]
fn mistakes_are_named() {
    for (text, part) in [
        ("", "two types"),
        ("Ti", "two types"),
        ("Ti-O<", "not a length"),
        ("Ti-O<0", "not a length"),
        ("Ti-O,", "two types"),
    ] {
        let error = text.parse::<Polyhedra>().expect_err(text);
        assert!(error.contains(part), "{text}: {error}");
    }
    let mut particles = perovskite();
    assert!(find(&mut particles, "Zr-O<2").is_err_and(|error| error.contains("no type `Zr`")));
    assert!(find(&mut particles, "Ti-O<12").is_err_and(|error| error.contains("more than 64")));
    let rules: Polyhedra = "Zr-O<2".parse().expect("a rule");
    assert!(
        super::find(&[&rules], Path::new("file"), &mut particles, true)
            .is_ok_and(|found| found.is_empty())
    );
}

/// The particles of a style have its polyhedra, and others those of all.
#[test]
fn styles_have_polyhedra_of_their_own() {
    let found = |rules: &str, styles: &[&str]| {
        let mut particles = perovskite();
        let style = ParticleStyle {
            polyhedra: rules.parse().unwrap_or_default(),
            styles: styles.iter().map(|style| style.parse().expect(style)).collect(),
            ..ParticleStyle::default()
        };
        style.apply(Path::new("file"), &mut particles).expect("a style");
        particles.replicate([2, 1, 1]).expect("copies");
        let found = style.find_polyhedra(Path::new("file"), &mut particles).expect("neighbors");
        found.iter().map(|own| (own.center, own.neighbors.len(), own.opacity)).collect::<Vec<_>>()
    };
    let own = ["element Ti: polyhedra=Ti-O<2.1 polyhedra-opacity=30%"];
    assert_eq!(found("", &own), [(0, 6, 0.3), (4, 6, 0.3)]);
    assert_eq!(found("*-O<3", &["element O: polyhedra=none"]), [(0, 6, OPACITY), (4, 6, OPACITY)]);
    assert_eq!(found("Ti-O<2.1", &["element O: polyhedra=O-O<1"]).len(), 2);
    assert_eq!(
        found("Ti-O<2.1", &["element Ti: polyhedra=no", "element Ti: polyhedra=Ti-O<2.1"]).len(),
        2
    );
    assert!(found("", &["element O: polyhedra=Ti-O<2.1"]).is_empty());
    let faults = [
        "all: polyhedra=Ti",
        "all: polyhedra-opacity=0.5",
        "all: polyhedra=Ti-O polyhedra-opacity=2",
    ];
    for (text, part) in faults.into_iter().zip(["Ti-O<2.5", "after polyhedra", "0 to 1"]) {
        let message = text.parse::<SelectedStyle>().expect_err(text);
        assert!(message.contains(part), "{message}");
    }
}
