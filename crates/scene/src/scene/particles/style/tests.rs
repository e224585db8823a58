use super::*;
use crate::color::elements::cpk;
use crate::color::{Map, RangeError, Spacing, category, srgb};
use crate::scene::particles::select::expression::numbers;
use crate::scene::particles::{
    ArrowCentering, ArrowSizes, Columns, Element, LengthUnit, ParticleFrame, Radii, ReadOptions,
    read,
};
use crate::scene::{Material, Rgb, Scene};
use glam::DVec3;

const DUMP: &str = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n3\nITEM: BOX BOUNDS pp pp pp\n0 9\n\
                    0 9\n0 9\nITEM: ATOMS type x y z radius q mol\n1 1 2 0 .5 10 a\n\
                    2 2 2 0 1 100 b\n2 3 2 0 2 1000 a\n";
const WATER: &str = "3\nwater\nO 0 0 0\nH 1 0 0\nH 0 1 0\n";

/// Applies a style to a file with this content.
fn apply(content: &str, style: &ParticleStyle) -> Result<(Particles, Option<Legend>), FileError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("particles");
    std::fs::write(&path, content).expect("a file");
    let columns = Columns { wanted: style.columns(), ..Columns::default() };
    let mut particles = read(&path, &ReadOptions { columns, ..ReadOptions::default() })?;
    let applied = style.apply(&path, &mut particles)?;
    Ok((particles, applied.legend().cloned()))
}

fn by(column: &str) -> ColumnColors {
    ColumnColors { column: column.to_owned(), ..ColumnColors::default() }
}

fn colored(colors: ColumnColors) -> ParticleStyle {
    ParticleStyle { coloring: Coloring::Column(colors), ..ParticleStyle::default() }
}

#[test]
fn numbers_have_the_colors_of_a_map() {
    let at = |position: f64| Map::Viridis.at(position);
    for (column, middle) in [("x", 0.5), ("RADIUS", 1.0 / 3.0), ("q", 10.0 / 110.0), ("id", 0.5)] {
        let (particles, legend) = apply(DUMP, &colored(by(column))).expect("colors");
        assert_eq!(particles.spheres.color, [at(0.0), at(middle), at(1.0)], "{column}");
        assert_eq!(legend.expect("a legend").label, column);
    }
    let logarithmic = ColumnColors { spacing: Spacing::Logarithmic, ..by("q") };
    let (particles, _) = apply(DUMP, &colored(logarithmic)).expect("colors");
    assert!(particles.spheres.color[1].abs_diff_eq(at(0.5), 1e-6));
    let reversed = ColumnColors { reversed: true, ..by("x") };
    let (particles, legend) = apply(DUMP, &colored(reversed)).expect("colors");
    assert_eq!(particles.spheres.color, [at(1.0), at(0.5), at(0.0)]);
    assert!(legend.expect("a legend").scale.reversed);
    let clipped =
        ColumnColors { ends: ColorEnds::numbers(50.0, 100.0), map: Some(Map::Turbo), ..by("q") };
    let (particles, _) = apply(DUMP, &colored(clipped)).expect("colors");
    let at = |position: f64| Map::Turbo.at(position);
    assert_eq!(particles.spheres.color, [at(0.0), at(1.0), at(1.0)]);
}

#[test]
fn texts_have_colors_of_their_own() {
    for (column, codes) in [("mol", [0, 1, 0]), ("type", [0, 1, 1]), ("element", [0, 1, 1])] {
        let (particles, legend) = apply(DUMP, &colored(by(column))).expect("colors");
        assert_eq!((particles.spheres.color, legend), (codes.map(category).into(), None));
    }
    let ranged = ColumnColors { ends: ColorEnds::numbers(0.0, 1.0), ..by("mol") };
    let error = apply(DUMP, &colored(ranged)).expect_err("no range");
    assert!(error.message.contains("`mol` holds texts"), "{error}");
}

