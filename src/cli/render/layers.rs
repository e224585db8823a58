//! The layers beside the picture, once it is there.

use super::job::Job;
use super::prepare::Prepared;
use spherule::image::Channel;
use spherule::layers::{Layer, layers};
use spherule::render::{Options, Render};
use spherule::scene::Settings;

/// The channels that were asked for: none takes no time.
pub(super) fn channels(job: &Job, prepared: &Prepared, render: &Render) -> Vec<Channel> {
    let wanted = wanted(&job.encoding.layers);
    if wanted.is_empty() {
        return Vec::new();
    }
    let mut settings = prepared.scene.settings.clone();
    if !render.complete {
        settings.spp = taken(&settings, prepared.share(render));
    }
    let options =
        Options { tracer: job.tracer, region: Some(prepared.region), ..Options::default() };
    layers(&prepared.world, &settings, &options, &wanted).channels(&wanted)
}

/// Samples per pixel of a render that was interrupted, about: who did so does not want to wait.
fn taken(settings: &Settings, share: f64) -> u32 {
    ((f64::from(settings.spp) * share).ceil() as u32).clamp(1, settings.spp)
}

/// Those that were typed, each once; all if one is `None`.
fn wanted(typed: &[Option<Layer>]) -> Vec<Layer> {
    let all = typed.contains(&None);
    Layer::ALL.into_iter().filter(|layer| all || typed.contains(&Some(*layer))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_come_once_and_in_order() {
        assert_eq!(wanted(&[]), []);
        let typed = [Some(Layer::Id), Some(Layer::Albedo), Some(Layer::Id)];
        assert_eq!(wanted(&typed), [Layer::Albedo, Layer::Id]);
        assert_eq!(wanted(&[Some(Layer::Id), None]), Layer::ALL);
    }

    #[test]
    fn interrupted_pictures_get_as_many_samples_as_they_have() {
        let settings = Settings { spp: 100, ..Settings::default() };
        let samples = [0.0, 0.101, 0.5, 1.0].map(|share| taken(&settings, share));
        assert_eq!(samples, [1, 11, 50, 100]);
    }
}
