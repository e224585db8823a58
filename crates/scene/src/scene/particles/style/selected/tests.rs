use super::*;
use crate::color::{Map, category, parse, srgb};
use crate::scene::Scene;
use crate::scene::particles::{
    BondSource, ColumnColors, Columns, ElementColors, ReadOptions, read,
};

/// A chain of three carbons, a ligand of two atoms that are bonded to each other, and water.
const ATOMS: &str = "\
ATOM      1  CA  GLY A   1       0.000   0.000   0.000  1.00  0.00           C
ATOM      2  C   GLY A   1       1.500   0.000   0.000  1.00  1.00           C
ATOM      3  CB  ALA B   2       3.000   0.000   0.000  1.00  2.00           C
HETATM    4  C1  LIG C   1       0.000   9.000   0.000  1.00  3.00           C
HETATM    5  O1  LIG C   1       1.300   9.000   0.000  1.00  4.00           O
HETATM    6  O   HOH D   1       0.000   0.000   9.000  1.00  5.00           O
";

/// The style of base options, and of texts of `--style`.
fn styled(base: ParticleStyle, styles: &[&str]) -> ParticleStyle {
    let styles = styles.iter().map(|text| text.parse().expect("a style")).collect();
    ParticleStyle { styles, ..base }
}

fn apply(style: &ParticleStyle) -> Result<(Particles, Applied), FileError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("atoms.pdb");
    std::fs::write(&path, ATOMS).expect("a file");
    let columns = Columns { wanted: style.columns(), ..Columns::default() };
    let bonds = style.bond_source();
    let options = ReadOptions { columns, bonds, ..ReadOptions::default() };
    let mut particles = read(&path, &options)?;
    let applied = style.apply(&path, &mut particles)?;
    Ok((particles, applied))
}

fn own(styles: &[&str]) -> (Particles, Applied) {
    apply(&styled(ParticleStyle::default(), styles)).expect("a valid style")
}

fn by(column: &str) -> Coloring {
    Coloring::Column(ColumnColors { column: column.to_owned(), ..ColumnColors::default() })
}

#[test]
fn selections_have_models_of_their_own_with_their_bonds() {
    let (particles, _) = own(&["ligand: model=ball-and-stick"]);
    let radii = &particles.spheres.radius;
    let usual = own(&[]).0.spheres.radius;
    assert_eq!(radii[..3], usual[..3]);
    assert_eq!([radii[3], radii[4]], [usual[3] / 4.0, usual[4] / 4.0]);
    let scene = Scene::of_particles(particles, "");
    // The bonds of the chain, which is spheres, are not drawn.
    assert_eq!(scene.sticks.len(), 1);
    let stick = scene.sticks.radius[0];
    let (two, _) = own(&["all: model=licorice", "ligand: model=ball-and-stick bond-radius=0.2"]);
    let scene = Scene::of_particles(two.clone(), "");
    assert_eq!(scene.sticks.len(), 3);
    let thick = scene.sticks.radius.iter().filter(|radius| **radius == 0.2).count();
    assert_eq!(thick, 1);
    let licorice = two.spheres.radius[0];
    assert!((licorice / stick - 1.5).abs() < 1e-12, "{licorice} {stick}");
    assert_eq!(two.spheres.radius[1..3], [licorice; 2]);
    // One end of the bond between the two residues is spheres.
    let (mixed, _) = own(&["chain A: model=licorice"]);
    let scene = Scene::of_particles(mixed, "");
    assert_eq!(scene.sticks.radius, [licorice; 2]);
}

#[test]
fn bonds_of_selections_are_drawn_or_not() {
    let count = |styles: &[&str]| Scene::of_particles(own(styles).0, "").sticks.len();
    assert_eq!(count(&["all: model=ball-and-stick", "chain A: bonds=no"]), 1);
    assert_eq!(count(&["all: model=ball-and-stick", "chain A: bonds=no", "chain A: bonds=yes"]), 3);
    assert_eq!(count(&["chain C: bonds=yes scale=0.3"]), 1);
    assert_eq!(count(&["chain C: model=licorice visible=no"]), 0);
    let base = ParticleStyle { model: Some(Model::BallAndStick), ..ParticleStyle::default() };
    let (particles, _) = apply(&styled(base, &["all: model=space-filling"])).expect("a style");
    assert_eq!(particles.spheres.radius, own(&[]).0.spheres.radius);
}

#[test]
fn later_colors_win() {
    let (particles, applied) =
        own(&["all: color=white", "chain B: color=gold", "chain A B: color=#ff0000"]);
    let color = |name: &str| parse(name).expect("a color");
    let expected = ["red", "red", "red", "white", "white", "white"].map(color);
    assert_eq!(particles.spheres.color, expected);
    assert_eq!(applied.matched, [true; 3]);
    let (particles, _) = own(&["all: color=white", "ligand: color=cpk"]);
    let cpk = |number| {
        ElementColors::Cpk.of(Some(spherule_particles::Element::from_number(number).expect("one")))
    };
    assert_eq!(particles.spheres.color[3..5], [cpk(6), cpk(8)]);
    let (particles, _) = own(&["all: color=white", "chain A B: color=chain"]);
    assert_eq!(particles.spheres.color[..3], [0, 0, 1].map(category));
}

