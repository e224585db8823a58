//! The sections of a scene file as text.

use crate::color::{Scale, Spacing};
use crate::scene::{
    Annotations, AxisTripod, Background, Camera, ColorBar, ColorLegend, ConductorFresnel, Cones,
    Ellipsoids, Environment, EnvironmentMap, Insets, Label, Lens, Lettering, Light, Look, Material,
    Pose, Projection, Rgb, ScaleBar, Slice, Sticks,
};
use crate::settings::{SETTINGS, Setting, Settings, Value};
use glam::{DQuat, DVec3};
use std::fmt::Write as _;

pub(super) fn render(settings: &Settings) -> String {
    let line = |setting: &Setting| match setting.get(settings) {
        // Without the key there is no limit.
        Value::None | Value::Word("inf") => String::new(),
        // Nor does it decide when the render stops.
        _ if setting.name == "spp" && is_undecided(settings) => String::new(),
        Value::Word(word) => format!("{} = \"{word}\"\n", setting.name),
        value => format!("{} = {value}\n", setting.name),
    };
    format!("[render]\n{}\n", SETTINGS.iter().map(line).collect::<String>())
}

/// Returns whether it is left to the program when a render stops.
fn is_undecided(settings: &Settings) -> bool {
    !settings.stop_given && !settings.has_target() && settings.spp == Settings::default().spp
}

pub(in crate::scene) fn camera(camera: &Camera) -> String {
    let projection = match camera.projection {
        Projection::Perspective { fov } => format!("\"perspective\"\nfov = {fov:?}"),
        Projection::Orthographic { height: Some(height) } => {
            format!("\"orthographic\"\nheight = {height:?}")
        }
        Projection::Orthographic { height: None } => "\"orthographic\"".to_owned(),
    };
    let pose = match camera.pose {
        Pose::LookAt { eye, target } => {
            format!("eye = {}\ntarget = {}", vector(eye), vector(target))
        }
        Pose::Fit { direction, margin } => {
            format!("fit = true\ndirection = {}\nmargin = {margin:?}", vector(direction))
        }
    };
    let lens = match camera.lens {
        Some(Lens { aperture, focus: Some(focus) }) => {
            format!("aperture = {aperture:?}\nfocus = {focus:?}\n")
        }
        Some(Lens { aperture, focus: None }) => format!("aperture = {aperture:?}\n"),
        None => String::new(),
    };
    let (up, near) = (vector(camera.up), camera.near);
    let insets = match camera.pose {
        Pose::Fit { .. } if camera.insets != Insets::default() => {
            format!("insets = {:?}\n", camera.insets.to_array())
        }
        _ => String::new(),
    };
    format!(
        "[camera]\nprojection = {projection}\n{pose}\nup = {up}\nnear = {near:?}\n{lens}{insets}\n"
    )
}

/// Nothing if nothing is drawn over the picture.
pub(in crate::scene) fn look(look: &Look) -> String {
    if *look == Look::default() {
        return String::new();
    }
    let background = match look.background {
        Background::Sky => "\"sky\"".to_owned(),
        Background::Transparent => "\"transparent\"".to_owned(),
        Background::Color(color) => rgb(color),
    };
    let cell = look.cell.map_or_else(String::new, |cell| {
        let [a, b, c] = cell.vectors.map(vector);
        format!("cell = [{}, {a}, {b}, {c}]\n", vector(cell.origin))
    });
    let Look { depth_cue, outline, .. } = look;
    format!(
        "[look]\nbackground = {background}\ndepth_cue = {depth_cue}\noutline = {outline}\n{cell}\n"
    )
}

/// Returns the sections of all annotations; empty if there are none.
pub(in crate::scene) fn annotations(annotations: &Annotations) -> String {
    let Annotations { color_bar: bar, legend: colors, axes: tripod, scale_bar: scale, .. } =
        annotations;
    let mut text = bar.as_ref().map_or_else(String::new, color_bar);
    text += &colors.as_ref().map_or_else(String::new, legend);
    text += &tripod.as_ref().map_or_else(String::new, axes);
    text += &scale.as_ref().map_or_else(String::new, scale_bar);
    for Label { text: line, position } in &annotations.labels {
        let (line, position) = (quoted(line), position.name());
        let _ = write!(text, "[[label]]\ntext = {line}\nposition = \"{position}\"\n\n");
    }
    if annotations.lettering != Lettering::default() {
        let Lettering { size, color } = annotations.lettering;
        let color = color.map_or_else(String::new, |color| format!("color = {}\n", rgb(color)));
        let _ = write!(text, "[lettering]\nsize = {size:?}\n{color}\n");
    }
    text
}

