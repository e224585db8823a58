//! `[render]`: render settings, by the table of [`SETTINGS`].

use super::block::Block;
use super::value::Value;
use crate::scene::{FileError, Settings};
use crate::settings::{self, Kind, Limits, SETTINGS};
use toml::de::DeValue;

pub(super) fn read(block: &Block) -> Result<Settings, FileError> {
    let mut settings = Settings::default();
    // Checks that there is no parameter of another integrator.
    block.kind()?;
    for setting in SETTINGS {
        if let Some(value) = block.value(setting.name) {
            setting.set(&mut settings, read_value(&value, &setting.kind)?);
        }
    }
    settings.stop_given = ["spp", "until_error", "time"].into_iter().any(|name| block.has(name));
    if settings.has_target() && !block.has("spp") {
        settings.spp = Settings::HARD_SAMPLES;
    }
    Ok(settings)
}

/// Reads a value of this kind.
fn read_value(value: &Value, kind: &Kind) -> Result<settings::Value, FileError> {
    let is_text = matches!(value.item, DeValue::String(_));
    Ok(match *kind {
        Kind::Size if is_text => {
            settings::paper_size(value.text()?).map_err(|_| value.must_be(kind.describe()))?
        }
        Kind::Size => {
            let [least, greatest] = [Settings::PIXELS.start(), Settings::PIXELS.end()];
            let [width, height] = value.list()?;
            let pixels = |value: Value| value.whole(u64::from(*least), u64::from(*greatest));
            settings::Value::Size([pixels(width)? as u32, pixels(height)? as u32])
        }
        Kind::Whole { words, .. } | Kind::Number { words, .. } if is_text && !words.is_empty() => {
            settings::Value::Word(value.choice(words)?)
        }
        Kind::Whole { range: [least, greatest], .. } => {
            settings::Value::Whole(value.whole(least, greatest)?)
        }
        Kind::Number { limits, .. } => settings::Value::Number(value.number(limits)?),
        Kind::Error => settings::Value::Number(value.number(Limits::AboveTo(0.0, 1.0))?),
        Kind::Time => {
            let [least, greatest] = [Settings::TIMES.start(), Settings::TIMES.end()];
            let limits = Limits::Within(least.as_secs_f64(), greatest.as_secs_f64());
            settings::Value::Number(value.number(limits)?)
        }
        Kind::Choice(list) => {
            let names: Vec<_> = list().iter().map(|(name, _)| *name).collect();
            settings::Value::Word(value.choice(&names)?)
        }
        Kind::Flag => settings::Value::Flag(value.flag()?),
    })
}
