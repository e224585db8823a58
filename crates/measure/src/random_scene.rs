//! Random scenes for comparisons: spheres of all materials under all lights, coincident, touching and nested ones among them, cameras
//! inside of them, at any scale.

use glam::DVec3;
use spherule_core::internals::random::Random;
use std::fmt::{Display, Write};

/// Returns a scene file, the same for a seed. It has spheres alone, opaque or of glass, and no slices.
pub fn random_scene(seed: u64) -> String {
    let random = &mut Random::new(seed);
    RandomScene::of_spheres(random).0.text
}

/// Returns a scene file, the same for a seed, with bodies of all kinds, translucent ones among them, and slices, which cut no
/// glass.
pub fn random_scene_of_all_bodies(seed: u64) -> String {
    let random = &mut Random::new(seed);
    let (mut scene, spheres) = RandomScene::of_spheres(random);
    scene.add_bodies(random, &spheres);
    (0..random.index(3)).for_each(|_| scene.add_slice(random));
    scene.text
}

/// A scene file, whose points and lengths are those of a scene in the cube from -2 to 2, moved and scaled.
struct RandomScene {
    text: String,
    scale: f64,
    offset: DVec3,
}

/// Kinds of materials; conductors are of a color, and then of indices of refraction.
const KINDS: [&str; 9] = [
    "lambertian",
    "lambertian",
    "conductor",
    "conductor",
    "dielectric",
    "dielectric",
    "plastic",
    "reflective",
    "emitter",
];

/// A center and a radius, before they are moved.
type Sphere = (DVec3, f64);

impl RandomScene {
    /// Returns a scene of spheres, and these.
    fn of_spheres(random: &mut Random) -> (Self, Vec<Sphere>) {
        let scale = if random.coin() { 1.0 } else { random.decades([-4.0, 4.0]) };
        let far = if random.index(4) == 0 { random.decades([0.0, 3.0]) } else { 0.0 };
        let mut scene = Self { text: String::new(), scale, offset: random.in_cube() * far };
        scene.add_settings(random);
        let materials = scene.add_materials(random);
        scene.add_environment(random);
        (0..random.index(4)).for_each(|_| scene.add_light(random));
        scene.add_ground(random);
        let spheres = scene.add_spheres(random, &materials);
        scene.add_camera(random, &spheres);
        (scene, spheres)
    }

    fn line(&mut self, text: impl Display) {
        // A string takes all that is written.
        let _ = writeln!(self.text, "{text}");
    }

    fn set(&mut self, key: &str, value: impl Display) {
        self.line(format_args!("{key} = {value}"));
    }

    fn set_name(&mut self, key: &str, name: &str) {
        self.line(format_args!("{key} = {name:?}"));
    }

    fn set_number(&mut self, key: &str, number: f64) {
        self.line(format_args!("{key} = {number:?}"));
    }

    fn set_length(&mut self, key: &str, length: f64) {
        self.set_number(key, self.scale * length);
    }

    fn set_point(&mut self, key: &str, point: DVec3) {
        let point = self.scale * (point + self.offset);
        self.line(format_args!("{key} = {:?}", point.to_array()));
    }

    fn add_settings(&mut self, random: &mut Random) {
        self.line("[render]\ndenoise = \"off\"");
        let (width, height) = (12 + random.index(20), 8 + random.index(20));
        self.line(format_args!("size = [{width}, {height}]"));
        // Sometimes in several passes.
        let most = if random.index(8) == 0 { 50 } else { 5 };
        self.set("spp", 1 + random.index(most));
        self.set("seed", random.index(1000));
        match random.index(8) {
            0 => {
                self.set_name("integrator", "ao");
                if random.coin() {
                    self.set_length("ao_distance", random.decades([-1.0, 1.0]));
                }
            }
            1 | 2 => {
                self.set_name("integrator", "whitted");
                self.set("shadow_samples", 1 + random.index(20));
            }
            _ => {
                self.set_name(
                    "light_choice",
                    one_of(random, &["tree", "tree", "power", "uniform"]),
                );
                self.set("caustics", random.index(4) > 0);
            }
        }
        let bounded = random.coin();
        if bounded {
            self.set("depth", random.index(9));
        }
        match random.index(4) {
            0 if bounded => self.set_name("roulette", "none"),
            1 => self.set_number("roulette", random.between([0.3, 0.95])),
            _ => {}
        }
        self.set_name("filter", one_of(random, &["box", "gaussian", "blackman-harris"]));
        if random.index(3) == 0 {
            self.line("[look]");
            let backgrounds = ["\"white\"", "\"transparent\"", "[0.1, 0.2, 0.9]"];
            self.set("background", one_of(random, &backgrounds));
        }
    }

