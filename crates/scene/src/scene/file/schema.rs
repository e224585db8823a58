//! The keys that a scene file may have: the list that the reader checks, and with which a test compares
//! the manual.

use crate::settings::{INTEGRATORS, SETTINGS, Scope};

/// A section, its keys, and the kinds each key has a meaning for.
pub(super) struct Schema {
    /// As a scene file writes it.
    pub(super) section: &'static str,
    /// The key that chooses among `kinds`; empty if the section has no kinds.
    pub(super) selector: &'static str,
    /// The values of the selector.
    pub(super) kinds: &'static [&'static str],
    /// The kind without a selector; `None` if the selector is required.
    pub(super) default_kind: Option<&'static str>,
    /// Every key but the selector, with its kinds; none listed means all.
    pub(super) keys: &'static [(&'static str, &'static [&'static str])],
}

impl Schema {
    /// Every key of the section.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> + Clone {
        let selector = Some(self.selector).filter(|name| !name.is_empty());
        selector.into_iter().chain(self.keys.iter().map(|&(name, _)| name))
    }
}

/// A section without kinds.
const fn plain(
    section: &'static str,
    keys: &'static [(&'static str, &'static [&'static str])],
) -> Schema {
    Schema { section, selector: "", kinds: &[], default_kind: None, keys }
}

pub(super) const ROOT: Schema = plain(
    "the scene",
    &[
        ("title", &[]),
        ("render", &[]),
        ("camera", &[]),
        ("look", &[]),
        ("color_bar", &[]),
        ("legend", &[]),
        ("axes", &[]),
        ("scale_bar", &[]),
        ("label", &[]),
        ("lettering", &[]),
        ("environment", &[]),
        ("ground", &[]),
        ("slice", &[]),
        ("light", &[]),
        ("material", &[]),
        ("sphere", &[]),
        ("stick", &[]),
        ("ellipsoid", &[]),
        ("cone", &[]),
        ("generate", &[]),
        ("file", &[]),
    ],
);

/// The keys of [`SETTINGS`].
pub(super) const RENDER: Schema = Schema {
    section: "[render]",
    selector: SELECTOR,
    kinds: &integrators(),
    default_kind: Some(INTEGRATORS.0[0].0),
    keys: &render_keys(),
};

/// The setting that chooses among kinds.
const SELECTOR: &str = "integrator";

/// Returns the names of integrators.
const fn integrators() -> [&'static str; INTEGRATORS.0.len()] {
    let mut names = [""; INTEGRATORS.0.len()];
    let mut row = 0;
    while row < names.len() {
        names[row] = INTEGRATORS.0[row].0;
        row += 1;
    }
    names
}

