//! Particle files on the command line.

use crate::folder::{Folder, SMALL, text};
use serde_json::json;
use spherule_render::image::read_metadata;

const DUMP: &str = "\
ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
1
ITEM: BOX BOUNDS pp pp ff
0 2
0 2
0 4
ITEM: ATOMS id type x y z size
1 1 1 1 1 3
ITEM: TIMESTEP
100
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS pp pp ff
0 2
0 2
0 4
ITEM: ATOMS id type x y z size
1 1 0.5 1 1 3
2 2 1.5 1 1 4
";

#[test]
fn info_describes_files() {
    let folder = Folder::new();
    folder.write("run.dump", DUMP);
    let info = folder.json(&["info", "run.dump", "--frame", "last", "--json"]);
    let particles = &info["particles"];
    assert_eq!(particles["format"], json!("lammps-dump"));
    assert_eq!((&particles["frames"], &particles["step"]), (&json!(2), &json!(100)));
    assert_eq!(particles["columns"], json!(["id", "type", "x", "y", "z", "size"]));
    assert_eq!(particles["cell"]["periodic"], json!([true, true, false]));
    let second = json!({"name": "2", "element": null, "element_from": null, "spheres": 1});
    assert_eq!(particles["types"][1], second);
    assert_eq!(info["spheres"], json!(2));
    let lines = folder.succeed(&["info", "run.dump"]);
    assert!(lines.contains("frames       2") && lines.contains("cell         [2.0, 0.0, 0.0]"));
}

#[test]
fn rows_are_listed_from_both_ends() {
    let folder = Folder::new();
    folder.write("rows.csv", "x,y,z,radius\n0,0,0,1\n1,0,0,1\n2,0,0,1\n3,0,0,0.5\n");
    folder.write("a.toml", "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n");
    let rows = |count: &str| {
        let info = folder.json(&["info", "rows.csv", "--rows", count, "--json"]);
        let numbers = |end: &str| {
            let rows = info["particles"]["rows"][end].as_array().expect("rows").iter();
            rows.map(|row| row["row"].as_u64().expect("a number")).collect::<Vec<_>>()
        };
        (numbers("first"), numbers("last"))
    };
    assert_eq!(rows("1"), (vec![0], vec![3]));
    assert_eq!(rows("3"), (vec![0, 1, 2], vec![3]));
    assert_eq!(rows("9"), (vec![0, 1, 2, 3], vec![]));
    let lines = folder.succeed(&["info", "rows.csv", "--rows", "1"]);
    assert!(lines.contains("3: at [3.0, 0.0, 0.0], radius 0.5"), "{lines}");
    assert_eq!(folder.run(&["info", "a.toml", "--rows", "1"]).status.code(), Some(2));
}

#[test]
fn frames_and_radii_are_chosen() {
    let folder = Folder::new();
    folder.write("run.dump", DUMP);
    let radius = |args: &[&str]| {
        let all = [&["info", "run.dump", "--json", "--frame", "1"], args].concat();
        folder.json(&all)["radius"].clone()
    };
    assert_eq!(radius(&["--radii", "0.25"]), json!([0.25, 0.25]));
    assert_eq!(radius(&["--radii", "column:size", "--radius-scale", "0.5"]), json!([1.5, 2.0]));
    assert_eq!(radius(&["--columns", "diameter=size"]), json!([1.5, 2.0]));
    let args = [&SMALL[..], &["run.dump", "--radii", "1", "-o", "run.png"]].concat();
    folder.succeed(&args);
    assert!(folder.path("run.png").exists());
}