    /// Adds materials, which may all be of one kind, and returns their names.
    fn add_materials(&mut self, random: &mut Random) -> Vec<String> {
        let count = 1 + random.index(6);
        let only = (random.index(3) == 0).then(|| random.index(KINDS.len()));
        let names: Vec<String> = (0..count).map(|row| format!("m{row}")).collect();
        for name in &names {
            self.line(format_args!("[material.{name}]"));
            let kind = random.index(KINDS.len());
            self.add_material(random, only.unwrap_or(kind));
        }
        names
    }

    fn add_material(&mut self, random: &mut Random, kind: usize) {
        self.set_name("kind", KINDS[kind]);
        match kind {
            2 => self.set_name("fresnel", one_of(random, &["schlick", "constant"])),
            3 => {
                self.set_number("eta", random.decades([-1.0, 1.0]));
                self.set_number("k", random.decades([-1.0, 1.0]));
            }
            4 | 5 => match random.index(4) {
                0 => self.set_number("ior", 1.0),
                1 => self.set_number("ior", random.between([0.5, 1.0])),
                _ => self.set_number("ior", random.between([1.0, 2.5])),
            },
            6 => self.set_number("ior", random.between([1.01, 2.5])),
            7 => {
                let diffuse = random.unit();
                self.set_number("diffuse", diffuse);
                self.set_number("mirror", (1.0 - diffuse) * random.unit());
            }
            8 => self.set_number("radiance", random.decades([-1.0, 3.0])),
            _ => {}
        }
        if kind == 2 || kind == 3 {
            let smooth = random.coin();
            self.set_number("roughness", if smooth { 0.0 } else { random.unit() });
        }
        match kind {
            3 => {}
            8 => self.set("albedo", color(random)),
            _ => self.set("color", color(random)),
        }
    }

    fn add_environment(&mut self, random: &mut Random) {
        let kind = random.index(4);
        if kind > 0 {
            self.line("[environment]");
        }
        match kind {
            0 => {}
            1 => {
                self.set_name("kind", "gradient");
                self.set("bottom", color(random));
                self.set("top", color(random));
                self.set("up", direction(random));
            }
            _ => {
                self.set("color", color(random));
                self.set("illuminates", kind == 2);
            }
        }
    }

    fn add_light(&mut self, random: &mut Random) {
        self.line("[[light]]");
        if random.coin() {
            let radius = match random.index(4) {
                0 => 0.0,
                1 => 0.27,
                2 => random.between([0.0, 10.0]),
                _ => random.between([0.0, 89.0]),
            };
            self.set_name("kind", "sun");
            self.set("direction", direction(random));
            self.set_number("irradiance", random.decades([-1.0, 1.0]));
            self.set_number("angular_radius", radius);
        } else {
            let fades = random.coin();
            let factor = if fades { self.scale * self.scale } else { 1.0 };
            self.set_name("kind", "point");
            self.set_point("position", random.in_cube() * 5.0);
            self.set_name("falloff", if fades { "square" } else { "none" });
            self.set_number("intensity", factor * random.decades([-1.0, 1.0]));
        }
    }

    fn add_ground(&mut self, random: &mut Random) {
        if random.coin() {
            let normal = random.direction();
            self.line("[ground]");
            self.line(format_args!("normal = {:?}", normal.to_array()));
            self.set_length("height", random.between([-3.0, 0.0]) + normal.dot(self.offset));
        }
    }

    /// Adds spheres, and returns them.
    fn add_spheres(&mut self, random: &mut Random, materials: &[String]) -> Vec<Sphere> {
        let most = [4, 40, 40, 400][random.index(4)];
        let usual = random.decades([-2.0, 0.3]);
        let spread = random.unit();
        let mut spheres: Vec<Sphere> = Vec::new();
        for _ in 0..=random.index(most) {
            let alone = (random.in_cube() * 2.0, usual * random.decades([-spread, spread]));
            let other = spheres.get(random.index(spheres.len())).copied();
            let sphere = other.map_or(alone, |other| beside(random, other, alone));
            spheres.push(sphere);
            self.line("[[sphere]]");
            self.set_point("center", sphere.0);
            self.set_length("radius", sphere.1);
            self.set_name("material", &materials[random.index(materials.len())]);
            if random.index(3) == 0 {
                self.set("color", color(random));
            }
        }
        spheres
    }

    /// Adds bodies of other kinds beside spheres, and translucent spheres: most often where the others are.
    fn add_bodies(&mut self, random: &mut Random, spheres: &[Sphere]) {
        const OPAQUE: [usize; 5] = [0, 2, 3, 6, 7];
        let names: Vec<String> = (0..3).map(|row| format!("b{row}")).collect();
        for name in &names {
            self.line(format_args!("[material.{name}]"));
            let kind = OPAQUE[random.index(OPAQUE.len())];
            self.add_material(random, kind);
            if random.coin() {
                self.set_number("opacity", [0.0, 0.3, random.unit(), 1.0][random.index(4)]);
            }
        }
        let only = (random.index(3) == 0).then(|| random.index(4));
        let most = [4, 30][random.index(2)];
        for _ in 0..random.index(most) {
            let [first, second] = [0; 2].map(|_| spheres[random.index(spheres.len())]);
            let kind = random.index(4);
            self.add_body(random, only.unwrap_or(kind), [first, second]);
            self.set_name("material", &names[random.index(names.len())]);
        }
    }