#[test]
fn integers_of_labels_have_colors_of_their_own() {
    let table = "x,y,z,mol,q\n0,0,0,7,1\n1,0,0,3,2\n2,0,0,,1\n3,0,0,7,3\n";
    let gray = srgb(0x80_80_80);
    let (particles, legend) = apply(table, &colored(by("mol"))).expect("colors");
    let colors = vec![category(1), category(0), gray, category(1)];
    assert_eq!((&particles.spheres.color, &legend), (&colors, &None));
    assert!(particles.frame.warnings.iter().any(|text| text.contains("no value of `mol`")));
    let names = particles.categories(&colored(by("mol")), &Applied::default()).expect("categories");
    let names: Vec<(&str, u64)> = names.iter().map(|own| (own.name.as_str(), own.count)).collect();
    assert_eq!(names, [("3", 1), ("7", 2), ("missing", 1)]);
    // Frames have the colors of their sequence, and values that were not in it come last.
    let mut all = ColumnSummary::of(&by("mol"), &[1.0, 7.0]);
    all.add(&ColumnSummary::of(&by("mol"), &[5.0]));
    let shared = ColumnColors { shared: all.share(&by("mol")).ok(), ..by("mol") };
    let (particles, _) = apply(table, &colored(shared)).expect("colors");
    assert_eq!(particles.spheres.color, [category(2), category(3), gray, category(2)]);
    // A map, a range or a color bar is for numbers, and other columns are numbers unless categories are asked for.
    let mut bar = Coloring::Column(by("mol"));
    bar.prefer_map();
    let style = ParticleStyle { coloring: bar, ..ParticleStyle::default() };
    assert!(apply(table, &style).expect("colors").1.is_some());
    for colors in [
        ColumnColors { map: Some(Map::Turbo), ..by("mol") },
        ColumnColors { ends: ColorEnds::numbers(0.0, 9.0), ..by("mol") },
        by("q"),
    ] {
        assert!(apply(table, &colored(colors)).expect("colors").1.is_some());
    }
    let chosen = |column| ColumnColors { numbers: NumberColors::Categories, ..by(column) };
    let (particles, _) = apply(table, &colored(chosen("q"))).expect("colors");
    assert_eq!(particles.spheres.color, [0, 1, 0, 2].map(category));
    let odd = table.replace(",3\n", ",2.5\n");
    let error = apply(&odd, &colored(chosen("q"))).expect_err("no integers");
    assert!(error.message.contains("categories of the column `q`"), "{error}");
    let ranged = ColumnColors { spacing: Spacing::Logarithmic, ..chosen("q") };
    assert!(apply(table, &colored(ranged)).is_err());
}

#[test]
fn more_categories_than_colors_are_reported() {
    let rows: Vec<String> = (0..31).map(|row| format!("{row},0,0,m{row},{row}\n")).collect();
    let rows = rows.concat();
    let table = format!("x,y,z,name,n\n{rows}");
    let chosen = ColumnColors { numbers: NumberColors::Categories, ..by("n") };
    for colors in [by("name"), chosen] {
        let (particles, _) = apply(&table, &colored(colors)).expect("colors");
        let color = &particles.spheres.color;
        assert_eq!((color[30], color[29]), (category(0), category(29)));
        let warnings = &particles.frame.warnings;
        assert!(warnings.iter().any(|text| text.contains("31 different values")), "{warnings:?}");
    }
}

#[test]
fn values_beyond_the_range_have_the_colors_of_its_ends() {
    let scale = |ends: &str| {
        let colors = ColumnColors { ends: ends.parse().expect("ends"), ..by("q") };
        apply(DUMP, &colored(colors)).expect("colors").1.expect("a legend").scale
    };
    let ends = |ends: &str| [scale(ends).below, scale(ends).above];
    let [low, high] = [0.0, 1.0].map(|position| Map::Viridis.at(position));
    assert_eq!(ends("50%,2000"), [Some(low), None]);
    assert_eq!(ends("10,50%"), [None, Some(high)]);
    assert_eq!(ends("auto"), [None, None]);
    let range = scale("50%,auto").range;
    assert_eq!([range.low(), range.high()], [100.0, 1000.0]);
}

#[test]
fn elements_have_the_colors_of_a_scheme() {
    let style =
        |scheme| ParticleStyle { coloring: Coloring::Elements(scheme), ..ParticleStyle::default() };
    let (particles, _) = apply(WATER, &style(ElementColors::Cpk)).expect("colors");
    assert_eq!(Some(particles.spheres.color[0]), cpk(8));
    assert_eq!(ElementColors::Cpk.of(None), ElementColors::Jmol.of(None));
    let error = apply(DUMP, &style(ElementColors::Cpk)).expect_err("no elements");
    assert!(error.message.contains("no particle has an element"), "{error}");
}

#[test]
fn missing_columns_and_values_are_reported() {
    let error = apply(DUMP, &colored(by("speed"))).expect_err("no column");
    let expected =
        "no column is named `speed`; there are type, x, y, z, radius, q, mol, id, index, element";
    assert_eq!(error.message, expected);
    let dust = "x,y,z,q\n0,0,0,4\n1,1,1,\n2,2,2,8\n";
    let (particles, _) = apply(dust, &colored(by("q"))).expect("colors");
    assert_eq!(particles.spheres.color[1], srgb(0x80_80_80));
    assert!(
        particles.frame.warnings.iter().any(|text| text.contains("1 particle has no value of `q`"))
    );
    let flat = ColumnColors { spacing: Spacing::Logarithmic, ..by("z") };
    let error = apply(DUMP, &colored(flat)).expect_err("no range");
    assert!(
        error.message.contains("cannot color by the column `z`: none of the values"),
        "{error}"
    );
}