#[test]
fn settings_without_effect_are_refused() {
    let folder = Folder::new();
    folder.write("run.dump", DUMP);
    folder.write("a.toml", "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n");
    for (args, code, message) in [
        (&["info", "a.toml", "--frame", "1"][..], 2, "[[file]]"),
        (&["render", "--radii", "vdw"], 2, "particle file"),
        (&["info", "run.dump", "--radii", "thick"], 2, "expected vdw, covalent"),
        (&["info", "run.dump", "--frame", "second"], 2, "give first, last"),
        (&["info", "run.dump", "--columns", "width=size"], 2, "unknown column role"),
        (&["info", "run.dump", "--format", "png"], 2, "formats are: xyzr"),
        (&["info", "run.dump", "--frame", "2"], 1, "has no frame 2"),
        (&["info", "run.dump", "--radii", "vdw"], 1, "no particle has an element"),
        (&["info", "run.dump", "--radii", "column:q"], 1, "no column is named `q`"),
    ] {
        let output = folder.run(args);
        let stderr = text(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(code), "{args:?}: {stderr}");
        assert!(stderr.contains(message), "{args:?}: {stderr}");
    }
}

#[test]
fn elements_follow_from_names_of_atoms() {
    let folder = Folder::new();
    let row = |number: usize, name: &str, element: &str| {
        let x = 1.5 * number as f64;
        format!(
            "ATOM  {number:5} {name:4} MOL A   1    {x:8.3}   0.000   0.000  1.00  0.00          {element:>2}\n"
        )
    };
    let rows = [(" CA ", "C"), (" CB ", "C"), ("HB1 ", "H"), (" OG ", "O"), ("CA  ", "CA")];
    let rows =
        rows.iter().enumerate().map(|(place, (name, element))| row(place + 1, name, element));
    folder.write("a.pdb", &rows.collect::<String>());
    let cif = "data_a\nloop_\n_atom_site.id\n_atom_site.type_symbol\n_atom_site.label_atom_id\n\
        _atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n1 C CA 0 0 0\n2 C CB 2 0 0\n\
        3 H HB1 4 0 0\n4 O OG 6 0 0\n5 CA CA 8 0 0\n";
    folder.write("a.cif", cif);
    let spheres = |file: &str, condition: &str, more: &[&str]| {
        let args = [&SMALL[..], &[file, "--select", condition, "--json", "-o", "a.png"], more];
        folder.json(&args.concat())["statistics"]["spheres"].as_u64().expect("a count")
    };
    for file in ["a.pdb", "a.cif"] {
        assert_eq!(spheres(file, "element == C", &[]), 2, "{file}");
        assert_eq!(spheres(file, "element != H", &[]), 4, "{file}");
        assert_eq!(spheres(file, "element == Ca", &[]), 1, "{file}");
    }
    assert_eq!(spheres("a.pdb", "name == CA", &[]), 2);
    assert_eq!(spheres("a.pdb", "type == CA", &[]), 2);
    assert_eq!(spheres("a.pdb", "type == C", &["--columns", "type=element"]), 2);
}

#[test]
fn topologies_name_the_particles_of_trajectories() {
    let folder = Folder::new();
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data");
    let trajectory = format!("{data}/particles/water.xtc");
    folder.write(
        "top.gro",
        &text(&std::fs::read(format!("{data}/topologies/water.gro")).expect("a file")),
    );
    let args = ["--topology", "top.gro", "--frame", "3"];
    let info = folder.json(&[&["info", &trajectory[..], "--json"][..], &args].concat());
    let particles = &info["particles"];
    assert_eq!((&particles["format"], &particles["step"]), (&json!("xtc"), &json!(3)));
    let oxygen = json!({"name": "OW", "element": "O", "element_from": "name", "spheres": 60});
    assert_eq!(particles["types"][0], oxygen);
    let render =
        |more: &[&str]| folder.run(&[&SMALL, &[&trajectory[..]][..], &args, more].concat());
    assert!(render(&["-o", "a.png"]).status.success());
    let settings = read_metadata(folder.path("a.png")).expect("metadata");
    assert_eq!(settings.value("topology"), Some("top.gro"));
    // An output never replaces the topology.
    let refused = render(&["-o", "top.gro", "--output-format", "png"]);
    assert!(text(&refused.stderr).contains("the topology"), "{}", text(&refused.stderr));
    let other =
        folder.run(&["info", &trajectory, "--topology", &format!("{data}/particles/water.pqr")]);
    assert!(text(&other.stderr).contains("has 184 particles, but its topology 12"));
}