/// Returns the settings and their integrators; the selector, which is no key of its own, is among them.
const fn render_keys() -> [(&'static str, &'static [&'static str]); SETTINGS.len()] {
    let mut keys: [(&str, &[&str]); SETTINGS.len()] = [("", &[]); SETTINGS.len()];
    let mut row = 0;
    while row < keys.len() {
        let setting = &SETTINGS[row];
        keys[row] = match setting.scope {
            Scope::ParameterOf(integrators) => (setting.name, integrators),
            Scope::All | Scope::Only(_) => (setting.name, &[]),
        };
        row += 1;
    }
    keys
}

pub(super) const CAMERA: Schema = Schema {
    section: "[camera]",
    selector: "projection",
    kinds: &["perspective", "orthographic"],
    default_kind: Some("perspective"),
    keys: &[
        ("fov", &["perspective"]),
        ("height", &["orthographic"]),
        ("eye", &[]),
        ("target", &[]),
        ("fit", &[]),
        ("direction", &[]),
        ("margin", &[]),
        ("up", &[]),
        ("aperture", &[]),
        ("focus", &[]),
        ("near", &[]),
        ("insets", &[]),
    ],
};

pub(super) const LOOK: Schema =
    plain("[look]", &[("background", &[]), ("depth_cue", &[]), ("outline", &[]), ("cell", &[])]);

pub(super) const COLOR_BAR: Schema = plain(
    "[color_bar]",
    &[
        ("range", &[]),
        ("log", &[]),
        ("map", &[]),
        ("reversed", &[]),
        ("label", &[]),
        ("position", &[]),
    ],
);

pub(super) const LEGEND: Schema =
    plain("[legend]", &[("entries", &[]), ("omitted", &[]), ("label", &[]), ("position", &[])]);

pub(super) const AXES: Schema =
    plain("[axes]", &[("directions", &[]), ("names", &[]), ("position", &[])]);

pub(super) const SCALE_BAR: Schema =
    plain("[scale_bar]", &[("length", &[]), ("unit", &[]), ("position", &[])]);

pub(super) const LABEL: Schema = plain("[[label]]", &[("text", &[]), ("position", &[])]);

pub(super) const LETTERING: Schema = plain("[lettering]", &[("size", &[]), ("color", &[])]);

pub(super) const ENVIRONMENT: Schema = Schema {
    section: "[environment]",
    selector: "kind",
    kinds: &["constant", "gradient", "picture"],
    default_kind: Some("constant"),
    keys: &[
        ("color", &["constant"]),
        ("bottom", &["gradient"]),
        ("top", &["gradient"]),
        ("up", &["gradient", "picture"]),
        ("file", &["picture"]),
        ("rotation", &["picture"]),
        ("scale", &["picture"]),
        ("illuminates", &[]),
    ],
};

pub(super) const GROUND: Schema =
    plain("[ground]", &[("normal", &[]), ("height", &[]), ("material", &[])]);

pub(super) const SLICE: Schema =
    plain("[[slice]]", &[("normal", &[]), ("distance", &[]), ("mode", &[])]);

pub(super) const LIGHT: Schema = Schema {
    section: "[[light]]",
    selector: "kind",
    kinds: &["sun", "point"],
    default_kind: None,
    keys: &[
        ("direction", &["sun"]),
        ("irradiance", &["sun"]),
        ("angular_radius", &["sun"]),
        ("position", &["point"]),
        ("intensity", &["point"]),
        ("falloff", &["point"]),
    ],
};

pub(super) const MATERIAL: Schema = Schema {
    section: "[material.NAME]",
    selector: "kind",
    kinds: &["lambertian", "conductor", "dielectric", "plastic", "reflective", "emitter"],
    default_kind: None,
    keys: &[
        ("color", &["lambertian", "conductor", "dielectric", "plastic", "reflective"]),
        ("fresnel", &["conductor"]),
        ("eta", &["conductor"]),
        ("k", &["conductor"]),
        ("roughness", &["conductor"]),
        ("ior", &["dielectric", "plastic"]),
        ("diffuse", &["reflective"]),
        ("mirror", &["reflective"]),
        ("radiance", &["emitter"]),
        ("albedo", &["emitter"]),
        ("opacity", &["lambertian", "conductor", "plastic", "reflective"]),
    ],
};

pub(super) const SPHERE: Schema =
    plain("[[sphere]]", &[("center", &[]), ("radius", &[]), ("material", &[]), ("color", &[])]);

pub(super) const STICK: Schema = plain(
    "[[stick]]",
    &[
        ("from", &[]),
        ("to", &[]),
        ("radius", &[]),
        ("material", &[]),
        ("color", &[]),
        ("colors", &[]),
    ],
);

pub(super) const ELLIPSOID: Schema = plain(
    "[[ellipsoid]]",
    &[("center", &[]), ("semi_axes", &[]), ("orientation", &[]), ("material", &[]), ("color", &[])],
);

pub(super) const CONE: Schema = plain(
    "[[cone]]",
    &[("apex", &[]), ("base", &[]), ("radius", &[]), ("material", &[]), ("color", &[])],
);

pub(super) const GENERATE: Schema = Schema {
    section: "[[generate]]",
    selector: "kind",
    kinds: &["grid", "field", "volume", "lattice", "sphereflake", "weekend"],
    default_kind: None,
    keys: &[
        ("seed", &["field", "volume", "lattice", "weekend"]),
        ("count", &["grid", "field", "volume", "lattice"]),
        ("spacing", &["grid"]),
        ("size", &["volume"]),
        ("radius", &["grid", "field", "volume", "lattice", "sphereflake"]),
        ("jitter", &["lattice"]),
        ("level", &["sphereflake"]),
        ("colors", &["field", "volume"]),
        ("mix", &["field"]),
        ("material", &["grid", "field", "volume", "lattice", "sphereflake"]),
    ],
};

pub(super) const FILE: Schema = plain(
    "[[file]]",
    &[
        ("path", &[]),
        ("format", &[]),
        ("topology", &[]),
        ("material", &[]),
        ("radius", &[]),
        ("scale", &[]),
    ],
);

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [&Schema; 21] = [
        &ROOT,
        &RENDER,
        &CAMERA,
        &LOOK,
        &COLOR_BAR,
        &LEGEND,
        &AXES,
        &SCALE_BAR,
        &LABEL,
        &LETTERING,
        &ENVIRONMENT,
        &GROUND,
        &SLICE,
        &LIGHT,
        &MATERIAL,
        &SPHERE,
        &STICK,
        &ELLIPSOID,
        &CONE,
        &GENERATE,
        &FILE,
    ];

    #[test]
    fn keys_refer_to_existing_kinds() {
        for schema in ALL {
            for (key, kinds) in schema.keys {
                let known = kinds.iter().all(|kind| schema.kinds.contains(kind));
                assert!(known, "{key} of {}", schema.section);
            }
        }
    }

    #[test]
    fn the_manual_mentions_every_key_and_kind() {
        let manual = include_str!("../../../../../scenes/README.md");
        for schema in ALL {
            let heading = match schema.section.strip_prefix('[') {
                Some(_) => format!("\n## `{}`\n", schema.section),
                None => "\n## Sections\n".to_owned(),
            };
            let section = manual.split_once(&heading).map_or("", |(_, rest)| {
                rest.split_once("\n## ").map_or(rest, |(section, _)| section)
            });
            for word in schema.names().chain(schema.kinds.iter().copied()) {
                let ends = ["`", "\"`", "]`", "]]`", ".NAME]`"].into_iter();
                let mut quoted = ends.zip(["`", "`\"", "`[", "`[[", "`["]);
                let found =
                    quoted.any(|(end, start)| section.contains(&[start, word, end].concat()));
                assert!(found, "`{word}` is missing under {} in scenes/README.md", schema.section);
            }
        }
    }
}