fn typed(styles: &[&str]) -> ParticleStyle {
    let types = styles.iter().map(|style| style.parse().expect("a valid style")).collect();
    ParticleStyle { types, ..ParticleStyle::default() }
}

#[test]
fn maps_and_ranges_are_for_numbers() {
    let (particles, _) = apply(DUMP, &ParticleStyle::default()).expect("spheres");
    assert!(by("x").is_numeric(&particles) && !by("type").is_numeric(&particles));
    assert!(!by("speed").is_numeric(&particles));
    for colors in [
        ColumnColors { map: Some(Map::Turbo), ..by("mol") },
        ColumnColors { spacing: Spacing::Logarithmic, ..by("mol") },
    ] {
        let error = apply(DUMP, &colored(colors)).expect_err("texts");
        assert!(error.message.contains("`mol` holds texts"), "{error}");
    }
    for (spacing, reason) in
        [(Spacing::Linear, RangeError::Empty), (Spacing::Logarithmic, RangeError::NonePositive)]
    {
        let colors = ColumnColors { spacing, ..by("q") };
        assert_eq!(ColumnSummary::default().share(&colors), Err(reason));
        let error = colors.range_error(Path::new("p"), &reason);
        assert_eq!(error.message, format!("cannot color by the column `q`: {reason}"));
    }
}

#[test]
fn lengths_have_their_unit_in_the_legend() {
    let label = |content: &str, column: &str| {
        let (_, legend) = apply(content, &colored(by(column))).expect("colors");
        legend.expect("a legend").label
    };
    let atoms = "2\nProperties=species:S:1:pos:R:3:q:R:1\nO 0 0 0 1\nH 1 2 0 2\n";
    assert_eq!(label(atoms, "x"), "x (\u{c5})");
    assert_eq!(label(atoms, "RADIUS"), "RADIUS (\u{c5})");
    assert_eq!((label(atoms, "q"), label(DUMP, "x")), ("q".to_owned(), "x".to_owned()));
}

#[test]
fn columns_without_a_number_have_no_colors_unless_that_is_allowed() {
    let dust = "x,y,z,q\n0,0,0,-4\n1,1,1,\n";
    let colors = ColumnColors { spacing: Spacing::Logarithmic, ..by("q") };
    let (particles, _) = apply(dust, &colored(by("x"))).expect("colors");
    assert!(particles.frame.warnings.iter().all(|text| !text.contains("no value of")));
    assert!(apply(dust, &colored(colors.clone())).is_err());
    let style = ParticleStyle { allow_empty: true, ..colored(colors.clone()) };
    let (particles, legend) = apply(dust, &style).expect("no colors");
    assert_eq!((particles.spheres.color.len(), legend), (0, None));
    let backwards = ColumnColors { ends: ColorEnds::numbers(2.0, 1.0), ..by("x") };
    let style = ParticleStyle { allow_empty: true, ..colored(backwards) };
    assert!(apply(dust, &style).is_err(), "a range that ends before it begins");
    // The ends of the map are known without particles.
    let frame = ParticleFrame { unit: LengthUnit::Nanometer, ..ParticleFrame::default() };
    assert_eq!(by("x").legend_of_ends(&frame), None);
    let legend =
        ColumnColors { ends: ColorEnds::numbers(1.0, 2.0), ..by("x") }.legend_of_ends(&frame);
    assert_eq!(legend.expect("a legend").label, "x (nm)");
}

#[test]
fn equal_styles_share_their_material() {
    let style = typed(&["O:material=mirror", "H:material=glass", "H:material=glass"]);
    let (particles, _) = apply(WATER, &style).expect("a valid style");
    assert_eq!(particles.material_names, ["", "O: mirror", "H: glass"]);
    assert_eq!(particles.spheres.material, [1, 2, 2]);
    assert_eq!(particles.materials.len(), 2);
}

#[test]
fn types_have_styles_of_their_own() {
    let style = typed(&["H:radius=0.5,color=#ff0000", "O:material=glass", "H:radius=0.25"]);
    let (particles, _) = apply(WATER, &style).expect("a valid style");
    assert_eq!(particles.spheres.radius[1..], [0.25, 0.25]);
    assert_eq!(particles.spheres.color[1..], [Rgb::X, Rgb::X]);
    let scene = Scene::of_particles(particles, "water");
    let material = |row| &scene.materials[scene.spheres.material_of(row) as usize].material;
    assert!(matches!(material(0), Material::Dielectric { .. }));
    assert!(matches!(material(1), Material::Lambertian { .. }));
}

