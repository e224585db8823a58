//! The table of the keys of scene files, but for `[render]`, whose keys are those of
//! [`SETTINGS`](crate::settings::SETTINGS).

use super::kinds::Str::{Path, Text};
use super::kinds::Triple::{Direction, Point, Vector};
use super::kinds::{
    Backdrop, Entries, Flag, Letters, List, MapName, Optional, Points, Whole, Word,
};
use super::shared::{self, RADIUS};
use super::{Schema, Section, Visitor, key};
use crate::color::{Map, Range, Scale, Spacing};
use crate::image::Image;
use crate::scene::bodies::{ConeKeys, EllipsoidKeys, MeshKeys, StickKeys, TriangleKeys};
use crate::scene::generate::{Field, Generator, Grid, Lattice, Sphereflake, Volume, Weekend};
use crate::scene::particles::{Cell, Format, Model, TypeMaterial};
use crate::scene::{
    Anchor, AxisTripod, BRIGHTEST, Camera, ColorBar, ColorLegend, ConductorFresnel, Environment,
    EnvironmentMap, FramedSphere, Ground, Insets, Label, Lens, Lettering, Light, Look, Material,
    Measure, Pose, Projection, Rgb, ScaleBar, Slice, SliceMode,
};
use crate::settings::Limits::{
    self, AboveTo, Any, Below, Between, NotNegative, Positive, Share, Within,
};
use glam::DVec3;
use std::sync::Arc;

/// Returns the schema of a section.
type SchemaOf = fn() -> Schema;

/// The sections and their schemas, by the names of their keys; `title` is no section.
pub(in crate::scene) const SECTIONS: [(&str, SchemaOf); 24] = [
    ("render", Schema::render),
    ("camera", Schema::of::<Camera>),
    ("look", Schema::of::<Look>),
    ("color_bar", Schema::of::<ColorBar>),
    ("legend", Schema::of::<ColorLegend>),
    ("axes", Schema::of::<AxisTripod>),
    ("scale_bar", Schema::of::<ScaleBar>),
    ("label", Schema::of::<Label>),
    ("measure", Schema::of::<Measure>),
    ("lettering", Schema::of::<Lettering>),
    ("environment", Schema::of::<EnvironmentKeys>),
    ("ground", Schema::of::<GroundKeys>),
    ("slice", Schema::of::<Slice>),
    ("light", Schema::of::<Light>),
    ("material", Schema::of::<Material>),
    ("sphere", Schema::of::<SphereKeys>),
    ("stick", Schema::of::<StickKeys>),
    ("ellipsoid", Schema::of::<EllipsoidKeys>),
    ("cone", Schema::of::<ConeKeys>),
    ("triangle", Schema::of::<TriangleKeys>),
    ("mesh", Schema::of::<MeshKeys>),
    ("generate", Schema::of::<GenerateKeys>),
    ("file", Schema::of::<FileKeys>),
    ("style", Schema::of::<StyleKeys>),
];

/// Radiance and irradiance.
const LIGHT: Limits = Within(0.0, BRIGHTEST as f64);

/// Default reflectance of matte materials.
const GRAY: Rgb = Rgb::splat(0.7);

/// Index of refraction of glass.
const GLASS: f64 = 1.5;

/// Degrees: the sun's radius seen from the earth.
const SUN: f64 = 0.27;

