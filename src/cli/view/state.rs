//! Facts for pages: the state of the viewer, and once the commands and options that there are.

use super::camera_control::{CameraControl, Outline};
use super::events::Picked;
use super::keys;
use super::options::{Options, command, topics};
use super::python;
use super::script::COMMANDS;
use super::session;
use super::token::token;
use super::viewer::Viewer;
use crate::cli::failure::Failure;
use crate::cli::help;
use clap::Arg;
use glam::DVec3;
use serde_json::{Map, Value, json};
use spherule_render::color::{Rgb, ticks};
use spherule_render::graphics::unmarked;
use spherule_render::image::tone::srgb_encode;
use spherule_render::scene::{Background, Denoise, Pose, Preset, Projection};
use spherule_render::settings::{INTEGRATORS, SAMPLERS};

/// Number of colors of a color bar.
const COLORS: u32 = 64;

/// Number of selected spheres that are described.
const DESCRIBED: usize = 12;

/// Maximum number of ticks of a color bar.
const TICKS: usize = 6;

/// Returns what does not change: a name of the session, keys, commands, and options by topics.
///
/// # Errors
/// The system has no random numbers.
pub(super) fn greeting() -> Result<String, Failure> {
    let command = command();
    let topics: Vec<Value> = topics(&command)
        .into_iter()
        .map(|(topic, args)| json!([topic, args.into_iter().map(option).collect::<Vec<_>>()]))
        .collect();
    let greeting = json!({
        "hello": {
            "session": token(None)?,
            "version": env!("CARGO_PKG_VERSION"),
            "keys": keys::HELP.as_slice(),
            "bindings": keys::BINDINGS.map(|(key, _)| key).as_slice(),
            "commands": COMMANDS.as_slice(),
            "topics": topics,
        }
    });
    Ok(greeting.to_string())
}

/// Describes an option.
fn option(arg: &Arg) -> Value {
    let values = arg.get_possible_values();
    let values: Vec<&str> = values.iter().map(clap::builder::PossibleValue::get_name).collect();
    let flag = !arg.get_action().takes_values();
    json!({
        "name": arg.get_long(),
        "help": arg.get_help().map(ToString::to_string),
        "value": arg.get_value_names().map(|names| names.join(" ")),
        "values": if flag { Vec::new() } else { values },
        "flag": flag,
        "optional": !flag && arg.get_num_args().is_some_and(|count| count.min_values() == 0),
        "many": matches!(arg.get_action(), clap::ArgAction::Append),
    })
}

/// Returns the state of the viewer.
pub(super) fn state(viewer: &Viewer) -> Value {
    let facts = &viewer.facts;
    let mut options = Map::new();
    for (name, value) in viewer.content.options.iter() {
        let value = value.map_or(Value::Null, |value| json!(value.to_string_lossy()));
        if let Value::Array(values) = options.entry(name).or_insert_with(|| json!([])) {
            values.push(value);
        }
    }
    let settings = &viewer.settings;
    let preset = viewer.content.preset.as_ref().map(|(preset, _)| *preset).or(facts.preset);
    let camera_line = viewer.control.camera.to_line();
    let remade = remade(viewer);
    // What is lit as for another camera is so only by the command line.
    let python = remade.as_ref().and_then(|options| {
        let options = options.restricted(|name| !["lit-from", "camera"].contains(&name));
        python::lines(&options, &camera_line)
    });
    let command = remade.map(|mut options| {
        options.put("output", "view.png");
        options.command_line()
    });
    let [undo, redo] = viewer.history.reach();
    json!({
        "title": facts.title,
        "spheres": facts.spheres,
        "types": facts.types,
        "hidden": viewer.content.hidden,
        "cuts": viewer.content.cuts.len(),
        "columns": facts.columns,
        "color": viewer.content.color,
        "preset": preset.map(Preset::name),
        "frame": viewer.content.frame.unwrap_or(facts.frame),
        "frames": facts.frames,
        "options": options,
        "legend": legend(viewer),
        "camera": camera(viewer),
        "size": [settings.width, settings.height],
        "samples": settings.spp,
        "exposure": settings.exposure,
        "integrator": INTEGRATORS.name(&settings.integrator),
        "sampler": SAMPLERS.name(&settings.sampler),
        "background": background(viewer.look().background),
        "depth_cue": viewer.look().depth_cue,
        "outline": viewer.look().outline,
        "command": command,
        "python": python,
        "named": viewer.named,
        "picked": picked(viewer),
        "drawn": drawn(viewer),
        "slices": slices(viewer),
        "measures": measures(viewer),
        "message": viewer.message,
        "loading": viewer.loading.as_ref().map(|loading| json!([loading.text(), loading.done])),
        "cutting": viewer.is_cutting(),
        "undo": undo,
        "redo": redo,
    })
}

