//! The lines of Python that make an image.

use super::options::Options;
use std::fmt::Write;

/// Ways in which Python has values.
#[derive(Clone, Copy)]
enum Kind {
    Text,
    Number,
    Flag,
    /// True, or a text.
    Place,
    /// Numbers or texts between parentheses.
    Tuple,
    List,
}

/// Options and keyword arguments of `spherule.Scene.load` or `spherule.Scene`.
const OF_SCENES: [(&str, &str, Kind); 36] = [
    ("select", "select", Kind::Text),
    ("hide", "hide", Kind::Text),
    ("style", "styles", Kind::List),
    ("colors", "colors", Kind::Text),
    ("color-by", "color_by", Kind::Text),
    ("color-map", "color_map", Kind::Text),
    ("color-range", "color_range", Kind::Tuple),
    ("color-title", "color_title", Kind::Text),
    ("color-log", "color_log", Kind::Flag),
    ("color-bar", "color_bar", Kind::Place),
    ("radius-scale", "radius_scale", Kind::Number),
    ("model", "model", Kind::Text),
    ("bond-radius", "bond_radius", Kind::Number),
    ("polyhedra", "polyhedra", Kind::Text),
    ("polyhedra-opacity", "polyhedra_opacity", Kind::Number),
    ("opacity", "opacity", Kind::Text),
    ("translucent", "translucent", Kind::Text),
    ("arrows", "arrows", Kind::Text),
    ("arrow-scale", "arrow_scale", Kind::Number),
    ("arrow-radius", "arrow_radius", Kind::Number),
    ("arrow-color", "arrow_color", Kind::Text),
    ("arrow-center", "arrow_center", Kind::Text),
    ("preset", "preset", Kind::Text),
    ("background", "background", Kind::Text),
    ("up", "up", Kind::Text),
    ("wrap", "wrap", Kind::Flag),
    ("replicate", "replicate", Kind::Tuple),
    ("outside", "outside", Kind::Text),
    ("cell", "show_cell", Kind::Flag),
    ("slice", "slices", Kind::List),
    ("slice-mode", "slice_mode", Kind::Text),
    ("legend", "legend", Kind::Place),
    ("axes", "axes", Kind::Place),
    ("scale-bar", "scale_bar", Kind::Place),
    ("label", "label", Kind::List),
    ("measure", "measure", Kind::List),
];

/// Options and keyword arguments of `spherule.read`.
const OF_FILES: [(&str, &str, Kind); 6] = [
    ("frame", "frame", Kind::Number),
    ("format", "format", Kind::Text),
    ("columns", "columns", Kind::Text),
    ("atom-style", "atom_style", Kind::Text),
    ("topology", "topology", Kind::Text),
    ("bonds", "bonds", Kind::Text),
];

/// Options and keyword arguments of renders.
const OF_RENDERS: [(&str, &str, Kind); 10] = [
    ("size", "size", Kind::Tuple),
    ("spp", "spp", Kind::Number),
    ("denoise", "denoise", Kind::Text),
    ("depth", "depth", Kind::Number),
    ("seed", "seed", Kind::Number),
    ("integrator", "integrator", Kind::Text),
    ("sampler", "sampler", Kind::Text),
    ("exposure", "exposure", Kind::Number),
    ("tone", "tone", Kind::Text),
    ("ao-distance", "ao_distance", Kind::Number),
];

