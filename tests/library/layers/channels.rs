//! Names and types of the channels of layers in a file.

use super::all_of;
use crate::common::*;
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, read};
use spherule_render::image::Values::{Floats, Integers};
use spherule_render::image::{Image, WriteOptions};
use spherule_render::layers::{Features, Layer};
use spherule_render::render::Options;

#[test]
fn statistics_come_from_the_render() {
    let mut scene = menagerie();
    (scene.settings.width, scene.settings.height) = (9, 7);
    let mut layers = all_of(&scene);
    let statistics = [Layer::Variance, Layer::Samples];
    assert_eq!(layers.channels(&statistics), []);
    layers.statistics =
        render_scene_with(&scene, &Options { statistics: true, ..Options::default() }).statistics;
    let known = layers.statistics.clone().expect("what was asked for");
    let channels = layers.channels(&statistics);
    let green = known.variance.pixels.iter().map(|pixel| pixel[1]).collect();
    assert_eq!((channels[1].name.as_str(), &channels[1].values), ("variance.G", &Floats(green)));
    assert_eq!(channels[3].values, Integers(vec![8; 63]));
}

#[test]
fn files_hold_every_channel_by_name_and_type() {
    let mut scene = menagerie();
    (scene.settings.width, scene.settings.height) = (19, 13);
    let layers = all_of(&scene);
    let image = Image::filled(19, 13, [0.5, 0.25, 4.0]).expect("a picture");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.exr");
    let channels = layers.channels(&Layer::ALL);
    image.write_layers(&path, &channels, &WriteOptions::default()).expect("a file");
    assert_eq!(Image::read(&path).expect("a picture"), image);

    let file = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let file = file.all_attributes().from_file(&path).expect("an EXR file");
    let list = &file.layer_data.channel_data.list;
    let names: Vec<String> = list.iter().map(|channel| channel.name.to_string()).collect();
    let expected = [
        "B",
        "G",
        "R",
        "albedo.B",
        "albedo.G",
        "albedo.R",
        "coverage.Y",
        "depth.Z",
        "id.Y",
        "normal.X",
        "normal.Y",
        "normal.Z",
    ];
    assert_eq!(names, expected);
    let floats = |name: &str| {
        let channel = list.iter().find(|channel| channel.name.eq(name)).expect(name);
        match &channel.sample_data {
            FlatSamples::F32(values) => values.clone(),
            other => panic!("{name}: {other:?}"),
        }
    };
    let column = |value: fn(&Features) -> f32| layers.pixels.iter().map(value).collect::<Vec<_>>();
    assert_eq!(floats("albedo.B"), column(|pixel| pixel.albedo[2]));
    assert_eq!(floats("normal.X"), column(|pixel| pixel.normal[0]));
    assert_eq!(floats("depth.Z"), column(|pixel| pixel.depth));
    assert_eq!(floats("coverage.Y"), column(|pixel| pixel.coverage));
    let ids: Vec<u32> = layers.pixels.iter().map(|pixel| pixel.id).collect();
    assert_eq!(list[8].sample_data, FlatSamples::U32(ids));
}