/// Describes the selected spheres, the first ones and the last one in words.
fn picked(viewer: &Viewer) -> Vec<Value> {
    let picked = viewer.picked.iter().enumerate();
    let is_last = |at: usize| at + 1 == viewer.picked.len();
    let text = |at: usize, own: &Picked| (at < DESCRIBED || is_last(at)).then(|| own.text.clone());
    picked.map(|(at, own)| json!({ "id": own.id, "text": text(at, own) })).collect()
}

/// Returns what pages draw over the image that is shown: outlines of the selected spheres, and handles of slices.
pub(super) fn drawn(viewer: &Viewer) -> Value {
    let Some(picture) = &viewer.shown else { return Value::Null };
    let control = CameraControl::new(picture.camera.clone(), viewer.facts.size);
    json!({ "marks": marks(viewer, &control), "handles": handles(viewer, &control) })
}

/// Returns the outlines of the selected spheres: center, radii and direction of the first one.
fn marks(viewer: &Viewer, control: &CameraControl) -> Vec<[f32; 6]> {
    let outlines = viewer.picked.iter().filter_map(|own| control.outline(own.center, own.radius));
    let numbers = |Outline { center, radii, axis }: Outline| {
        [center.x, center.y, radii.x, radii.y, axis.x, axis.y].map(|number| number as f32)
    };
    outlines.map(numbers).collect()
}

/// Describes the slices that can be moved.
fn slices(viewer: &Viewer) -> Vec<Value> {
    let [low, high] = viewer.facts.bounds;
    let texts = viewer.content.options.all("slice");
    let describe = |(index, (normal, distance)): (usize, (DVec3, f64))| {
        let [a, b] = [normal * low, normal * high];
        let range = [a.min(b).element_sum(), a.max(b).element_sum()];
        let text = texts.get(index).and_then(Option::as_ref).map(|text| text.to_string_lossy());
        json!({ "text": text, "distance": distance, "range": range })
    };
    planes(viewer).enumerate().map(describe).collect()
}

/// Normals and distances of slices: those of the option, then those that were drawn.
fn planes(viewer: &Viewer) -> impl Iterator<Item = (DVec3, f64)> {
    let given = viewer.facts.slices.iter().map(|own| (own.normal, own.distance));
    let drawn = viewer.content.cuts.iter().map(|cut| (cut.normal, cut.point.dot(cut.normal)));
    given.chain(drawn)
}

/// Returns for each slice a place on its plane, and how far it moves by a unit of distance.
fn handles(viewer: &Viewer, control: &CameraControl) -> Vec<Option<[f32; 4]>> {
    let [low, high] = viewer.facts.bounds;
    let middle = (low + high) / 2.0;
    let handle = |(normal, distance): (DVec3, f64)| {
        let at = middle + normal * (distance - middle.dot(normal));
        let unit = 1e-3 * viewer.facts.size;
        let place = control.place_of(at)?;
        let along = (control.place_of(at + normal * unit)? - place) / unit;
        Some([place.x, place.y, along.x, along.y].map(|number| number as f32))
    };
    planes(viewer).map(handle).collect()
}

/// Returns what the selected spheres measure, each with the value of the option that draws it: directly, and between nearest
/// images if that differs.
fn measures(viewer: &Viewer) -> Vec<Value> {
    let ids = viewer.picked.iter().map(|picked| Some(picked.id?.to_string()));
    let ids: Option<Vec<String>> = ids.collect();
    // Only particles of files are measured by an option.
    let ids = ids.filter(|_| viewer.facts.preset.is_some());
    let mut measures: Vec<Value> = Vec::new();
    let mut before = None;
    for (periodic, suffix) in [(false, ""), (true, ":periodic")] {
        let text = session::measure(viewer, periodic);
        let Some(text) = text.filter(|text| before.as_ref() != Some(text)) else { continue };
        let option = ids.as_ref().map(|ids| ids.join("-") + suffix);
        measures.push(json!({ "text": text, "periodic": periodic, "option": option }));
        before = Some(text);
    }
    measures
}