impl Section for Camera {
    const NAME: &'static str = "[camera]";
    const EMPTY: fn() -> Self = Self::default;

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { projection, pose, up, lens, near, insets, zoom, framed } = self;
        let parallel = Projection::Orthographic { height: None };
        let kinds = [("perspective", Self::default().projection), ("orthographic", parallel)];
        keys.choose(key("projection", "perspective or parallel projection"), &kinds, projection);
        match projection {
            Projection::Perspective { fov } => {
                let help = "vertical field of view, degrees";
                keys.visit(key("fov", help), Between(0.0, 180.0), fov);
            }
            Projection::Orthographic { height } => {
                let help = "height of the image in the scene's unit";
                let default = "such that all spheres are framed";
                keys.visit(key("height", help).or(default), Optional(Positive), height);
            }
        }
        let looks = Pose::LookAt { eye: DVec3::ZERO, target: DVec3::ZERO };
        keys.form(&[(&["eye", "target"], looks), (&[], Self::default().pose)], pose);
        let mut fit = matches!(pose, Pose::Fit { .. }).then_some(true);
        let help = "place the camera as close as possible with all spheres in the image; replaces \
                    `eye` and `target`";
        keys.visit(key("fit", help).or("`true` without those"), Optional(Flag), &mut fit);
        if fit == Some(true) {
            let help = "write either fit = true with a direction, or eye and target";
            keys.forbid(&["eye", "target"], "fit = true", help);
        } else {
            let help = "remove it, or write fit = true instead of eye and target";
            let fitted = ["direction", "margin", "insets", "center", "radius"];
            keys.forbid(&fitted, "eye and target", help);
            if matches!(pose, Pose::Fit { .. }) {
                *pose = looks;
            }
        }
        match pose {
            Pose::LookAt { eye, target } => {
                let example = "eye = [x, y, z] and target = [x, y, z], or fit = true";
                let own = key("eye", "position of the camera").required(example);
                keys.visit(own.or("with `target`, or neither"), Point, eye);
                let example = "target = [x, y, z]: the point in the middle of the picture";
                let own = key("target", "point in the center of the image, not that of `eye`");
                keys.visit(own.required(example).or("with `eye`, or neither"), Point, target);
                if eye == target {
                    let help = "write the point that is in the middle of the picture";
                    let message = "`target` is the same point as `eye`";
                    keys.refuse(&["target"], message, Some(help));
                }
            }
            Pose::Fit { direction, margin } => {
                let help = "with `fit`: the view direction, from the camera into the scene";
                keys.visit(key("direction", help), Vector, direction);
                let help = "with `fit`: fraction of the image left empty at its edges";
                keys.visit(key("margin", help), Below(0.0, 1.0), margin);
                visit_framed(framed, keys);
            }
        }
        let help = "magnification about the middle of the image, or of what `fit` frames";
        let mut own = Some(*zoom).filter(|zoom| *zoom != 1.0);
        let (least, most) = (*Self::ZOOMS.start(), *Self::ZOOMS.end());
        keys.visit(key("zoom", help).or("1"), Optional(Within(least, most)), &mut own);
        *zoom = own.unwrap_or(1.0);
        keys.visit(key("up", "approximate up direction of the image"), Vector, up);
        let help = "distance of the near plane along the view axis, at which rays start";
        keys.visit(key("near", help), NotNegative, near);
        let mut aperture = lens.map(|lens| lens.aperture);
        let help = "diameter of the thin lens; 0 is a pinhole";
        keys.visit(key("aperture", help).or("0"), Optional(NotNegative), &mut aperture);
        let mut focus = lens.and_then(|lens| lens.focus);
        let help = "with `aperture`: focus distance along the view axis";
        let default = "the distance of `target`, or of the center of the spheres";
        keys.visit(key("focus", help).or(default), Optional(Positive), &mut focus);
        if aperture.is_none() {
            let help = "write aperture = the diameter of the lens, or remove focus";
            keys.forbid(&["focus"], "a pinhole", help);
        }
        *lens = aperture.map(|aperture| Lens { aperture, focus });
        let fits = matches!(pose, Pose::Fit { .. }) && *insets != Insets::default();
        let mut own = fits.then(|| insets.to_array());
        let help = "with `fit`: fractions of the image left empty at the left, the right, the bottom \
                    and the top, besides the margin";
        let default = "those that [annotations](#color_bar) need";
        let kind = Optional(List(Below(0.0, 1.0)));
        keys.visit(key("insets", help).or(default), kind, &mut own);
        if let Some([left, right, bottom, top]) = own {
            *insets = Insets { left, right, bottom, top };
        }
        keys.check("insets", List(Below(0.0, 1.0)), &insets.to_array());
        if let Pose::Fit { margin, .. } = pose
            && *insets != Insets::default()
            && (insets.left + insets.right).max(insets.bottom + insets.top) + *margin >= 1.0
        {
            let message = "`insets` and the margin leave no room for the spheres";
            let help = "write smaller fractions of the width and the height";
            keys.refuse(&["insets"], message, Some(help));
        }
    }
}

/// Visits the keys of the sphere that a fitted camera frames.
fn visit_framed<V: Visitor>(framed: &mut Option<FramedSphere>, keys: &mut V) {
    let mut center = framed.map(|sphere| sphere.center);
    let help = "with `fit`: center of a sphere that is framed instead of all bodies";
    keys.visit(key("center", help).or("with `radius`, or neither"), Optional(Point), &mut center);
    let mut radius = framed.map(|sphere| sphere.radius);
    let help = "with `fit`: radius of the sphere that is framed";
    keys.visit(
        key("radius", help).or("with `center`, or neither"),
        Optional(Positive),
        &mut radius,
    );
    let help = "write both center = [x, y, z] and radius, or neither";
    match (center, radius) {
        (Some(_), None) => keys.refuse(&["center"], "`center` has no `radius`", Some(help)),
        (None, Some(_)) => keys.refuse(&["radius"], "`radius` has no `center`", Some(help)),
        _ => (),
    }
    *framed = center.zip(radius).map(|(center, radius)| FramedSphere { center, radius });
}