/// Two molecules of water, one of which is cut by the periodic cell.
const WATER: &str = "\
6
Lattice=\"8 0 0 0 8 0 0 0 8\" Properties=species:S:1:pos:R:3 pbc=\"T T T\"
O 4 4 4
H 4.757 4.586 4
H 3.243 4.586 4
O 0.2 1 4
H 0.957 1.586 4
H 7.443 1.586 4
";

#[test]
fn bonds_are_drawn_where_they_are_asked_for() {
    let folder = Folder::new();
    folder.write("water.xyz", WATER);
    // Without metadata, which names the options.
    let pixels = |more: &[&str]| {
        let usual = ["render", "water.xyz", "--size", "48x48", "--spp", "4", "-o", "a.pfm"];
        folder.succeed(&[&usual, more].concat());
        folder.read("a.pfm")
    };
    let spheres = pixels(&[]);
    let balls = pixels(&["--model", "ball-and-stick"]);
    let sticks = pixels(&["--model", "licorice"]);
    assert!(spheres != balls && balls != sticks && spheres != sticks);
    assert!(pixels(&["--model", "space-filling"]) == spheres);
    assert!(pixels(&["--bonds", "none"]) == spheres);
    // The rule gives the bonds that covalent radii give.
    assert!(pixels(&["--bonds", "O-H<1.1"]) == balls);
    assert!(pixels(&["--bonds", "O-H<0.9"]) != balls);
}

#[test]
fn crystals_are_balls_and_sticks_in_their_cell() {
    let folder = Folder::new();
    folder.write(
        "salt.poscar",
        "salt\n1\n3 0 0\n0 3 0\n0 0 3\nZn S\n1 1\nDirect\n0.1 0.1 0.1\n0.6 0.6 0.6\n",
    );
    let pixels = |file: &str, more: &[&str]| {
        let usual = ["render", file, "--size", "48x48", "--spp", "4", "-o", "a.pfm"];
        folder.succeed(&[&usual, more].concat());
        folder.read("a.pfm")
    };
    let crystal = pixels("salt.poscar", &[]);
    let named = ["--model", "ball-and-stick"];
    assert!(crystal == pixels("salt.poscar", &[&named[..], &["--cell"]].concat()));
    assert!(crystal != pixels("salt.poscar", &named));
    let spheres = pixels("salt.poscar", &["--model", "space-filling"]);
    assert!(crystal != spheres && spheres == pixels("salt.poscar", &["--bonds", "none"]));
    // Bonds that a column needs are not drawn, and do not make a crystal of molecules.
    folder.write("water.xyz", WATER);
    let by_column = ["--select", "coordination >= 0"];
    assert!(pixels("water.xyz", &by_column) == pixels("water.xyz", &[]));
    assert!(crystal == pixels("salt.poscar", &by_column));
    // The cell needs the whole image.
    let part = ["render", "salt.poscar", "-o", "a.png", "--part", "1/2"];
    let refusal = folder.run(&part);
    assert!(text(&refusal.stderr).contains("--model"), "{}", text(&refusal.stderr));
    folder.succeed(&[&part[..], &named, &["--size", "48x48", "--spp", "4"]].concat());
}