#[test]
fn emitters_have_the_color_of_their_type() {
    let radiance = |style: &[&str]| {
        let (particles, _) = apply(WATER, &typed(style)).expect("a valid style");
        match particles.materials.first().expect("a material").material {
            Material::Emitter { radiance, .. } => radiance,
            ref other => panic!("{other:?}"),
        }
    };
    assert_eq!(radiance(&["H:color=#00ff00,material=emitter"]), Rgb::Y * 4.0);
    assert_eq!(radiance(&["O:material=emitter"]), srgb(0xFF_0D_0D) * 4.0);
    let (before, after) = ("H:material=emitter", "H:color=#00ff00");
    assert_eq!(radiance(&[before, after]), Rgb::Y * 4.0);
    let again = "H:material=emitter,color=#0000ff";
    assert_eq!(radiance(&[before, after, again]), Rgb::Z * 4.0);
}

#[test]
fn materials_named_by_files_are_those_of_types() {
    let made = "x,y,z,material,red,green,blue\n0,0,0,emitter,0,1,0\n1,0,0,GLASS,1,1,1\n\
                2,0,0,oak,1,1,1\n3,0,0,,1,1,1\n";
    let (particles, _) = apply(made, &ParticleStyle::default()).expect("spheres");
    let usual = Material::Lambertian { color: Rgb::ONE };
    let scene = Scene::of_particles_with(particles, "made", &usual);
    let material = |row| &scene.materials[scene.spheres.material_of(row) as usize].material;
    let light = Material::Emitter { radiance: Rgb::Y * 4.0, albedo: Rgb::ZERO };
    assert_eq!(*material(0), light);
    assert!(matches!(material(1), Material::Dielectric { .. }));
    assert_eq!([material(2), material(3)], [&usual; 2]);
    let unknown = |text: &&String| text.contains("unknown materials");
    let warnings: Vec<&String> = scene.warnings.iter().filter(unknown).collect();
    assert!(warnings.len() == 1 && warnings[0].ends_with(": oak"), "{warnings:?}");
}

#[test]
fn unknown_types_are_reported_with_known_ones() {
    let error = apply(WATER, &typed(&["N:radius=1"])).expect_err("no nitrogen");
    assert_eq!(error.message, "no type is called `N`; there are O, H");
    let error = apply(WATER, &typed(&["h:radius=1"])).expect_err("no such case");
    assert_eq!(error.message, "no type is called `h`; did you mean `H`?");
    let dust = "x,y,z\n0,0,0\n1,1,1\n";
    let error = apply(dust, &typed(&["N:radius=1"])).expect_err("no types");
    assert!(error.message.contains("the file has no types"), "{error}");
    for (text, expected) in [
        ("N", "expected a type and its style"),
        ("N:", "expected a type and its style"),
        ("N:radius=0", "`0` is not a valid radius"),
        ("N:color=#rde", "`#rde` is not a valid color"),
        ("N:material=wood", "materials are: lambertian, plastic"),
        ("N:material=Glass", "did you mean `glass`"),
        ("N:colour=red", "did you mean `color`"),
        ("N:opacity=1.5", "`1.5` is not between 0 and 1"),
        ("N:opacity=nan", "`nan` is not between 0 and 1"),
        ("N:size=1", "`size` is no property; properties are: model"),
    ] {
        let error = text.parse::<TypeStyle>().expect_err(text);
        assert!(error.contains(expected), "{text}: {error}");
    }
}

#[test]
fn numbers_out_of_range_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
        let usual = || TypeStyle { name: "O".to_owned(), ..TypeStyle::default() };
        let properties = |properties| TypeStyle { properties, ..usual() };
        let radius = Properties { radius: Some(bad), ..Properties::default() };
        let mut style = vec![("radius", properties(radius))];
        if bad != 0.0 {
            let color = Some(Coloring::Uniform(Rgb::new(0.5, bad as f32, 0.5)));
            style.push(("color", properties(Properties { color, ..Properties::default() })));
        }
        for (name, style) in style {
            let style = ParticleStyle { types: vec![style], ..ParticleStyle::default() };
            let error = apply(WATER, &style).expect_err(name);
            assert!(error.message.contains(&format!("`{name}`")), "{error}");
        }
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("water");
        std::fs::write(&path, WATER).expect("a file");
        let usual = ReadOptions::default;
        for (name, options) in [
            ("scale", ReadOptions { scale: bad, ..usual() }),
            ("radius_scale", ReadOptions { radius_scale: bad, ..usual() }),
            ("radii", ReadOptions { radii: Radii::Constant(bad), ..usual() }),
            ("radii", ReadOptions { radii: Radii::Missing(bad), ..usual() }),
        ] {
            let error = read(&path, &options).expect_err(name);
            assert!(error.message.contains(&format!("`{name}`")), "{error}");
        }
    }
}

#[test]
fn ranges_are_those_of_selected_particles() {
    let select = Some("id > 0".parse().expect("a condition"));
    let style = ParticleStyle { select, ..colored(by("id")) };
    assert_eq!(style.columns()[..2], ["id", "id"]);
    let (particles, legend) = apply(DUMP, &style).expect("colors");
    let range = legend.expect("a legend").scale.range;
    assert_eq!((range.low(), range.high()), (1.0, 2.0));
    let at = |position: f64| Map::Viridis.at(position);
    assert_eq!(particles.spheres.color, [at(0.0), at(1.0)]);
}