#[test]
fn columns_color_selections_by_their_own_range() {
    let (particles, applied) = own(&["chain A B: color=bfactor*2 map=magma_r"]);
    let at = |place: f64| Map::Magma.at(1.0 - place);
    assert_eq!(particles.spheres.color[..3], [at(0.0), at(0.5), at(1.0)]);
    let legend = applied.legend().expect("a legend");
    assert_eq!([legend.scale.range.low(), legend.scale.range.high()], [0.0, 4.0]);
    let base = ParticleStyle { coloring: by("x"), ..ParticleStyle::default() };
    let style = styled(base, &["ligand: color=bfactor range=0,4"]);
    let (particles, applied) = apply(&style).expect("a style");
    assert_eq!(applied.legends.len(), 2);
    assert_eq!(style.column_colors().count(), 2);
    assert_eq!(applied.legend().expect("a legend").label, "x (\u{c5})");
    assert_eq!(particles.spheres.color[4], Map::Viridis.at(1.0));
    assert_eq!(particles.spheres.color[3], Map::Viridis.at(0.75));
}

#[test]
fn legends_name_selections() {
    let named = |base: ParticleStyle, styles: &[&str]| {
        let style = styled(base, styles);
        let (particles, applied) = apply(&style).expect("a style");
        let found = particles.categories(&style, &applied)?;
        Some(found.into_iter().map(|own| (own.name, own.count)).collect::<Vec<_>>())
    };
    let pairs = |pairs: &[(&str, u64)]| {
        Some(pairs.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect::<Vec<_>>())
    };
    let by_chain = || ParticleStyle { coloring: by("chain"), ..ParticleStyle::default() };
    let expected = pairs(&[("A", 2), ("B", 1), ("D", 1), ("resname LIG", 2)]);
    assert_eq!(named(by_chain(), &["resname LIG: color=magenta"]), expected);
    let expected = pairs(&[("C", 3), ("O", 1), ("ligand", 2)]);
    assert_eq!(named(ParticleStyle::default(), &["ligand: color=magenta"]), expected);
    let expected = pairs(&[("C", 3), ("O", 1), ("C", 1), ("O", 1)]);
    assert_eq!(named(ParticleStyle::default(), &["ligand: color=cpk"]), expected);
    let by_x = || ParticleStyle { coloring: by("x"), ..ParticleStyle::default() };
    assert_eq!(named(by_x(), &["ligand: color=magenta"]), pairs(&[("ligand", 2)]));
    assert_eq!(named(by_x(), &["ligand: opacity=0.5"]), None);
}

#[test]
fn hidden_particles_are_dropped() {
    let (particles, _) = own(&["water: visible=no", "chain A: visible=no", "name CA: visible=yes"]);
    assert_eq!(particles.spheres.y, [0.0, 0.0, 9.0, 9.0]);
    let style = ParticleStyle {
        select: Some("not water".parse().expect("a selection")),
        ..ParticleStyle::default()
    };
    // Selections of styles are of all particles.
    let near = "chain C and within 9.5 of water: color=red";
    let error = apply(&styled(style.clone(), &[near])).expect_err("none");
    assert!(error.message.contains("none of its 6 particles is styled"), "{error}");
    let (particles, _) =
        apply(&styled(style, &["chain A and within 9.5 of water: color=red"])).expect("some");
    assert_eq!(particles.spheres.len(), 5);
    assert_eq!(particles.spheres.color[..2], [Rgb::X; 2]);
    let hidden = SelectedStyle::hidden("all".parse().expect("a selection"));
    let style = ParticleStyle { styles: vec![hidden], ..ParticleStyle::default() };
    let error = apply(&style).expect_err("nothing left");
    assert!(error.message.contains("none of its 6 particles is visible"), "{error}");
}

#[test]
fn sizes_materials_and_opacities_are_of_selections() {
    let (particles, _) = own(&[
        "all: radius=2",
        "chain A: scale=0.5",
        "chain C: material=mirror color=gold",
        "chain A: opacity=0.25",
        "name CA: opacity=bfactor:0,2",
    ]);
    assert_eq!(particles.spheres.radius, [1.0, 1.0, 2.0, 2.0, 2.0, 2.0]);
    let scene = Scene::of_particles(particles, "");
    let material = |row: usize| &scene.materials[scene.spheres.material_of(row) as usize];
    assert_eq!(material(3).name, "chain C: mirror");
    let opacities: Vec<f64> = (0..4).map(|row| material(row).material.opacity()).collect();
    assert_eq!(opacities, [0.0, 0.25, 1.0, 1.0]);
    assert_eq!(scene.spheres.color_of(3), parse("gold").expect("a color"));
    assert_ne!(scene.spheres.color_of(3), srgb(0));
}