impl Section for Look {
    const NAME: &'static str = "[look]";
    const EMPTY: fn() -> Self = Self::default;

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { background, depth_cue, outline, cell } = self;
        let help = "visible background, which does not change the light of the sky: the sky, a color \
                    (before `exposure`) that the camera sees instead of sky and suns, also through \
                    glass, or transparent, with alpha in PNG and EXR and only the shadows of a ground";
        keys.visit(key("background", help), Backdrop(LIGHT), background);
        let help =
            "fade distant spheres into the background, or into white without a background color";
        keys.visit(key("depth_cue", help), Flag, depth_cue);
        keys.visit(key("outline", "draw lines along the edges of spheres"), Flag, outline);
        let help = "periodic cell whose edges are drawn, hidden behind nearer spheres: a corner and \
                    the three edge vectors; with `fit`, the camera frames it too";
        let edges = |Cell { origin, vectors: [a, b, c], .. }| [origin, a, b, c];
        let mut own = cell.map(edges);
        keys.visit(key("cell", help), Optional(List(Point)), &mut own);
        *cell =
            own.map(|[origin, a, b, c]| Cell { origin, vectors: [a, b, c], periodic: [false; 3] });
    }
}

/// Visits the key of an annotation's position.
fn position<V: Visitor>(keys: &mut V, anchor: &mut Anchor, help: &'static str) {
    keys.visit(key("position", help), Word(&Anchor::ALL), anchor);
}

impl Section for ColorBar {
    const NAME: &'static str = "[color_bar]";
    const EMPTY: fn() -> Self = || {
        let scale = Scale::new(Map::default(), Range::UNIT);
        Self { scale, label: String::new(), position: Anchor::BottomRight }
    };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        // Colors for what is beyond the range have no words in a scene file.
        let Self { scale: Scale { map, reversed, range, .. }, label, position } = self;
        let mut ends = [range.low(), range.high()];
        let example = "range = [low, high]: the numbers at the ends of the map";
        let help = "the numbers at the two ends of the map, the lower one first";
        keys.visit(key("range", help).required(example), List(Any), &mut ends);
        let mut log = range.spacing() == Spacing::Logarithmic;
        keys.visit(key("log", "logarithmic scale"), Flag, &mut log);
        let spacing = if log { Spacing::Logarithmic } else { Spacing::Linear };
        match Range::new(ends[0], ends[1], spacing) {
            Ok(own) => *range = own,
            Err(error) => keys.refuse(&["range"], &error.to_string(), None),
        }
        keys.visit(key("map", "the color map"), MapName, map);
        keys.visit(key("reversed", "reverse the color map"), Flag, reversed);
        let help = "label; in `v_x` and `m^2`, and in `v_{max}`, what follows a mark is a subscript or superscript";
        keys.visit(key("label", help), Text, label);
        let help = "position of the color bar, which is horizontal at `\"top\"` and `\"bottom\"`";
        self::position(keys, position, help);
    }
}

impl Section for ColorLegend {
    const NAME: &'static str = "[legend]";
    const EMPTY: fn() -> Self = || Self { position: Anchor::TopRight, ..Self::default() };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { label, entries, omitted, position } = self;
        let example = "entries = [[\"name\", color], ...]: a name and a color for each line";
        let help = "names and colors from top to bottom";
        keys.visit(key("entries", help).required(example), Entries(Share), entries);
        let help = "number of further names that a last line mentions";
        keys.visit(key("omitted", help), Whole(0, u32::MAX as u64), omitted);
        let help = "first line, with subscripts and superscripts as in a [color bar](#color_bar)";
        keys.visit(key("label", help), Text, label);
        self::position(keys, position, "position");
    }
}

impl Section for AxisTripod {
    const NAME: &'static str = "[axes]";
    const EMPTY: fn() -> Self = Self::default;

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { directions, names, position } = self;
        let help = "directions of the arrows, which have equal lengths in space";
        keys.visit(key("directions", help), List(Vector), directions);
        keys.visit(key("names", "names of the arrows"), List(Text), names);
        self::position(keys, position, "position");
    }
}

