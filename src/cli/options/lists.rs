//! Lists of options and settings, for metadata and reports.

use super::names::PPM;
use serde_json::{Map, Value, json};
use spherule_render::film::Region;
use spherule_render::image::{Depth, Format, WriteOptions};
use spherule_render::scene::Settings;
use spherule_render::settings::{self, Role, Scope, TONES};
use std::num::NonZeroU16;

/// Names and values, in order.
pub(in crate::cli) type List = Map<String, Value>;

/// Adds a value to a list, if there is one.
pub(in crate::cli) fn put(list: &mut List, name: &str, value: Option<impl Into<Value>>) {
    if let Some(value) = value {
        list.insert(name.to_owned(), value.into());
    }
}

/// Lists all settings that determine the image, by the names of scene files, and nothing else: equal images
/// have equal lists.
pub(in crate::cli) fn of_settings(settings: &Settings, region: Region) -> List {
    let mut list = List::new();
    let integrator = settings::INTEGRATORS.name(&settings.integrator);
    for setting in settings::SETTINGS.iter().filter(|setting| setting.role != Role::Display) {
        let value = match setting.get(settings) {
            // Flags are on unless they are listed.
            settings::Value::None | settings::Value::Flag(true) => continue,
            // Images are not denoised unless it is listed.
            settings::Value::Word("auto" | "off") if setting.name == "denoise" => continue,
            settings::Value::Size([width, height]) => {
                list.insert("width".to_owned(), json!(width));
                list.insert("height".to_owned(), json!(height));
                if region != (Region { x: 0, y: 0, width, height }) {
                    list.insert("region".to_owned(), json!(region_text(region)));
                }
                continue;
            }
            _ if matches!(setting.scope, Scope::Only(names) if !names.contains(&integrator)) => {
                continue;
            }
            settings::Value::Flag(flag) => json!(flag),
            settings::Value::Whole(number) => json!(number),
            settings::Value::Number(number) => json!(number),
            settings::Value::Word(word) => json!(word),
            settings::Value::Paper { .. } => json!(setting.get(settings).to_string()),
        };
        list.insert(setting.name.to_owned(), value);
    }
    list
}

/// Lists the resolution, and for formats that do not store linear radiance exposure and tone curve.
pub(in crate::cli) fn of_encoding(format: Format, options: &WriteOptions) -> List {
    let mut list = List::new();
    if !format.is_linear() {
        list.insert("exposure".to_owned(), json!(options.exposure));
        list.insert("tone".to_owned(), json!(TONES.name(&options.tone)));
        list.insert("bits".to_owned(), json!(bits(options.depth)));
    }
    put(&mut list, "dpi", options.resolution.map(NonZeroU16::get));
    if format == Format::Jpeg {
        list.insert("quality".to_owned(), json!(options.quality));
    }
    if format == Format::Ppm {
        list.insert("ppm".to_owned(), json!(PPM.name(&options.ppm)));
    }
    list
}

/// Formats a region as the command line takes it.
pub(in crate::cli) fn region_text(region: Region) -> String {
    format!("{},{},{}x{}", region.x, region.y, region.width, region.height)
}

fn bits(depth: Depth) -> u32 {
    match depth {
        Depth::Eight => 8,
        Depth::Sixteen => 16,
    }
}
