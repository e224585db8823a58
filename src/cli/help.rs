//! Help by topics: `-h` is one screen of the options that people use most, `--help TOPIC` all of one topic.

use clap::{Arg, Command};
use std::ffi::OsString;

/// The options of `-h`, in the order in which it lists them, each with its value and a line of help.
const FRONT: [(&str, &str, &str); 25] = [
    ("output", "FILE", "Image: .png, .jpg, .tif, .exr, .pdf, .svg; or film: .mp4, .gif"),
    ("frame", "N", "Frame of several: a number, first, last, or all for a film"),
    ("select", "EXPR", "Draw only these particles, as in 'element != H and z > 10'"),
    ("hide", "EXPR", "Leave out these particles, as in water"),
    ("styles", "EXPR: ...", "Look of some particles, as in 'ligand: color=magenta'"),
    ("radii", "RADII", "vdw, covalent, ionic, a number, or column:NAME"),
    ("color_by", "EXPR", "Colors by a column or expression, as in 'norm(velocity)'"),
    ("color_map", "MAP", "Color map of numbers, as in turbo, reversed with _r"),
    ("model", "MODEL", "space-filling, ball-and-stick or licorice"),
    ("bonds", "BONDS", "Bonds to draw: auto, file, none, or rules such as 'C-C<1.7'"),
    ("polyhedra", "A-B", "Coordination polyhedra, as in Ti-O"),
    ("opacity", "NUMBER", "Opacity of particles: 0.3, 30%, or a column"),
    ("planes", "PLANE", "Cut away one side of a plane, as in 'z > 50%'"),
    ("view", "DIRECTION", "Direction: auto, iso, x, -y; azimuth,elevation; or a vector"),
    ("look_at", "EXPR", "Particles to frame, as in 'resname LIG'"),
    ("zoom", "FACTOR", "Magnification"),
    ("preset", "NAME", "figure, chalk, studio, cloudy, glossy, outline, ghost ..."),
    ("background", "COLOR", "A color, transparent, or sky"),
    ("size", "SIZE", "Pixels, as in 1280x720, or size on paper, as in 85mm"),
    ("dpi", "N", "Pixels per inch on paper"),
    ("color_bar", "POSITION", "Color bar in the image, as in right, or in a file"),
    ("legend", "POSITION", "Legend of the names that colors stand for, as in top-left"),
    ("scale_bar", "POSITION", "Scale bar"),
    ("until_error", "PERCENT", "Render until the error of the image is below it, as in 1%"),
    ("turntable", "N", "Images of a full turn, as in 360 for a film"),
];

/// Returns the topics, with the names of their options.
pub(super) fn topics() -> &'static [(&'static str, &'static [&'static str])] {
    &TOPICS
}

/// Returns whether a topic has an option, which is named as on the command line.
pub(super) fn has(topic: &str, option: &str) -> bool {
    let id = option.replace('-', "_");
    TOPICS.iter().any(|(own, ids)| *own == topic && ids.contains(&id.as_str()))
}

/// The topics of `--help TOPIC`, with their options.
const TOPICS: [(&str, &[&str]); 9] = [
    (
        "particles",
        &[
            "format",
            "columns",
            "frame",
            "radii",
            "radius_scale",
            "atom_style",
            "topology",
            "whole",
            "align",
            "smooth",
            "trail",
            "select",
            "hide",
            "styles",
            "types",
            "arrows",
            "arrow_scale",
            "arrow_radius",
            "arrow_color",
            "arrow_center",
            "planes",
            "slice_mode",
            "wrap",
            "replicate",
            "complete",
            "outside",
            "cell",
        ],
    ),
    (
        "bonds",
        &[
            "model",
            "bonds",
            "bond_radius",
            "polyhedra",
            "polyhedra_opacity",
            "complete",
            "outside",
            "styles",
            "types",
        ],
    ),
    (
        "colors",
        &[
            "colors",
            "color_by",
            "color_map",
            "color_range",
            "color_title",
            "color_log",
            "color_bar",
            "legend",
            "opacity",
            "translucent",
            "styles",
            "types",
        ],
    ),
    (
        "camera",
        &[
            "view",
            "look_at",
            "zoom",
            "roll",
            "camera",
            "projection",
            "margin",
            "up",
            "turntable",
            "aperture",
            "focus",
        ],
    ),
    (
        "light",
        &[
            "preset",
            "background",
            "depth_cue",
            "outline",
            "lit_from",
            "exposure",
            "tone",
            "integrator",
            "light_choice",
            "shadow_samples",
            "ao_distance",
            "caustics",
            "depth",
        ],
    ),
    (
        "image",
        &[
            "output",
            "size",
            "dpi",
            "output_format",
            "bits",
            "quality",
            "ppm",
            "layers",
            "region",
            "legend",
            "axes",
            "scale_bar",
            "labels",
            "measures",
            "text_size",
            "text_color",
            "color_bar",
        ],
    ),
    (
        "films",
        &["frame", "turntable", "fps", "skip_existing", "align", "smooth", "trail", "output"],
    ),
    (
        "error",
        &[
            "until_error",
            "spp",
            "time",
            "denoise",
            "seed",
            "sampler",
            "filter",
            "roulette",
            "checkpoint",
            "checkpoint_every",
            "resume",
        ],
    ),
    (
        "machine",
        &[
            "threads",
            "traversal",
            "builder",
            "lanes",
            "device",
            "memory_limit",
            "part",
            "split",
            "prepare",
            "quiet",
            "verbose",
            "stats",
            "json",
            "terminal",
        ],
    ),
];