#[test]
fn diameters_are_twice_the_radii() {
    let ranged = ColumnColors { ends: ColorEnds::numbers(0.0, 2.0), ..by("diameter") };
    let (particles, _) =
        apply(&DUMP.replace("radius", "diameter"), &colored(ranged)).expect("colors");
    let at = |position: f64| Map::Viridis.at(position);
    assert_eq!(particles.spheres.color, [at(0.25), at(0.5), at(1.0)]);
}

/// Opacities of the spheres of a scene.
fn opacities(text: &str, style: &ParticleStyle) -> Vec<f64> {
    let (particles, _) = apply(text, style).expect("a valid style");
    let scene = Scene::of_particles(particles, "some");
    let material = |row| &scene.materials[scene.spheres.material_of(row) as usize].material;
    (0..scene.spheres.len()).map(|row| material(row).opacity()).collect()
}

#[test]
fn opacities_are_of_all_of_a_selection_of_a_column_or_of_a_type() {
    let table = "x,y,z,charge\n0,0,0,-1\n1,0,0,0\n2,0,0,1\n3,0,0,9\n";
    let style = |opacity: &str, translucent: &str| ParticleStyle {
        opacity: Some(opacity).filter(|text| !text.is_empty()).map(|text| text.parse().unwrap()),
        translucent: Some(translucent)
            .filter(|text| !text.is_empty())
            .map(|text| text.parse().unwrap()),
        ..ParticleStyle::default()
    };
    assert_eq!(opacities(table, &style("", "")), [1.0; 4]);
    assert_eq!(opacities(table, &style("0.3", "")), [0.3; 4]);
    assert_eq!(opacities(table, &style("0", "x > 1")), [1.0, 1.0, 0.0, 0.0]);
    assert_eq!(opacities(table, &style("", "x < 1")), [GHOST, 1.0, 1.0, 1.0]);
    let half = 128.0 / 255.0;
    assert_eq!(opacities(table, &style("charge:-1,1", "")), [0.0, half, 1.0, 1.0]);
    assert_eq!(opacities(table, &style("charge:1,-1", "x < 3")), [1.0, half, 0.0, 1.0]);
    let typed = ParticleStyle { opacity: Some(Opacity::Number(0.5)), ..typed(&["H:opacity=0.25"]) };
    let mut by_type = opacities(WATER, &typed);
    by_type.sort_by(f64::total_cmp);
    by_type.dedup();
    assert_eq!(by_type, [0.25, 0.5]);
}

#[test]
fn opacities_replace_those_of_presets_where_they_are_given() {
    let ghost = crate::scene::Preset::Ghost.material(1);
    let of = |style: &ParticleStyle| {
        let (particles, _) = apply(WATER, style).expect("a valid style");
        let scene = Scene::of_particles_with(particles, "water", &ghost);
        let material = |row| &scene.materials[scene.spheres.material_of(row) as usize].material;
        [0, 1].map(|row| material(row).opacity())
    };
    let opacity = |number| Some(Opacity::Number(number));
    assert_eq!(of(&ParticleStyle::default()), [GHOST; 2]);
    assert_eq!(of(&typed(&["H:opacity=1"])), [GHOST, 1.0]);
    assert_eq!(of(&ParticleStyle { opacity: opacity(1.0), ..ParticleStyle::default() }), [1.0; 2]);
    let translucent = Some("element == O".parse().expect("a condition"));
    let style = ParticleStyle { opacity: opacity(0.5), translucent, ..ParticleStyle::default() };
    assert_eq!(of(&style), [0.5, 1.0]);
}

#[test]
fn opacities_that_are_none_are_refused() {
    for (text, expected) in [
        ("1.5", "`1.5` is not between 0 and 1"),
        ("-0.1", "`-0.1` is not between 0 and 1"),
        ("nan", "`nan` is not between 0 and 1"),
        ("", "give a number from 0 to 1"),
        ("charge:1,1", "`1,1` is not two different numbers"),
        ("charge:a,b", "`a,b` is not two different numbers"),
        ("charge:0,inf", "`0,inf` is not two different numbers"),
    ] {
        let error = text.parse::<Opacity>().expect_err(text);
        assert!(error.contains(expected), "{text}: {error}");
    }
    let by = |text: &str| ParticleStyle {
        opacity: Some(text.parse().expect("a column")),
        ..ParticleStyle::default()
    };
    let error = apply(WATER, &by("weight")).expect_err("no such column");
    assert!(error.message.contains("weight"), "{error}");
    let error = apply(WATER, &by("type")).expect_err("texts");
    assert!(error.message.contains("texts"), "{error}");
}