impl Section for ScaleBar {
    const NAME: &'static str = "[scale_bar]";
    const EMPTY: fn() -> Self = Self::default;

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { length, unit, position } = self;
        let default = "a round number, up to a quarter of the image's width";
        let help = "length in the scene's unit";
        keys.visit(key("length", help).or(default), Optional(Positive), length);
        keys.visit(key("unit", "name of the scene's unit"), Text, unit);
        self::position(keys, position, "position");
    }
}

impl Section for Label {
    const NAME: &'static str = "[[label]]";
    const EMPTY: fn() -> Self = || Self { position: Anchor::TopLeft, ..Self::default() };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { text, position, at } = self;
        let own = key("text", "text, of one or more lines").required("text = \"the label\"");
        keys.visit(own, Text, text);
        self::position(keys, position, "position");
        let help = "point of the scene that the text is over, instead of a `position`";
        keys.visit(key("at", help).or("none"), Optional(Point), at);
    }
}

impl Section for Measure {
    const NAME: &'static str = "[[measure]]";
    const EMPTY: fn() -> Self = Self::default;

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { points, unit } = self;
        let example = "points = [[x, y, z], [x, y, z]]: two to four points";
        let help = "two points for their distance, three for the angle at the second, four for the dihedral about the line \
                    from the second to the third";
        keys.visit(key("points", help).required(example), Points(2, 4), points);
        keys.visit(key("unit", "name of the scene's unit, for distances"), Text, unit);
    }
}

impl Section for Lettering {
    const NAME: &'static str = "[lettering]";
    const EMPTY: fn() -> Self = Self::default;

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { size, color } = self;
        let default = "`\"7pt\"` if the image has a `dpi`, or else 0.03";
        let help = "size of the letters; smaller where annotations would overlap";
        keys.visit(key("size", help).or(default), Optional(Letters), size);
        let default = "dark or light, in contrast with the background";
        keys.visit(key("color", "color of letters").or(default), Optional(LIGHT), color);
    }
}

/// `[environment]`.
#[derive(Clone)]
pub(in crate::scene) struct EnvironmentKeys {
    pub(in crate::scene) environment: Environment,
    /// The path of the picture's file, if there is a picture.
    pub(in crate::scene) file: String,
}

impl Section for EnvironmentKeys {
    const NAME: &'static str = "[environment]";
    const EMPTY: fn() -> Self =
        || Self { environment: Environment::default(), file: String::new() };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Environment { map, illuminates } = &mut self.environment;
        let (bottom, top, up) = (Rgb::ONE, Rgb::new(0.5, 0.7, 1.0), DVec3::Y);
        let image = Arc::new(Image { width: 0, height: 0, pixels: Vec::new() });
        let kinds = [
            ("constant", EnvironmentMap::Constant(Rgb::ONE)),
            ("gradient", EnvironmentMap::Gradient { bottom, top, up }),
            ("picture", EnvironmentMap::Picture { image, up, rotation: 0.0, scale: 1.0 }),
        ];
        let help = "constant radiance, a gradient, or an environment map";
        keys.choose(key("kind", help), &kinds, map);
        let up_help = "up direction";
        match map {
            EnvironmentMap::Constant(color) => {
                keys.visit(key("color", "the radiance"), LIGHT, color);
            }
            EnvironmentMap::Gradient { bottom, top, up } => {
                keys.visit(key("bottom", "radiance from straight below"), LIGHT, bottom);
                let help = "radiance from straight above; in between, it is linear in the cosine of \
                            the angle to `up`";
                keys.visit(key("top", help), LIGHT, top);
                keys.visit(key("up", up_help), Direction, up);
            }
            EnvironmentMap::Picture { image: _, up, rotation, scale } => {
                let example = "file = \"sky.hdr\": a latitude-longitude picture";
                let help = "latitude-longitude image whose first row is at `up`, seen from inside as \
                            it is painted; its values are linear, finite and 0 or more";
                keys.visit(key("file", help).required(example), Path, &mut self.file);
                keys.visit(key("up", up_help), Direction, up);
                let help = "rotation of the image about `up` in degrees";
                keys.visit(key("rotation", help), Any, rotation);
                keys.visit(key("scale", "factor for its values"), NotNegative, scale);
            }
        }
        let help = "whether the environment lights diffuse surfaces; with `false` only the camera, \
                    mirrors and glass see it";
        keys.visit(key("illuminates", help), Flag, illuminates);
    }
}

/// `[ground]`.
#[derive(Clone)]
pub(in crate::scene) struct GroundKeys {
    /// The ground, with any material.
    pub(in crate::scene) ground: Ground,
    /// The name of its material, in quotes.
    pub(in crate::scene) material: Option<String>,
}