#[test]
fn short_forms_come_before_styles() {
    let types = vec!["C:color=red,radius=3".parse().expect("a type")];
    let base =
        ParticleStyle { types, opacity: Some(Opacity::Number(0.5)), ..ParticleStyle::default() };
    let (particles, _) = apply(&styled(base, &["chain B: color=blue opacity=1"])).expect("a style");
    assert_eq!(particles.spheres.color[1..3], [Rgb::X, Rgb::Z]);
    assert_eq!(particles.spheres.radius[1], 3.0);
    let opacity = |row: usize| particles.opacities[particles.spheres.material_of(row) as usize];
    assert_eq!([opacity(1), opacity(2)], [Some(0.5), Some(1.0)]);
}

#[test]
fn sources_of_bonds_follow_models() {
    let source = |styles: &[&str]| styled(ParticleStyle::default(), styles).bond_source();
    assert_eq!(source(&[]), BondSource::OfCrystals);
    assert_eq!(source(&["all: color=red"]), BondSource::OfCrystals);
    assert_eq!(source(&["ligand: model=licorice"]), BondSource::Auto);
    assert_eq!(source(&["ligand: bonds=yes"]), BondSource::Auto);
    let base = ParticleStyle { bonds: Some(BondSource::None), ..ParticleStyle::default() };
    assert_eq!(styled(base, &["ligand: model=licorice"]).bond_source(), BondSource::None);
}

#[test]
fn styles_are_read_from_texts() {
    let read = |text: &str| text.parse::<SelectedStyle>().expect(text);
    let style = read(
        "resid 5:10 and name \"A:B\" : model=licorice, color=c_pe / mass map=turbo_r range=-1, 2",
    );
    assert_eq!(style.selection.text(), "resid 5:10 and name \"A:B\"");
    assert_eq!(style.properties.model, Some(Model::Licorice));
    let Some(Coloring::Column(colors)) = &style.properties.color else { panic!("a column") };
    assert_eq!(
        (colors.column.as_str(), colors.map, colors.reversed),
        ("c_pe / mass", Some(Map::Turbo), true)
    );
    assert_eq!(colors.ends, crate::scene::particles::ColorEnds::numbers(-1.0, 2.0));
    let style = read("all:visible=no opacity=charge:-1,1");
    assert_eq!(style.properties.visible, Some(false));
    assert!(matches!(style.properties.opacity, Some(Opacity::Column { .. })));
    for (text, part) in [
        ("", "expected a selection"),
        ("protein", "expected a selection"),
        (": color=red", "expected a selection"),
        ("protein: red", "expected a selection"),
        ("protein:", "expected a selection"),
        ("z>0: color:red", "expected a selection"),
        ("z>0: red=", "`red=` has no value"),
        ("protein: color=", "has no value"),
        ("protein: colour=red", "did you mean `color`"),
        ("protein: modle=licorice color=red", "did you mean `model`"),
        ("protein: model=ball", "models are: space-filling, ball-and-stick, licorice"),
        ("protein: map=turbo", "after color=COLUMN"),
        ("protein: color=red range=0,1", "after color=COLUMN"),
        ("protein: color=x map=jet", "unknown color map `jet`"),
        ("protein: color=x range=2,1", "the lower one first"),
        ("protein: radius=0", "greater than 0"),
        ("protein: material=wood", "materials are: lambertian"),
        ("protein: visible=perhaps", "neither yes nor no"),
        ("z >: color=red", "expected a number or a name"),
    ] {
        let error = text.parse::<SelectedStyle>().expect_err(text);
        assert!(error.contains(part), "{text}: {error}");
    }
}

#[test]
fn what_is_not_there_is_reported() {
    for (text, part) in [
        ("resname ATP: color=red", "none of its 6 particles is styled: `resname ATP`"),
        ("all: color=magneta", "no column is named `magneta`"),
        ("all: color=spede", "no column is named `spede`"),
        ("ligands and cha A: color=red", "no column is named `cha`"),
        ("ligant: color=red", "did you mean `ligand`"),
    ] {
        let error = apply(&styled(ParticleStyle::default(), &[text])).expect_err(text);
        assert!(error.to_string().contains(part), "{text}: {error}");
    }
    let error =
        apply(&styled(ParticleStyle::default(), &["all: color=magneta"])).expect_err("a typo");
    assert!(error.help.is_some_and(|help| help.contains("`magenta`")));
    let style = styled(ParticleStyle::default(), &["resname ATP: color=red"]);
    let style = ParticleStyle { allow_empty: true, ..style };
    let (_, applied) = apply(&style).expect("allowed");
    assert_eq!(applied.matched, [false]);
    let path = Path::new("p");
    assert!(style.check_matched(path, &applied.matched).is_err());
    assert!(style.check_matched(path, &[true]).is_ok());
}

#[test]
fn orientations_are_of_all_particles() {
    let (whole, _) = own(&[]);
    for styles in [&["chain B C D: visible=no"][..], &["all: model=licorice"], &["all: radius=9"]] {
        let (particles, _) = own(styles);
        assert!(particles.orientation.is_some() && particles.orientation == whole.orientation);
    }
}