#[test]
fn cells_of_crystals_are_completed_and_have_polyhedra() {
    let folder = Folder::new();
    folder.write(
        "rutile.poscar",
        "TiO2\n1\n4.594 0 0\n0 4.594 0\n0 0 2.9586\nTi O\n2 4\nDirect\n0 0 0\n.5 .5 .5\n\
         .3051 .3051 0\n.6949 .6949 0\n.1949 .8051 .5\n.8051 .1949 .5\n",
    );
    folder.write("bare.xyz", "1\n\nO 0 0 0\n");
    let of = |file: &str, more: &[&str]| {
        let args = [file, "--json", "-o", "a.png"];
        let statistics = &folder.json(&[&SMALL[..], &args, more].concat())["statistics"];
        ["spheres", "sticks", "triangles"].map(|kind| statistics[kind].as_u64())
    };
    let bodies = |more: &[&str]| of("rutile.poscar", more);
    // Nine titanium atoms, and two oxygen atoms on each of two faces and in the middle.
    assert_eq!(bodies(&[]), [15, 14, 0].map(Some));
    // Molecules are whole at the eight corners, instead of cut at the edges.
    folder.write(
        "dry.poscar",
        "CO2\n1\n5 0 0\n0 5 0\n0 0 5\nC O\n1 2\nDirect\n0 0 0\n.232 0 0\n.768 0 0\n",
    );
    assert_eq!(of("dry.poscar", &[])[0], Some(8 * 3));
    assert_eq!(of("dry.poscar", &["--outside", "none"])[0], Some(8 + 2 * 4));
    assert_eq!(of("dry.poscar", &["--complete", "no", "--outside", "molecules"])[0], Some(3));
    assert_eq!(bodies(&["--complete", "no"])[0], Some(6));
    assert_eq!(bodies(&["--complete", "no", "--outside", "none", "--cell"])[0], Some(6));
    assert!(bodies(&["--outside", "whole"])[0] > Some(15));
    let [spheres, _, triangles] = bodies(&["--polyhedra", "Ti-O"]);
    assert!(spheres > Some(15) && triangles == Some(9 * 8), "{spheres:?} {triangles:?}");
    assert_eq!(bodies(&["--polyhedra", "Ti-O<2.2", "--outside", "none"])[2], Some(8));
    for (args, part) in [
        (&["rutile.poscar", "--polyhedra", "Ti-N"][..], "no type `N`"),
        (&["rutile.poscar", "--polyhedra", "Ti"], "two types"),
        (&["rutile.poscar", "--outside", "some"], "whole"),
        (&["bare.xyz", "--complete", "yes"], "no cell"),
    ] {
        let output = folder.run(&[&["render", "-o", "b.png"], args].concat());
        let stderr = text(&output.stderr);
        assert!(!output.status.success() && stderr.contains(part), "{args:?}: {stderr}");
    }
}

#[test]
fn bonds_that_cannot_be_drawn_are_refused() {
    let folder = Folder::new();
    folder.write("water.xyz", WATER);
    let refused = |args: &[&str]| {
        let output = folder.run(&[&["render", "water.xyz", "-o", "a.png"], args].concat());
        assert!(!output.status.success() && !folder.path("a.png").exists());
        text(&output.stderr)
    };
    assert!(refused(&["--bonds", "file"]).contains("water.xyz"));
    assert!(refused(&["--bonds", "O-X<1.1"]).contains("`X`"));
    assert!(refused(&["--bonds", "fil"]).contains("file"));
    assert!(refused(&["--model", "sticks"]).contains("licorice"));
    assert!(refused(&["--bond-radius", "0"]).contains("greater than 0"));
}

/// A water that the cell divides, and that moves from frame to frame, beside an argon.
fn waters(frames: usize) -> String {
    let frame = |step: usize| {
        let x = (9.8 + 0.3 * step as f64).rem_euclid(10.0);
        let hydrogen = (x + 0.96).rem_euclid(10.0);
        format!(
            "4\nLattice=\"10 0 0 0 10 0 0 0 10\" Properties=species:S:1:pos:R:3\n\
             O {x} 5 5\nH {hydrogen} 5 5\nH {x} 5.96 5\nAr 3 3 3\n"
        )
    };
    (0..frames).map(frame).collect()
}