impl Section for GroundKeys {
    const NAME: &'static str = "[ground]";
    const EMPTY: fn() -> Self = || {
        let ground = Ground { normal: DVec3::Y, height: 0.0, material: 0 };
        Self { ground, material: None }
    };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Ground { normal, height, material: _ } = &mut self.ground;
        keys.visit(key("normal", "normal of the plane"), Direction, normal);
        let help = "signed distance from the origin along the normal";
        keys.visit(key("height", help), Any, height);
        let help = "material; neither a dielectric nor an emitter";
        shared::material(keys, &mut self.material, help);
    }
}

impl Section for Slice {
    const NAME: &'static str = "[[slice]]";
    const EMPTY: fn() -> Self =
        || Self { normal: DVec3::Y, distance: 0.0, mode: SliceMode::default() };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { normal, distance, mode } = self;
        let example = "normal = [x, y, z], toward the part that is cut away";
        let help = "normal of the plane, toward the side that is cut away";
        keys.visit(key("normal", help).required(example), Direction, normal);
        let help = "signed distance of the plane from the origin along the normal";
        keys.visit(key("distance", help), Any, distance);
        let help = "`\"remove\"`: removes spheres whose centers are cut away, and keeps others whole; \
                    `\"caps\"`: cuts spheres at the plane, with flat caps of their own color; \
                    `\"hide\"`: hides spheres whose centers are cut away from camera rays, but keeps \
                    their shadows and reflections";
        keys.visit(key("mode", help), Word(&SliceMode::ALL), mode);
    }
}

impl Section for Light {
    const NAME: &'static str = "[[light]]";
    const EMPTY: fn() -> Self =
        || Self::Sun { direction: DVec3::Y, irradiance: Rgb::ONE, angular_radius: SUN };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let point = Self::Point { position: DVec3::ZERO, intensity: Rgb::ONE, falloff: true };
        let kinds = [("sun", (Self::EMPTY)()), ("point", point)];
        keys.choose(key("kind", "a disc at infinity, or a point").required(""), &kinds, self);
        match self {
            Self::Sun { direction, irradiance, angular_radius } => {
                let example = "direction = [x, y, z], toward the sun";
                let help = "direction from the scene toward the sun";
                keys.visit(key("direction", help).required(example), Direction, direction);
                let example = "irradiance = [r, g, b], or a number for white";
                let help = "irradiance of a plane that faces the sun";
                keys.visit(key("irradiance", help).required(example), LIGHT, irradiance);
                let help = "angular radius in degrees; with 0, shadows are sharp and mirrors do not \
                            show the sun";
                keys.visit(key("angular_radius", help), Below(0.0, 90.0), angular_radius);
            }
            Self::Point { position, intensity, falloff } => {
                let own = key("position", "position").required("position = [x, y, z]");
                keys.visit(own, Point, position);
                let example = "intensity = [r, g, b], or a number for white";
                let help = "radiant intensity; without falloff, the irradiance at any distance";
                keys.visit(key("intensity", help).required(example), NotNegative, intensity);
                let help = "inverse-square falloff, or none as in NFF files";
                let words = [("square", true), ("none", false)];
                keys.visit(key("falloff", help), Word(&words), falloff);
            }
        }
    }
}