    /// Adds a stick, an ellipsoid, a cone or a sphere, at or between two spheres.
    fn add_body(&mut self, random: &mut Random, kind: usize, [first, second]: [Sphere; 2]) {
        let place = if random.coin() { first.0 } else { random.in_cube() * 2.0 };
        let size = first.1 * [1.0, 0.5, 1.0, random.decades([-1.0, 1.0])][random.index(4)];
        match kind {
            0 => {
                self.line("[[stick]]");
                self.set_point("from", place);
                self.set_point("to", second.0);
                self.set_length("radius", size);
                if random.coin() {
                    self.set("colors", format_args!("[{}, {}]", color(random), color(random)));
                }
            }
            1 => {
                let axes = [0; 3].map(|_| self.scale * size * random.decades([-0.5, 0.5]));
                let [x, y, z] = random.direction().to_array();
                self.line("[[ellipsoid]]");
                self.set_point("center", place);
                self.set("semi_axes", format_args!("{axes:?}"));
                if random.coin() {
                    self.set("orientation", format_args!("{:?}", [random.unit(), x, y, z]));
                }
            }
            2 => {
                let apex = place + 2.0 * size * random.direction();
                self.line("[[cone]]");
                self.set_point("apex", apex);
                self.set_point("base", place);
                self.set_length("radius", size);
            }
            _ => {
                self.line("[[sphere]]");
                self.set_point("center", place);
                self.set_length("radius", size);
            }
        }
    }

    /// Adds a slice; caps must not cut glass.
    fn add_slice(&mut self, random: &mut Random) {
        let modes: &[&str] = if self.text.contains("dielectric") {
            &["remove", "hide"]
        } else {
            &["remove", "hide", "caps", "caps"]
        };
        let normal = if random.coin() { DVec3::X } else { random.direction() };
        self.line("[[slice]]");
        self.set("normal", format_args!("{:?}", normal.to_array()));
        self.set_length("distance", random.between([-1.0, 2.0]) + normal.dot(self.offset));
        self.set_name("mode", one_of(random, modes));
    }

    fn add_camera(&mut self, random: &mut Random, spheres: &[Sphere]) {
        self.line("[camera]");
        match random.index(4) {
            0 => self.set_name("projection", "orthographic"),
            1 => {
                self.set_name("projection", "orthographic");
                self.set_length("height", random.decades([-1.0, 1.0]));
            }
            2 => self.set_number("fov", random.between([1.0, 150.0])),
            _ => {}
        }
        let (target, size) = spheres[random.index(spheres.len())];
        match random.index(4) {
            0 => {
                self.set("fit", true);
                self.set("direction", direction(random));
            }
            1 => {
                let (center, radius) = spheres[random.index(spheres.len())];
                self.set_point("eye", center + 0.9 * radius * random.in_cube());
                self.set_point("target", target + size * 1.01 * random.direction());
            }
            _ => {
                self.set_point("eye", random.direction() * random.decades([0.0, 1.5]));
                self.set_point("target", target + 0.1 * random.in_cube());
            }
        }
        if random.index(4) == 0 {
            self.set_length("aperture", random.decades([-2.0, 0.0]));
            self.set_length("focus", random.decades([-1.0, 1.0]));
        }
        if random.index(6) == 0 {
            self.set_length("near", random.between([0.0, 3.0]));
        }
    }
}

/// Returns a sphere that coincides with another, is inside of it, touches it, or is much larger; most often one that is
/// `alone`.
fn beside(random: &mut Random, (center, radius): Sphere, alone: Sphere) -> Sphere {
    let smaller = radius * random.unit().max(1e-2);
    let toward = random.direction();
    match random.index(12) {
        0 => (center, radius),
        1 => (center, smaller),
        2 => (center + (radius + alone.1) * toward, alone.1),
        3 => (center + (radius - smaller) * toward, smaller),
        4 if random.index(20) == 0 => (alone.0, random.decades([0.0, 4.0])),
        _ => alone,
    }
}

/// Returns one of several names.
fn one_of<'a>(random: &mut Random, names: &[&'a str]) -> &'a str {
    names[random.index(names.len())]
}

fn color(random: &mut Random) -> String {
    match random.index(6) {
        0 => "1".to_owned(),
        1 => "0".to_owned(),
        2 => format!("{:?}", random.unit()),
        _ => format!("{:?}", [random.unit(), random.unit(), random.unit()]),
    }
}

fn direction(random: &mut Random) -> String {
    match random.index(4) {
        0 => one_of(random, &["[0, 1, 0]", "[1, 0, 0]", "[0, 0, -1]", "[1, 1, 0]"]).to_owned(),
        _ => format!("{:?}", random.direction().to_array()),
    }
}