#[test]
fn frames_are_made_whole_aligned_and_smoothed() {
    let folder = Folder::new();
    folder.write("w.xyz", &waters(4));
    let bytes = |name: &str, args: &str| {
        let line = format!("render w.xyz --size 32x24 --spp 1 -q -o {name}.pfm {args}");
        let output = folder.run(&line.split(' ').collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(0), "{line}: {}", text(&output.stderr));
        folder.read(&format!("{name}.pfm"))
    };
    // The first water is divided in frame 0, and moves.
    for (frame, name, args) in
        [(0, "whole", "--whole"), (1, "align", "--align"), (0, "smooth", "--smooth 1")]
    {
        let plain = bytes("plain", &format!("--frame {frame}"));
        assert_ne!(bytes(name, &format!("--frame {frame} {args}")), plain, "{args}");
    }
    for (args, part) in [
        ("--frame 1 --align=resname", "`resname` is no condition"),
        ("--frame 1 --align=element==O", "cannot be aligned by 1 particles"),
        ("--frame 1 --smooth 0", "0 is not in 1..=1000"),
        ("--frame 1 --select coordination==7", "none of its 4 particles"),
    ] {
        let line = format!("render w.xyz --size 32x24 --spp 1 -q -o no.png {args}");
        let output = folder.run(&line.split(' ').collect::<Vec<_>>());
        let stderr = text(&output.stderr);
        assert!(output.status.code() != Some(0) && stderr.contains(part), "{line}: {stderr}");
    }
}

#[test]
fn info_says_what_one_needs_before_drawing() {
    let folder = Folder::new();
    folder.write("a.csv", "x,y,z,radius,q,chain\n0,0,0,1,2.5,A\n1,0,0,1,,B\n2,0,0,1,-1,A\n");
    let info = folder.json(&["info", "a.csv", "--json"]);
    let columns = info["particles"]["column_values"].as_array().expect("columns");
    let named = |name: &str| columns.iter().find(|column| column["name"] == name).expect("it");
    assert_eq!((&named("q")["range"], &named("q")["missing"]), (&json!([-1.0, 2.5]), &json!(1)));
    assert_eq!((&named("x")["range"], &named("x")["missing"]), (&json!([0.0, 2.0]), &json!(0)));
    assert_eq!(named("chain")["texts"], json!(["A", "B"]));
    assert_eq!(info["particles"]["molecules"], json!(null));
    assert!(folder.succeed(&["info", "a.csv"]).contains("column       q: -1 to 2.5, 1 missing"));

    let atom = |serial: u32, name: &str, residue: &str, number: u32| {
        format!(
            "{:<6}{serial:>5}  {name:<3} {residue:>3} A{number:>4}    {:>8.3}   0.000   0.000  1.00  0.00           C\n",
            if residue == "LIG" { "HETATM" } else { "ATOM" },
            f64::from(serial) * 3.0
        )
    };
    let atoms = atom(1, "CA", "ALA", 1) + &atom(2, "CB", "ALA", 1) + &atom(3, "CA", "GLY", 2);
    folder.write("a.pdb", &(atoms + &atom(4, "C1", "LIG", 3) + "END\n"));
    let info = folder.json(&["info", "a.pdb", "--json"]);
    let molecules = &info["particles"]["molecules"];
    assert_eq!(molecules["chains"], json!([{"name": "A", "count": 4}]));
    assert_eq!(
        (&molecules["residues"], &molecules["groups"]),
        (&json!(3), &json!([{"name": "protein", "count": 2}]))
    );
    assert_eq!(molecules["ligands"], json!([{"name": "LIG", "count": 1}]));

    let frame = |time: f64| format!("2\nTime={time}\nC 0 0 0\nC 1 0 0\n");
    folder.write("a.xyz", &[0.5, 1.0, 1.5].map(frame).concat());
    let info = folder.json(&["info", "a.xyz", "--json"]);
    assert_eq!(info["particles"]["times"], json!([0.5, 1.5]));
}