const VECTORS: &str = "x,y,z,radius,vx,vy,vz,name\n0,0,0,1,2,0,0,a\n5,0,0,1,0,4,0,b\n10,0,0,1,0,0,0,c\n15,0,0,1,0,0,8,d\n";

fn with_arrows(text: &str, change: impl FnOnce(&mut ArrowStyle)) -> ParticleStyle {
    let mut arrows = ArrowStyle::new(text.parse().expect("a vector"));
    change(&mut arrows);
    ParticleStyle { arrows: Some(arrows), ..ParticleStyle::default() }
}

#[test]
fn vectors_become_sticks_and_cones() {
    let style = with_arrows("velocity", |_| ());
    let (particles, _) = apply(VECTORS, &style).expect("arrows");
    // The median of the vectors that are not 0 is as long as four radii.
    assert_eq!(particles.arrows.sizes, Some(ArrowSizes { scale: 1.0, radius: 0.25 }));
    let scene = Scene::of_particles(particles, "");
    assert_eq!((scene.sticks.len(), scene.cones.len(), scene.spheres.len()), (3, 3, 4));
    let heads = [DVec3::X * 2.0, DVec3::new(5.0, 4.0, 0.0), DVec3::new(15.0, 0.0, 8.0)];
    for (row, head) in heads.into_iter().enumerate() {
        assert!(scene.cones.apex[row].distance(head) < 1e-12, "{}", scene.cones.apex[row]);
        assert_eq!(scene.sticks.to[row], scene.cones.base[row]);
    }
    let chosen = with_arrows("vx,vy,vz", |arrows| {
        (arrows.scale, arrows.radius) = (Some(0.5), Some(0.01));
        (arrows.color, arrows.centering) = (Some(Rgb::X), ArrowCentering::Head);
    });
    let (particles, _) = apply(VECTORS, &chosen).expect("arrows");
    let scene = Scene::of_particles(particles, "");
    assert!(scene.cones.apex[0].distance(DVec3::ZERO) < 1e-12);
    assert!(scene.sticks.from[0].distance(DVec3::X * -0.99) < 1e-12);
    assert_eq!((scene.cones.color[2], scene.sticks.colors[1]), (Rgb::X, [Rgb::X; 2]));
}

#[test]
fn arrows_follow_selections_rotations_and_copies() {
    let mut style = with_arrows("v", |arrows| arrows.scale = Some(1.0));
    style.select = Some("x > 4".parse().expect("a selection"));
    let (mut particles, _) = apply(VECTORS, &style).expect("arrows");
    assert_eq!(particles.arrows.vectors, [DVec3::Y * 4.0, DVec3::ZERO, DVec3::Z * 8.0]);
    particles.frame.rotation = glam::DMat3::from_rotation_x(std::f64::consts::FRAC_PI_2);
    style.select = None;
    style.apply(Path::new("a"), &mut particles).expect("arrows");
    assert!(particles.arrows.vectors[0].distance(DVec3::Z * 4.0) < 1e-12);
}

#[test]
fn vectors_that_are_not_there_are_refused_by_name() {
    let refused = |text: &str| apply(VECTORS, &with_arrows(text, |_| ())).expect_err(text).message;
    assert!(refused("force").contains("`fx`"), "{}", refused("force"));
    assert!(refused("vx,vy,name").contains("`name` has texts"));
    let zero =
        VECTORS.replace("2,0,0,a", "0,0,0,a").replace("0,4,0", "0,0,0").replace("0,8,d", "0,0,d");
    let (particles, _) = apply(&zero, &with_arrows("velocity", |_| ())).expect("no arrows");
    assert!(particles.arrows.sizes.is_none());
    assert!(particles.frame.warnings.iter().any(|text| text.contains("no arrows")));
}

#[test]
fn numbers_without_a_logarithm_are_gray_and_counted() {
    let csv = "x,y,z,radius,p\n0,0,0,1,-1\n1,0,0,1,0\n2,0,0,1,1\n3,0,0,1,100\n4,0,0,1,\n";
    let logarithmic = ColumnColors { spacing: Spacing::Logarithmic, ..by("p") };
    let (particles, legend) = apply(csv, &colored(logarithmic)).expect("colors");
    let (gray, at) = (srgb(0x80_80_80), |position: f64| Map::Viridis.at(position));
    assert_eq!(particles.spheres.color, [gray, gray, at(0.0), at(1.0), gray]);
    assert_eq!(legend.expect("a legend").scale.range.low(), 1.0);
    let counts = |text: &str| particles.frame.warnings.iter().any(|own| own.contains(text));
    assert!(counts(": 2 particles") && counts(": 1 particle "), "{:?}", particles.frame.warnings);
}

