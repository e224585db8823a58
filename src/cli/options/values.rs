//! Parsers of option values. Errors state the valid range; clap adds the option's name and value.

use spherule_render::film::Region;
use spherule_render::scene::Settings;
use spherule_render::settings::{Kind, Value, paper_size, share};
use spherule_render::suggest;
use std::ops::RangeInclusive;
use std::str::FromStr;
use std::time::Duration;

/// Range of widths and heights in pixels.
const PIXELS: RangeInclusive<u32> = Settings::PIXELS;

/// Range of samples per pixel.
pub(in crate::cli) const SAMPLES: RangeInclusive<i64> =
    *Settings::SAMPLES.start() as i64..=*Settings::SAMPLES.end() as i64;

/// Range of time limits.
const TIMES: RangeInclusive<Duration> = Settings::TIMES;

/// Range of numbers of threads, bounded to limit memory.
pub(in crate::cli) const THREADS: RangeInclusive<i64> = 1..=4096;

/// Range of rays of a stress run.
pub(in crate::cli) const RAYS: RangeInclusive<u64> = 1..=1 << 52;

/// A stop condition that `none` turns off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::cli) struct OrNone<T>(pub(in crate::cli) Option<T>);

/// One radius, or a minimum and a maximum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::cli) struct Radii {
    pub(in crate::cli) least: f64,
    pub(in crate::cli) greatest: f64,
}

/// A value of a render setting. Names of choices are checked by clap.
pub(in crate::cli) fn setting(kind: &Kind, text: &str) -> Result<Value, String> {
    let (words, number) = match *kind {
        Kind::Size => return size(text),
        Kind::Error => return error(text).map(|OrNone(error)| number_or_none(error)),
        Kind::Time => {
            let seconds = |OrNone(time): OrNone<Duration>| time.map(|time| time.as_secs_f64());
            return time(text).map(seconds).map(number_or_none);
        }
        Kind::Whole { words, .. } => (words, number(text).map(Value::Whole)),
        Kind::Number { words, limits, .. } if limits.is_share() => {
            (words, share(text).map(Value::Number))
        }
        Kind::Number { words, .. } => (words, number(text).map(Value::Number)),
        Kind::Choice(_) | Kind::Flag => (&[] as &[_], None),
    };
    let value = word(text, words).or(number);
    value.filter(|value| kind.contains(*value)).ok_or_else(|| {
        let list = words.iter().fold(String::new(), |list, word| list + word + ", or ");
        let near = suggest::question(text, words.iter().copied());
        format!("give {list}{}{near}", range(kind))
    })
}

/// The range of numbers of a setting, in words.
fn range(kind: &Kind) -> String {
    match *kind {
        Kind::Whole { range: [least, greatest], .. } => {
            format!("an integer from {least} to {greatest}")
        }
        Kind::Number { limits, .. } => format!("a number {}", limits.describe()),
        _ => kind.describe(),
    }
}