impl Section for Material {
    const NAME: &'static str = "[material.NAME]";
    const EMPTY: fn() -> Self = || Self::Lambertian { color: GRAY };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let fresnel = ConductorFresnel::Schlick(GRAY);
        let kinds = [
            ("lambertian", (Self::EMPTY)()),
            ("conductor", Self::Conductor { fresnel, roughness: 0.0 }),
            ("dielectric", Self::Dielectric { ior: GLASS, color: Rgb::ONE }),
            ("plastic", Self::Plastic { color: GRAY, ior: GLASS }),
            ("reflective", Self::Reflective { color: GRAY, diffuse: 0.5, mirror: 0.5 }),
            ("emitter", Self::Emitter { radiance: Rgb::ONE, albedo: Rgb::ZERO }),
        ];
        let mut opacity = match self {
            Self::Translucent { opacity, .. } => Some(*opacity),
            _ => None,
        };
        let mut surface = self.surface().clone();
        keys.choose(key("kind", "see below").required(""), &kinds, &mut surface);
        let color_help = "fraction of light that is reflected or transmitted";
        match &mut surface {
            Self::Lambertian { color } => keys.visit(key("color", color_help), Share, color),
            Self::Conductor { fresnel, roughness } => {
                conductor(keys, fresnel, color_help);
                let help = "GGX alpha; 0 is a smooth mirror";
                keys.visit(key("roughness", help), Share, roughness);
            }
            Self::Dielectric { ior, color } => {
                keys.visit(key("ior", "index of refraction"), Positive, ior);
                keys.visit(key("color", color_help), Share, color);
            }
            Self::Plastic { color, ior } => {
                keys.visit(key("color", color_help), Share, color);
                keys.visit(key("ior", "index of refraction"), AboveTo(1.0, f64::MAX), ior);
            }
            Self::Reflective { color, diffuse, mirror } => {
                keys.visit(key("color", color_help), Share, color);
                keys.visit(key("diffuse", "fraction reflected diffusely"), Share, diffuse);
                let help = "fraction mirrored; the sum with `diffuse` is at most 1";
                keys.visit(key("mirror", help), Share, mirror);
                let sum = *diffuse + *mirror;
                keys.check("diffuse + mirror", Share, &sum);
                if sum > 1.0 {
                    let message = format!("the sum of `diffuse` and `mirror` is {sum}");
                    let help = "the sum must be at most 1; the default of each is 0.5";
                    keys.refuse(&["mirror", "diffuse"], &message, Some(help));
                }
            }
            Self::Emitter { radiance, albedo } => {
                let example = "radiance = [r, g, b], or a number for white";
                keys.visit(key("radiance", "emitted radiance").required(example), LIGHT, radiance);
                keys.visit(key("albedo", "reflectance"), Share, albedo);
            }
            Self::Translucent { .. } => (),
        }
        if surface.is_solid() {
            let help = "fraction of the light from behind that a body hides, without refraction";
            keys.visit(key("opacity", help).or("1"), Optional(Share), &mut opacity);
        }
        *self = opacity.map_or_else(|| surface.clone(), |opacity| surface.with_opacity(opacity));
    }
}

fn conductor<V: Visitor>(keys: &mut V, fresnel: &mut ConductorFresnel, help: &'static str) {
    let exact = ConductorFresnel::Exact { eta: Rgb::ONE, k: Rgb::ONE };
    keys.form(&[(&["eta", "k"], exact), (&[], *fresnel)], fresnel);
    let mut constant = matches!(fresnel, ConductorFresnel::Constant(_));
    match fresnel {
        ConductorFresnel::Schlick(color) | ConductorFresnel::Constant(color) => {
            let mut color = *color;
            let example = "color = [r, g, b], the reflectance at normal incidence, or eta and k";
            let own = key("color", help).required(example);
            keys.visit(own.or("*required* without `eta` and `k`"), Share, &mut color);
            let words = [("schlick", false), ("constant", true)];
            let help = "reflectance by `color` rises to 1 at grazing angles (`\"schlick\"`), or is \
                        constant (`\"constant\"`)";
            keys.visit(key("fresnel", help), Word(&words), &mut constant);
            *fresnel = if constant {
                ConductorFresnel::Constant(color)
            } else {
                ConductorFresnel::Schlick(color)
            };
        }
        ConductorFresnel::Exact { eta, k } => {
            let example = "eta = [r, g, b]: the real part of the index of refraction";
            let own = key("eta", "real part of the index of refraction, instead of `color`");
            keys.visit(own.required(example).or("with `k`, or neither"), Positive, eta);
            let example = "k = [r, g, b]: the imaginary part of the index of refraction";
            let own = key("k", "imaginary part of the index of refraction");
            keys.visit(own.required(example).or("with `eta`, or neither"), Positive, k);
            keys.forbid(&["color", "fresnel"], "eta and k", "write either color, or eta and k");
        }
    }
}

/// `[[sphere]]`.
#[derive(Clone)]
pub(in crate::scene) struct SphereKeys {
    pub(in crate::scene) center: DVec3,
    pub(in crate::scene) radius: f64,
    pub(in crate::scene) material: Option<String>,
    pub(in crate::scene) color: Rgb,
}

impl Section for SphereKeys {
    const NAME: &'static str = "[[sphere]]";
    const EMPTY: fn() -> Self =
        || Self { center: DVec3::ZERO, radius: 1.0, material: None, color: Rgb::ONE };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { center, radius, material, color } = self;
        keys.visit(key("center", "center").required("center = [x, y, z]"), Point, center);
        keys.visit(key("radius", "radius").required(RADIUS), Positive, radius);
        shared::material(keys, material, "material");
        shared::color(keys, color);
    }
}