/// Colors for what is beyond the range have no words in a scene file.
fn color_bar(bar: &ColorBar) -> String {
    let Scale { map, reversed, range, .. } = bar.scale;
    let (low, high, map) = (range.low(), range.high(), map.name());
    let log = range.spacing() == Spacing::Logarithmic;
    let (label, position) = (quoted(&bar.label), bar.position.name());
    format!(
        "[color_bar]\nrange = [{low:?}, {high:?}]\nlog = {log}\nmap = \"{map}\"\n\
         reversed = {reversed}\nlabel = {label}\nposition = \"{position}\"\n\n"
    )
}

fn legend(legend: &ColorLegend) -> String {
    let entry = |(color, name): &(Rgb, String)| format!("[{}, {}]", quoted(name), rgb(*color));
    let entries: Vec<String> = legend.entries.iter().map(entry).collect();
    let (omitted, label, position) =
        (legend.omitted, quoted(&legend.label), legend.position.name());
    format!(
        "[legend]\nentries = [{}]\nomitted = {omitted}\nlabel = {label}\nposition = \"{position}\"\n\n",
        entries.join(", ")
    )
}

fn axes(axes: &AxisTripod) -> String {
    let [a, b, c] = axes.directions.map(vector);
    let names = axes.names.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(", ");
    let position = axes.position.name();
    format!(
        "[axes]\ndirections = [{a}, {b}, {c}]\nnames = [{names}]\nposition = \"{position}\"\n\n"
    )
}

fn scale_bar(bar: &ScaleBar) -> String {
    let length = bar.length.map_or_else(String::new, |length| format!("length = {length:?}\n"));
    let (unit, position) = (quoted(&bar.unit), bar.position.name());
    format!("[scale_bar]\n{length}unit = {unit}\nposition = \"{position}\"\n\n")
}

/// `picture` is the name of the picture's file, if there is one.
pub(in crate::scene) fn environment(environment: &Environment, picture: &str) -> String {
    let map = match &environment.map {
        EnvironmentMap::Constant(color) => format!("kind = \"constant\"\ncolor = {}", rgb(*color)),
        EnvironmentMap::Gradient { bottom, top, up } => {
            let (bottom, top, up) = (rgb(*bottom), rgb(*top), vector(*up));
            format!("kind = \"gradient\"\nbottom = {bottom}\ntop = {top}\nup = {up}")
        }
        EnvironmentMap::Picture { up, rotation, scale, .. } => {
            let (file, up) = (quoted(picture), vector(*up));
            format!(
                "kind = \"picture\"\nfile = {file}\nup = {up}\nrotation = {rotation:?}\nscale = {scale:?}"
            )
        }
    };
    let illuminates = environment.illuminates;
    format!("[environment]\n{map}\nilluminates = {illuminates}\n\n")
}

pub(in crate::scene) fn material(material: &Material) -> String {
    match material {
        Material::Translucent { opacity, surface } => {
            format!("{}opacity = {opacity:?}\n", self::material(surface))
        }
        Material::Lambertian { color } => {
            format!("kind = \"lambertian\"\ncolor = {}\n", rgb(*color))
        }
        Material::Conductor { fresnel, roughness } => {
            let fresnel = match fresnel {
                ConductorFresnel::Schlick(color) => {
                    format!("color = {}\nfresnel = \"schlick\"", rgb(*color))
                }
                ConductorFresnel::Constant(color) => {
                    format!("color = {}\nfresnel = \"constant\"", rgb(*color))
                }
                ConductorFresnel::Exact { eta, k } => {
                    format!("eta = {}\nk = {}", rgb(*eta), rgb(*k))
                }
            };
            format!("kind = \"conductor\"\n{fresnel}\nroughness = {roughness:?}\n")
        }
        Material::Dielectric { ior, color } => {
            format!("kind = \"dielectric\"\nior = {ior:?}\ncolor = {}\n", rgb(*color))
        }
        Material::Plastic { color, ior } => {
            format!("kind = \"plastic\"\ncolor = {}\nior = {ior:?}\n", rgb(*color))
        }
        Material::Reflective { color, diffuse, mirror } => {
            let shares = format!("diffuse = {diffuse:?}\nmirror = {mirror:?}");
            format!("kind = \"reflective\"\ncolor = {}\n{shares}\n", rgb(*color))
        }
        Material::Emitter { radiance, albedo } => {
            let (radiance, albedo) = (rgb(*radiance), rgb(*albedo));
            format!("kind = \"emitter\"\nradiance = {radiance}\nalbedo = {albedo}\n")
        }
    }
}

