//! Sets of settings that converge to the same image, and scenes to compare them in.

use crate::bench::scenes::{FIELD, NamedScene};
use crate::bench::{BenchError, Options};
use spherule_render::scene::{
    EnvironmentMap, Integrator, LightChoice, Material, NamedMaterial, Rgb, Roulette, SamplerKind,
    Scene, Settings,
};
use spherule_render::trace::{PacketWidth, Tracer, Traversal};

/// A set of settings, as a difference from the scene's.
#[derive(Clone, Copy)]
pub(super) struct Variant {
    /// The difference in a few words.
    pub(super) name: &'static str,
    /// Changes the settings.
    pub(super) change: fn(&mut Settings, &mut Tracer),
    /// True to sample adaptively until the image has the first variant's error, instead of
    /// taking equally many samples of every pixel.
    pub(super) adaptive: bool,
}

/// A scene, and the variants that are compared in it. The first variant is the baseline.
pub(super) struct Case {
    pub(super) scene: NamedScene,
    pub(super) variants: &'static [Variant],
}

const fn variant(name: &'static str, change: fn(&mut Settings, &mut Tracer)) -> Variant {
    Variant { name, change, adaptive: false }
}

/// Variants for every scene.
const SETTINGS: [Variant; 7] = [
    variant("as shipped", |_, _| ()),
    Variant { adaptive: true, ..variant("adaptive", |_, _| ()) },
    variant("stratified", |settings, _| settings.sampler = SamplerKind::Stratified),
    variant("independent", |settings, _| settings.sampler = SamplerKind::Independent),
    variant("no roulette", |settings, _| settings.roulette = Roulette::None),
    variant("roulette 0.5", |settings, _| settings.roulette = Roulette::Fixed(0.5)),
    variant("single rays", |_, tracer| {
        *tracer = Tracer { traversal: Traversal::Single, width: PacketWidth::One };
    }),
];

/// Variants for scenes with several lights.
const LIGHTS: [Variant; 3] = [
    variant("by the tree", |_, _| ()),
    variant("by power", |settings, _| settings.light_choice = LightChoice::Power),
    variant("all alike", |settings, _| settings.light_choice = LightChoice::Uniform),
];

/// Variants for scenes with spheres that cast caustics.
const CAUSTICS: [Variant; 2] = [
    variant("looked for", |_, _| ()),
    variant("by chance", |settings, _| settings.caustics = false),
];

/// Variants for scenes with one bounce, where both integrators converge to the same image.
const DIRECT: [Variant; 4] = [
    variant("path", |_, _| ()),
    variant("whitted, 1", |settings, _| settings.integrator = whitted(1)),
    variant("whitted, 4", |settings, _| settings.integrator = whitted(4)),
    variant("whitted, 16", |settings, _| settings.integrator = whitted(16)),
];

/// Variants for diffuse spheres under a white sky with one bounce, which is ambient occlusion.
const SKY: [Variant; 4] = [
    variant("path", |_, _| ()),
    variant("ao", |settings, _| settings.integrator = Integrator::Ao { distance: f64::INFINITY }),
    variant("whitted, 1", |settings, _| settings.integrator = whitted(1)),
    variant("whitted, 16", |settings, _| settings.integrator = whitted(16)),
];

const fn whitted(shadow_samples: u32) -> Integrator {
    Integrator::Whitted { shadow_samples }
}