/// `[[generate]]`.
#[derive(Clone)]
pub(in crate::scene) struct GenerateKeys {
    pub(in crate::scene) generator: Generator,
    pub(in crate::scene) seed: u64,
    pub(in crate::scene) material: Option<String>,
}

impl Section for GenerateKeys {
    const NAME: &'static str = "[[generate]]";
    const EMPTY: fn() -> Self =
        || Self { generator: Generator::Grid(Grid::default()), seed: 0, material: None };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let kinds = [
            ("grid", Generator::Grid(Grid::default())),
            ("field", Generator::Field(Field::default())),
            ("volume", Generator::Volume(Volume::default())),
            ("lattice", Generator::Lattice(Lattice::default())),
            ("sphereflake", Generator::Sphereflake(Sphereflake::default())),
            ("weekend", Generator::Weekend(Weekend)),
        ];
        let Self { generator, seed, material } = self;
        keys.choose(key("kind", "see below").required(""), &kinds, generator);
        if !matches!(generator, Generator::Grid(_) | Generator::Sphereflake(_)) {
            keys.visit(key("seed", "random seed"), Whole(0, u64::MAX), seed);
        }
        let (sides, radius_help) = ("number of spheres along each side", "radius of all spheres");
        let radii_help = "least and greatest radius";
        let (whole, positive) = (Whole(1, u64::MAX), Positive);
        let colors_help = "give each sphere a random color";
        match generator {
            Generator::Grid(Grid { count, spacing, radius }) => {
                keys.visit(key("count", sides), whole, count);
                keys.visit(key("spacing", "distance of neighboring centers"), positive, spacing);
                keys.visit(key("radius", radius_help), positive, radius);
            }
            Generator::Field(Field { count, radius, colors, mix }) => {
                keys.visit(key("count", sides), whole, count);
                let help = "least and greatest radius, at most 0.5";
                keys.visit(key("radius", help), List(positive), radius);
                keys.visit(key("colors", colors_help), Flag, colors);
                let help = "fractions of diffuse, metal and glass spheres, not all 0";
                let kind = Optional(List(NotNegative));
                keys.visit(key("mix", help).or("one material"), kind, mix);
                if mix.is_some() {
                    let help = "a mix uses the materials diffuse, metal and glass, which the scene \
                                may define";
                    keys.forbid(&["material"], "mix", help);
                }
            }
            Generator::Volume(Volume { count, size, radius, colors }) => {
                keys.visit(key("count", "total number of spheres"), whole, count);
                let default = "the cube root of `count`";
                keys.visit(key("size", "edge of the cube").or(default), Optional(positive), size);
                let kind = Optional(List(positive));
                let default = "0.2 to 0.4 of the mean spacing";
                keys.visit(key("radius", radii_help).or(default), kind, radius);
                keys.visit(key("colors", colors_help), Flag, colors);
            }
            Generator::Lattice(Lattice { count, radius, jitter }) => {
                keys.visit(key("count", "number of cells along each edge"), whole, count);
                keys.visit(key("radius", radius_help), positive, radius);
                let help = "standard deviation of thermal displacements along each axis, relative to \
                            the distance of neighbors";
                keys.visit(key("jitter", help), NotNegative, jitter);
            }
            Generator::Sphereflake(Sphereflake { level, radius }) => {
                let mut own = u64::from(*level);
                let help = "number of generations below the first sphere, at most 10; level L has \
                            (9^(L + 1) - 1) / 8 spheres";
                keys.visit(key("level", help), Whole(0, u32::MAX as u64), &mut own);
                *level = own as u32;
                keys.visit(key("radius", "radius of the first sphere"), positive, radius);
            }
            Generator::Weekend(Weekend) => return,
        }
        shared::material(keys, material, "material of all spheres; not with `mix`");
    }
}

/// `[[file]]`.
#[derive(Clone)]
pub(in crate::scene) struct FileKeys {
    pub(in crate::scene) path: String,
    pub(in crate::scene) format: Option<Format>,
    pub(in crate::scene) topology: Option<String>,
    pub(in crate::scene) material: Option<String>,
    pub(in crate::scene) radius: Option<f64>,
    pub(in crate::scene) scale: f64,
}