/// Returns the lines that make the image of a particle file with these options, with a comment for each option that Python has
/// by other means. `camera` are the keys of the camera.
pub(super) fn lines(options: &Options, camera: &str) -> Option<String> {
    let file = quoted(&options.name()?.to_string_lossy());
    let arguments = |table: &[(&str, &str, Kind)]| {
        let given = table.iter().filter_map(|(option, name, kind)| {
            let values: Vec<Option<String>> = options
                .iter()
                .filter(|(own, _)| own == option)
                .map(|(_, value)| value.map(|value| value.to_string_lossy().into_owned()))
                .collect();
            let values = (!values.is_empty()).then_some(values)?;
            Some(format!("{name}={}", value(*kind, &values)))
        });
        given.collect::<Vec<_>>()
    };
    let mut text = "import spherule\n\n".to_owned();
    let known = |name: &str| {
        let tables = [&OF_SCENES[..], &OF_FILES, &OF_RENDERS];
        ["camera", "output", "depth-cue", "outline"].contains(&name)
            || tables.iter().any(|table| table.iter().any(|row| row.0 == name))
    };
    let others = options.iter().filter(|(name, _)| !known(name));
    for (name, _) in others {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "# --{name} is not in these lines.");
    }
    let read = arguments(&OF_FILES);
    let mut scene = arguments(&OF_SCENES);
    let looks = [("depth-cue", "depth_cue"), ("outline", "outline")].into_iter().filter_map(
        |(option, key)| {
            let on = if options.last(option)? == "on" { "True" } else { "False" };
            Some(format!("\"{key}\": {on}"))
        },
    );
    let looks: Vec<String> = looks.collect();
    if !looks.is_empty() {
        scene.push(format!("look={{{}}}", looks.join(", ")));
    }
    scene.push(format!("camera={{{}}}", dictionary(camera)));
    let (call, first) = if read.is_empty() {
        ("spherule.Scene.load", file)
    } else {
        let _ = writeln!(text, "particles = spherule.read({file}, {})", read.join(", "));
        ("spherule.Scene", "particles".to_owned())
    };
    let _ = writeln!(text, "scene = {call}(\n    {first},\n    {},\n)", scene.join(",\n    "));
    let _ = write!(text, "scene.render({}).save(\"view.png\")", arguments(&OF_RENDERS).join(", "));
    Some(text)
}

fn value(kind: Kind, values: &[Option<String>]) -> String {
    let last = values.last().and_then(Option::as_deref);
    match (kind, last) {
        (Kind::Flag, _) | (Kind::Place, None) => "True".to_owned(),
        (Kind::List, _) => {
            let all: Vec<String> = values.iter().flatten().map(|text| quoted(text)).collect();
            format!("[{}]", all.join(", "))
        }
        (Kind::Tuple, Some(text)) => {
            let parts: Vec<String> = text.split([',', 'x']).map(plain).collect();
            format!("({})", parts.join(", "))
        }
        (Kind::Number, Some(text)) => plain(text),
        (_, Some(text)) => quoted(text),
        (_, None) => "None".to_owned(),
    }
}

/// A number as it is, and another text between quotes.
fn plain(text: &str) -> String {
    if text.parse::<f64>().is_ok_and(f64::is_finite) { text.to_owned() } else { quoted(text) }
}

/// A text as Python has it: JSON's escapes are Python's.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// Keys of TOML in one line as a dictionary: `eye = [1, 2, 3], fov = 20` as `"eye": [1, 2, 3], "fov": 20`.
fn dictionary(keys: &str) -> String {
    let mut items: Vec<String> = Vec::new();
    for part in keys.split(", ") {
        match part.split_once(" = ") {
            Some((key, value)) => items.push(format!("{}: {value}", quoted(key))),
            None => {
                if let Some(last) = items.last_mut() {
                    *last += ", ";
                    *last += part;
                }
            }
        }
    }
    items.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_become_keyword_arguments() {
        let options = Options::parse(&[
            "a \"b\".xyz",
            "--frame=3",
            "--color-by=vx / 2",
            "--color-range=2%,98%",
            "--legend",
            "--style=H: color=red",
            "--radii=vdw",
            "--cell",
            "--outline=on",
            "--size=64x48",
            "--spp=4",
        ]);
        let text = lines(&options, "eye = [1, 2, 3], target = [0, 0, 0], fov = 20").unwrap();
        let expected = "import spherule\n\n\
            # --radii is not in these lines.\n\
            particles = spherule.read(\"a \\\"b\\\".xyz\", frame=3)\n\
            scene = spherule.Scene(\n    particles,\n    styles=[\"H: color=red\"],\n    color_by=\"vx / 2\",\n    \
            color_range=(\"2%\", \"98%\"),\n    show_cell=True,\n    legend=\"top-right\",\n    \
            look={\"outline\": True},\n    camera={\"eye\": [1, 2, 3], \"target\": [0, 0, 0], \"fov\": 20},\n)\n\
            scene.render(size=(64, 48), spp=4).save(\"view.png\")";
        assert_eq!(text, expected);
        assert_eq!(lines(&Options::default(), ""), None);
    }
}