#[test]
fn speeds_are_lengths_of_velocities() {
    let csv = "x,y,z,radius,vx,vy,vz\n0,0,0,1,3,4,0\n1,0,0,1,0,0,1\n";
    let (_, legend) = apply(csv, &colored(by("speed"))).expect("colors");
    let range = legend.expect("a legend").scale.range;
    assert_eq!((range.low(), range.high()), (1.0, 5.0));
    let select = Some("speed > 2".parse().expect("a selection"));
    let fast =
        apply(csv, &ParticleStyle { select, ..ParticleStyle::default() }).expect("particles");
    assert_eq!(fast.0.spheres.x, [0.0]);
    assert!(apply("x,y,z,radius\n0,0,0,1\n", &colored(by("speed"))).is_err());
}

#[test]
fn arrows_that_are_far_longer_than_all_else_are_shortened() {
    let row = |x: usize| format!("{x},0,0,0.5,0,1,0\n");
    let rows: String = (0..20).map(row).collect();
    let csv = |last: &str| format!("x,y,z,radius,vx,vy,vz\n{rows}0,0,0,0.5,{last}\n");
    let arrows = Some(ArrowStyle::new("velocity".parse().expect("a vector")));
    let style = ParticleStyle { arrows, ..ParticleStyle::default() };
    for (last, length, warned) in [("1e4,0,0", 20.0, true), ("9,0,0", 18.0, false)] {
        let (particles, _) = apply(&csv(last), &style).expect("arrows");
        let sizes = particles.arrows.sizes.expect("sizes");
        assert_eq!(sizes.scale, 2.0, "{last}");
        let lengths: Vec<f64> = particles.arrows.vectors.iter().map(|v| v.length()).collect();
        assert_eq!((lengths[0], lengths[20]), (2.0, length), "{last}");
        let warning = particles.frame.warnings.iter().any(|text| text.contains(": 1, "));
        assert_eq!(warning, warned, "{:?}", particles.frame.warnings);
    }
}

#[test]
fn models_without_bonds_say_how_to_get_them() {
    let model = Some(Model::BallAndStick);
    let style = ParticleStyle { model, ..ParticleStyle::default() };
    let (particles, _) = apply(DUMP, &style).expect("particles");
    let mends = |text: &String| text.contains("--type 1:element=O");
    assert_eq!(particles.frame.warnings.iter().filter(|text| mends(text)).count(), 1);
    let element: TypeStyle = "1:element=o".parse().expect("a style");
    assert_eq!(element.element.map(Element::symbol), Some("O"));
    assert!("1:element=Xx".parse::<TypeStyle>().is_err());
}

const MOVING: &str = "x,y,z,vx,vy,vz,mass,my-own,kind\n0,0,0,3,4,0,2,5,a\n1,0,0,0,6,8,5,6,b\n\
                      2,0,0,,0,1,4,7,a\n3,0,0,0,0,1,0,8,a\n";

/// Returns the numbers of a column or an expression, or the faulty part and the message.
fn values(content: &str, text: &str) -> Result<Vec<f64>, String> {
    let style = ParticleStyle { also_read: vec!["id".to_owned()], ..colored(by(text)) };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("particles");
    std::fs::write(&path, content).expect("a file");
    let columns = Columns { wanted: style.columns(), ..Columns::default() };
    let options = ReadOptions { columns, ..ReadOptions::default() };
    let particles = read(&path, &options).expect("particles");
    match numbers(&path, &particles, text, "values") {
        Ok(numbers) => Ok(numbers.iter().map(|value| (value * 1e9).round() / 1e9).collect()),
        Err(error) => Err(match error.place {
            Some(place) => format!("{}: {}", &place.source_text[place.span], error.message),
            None => format!("{} {}", error.message, error.help.unwrap_or_default()),
        }),
    }
}

#[test]
fn columns_are_computed_by_expressions() {
    let known = |text: &str| -> Vec<f64> {
        let values = values(MOVING, text).unwrap_or_else(|fault| panic!("{text}: {fault}"));
        values.into_iter().filter(|value| !value.is_nan()).collect()
    };
    for (text, expected) in [
        ("norm(velocity)", &[5.0, 10.0, 1.0][..]),
        ("norm(v)", &[5.0, 10.0, 1.0]),
        ("speed", &[5.0, 10.0, 1.0]),
        ("mass * speed^2 / 2", &[25.0, 250.0, 0.0]),
        ("sqrt(vx*vx + vy^2 + vz**2)", &[5.0, 10.0, 1.0]),
        ("my-own", &[5.0, 6.0, 7.0, 8.0]),
        ("`my-own`", &[5.0, 6.0, 7.0, 8.0]),
        ("-`my-own`", &[-5.0, -6.0, -7.0, -8.0]),
        ("(mass)", &[2.0, 5.0, 4.0, 0.0]),
        ("max(vx, 1)", &[3.0, 1.0, 1.0]),
    ] {
        assert_eq!(known(text), expected, "{text}");
    }
}