impl Section for FileKeys {
    const NAME: &'static str = "[[file]]";
    const EMPTY: fn() -> Self = || {
        let (path, material) = (String::new(), None);
        Self { path, format: None, topology: None, material, radius: None, scale: 1.0 }
    };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { path, format, topology, material, radius, scale } = self;
        let own = key("path", "path of the file").required("path = \"particles.csv\"");
        keys.visit(own, Path, path);
        let formats = Optional(Word(&Format::ALL));
        keys.visit(key("format", "see below").or("detected from the content"), formats, format);
        let help = "file that names the particles of a trajectory";
        keys.visit(key("topology", help), Optional(Path), topology);
        shared::material(keys, material, "material of spheres without one in the file");
        let help = "radius of spheres without one in the file, in the scene's unit; overrides the \
                    elements' radii";
        let default = "the element's, or half of the mean spacing, with a warning";
        keys.visit(key("radius", help).or(default), Optional(Positive), radius);
        let help = "factor for the file's positions and radii";
        keys.visit(key("scale", help), Positive, scale);
    }
}

/// `[[style]]`: the look of some particles of all `[[file]]`s. Colors are in the words of options.
#[derive(Clone)]
pub(in crate::scene) struct StyleKeys {
    pub(in crate::scene) select: String,
    pub(in crate::scene) model: Option<Model>,
    pub(in crate::scene) color: Option<String>,
    pub(in crate::scene) map: Option<String>,
    pub(in crate::scene) range: Option<[f64; 2]>,
    pub(in crate::scene) log: bool,
    pub(in crate::scene) radius: Option<f64>,
    pub(in crate::scene) scale: Option<f64>,
    pub(in crate::scene) bonds: Option<bool>,
    pub(in crate::scene) bond_radius: Option<f64>,
    pub(in crate::scene) opacity: Option<f64>,
    pub(in crate::scene) polyhedra: Option<String>,
    pub(in crate::scene) polyhedra_opacity: Option<f64>,
    pub(in crate::scene) material: Option<TypeMaterial>,
    pub(in crate::scene) visible: bool,
}

impl Section for StyleKeys {
    const NAME: &'static str = "[[style]]";
    const EMPTY: fn() -> Self = || Self {
        select: String::new(),
        model: None,
        color: None,
        map: None,
        range: None,
        log: false,
        radius: None,
        scale: None,
        bonds: None,
        bond_radius: None,
        opacity: None,
        polyhedra: None,
        polyhedra_opacity: None,
        material: None,
        visible: true,
    };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { select, model, color, map, range, log, radius, scale, .. } = self;
        let own = key("select", "selection of particles, as in `--select`");
        keys.visit(own.required("select = \"resname ATP\""), Text, select);
        let help = "the way in which particles and their bonds are drawn";
        keys.visit(
            key("model", help).or("spheres without bonds"),
            Optional(Word(&Model::ALL)),
            model,
        );
        let help =
            "color by name or `#rrggbb`, `\"element\"`, or a column or an expression over columns";
        keys.visit(key("color", help).or("the file's, or the element's"), Optional(Text), color);
        let help = "color map of a column of numbers, reversed with `_r` after its name";
        keys.visit(key("map", help).or("`\"viridis\"`"), Optional(Text), map);
        let help = "numbers at the ends of the map";
        keys.visit(
            key("range", help).or("the minimum and the maximum"),
            Optional(List(Any)),
            range,
        );
        keys.visit(key("log", "logarithmic map"), Flag, log);
        let help = "radius as it is drawn, in the scene's unit";
        keys.visit(key("radius", help).or("the model's"), Optional(Positive), radius);
        keys.visit(key("scale", "factor on the radius").or("1"), Optional(Positive), scale);
        let Self { bonds, bond_radius, opacity, polyhedra, polyhedra_opacity, .. } = self;
        let help = "whether bonds are drawn";
        keys.visit(key("bonds", help).or("as the model has them"), Optional(Flag), bonds);
        let help = "radius of the sticks of bonds, in the scene's unit";
        keys.visit(key("bond_radius", help).or("the model's"), Optional(Positive), bond_radius);
        keys.visit(key("opacity", "opacity").or("1"), Optional(Share), opacity);
        let help = "coordination polyhedra of these particles, as in `\"Ti-O\"` or `\"Ti-O<2.5\"`";
        keys.visit(key("polyhedra", help).or("none"), Optional(Text), polyhedra);
        let help = "opacity of their faces";
        keys.visit(key("polyhedra_opacity", help).or("0.7"), Optional(Share), polyhedra_opacity);
        let Self { material, visible, .. } = self;
        let default = "that of the file, or of `[[file]]`";
        let words = Optional(Word(&TypeMaterial::ALL));
        keys.visit(key("material", "material").or(default), words, material);
        keys.visit(key("visible", "whether the particles are drawn"), Flag, visible);
    }
}