/// Returns the one of some words that a text is.
fn word(text: &str, words: &[&'static str]) -> Option<Value> {
    words.iter().copied().find(|word| *word == text).map(Value::Word)
}

fn number_or_none(number: Option<f64>) -> Value {
    number.map_or(Value::None, Value::Number)
}

/// `WxH`, or lengths on paper.
fn size(text: &str) -> Result<Value, String> {
    let size = pair(text).map(|(width, height)| Value::Size([width, height]));
    let size = size.filter(|size| Kind::Size.contains(*size));
    size.or_else(|| paper_size(text).ok()).ok_or_else(|| {
        let (least, most) = (PIXELS.start(), PIXELS.end());
        format!(
            "give width and height, {least} to {most} pixels each, as in 1280x720, or lengths in mm, cm, in or pt, \
             as in 85mm or 85mmx60mm"
        )
    })
}

/// `X,Y,WxH`.
pub(in crate::cli) fn region(text: &str) -> Result<Region, String> {
    let read = || {
        let (x, rest) = text.split_once(',')?;
        let (y, size) = rest.split_once(',')?;
        let (width, height) = pair(size)?;
        Some(Region { x: number(x)?, y: number(y)?, width, height })
    };
    let valid = |region: &Region| region.width > 0 && region.height > 0;
    read().filter(valid).ok_or_else(|| {
        "give column and row of the top left corner, and width and height of at least 1, as in \
         100,50,320x240"
            .to_owned()
    })
}

/// `1%` or `none`. A number without the sign could be a percentage or a fraction, so it is neither.
fn error(text: &str) -> Result<OrNone<f64>, String> {
    if text == "none" {
        return Ok(OrNone(None));
    }
    let given = share(text).filter(|share| *share > 0.0 && *share <= 1.0);
    given.filter(|_| text.trim_end().ends_with('%')).map(|share| OrNone(Some(share))).ok_or_else(
        || {
            let bare: Option<f64> =
                number(text).filter(|value: &f64| *value > 0.0 && *value <= 100.0);
            bare.map_or_else(
                || {
                    "give a relative error greater than 0% and at most 100%, as in 1%, or none"
                        .to_owned()
                },
                |percent| format!("give the percent sign, as in {percent}%, or none"),
            )
        },
    )
}

/// `90s`, `5m`, `1h 30m` or `none`.
pub(in crate::cli) fn time(text: &str) -> Result<OrNone<Duration>, String> {
    if text == "none" {
        return Ok(OrNone(None));
    }
    humantime::parse_duration(text)
        .ok()
        .filter(|time| TIMES.contains(time))
        .map(|time| OrNone(Some(time)))
        .ok_or_else(|| {
            "give a time of at least 1ms with a unit, as in 60s, 500ms, 5m or 1h 30m, or none"
                .to_owned()
        })
}

/// Any finite number; the generators check the range of each parameter.
pub(in crate::cli) fn finite(text: &str) -> Result<f64, String> {
    number(text).filter(|value: &f64| value.is_finite()).ok_or_else(|| "give a number".to_owned())
}

/// `R` or `MIN,MAX`.
pub(in crate::cli) fn radii(text: &str) -> Result<Radii, String> {
    let (least, greatest) = text.split_once(',').unwrap_or((text, text));
    match (finite(least), finite(greatest)) {
        (Ok(least), Ok(greatest)) => Ok(Radii { least, greatest }),
        _ => Err("give a radius, or a minimum and a maximum, as in 0.1,0.45".to_owned()),
    }
}

/// `DIFFUSE,METAL,GLASS`.
pub(in crate::cli) fn mix(text: &str) -> Result<[f64; 3], String> {
    let shares: Option<Vec<f64>> =
        text.split(',').map(|text| share(text).filter(|share| share.is_finite())).collect();
    shares.and_then(|shares| shares.try_into().ok()).ok_or_else(|| {
        "give the fractions of diffuse, metal and glass spheres, as in 0.6,0.3,0.1".to_owned()
    })
}

fn pair(text: &str) -> Option<(u32, u32)> {
    let (width, height) = text.split_once(['x', 'X'])?;
    Some((number(width)?, number(height)?))
}

fn number<T: FromStr>(text: &str) -> Option<T> {
    text.trim().parse().ok()
}

/// Numbers of copies of a cell, `NA,NB,NC`.
pub(in crate::cli) fn copies(text: &str) -> Result<[u32; 3], String> {
    let counts: Option<Vec<u32>> = text.split(',').map(|count| count.trim().parse().ok()).collect();
    counts
        .and_then(|counts| <[u32; 3]>::try_from(counts).ok())
        .filter(|counts| !counts.contains(&0))
        .ok_or_else(|| "give three integers of at least 1, as in 2,2,1".to_owned())
}

/// Returns the value of a name; `what` introduces the list of all names in the error.
pub(in crate::cli) fn named<T: Copy>(
    table: &[(&'static str, T)],
    name: &str,
    what: &str,
) -> Result<T, String> {
    let found = table.iter().find(|(own, _)| *own == name).map(|(_, value)| *value);
    found.ok_or_else(|| suggest::help(name, table.iter().map(|(name, _)| *name), what))
}

/// A finite number greater than 0.
pub(in crate::cli) fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| *number > 0.0 && *number < f64::INFINITY);
    number.ok_or_else(|| "give a number greater than 0".to_owned())
}

/// A number from 0 to 1, or a percentage.
pub(in crate::cli) fn opacity(text: &str) -> Result<f64, String> {
    let number = share(text).filter(|number| (0.0..=1.0).contains(number));
    number.ok_or_else(|| "give a number from 0 to 1, or a percentage".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule_render::settings::Setting;

    /// Parses a value of the setting with this name.
    fn set(name: &str, text: &str) -> Result<Value, String> {
        setting(&Setting::named(name).unwrap().kind, text)
    }

    #[test]
    fn sizes_and_regions_are_read() {
        assert_eq!(set("size", "1280x720"), Ok(Value::Size([1280, 720])));
        assert_eq!(set("size", "65535X1"), Ok(Value::Size([65_535, 1])));
        let (width, height) = ("85mm".parse().unwrap(), "60mm".parse().ok());
        assert_eq!(set("size", "85mm"), Ok(Value::Paper { width, height: None }));
        assert_eq!(set("size", "8.5cmx60mm"), Ok(Value::Paper { width, height }));
        let expected = Region { x: 3, y: 4, width: 5, height: 6 };
        assert_eq!(region("3,4,5x6"), Ok(expected));
        assert_eq!(region("3, 4, 5x6"), Ok(expected));
    }

    #[test]
    fn values_out_of_range_are_refused() {
        let cases: [(&str, &[&str]); 10] = [
            ("size", &["0x5", "5x0", "70000x1", "5", "x", "-1x5", "1.5x2", "99999999999x1", ""]),
            ("spp", &["0", "-1", "1.5", "16777217", "many"]),
            ("dpi", &["0", "-1", "72.5", "65536", "high"]),
            ("roulette", &["0", "1.01", "-0.5", "NaN", "inf", "some"]),
            ("exposure", &["NaN", "inf", "101", "-101", "bright"]),
            ("ao_distance", &["-1", "NaN", "-inf"]),
            (
                "until_error",
                &["0", "0%", "-1%", "101%", "NaN", "inf", "1 %%", "%", "small", "", "1", "0.01"],
            ),
            ("time", &["60", "0s", "-1s", "1 fortnight", "100y", "s", ""]),
            ("depth", &["-1", "4294967296", "none"]),
            ("seed", &["-1", "18446744073709551616"]),
        ];
        for (name, texts) in cases {
            for text in texts {
                assert!(set(name, text).is_err(), "{name} {text}");
            }
        }
        for text in ["1,2", "1,2,0x5", "-1,2,3x4", "1,2,3x4,5", "1,2,3"] {
            assert!(region(text).is_err(), "{text}");
        }
        assert!(radii("0.1,").is_err() && radii("inf").is_err());
        assert!(mix("1,2").is_err() && mix("1,2,3,4").is_err());
        assert!(set("until_error", "0.5").unwrap_err().contains("0.5%"));
        assert!(set("roulette", "throughputs").unwrap_err().contains("throughput"));
    }

    #[test]
    fn ranges_are_inclusive() {
        let cases = [
            ("roulette", "1", Value::Number(1.0)),
            ("roulette", "50%", Value::Number(0.5)),
            ("dpi", "300", Value::Whole(300)),
            ("roulette", "none", Value::Word("none")),
            ("until_error", "100%", Value::Number(1.0)),
            ("until_error", "2.5 %", Value::Number(0.025)),
            ("until_error", "0.01%", Value::Number(0.0001)),
            ("until_error", "none", Value::None),
            ("time", "1h 30m", Value::Number(5400.0)),
            ("time", "none", Value::None),
            ("exposure", "-100", Value::Number(-100.0)),
            ("ao_distance", "inf", Value::Word("inf")),
            ("depth", "0", Value::Whole(0)),
            ("depth", "unlimited", Value::Word("unlimited")),
            ("seed", "18446744073709551615", Value::Whole(u64::MAX)),
        ];
        for (name, text, value) in cases {
            assert_eq!(set(name, text), Ok(value), "{name} {text}");
        }
        assert_eq!(radii("2"), Ok(Radii { least: 2.0, greatest: 2.0 }));
        assert_eq!(mix("1,0,2"), Ok([1.0, 0.0, 2.0]));
        assert_eq!(mix("60%,30%,0.1"), Ok([0.6, 0.3, 0.1]));
    }

    #[test]
    fn three_counts_are_read_and_nothing_else() {
        assert_eq!(copies("2,3,1"), Ok([2, 3, 1]));
        assert_eq!(copies("2, 3, 1"), Ok([2, 3, 1]));
        for text in ["2,3", "2,3,1,1", "0,1,1", "-1,1,1", "1.5,1,1", "", "99999999999,1,1"] {
            assert!(copies(text).is_err(), "{text}");
        }
    }
}