/// Returns the options that make the image of a particle file; `None` for scenes, whose changes only a
/// scene file holds.
pub(super) fn remade(viewer: &Viewer) -> Option<Options> {
    let Viewer { content, settings, touched, facts, .. } = viewer;
    facts.preset?;
    let of_camera = |name: &str| help::has("camera", name) && name != "up";
    let mut options = content.options.restricted(|name| !of_camera(name));
    if let Some(frame) = content.frame {
        options.put("frame", frame.to_string());
    }
    if let Some(color) = &content.color {
        options.put("color-by", color);
    }
    if let Some((preset, _)) = &content.preset {
        options.put("preset", preset.name());
    }
    if let Some(chosen) = touched.background.map(background).as_ref().and_then(Value::as_str) {
        options.put("background", chosen);
    }
    for (name, on) in [("depth-cue", touched.depth_cue), ("outline", touched.outline)] {
        if let Some(on) = on {
            options.put(name, if on { "on" } else { "off" });
        }
    }
    if let Some(condition) = content.condition() {
        let own = options.last("select").map(|own| format!("({own}) and {condition}"));
        options.put("select", own.unwrap_or(condition));
    }
    options.put("size", format!("{}x{}", settings.width, settings.height));
    options.put("spp", settings.spp.to_string());
    if settings.integrator != facts.settings.integrator {
        options.put("integrator", INTEGRATORS.name(&settings.integrator));
    }
    if settings.sampler != facts.settings.sampler {
        options.put("sampler", SAMPLERS.name(&settings.sampler));
    }
    if settings.exposure != facts.settings.exposure {
        options.put("exposure", settings.exposure.to_string());
    }
    if let Some(settings) = viewer.settings_of_picture() {
        // The number of samples alone would say that it is not denoised.
        options.put("denoise", if settings.denoise == Denoise::On { "on" } else { "off" });
    }
    options.put("lit-from", facts.lit_from.to_line());
    options.put("camera", viewer.control.camera.to_line());
    Some(options)
}

fn background(background: Background) -> Value {
    match background {
        Background::Sky => json!("sky"),
        Background::Transparent => json!("transparent"),
        Background::Color(color) => json!(hex(color)),
    }
}

/// Returns a linear color as CSS has it.
fn hex(color: Rgb) -> String {
    let [red, green, blue] = color
        .to_array()
        .map(|value| (srgb_encode(f64::from(value.clamp(0.0, 1.0))) * 255.0).round() as u8);
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn camera(viewer: &Viewer) -> Value {
    let camera = &viewer.control.camera;
    let (eye, target) = match camera.pose {
        Pose::LookAt { eye, target } => (eye, target),
        Pose::Fit { direction, .. } => (-direction, viewer.control.pivot),
    };
    let (fov, height) = match camera.projection {
        Projection::Perspective { fov } => (Some(fov), None),
        Projection::Orthographic { height } => (None, height),
    };
    json!({
        "eye": eye.to_array(),
        "target": target.to_array(),
        "up": camera.up.to_array(),
        "fov": fov,
        "height": height,
        "line": camera.to_line(),
    })
}

/// Describes the color bar: its label, colors from its low end, and ticks at shares of its length.
fn legend(viewer: &Viewer) -> Value {
    let Some(legend) = viewer.facts.legend.as_ref().filter(|_| !viewer.facts.color_bar) else {
        return Value::Null;
    };
    let range = &legend.scale.range;
    let colors = (0..COLORS).map(|step| {
        let share = (f64::from(step) + 0.5) / f64::from(COLORS);
        hex(legend.scale.at(share))
    });
    let ticks = ticks(range, TICKS);
    let ticks = ticks.iter().map(|tick| json!([range.position(tick.value), tick.label]));
    json!({
        "label": unmarked(&legend.label),
        "colors": colors.collect::<Vec<_>>(),
        "ticks": ticks.collect::<Vec<_>>(),
    })
}