#[test]
fn errors_point_into_expressions() {
    for (text, expected) in [
        ("mass * speeed", "speeed: no column is named `speeed`"),
        ("mass *", ": expected a number or a name here"),
        ("sqrt(mass", "(: unclosed parenthesis"),
        ("sqrt(mass) mass", "mass: expected an operator before this"),
        ("mass * kind", "kind: the column `kind` holds texts: only columns of numbers"),
        ("(mass > 3)", "(mass > 3): expected a number, but this is a condition"),
        ("mass > 3", ">: expected an operator before this"),
        ("sin(mass)", "sin: no function is named `sin`"),
        ("kind", "the column `kind` has texts, but values are numbers"),
        ("masss", "no column is named `masss`; did you mean `mass`?"),
        ("no such", "no column is named `no such`; there are x, y, z"),
        ("2 * 3", "no column is named `2 * 3`"),
        ("my-oen", "my: no column is named `my`"),
    ] {
        let fault = values(MOVING, text).expect_err(text);
        assert!(fault.starts_with(expected), "{text}: {fault}");
    }
    let error = apply(MOVING, &colored(by("my-oen"))).expect_err("no column");
    assert!(error.help.is_some_and(|help| help.contains("did you mean `my-own`?")));
}

#[test]
fn expressions_stand_wherever_columns_do() {
    let at = |position: f64| Map::Viridis.at(position);
    let (particles, legend) = apply(MOVING, &colored(by("norm(velocity) - 1"))).expect("colors");
    let gray = srgb(0x80_80_80);
    assert_eq!(particles.spheres.color, [at(4.0 / 9.0), at(1.0), gray, at(0.0)]);
    assert_eq!(legend.expect("a legend").label, "norm(velocity) - 1");
    assert!(particles.frame.warnings.iter().any(|text| text.contains("1 particle has no value")));
    let faded = ParticleStyle { opacity: Some("mass/5:0,1".parse().unwrap()), ..typed(&[]) };
    assert_eq!(opacities(MOVING, &faded), [0.4, 1.0, 0.8, 0.0]);
    let faded = ParticleStyle { opacity: Some("min(mass, 2):0,2".parse().unwrap()), ..typed(&[]) };
    assert_eq!(opacities(MOVING, &faded), [1.0, 1.0, 1.0, 0.0]);
    let columns = "2*vx, max(vy, 5), vz - vz".parse().expect("columns");
    let arrows = ArrowStyle { scale: Some(1.0), ..ArrowStyle::new(columns) };
    let style = ParticleStyle { arrows: Some(arrows), ..ParticleStyle::default() };
    let (particles, _) = apply(MOVING, &style).expect("arrows");
    assert_eq!(
        particles.arrows.vectors[..2],
        [DVec3::new(6.0, 5.0, 0.0), DVec3::new(0.0, 6.0, 0.0)]
    );
}

#[test]
fn radii_follow_expressions() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("particles");
    let radii = |content: &str, text: &str, options: ReadOptions| {
        std::fs::write(&path, content).expect("a file");
        let mut options = ReadOptions { radii: text.parse().expect("radii"), ..options };
        crate::scene::particles::accept_radii_expression(&mut options);
        read(&path, &options)
    };
    let found = |content: &str, text: &str, options| {
        radii(content, text, options).expect("particles").spheres.radius
    };
    let usual = ReadOptions::default;
    assert_eq!(found(DUMP, "column:sqrt(q/10)", usual()), [1.0, 10_f64.sqrt(), 10.0]);
    assert_eq!(found(DUMP, "column:radius * 3", usual()), [1.5, 3.0, 6.0]);
    assert_eq!(found(DUMP, "column:q", usual()), [10.0, 100.0, 1000.0]);
    assert_eq!(found(DUMP, "column:index+1", usual()), [1.0, 2.0, 3.0]);
    let scaled = ReadOptions { radius_scale: 0.5, scale: 2.0, ..usual() };
    assert_eq!(found(DUMP, "column:2*radius", scaled), [1.0, 2.0, 4.0]);
    // No radius is drawn where there is none.
    let particles = radii(MOVING, "column:mass*speed", usual()).expect("particles");
    assert_eq!(particles.spheres.radius, [10.0, 50.0]);
    assert!(particles.frame.warnings.iter().any(|text| text.contains("2 of 4 rows were dropped")));
    assert_eq!((particles.guessed_radius, particles.frame.len()), (None, 0));
    let error = radii(DUMP, "column:0*q", usual()).expect_err("no sphere");
    assert!(error.message.contains("none of its 3 rows is a sphere"), "{error}");
    let error = radii(DUMP, "column:q*qq", usual()).expect_err("no column");
    assert_eq!(error.place.map(|place| place.span), Some(2..4));
}