/// Commands with these options.
const COMMANDS: [&str; 2] = ["render", "view"];

/// Shortens the help that a command line asks for, which has its command first: `-h` to one screen, and `--help TOPIC` to
/// the topic. Returns the command line without the topic, and the program, whose other help is as before.
pub(super) fn shortened(program: Command, mut line: Vec<OsString>) -> (Command, Vec<OsString>) {
    let Some(command) =
        COMMANDS.into_iter().find(|name| line.get(1).is_some_and(|word| word == name))
    else {
        return (program, line);
    };
    let before_end = line.iter().take_while(|word| *word != "--").count();
    if line[..before_end].iter().any(|word| word == "-h") {
        return (program.mut_subcommand(command, front), line);
    }
    let topic = |word: &OsString| TOPICS.into_iter().find(|(name, _)| word == name);
    let found = (2..before_end).find_map(|at| match line[at].to_str()?.strip_prefix("--help")? {
        "" => Some((at + 1, topic(line.get(at + 1)?)?)),
        text => Some((at, topic(&text.strip_prefix('=')?.into())?)),
    });
    match found {
        Some((at, (_, options))) => {
            line.truncate(at);
            line.push("--help".into());
            (program.mut_subcommand(command, |own| about(own, options)), line)
        }
        None => (program, line),
    }
}

/// Leaves the options of one screen.
fn front(command: Command) -> Command {
    let more = TOPICS.map(|(name, _)| name).join(", ");
    let name = command.get_name().to_owned();
    let place = |id: &str| FRONT.iter().position(|(own, ..)| *own == id);
    command
        .mut_args(|arg| match place(arg.get_id().as_str()) {
            Some(at) => {
                let (_, value, help) = FRONT[at];
                let arg = arg.value_name(value).help(help).hide_possible_values(true);
                arg.hide_default_value(true).help_heading(None::<&str>).display_order(at)
            }
            None if arg.is_positional() => arg,
            None => arg.hide(true),
        })
        .after_help(format!(
            "All options: spherule {name} --help; or those of a topic, spherule {name} --help TOPIC: {more}"
        ))
}

/// Leaves the options of a topic.
fn about(command: Command, options: &[&str]) -> Command {
    let is_of_topic = |arg: &Arg| arg.is_positional() || options.contains(&arg.get_id().as_str());
    command
        .mut_args(|arg| if is_of_topic(&arg) { arg } else { arg.hide(true) })
        .after_help("All options: --help")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::Args;
    use clap::CommandFactory;
    use std::collections::BTreeSet;

    fn options() -> BTreeSet<String> {
        let program = Args::command();
        let render = program.find_subcommand("render").expect("the command");
        let shown = render.get_arguments().filter(|arg| !arg.is_positional() && !arg.is_hide_set());
        shown.map(|arg| arg.get_id().to_string()).collect()
    }

    fn help(words: &[&str]) -> String {
        let line =
            std::iter::once("spherule").chain(words.iter().copied()).map(Into::into).collect();
        let (program, line) = shortened(Args::command(), line);
        program.try_get_matches_from(line).expect_err("help").to_string()
    }

    #[test]
    fn every_option_has_a_topic() {
        let all = options();
        let named: BTreeSet<String> =
            TOPICS.iter().flat_map(|(_, own)| own.iter()).map(|name| (*name).to_owned()).collect();
        assert_eq!(named, all);
        assert!(FRONT.iter().all(|(name, ..)| all.contains(*name)));
    }

    #[test]
    fn short_help_is_one_screen() {
        let text = help(&["render", "-h"]);
        assert!(text.lines().count() <= 40, "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= 120), "{text}");
        assert!(text.contains("--style") && !text.contains("--lanes") && text.contains("machine"));
        assert!(help(&["render", "a.xyz", "--spp", "4", "-h"]) == text);
    }

    #[test]
    fn topics_have_their_options() {
        for line in [&["render", "--help", "camera"][..], &["render", "a.xyz", "--help=camera"]] {
            let text = help(line);
            assert!(
                text.contains("--look-at") && !text.contains("--color-map"),
                "{line:?}: {text}"
            );
        }
        let all = help(&["render", "--help"]);
        assert!(
            all.contains("--look-at") && all.contains("--color-map") && all.contains("Examples:")
        );
        assert_eq!(help(&["render", "--help", "a.xyz"]), all);
    }
}