pub(in crate::scene) fn slice(slice: &Slice) -> String {
    let (normal, distance, mode) = (vector(slice.normal), slice.distance, slice.mode.name());
    format!("[[slice]]\nnormal = {normal}\ndistance = {distance:?}\nmode = \"{mode}\"\n\n")
}

pub(in crate::scene) fn light(light: &Light) -> String {
    match light {
        Light::Sun { direction, irradiance, angular_radius } => {
            let (direction, irradiance) = (vector(*direction), rgb(*irradiance));
            format!(
                "[[light]]\nkind = \"sun\"\ndirection = {direction}\nirradiance = {irradiance}\n\
                 angular_radius = {angular_radius:?}\n\n"
            )
        }
        Light::Point { position, intensity, falloff } => {
            let (position, intensity) = (vector(*position), rgb(*intensity));
            let falloff = if *falloff { "square" } else { "none" };
            format!(
                "[[light]]\nkind = \"point\"\nposition = {position}\nintensity = {intensity}\n\
                 falloff = \"{falloff}\"\n\n"
            )
        }
    }
}

/// A text as a basic string of TOML, which serves as a key too: `toml` itself would write some
/// texts in several lines, which no key may have.
pub(super) fn quoted(text: &str) -> String {
    let escape = |letter: char| match letter {
        '"' | '\\' => format!("\\{letter}"),
        _ if letter.is_control() => format!("\\u{:04X}", u32::from(letter)),
        _ => letter.to_string(),
    };
    format!("\"{}\"", text.chars().map(escape).collect::<String>())
}

pub(in crate::scene) fn vector(vector: DVec3) -> String {
    format!("{:?}", vector.to_array())
}

/// The sections of the sticks; `material` gives the name of a row of the materials.
pub(in crate::scene) fn sticks(sticks: &Sticks, material: impl Fn(u32) -> String) -> String {
    let mut text = String::new();
    for row in 0..sticks.len() {
        let ([from, to], [first, second]) =
            (sticks.ends(row).map(vector), sticks.colors[row].map(rgb));
        let (radius, material) = (sticks.radius[row], material(sticks.material[row]));
        let _ = write!(
            text,
            "[[stick]]\nfrom = {from}\nto = {to}\nradius = {radius:?}\nmaterial = {material}\n\
             colors = [{first}, {second}]\n\n"
        );
    }
    text
}

/// The sections of the ellipsoids, likewise.
pub(in crate::scene) fn ellipsoids(
    ellipsoids: &Ellipsoids,
    material: impl Fn(u32) -> String,
) -> String {
    let mut text = String::new();
    for row in 0..ellipsoids.len() {
        let [center, semi_axes] = [ellipsoids.center[row], ellipsoids.semi_axes[row]].map(vector);
        let DQuat { x, y, z, w } = ellipsoids.orientation[row];
        let (color, material) = (rgb(ellipsoids.color[row]), material(ellipsoids.material[row]));
        let _ = write!(
            text,
            "[[ellipsoid]]\ncenter = {center}\nsemi_axes = {semi_axes}\n\
             orientation = [{w:?}, {x:?}, {y:?}, {z:?}]\nmaterial = {material}\ncolor = {color}\n\n"
        );
    }
    text
}

/// The sections of the cones, likewise.
pub(in crate::scene) fn cones(cones: &Cones, material: impl Fn(u32) -> String) -> String {
    let mut text = String::new();
    for row in 0..cones.len() {
        let [apex, base] = [cones.apex[row], cones.base[row]].map(vector);
        let (color, material) = (rgb(cones.color[row]), material(cones.material[row]));
        let radius = cones.radius[row];
        let _ = write!(
            text,
            "[[cone]]\napex = {apex}\nbase = {base}\nradius = {radius:?}\nmaterial = {material}\n\
             color = {color}\n\n"
        );
    }
    text
}

fn rgb(color: Rgb) -> String {
    format!("{:?}", color.to_array())
}