/// Returns all cases.
///
/// # Errors
/// A scene is invalid.
pub(super) fn cases(options: &Options) -> Result<Vec<Case>, BenchError> {
    let usual = [FIELD, "smallpt", "veach", "paper-field-20"];
    let scenes = NamedScene::choose(options, &usual[..options.pick([1, 2, 4])])?;
    let resized = |scene: NamedScene| scene.resized(options.pick([24, 64, 160]));
    let scenes: Vec<_> = scenes.into_iter().map(resized).collect();
    let mut cases = Vec::new();
    for scene in &scenes {
        cases.push(Case { scene: scene.clone(), variants: &SETTINGS });
        if !options.scenes.is_empty() {
            cases.extend(several_lights(scene)?);
            cases.extend(caustics(scene)?);
            cases.push(direct(scene));
        }
    }
    if options.scenes.is_empty() {
        let field = &scenes[0];
        let every = options.pick([64, 8, 8]);
        let night = changed(field, "night", |scene| night(scene, every));
        cases.extend(several_lights(&night)?);
        cases.push(direct(field));
        cases.push(Case { scene: changed(field, "sky", chalk_under_the_sky), variants: &SKY });
    }
    Ok(cases)
}

fn changed(scene: &NamedScene, suffix: &str, change: impl Fn(&mut Scene)) -> NamedScene {
    let mut scene = NamedScene { name: format!("{}-{suffix}", scene.stem()), ..scene.clone() };
    change(&mut scene.scene);
    scene
}

/// Returns the comparison of light selection, if there are several lights.
fn several_lights(scene: &NamedScene) -> Result<Option<Case>, BenchError> {
    let with_path_tracing = |scene: &mut Scene| scene.settings.integrator = Integrator::Path;
    let scene = changed(scene, "lights", with_path_tracing);
    Ok((scene.world()?.lights.len() > 1).then_some(Case { scene, variants: &LIGHTS }))
}

/// Returns the comparison of caustics, if the scene has any.
fn caustics(scene: &NamedScene) -> Result<Option<Case>, BenchError> {
    let with_path_tracing = |scene: &mut Scene| scene.settings.integrator = Integrator::Path;
    let scene = changed(scene, "caustics", with_path_tracing);
    Ok(scene.world()?.samples_specular_light().then_some(Case { scene, variants: &CAUSTICS }))
}

fn direct(scene: &NamedScene) -> Case {
    let change = |scene: &mut Scene| {
        (scene.settings.integrator, scene.settings.depth) = (Integrator::Path, Some(1));
    };
    Case { scene: changed(scene, "direct", change), variants: &DIRECT }
}

/// Makes an emitter of one in some spheres, without other lights. One variant samples all of them at each hit.
fn night(scene: &mut Scene, every: usize) {
    scene.lights.clear();
    scene.environment.map = EnvironmentMap::Constant(Rgb::ZERO);
    let emitter = scene.materials.len() as u32;
    let material = Material::Emitter { radiance: Rgb::splat(8.0), albedo: Rgb::ZERO };
    scene.materials.push(NamedMaterial { name: "lamp".to_owned(), material });
    scene.spheres.material.iter_mut().step_by(every).for_each(|material| *material = emitter);
}

fn chalk_under_the_sky(scene: &mut Scene) {
    scene.lights.clear();
    scene.environment.map = EnvironmentMap::Constant(Rgb::ONE);
    for row in &mut scene.materials {
        row.material = Material::Lambertian { color: Rgb::splat(0.8) };
    }
    scene.settings.depth = Some(1);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::convergence::reference::Reference;
    use crate::bench::tests::quick;

    /// Images of all variants differ by no more than their estimated errors.
    #[test]
    fn variants_converge_to_the_same_image() {
        for case in cases(&quick(&[])).unwrap() {
            let scene = case.scene.resized(16);
            let expected = Reference::new(&scene, &scene.world().unwrap(), 64, None).unwrap();
            for variant in case.variants {
                let mut other = scene.clone();
                (variant.change)(&mut other.scene.settings, &mut Tracer::default());
                if other.scene.settings == scene.scene.settings {
                    continue;
                }
                let world = other.world().unwrap();
                let found = Reference::new(&other, &world, 64, None).unwrap();
                let difference = expected.squares(&found.mean).absolute;
                let estimate = expected.error.absolute + found.error.absolute;
                assert!(
                    difference < 6.0 * estimate,
                    "{}, {}: {difference} {estimate}",
                    scene.name,
                    variant.name
                );
            }
        }
    }
}
