//! Parsers of option values. Errors state the valid range; clap adds the option's name and value.

use spherule_render::film::Region;
use spherule_render::scene::{Roulette, Settings};
use spherule_render::suggest;
use std::ops::RangeInclusive;
use std::str::FromStr;
use std::time::Duration;

/// Range of widths and heights in pixels.
const PIXELS: RangeInclusive<u32> = Settings::PIXELS;

/// Range of samples per pixel.
pub(super) const SAMPLES: RangeInclusive<i64> =
    *Settings::SAMPLES.start() as i64..=*Settings::SAMPLES.end() as i64;

/// Range of time limits.
const TIMES: RangeInclusive<Duration> = Settings::TIMES;

/// Range of numbers of threads, bounded to limit memory.
pub(super) const THREADS: RangeInclusive<i64> = 1..=4096;

/// Range of rays of a stress run.
pub(super) const RAYS: RangeInclusive<u64> = 1..=1 << 52;

/// A stop condition that `none` turns off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OrNone<T>(pub(super) Option<T>);

/// Maximum number of bounces of a path; `None` for no limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct DepthLimit(pub(super) Option<u32>);

/// Width and height in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Size {
    pub(super) width: u32,
    pub(super) height: u32,
}

/// One radius, or a minimum and a maximum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Radii {
    pub(super) least: f64,
    pub(super) greatest: f64,
}

/// `WxH`.
pub(super) fn size(text: &str) -> Result<Size, String> {
    let valid = |size: &Size| PIXELS.contains(&size.width) && PIXELS.contains(&size.height);
    pair(text).map(|(width, height)| Size { width, height }).filter(valid).ok_or_else(|| {
        let (least, most) = (PIXELS.start(), PIXELS.end());
        format!("give width and height, {least} to {most} pixels each, as in 1280x720")
    })
}

/// `X,Y,WxH`.
pub(super) fn region(text: &str) -> Result<Region, String> {
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

/// `N` or `unlimited`.
pub(super) fn depth(text: &str) -> Result<DepthLimit, String> {
    if text == "unlimited" {
        return Ok(DepthLimit(None));
    }
    let near = || suggest::question(text, ["unlimited"]);
    let limit =
        number(text).ok_or_else(|| format!("give 0 to {}, or unlimited{}", u32::MAX, near()))?;
    Ok(DepthLimit(Some(limit)))
}

/// `none`, `throughput` or a probability.
pub(super) fn roulette(text: &str) -> Result<Roulette, String> {
    match text {
        "none" => Ok(Roulette::None),
        "throughput" => Ok(Roulette::Throughput),
        _ => number(text)
            .filter(|probability| *probability > 0.0 && *probability <= 1.0)
            .map(Roulette::Fixed)
            .ok_or_else(|| {
                let near = suggest::question(text, ["none", "throughput"]);
                format!(
                    "give none, throughput, or a probability greater than 0 and at most 1{near}"
                )
            }),
    }
}

/// `1%`, `0.01` or `none`.
pub(super) fn error(text: &str) -> Result<OrNone<f64>, String> {
    if text == "none" {
        return Ok(OrNone(None));
    }
    let (digits, unit) = text.strip_suffix('%').map_or((text, 1.0), |digits| (digits, 100.0));
    number(digits)
        .map(|value: f64| value / unit)
        .filter(|share| *share > 0.0 && *share <= 1.0)
        .map(|share| OrNone(Some(share)))
        .ok_or_else(|| {
            "give a relative error greater than 0 and at most 100%, as in 1% or 0.01, or none"
                .to_owned()
        })
}

/// `90s`, `5m`, `1h 30m` or `none`.
pub(super) fn time(text: &str) -> Result<OrNone<Duration>, String> {
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

/// Stops of exposure.
pub(super) fn exposure(text: &str) -> Result<f64, String> {
    number(text)
        .filter(|stops| Settings::EXPOSURES.contains(stops))
        .ok_or_else(|| "give a number of stops from -100 to 100, as in -1.5".to_owned())
}

/// More than 0, or `inf`.
pub(super) fn distance(text: &str) -> Result<f64, String> {
    number(text)
        .filter(|distance| *distance > 0.0)
        .ok_or_else(|| "give a distance greater than 0, or inf for no limit".to_owned())
}

/// Any finite number; the generators check the range of each parameter.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    number(text).filter(|value: &f64| value.is_finite()).ok_or_else(|| "give a number".to_owned())
}

/// `R` or `MIN,MAX`.
pub(super) fn radii(text: &str) -> Result<Radii, String> {
    let (least, greatest) = text.split_once(',').unwrap_or((text, text));
    match (finite(least), finite(greatest)) {
        (Ok(least), Ok(greatest)) => Ok(Radii { least, greatest }),
        _ => Err("give a radius, or a minimum and a maximum, as in 0.1,0.45".to_owned()),
    }
}

/// `DIFFUSE,METAL,GLASS`.
pub(super) fn mix(text: &str) -> Result<[f64; 3], String> {
    let shares: Option<Vec<f64>> = text.split(',').map(|share| finite(share).ok()).collect();
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_regions_are_read() {
        assert_eq!(size("1280x720"), Ok(Size { width: 1280, height: 720 }));
        assert_eq!(size("65535X1"), Ok(Size { width: 65_535, height: 1 }));
        let expected = Region { x: 3, y: 4, width: 5, height: 6 };
        assert_eq!(region("3,4,5x6"), Ok(expected));
        assert_eq!(region("3, 4, 5x6"), Ok(expected));
    }

    #[test]
    fn what_is_out_of_range_is_refused() {
        for text in ["0x5", "5x0", "70000x1", "5", "x", "-1x5", "1.5x2", "99999999999x1", ""] {
            assert!(size(text).is_err(), "{text}");
        }
        for text in ["1,2", "1,2,0x5", "-1,2,3x4", "1,2,3x4,5", "1,2,3"] {
            assert!(region(text).is_err(), "{text}");
        }
        for text in ["0", "1.01", "-0.5", "NaN", "inf", "some"] {
            assert!(roulette(text).is_err(), "{text}");
        }
        for text in ["NaN", "inf", "101", "-101", "bright"] {
            assert!(exposure(text).is_err(), "{text}");
        }
        for text in ["0", "-1", "NaN"] {
            assert!(distance(text).is_err(), "{text}");
        }
        for text in ["0", "0%", "-1%", "101%", "NaN", "inf", "1 %%", "%", "small", ""] {
            assert!(error(text).is_err(), "{text}");
        }
        for text in ["60", "0s", "-1s", "1 fortnight", "100y", "s", ""] {
            assert!(time(text).is_err(), "{text}");
        }
        assert!(depth("-1").is_err() && depth("4294967296").is_err() && depth("none").is_err());
        assert!(radii("0.1,").is_err() && radii("inf").is_err());
        assert!(mix("1,2").is_err() && mix("1,2,3,4").is_err());
    }

    #[test]
    fn the_ends_of_ranges_belong_to_them() {
        assert_eq!(roulette("1"), Ok(Roulette::Fixed(1.0)));
        assert_eq!(error("100%"), Ok(OrNone(Some(1.0))));
        assert_eq!(error("2.5 %"), Ok(OrNone(Some(0.025))));
        assert_eq!(error("0.01"), Ok(OrNone(Some(0.01))));
        assert_eq!(time("1h 30m"), Ok(OrNone(Some(Duration::from_secs(5400)))));
        assert_eq!((error("none"), time("none")), (Ok(OrNone(None)), Ok(OrNone(None))));
        assert_eq!(exposure("-100"), Ok(-100.0));
        assert_eq!(distance("inf"), Ok(f64::INFINITY));
        assert_eq!(depth("0"), Ok(DepthLimit(Some(0))));
        assert_eq!(depth("unlimited"), Ok(DepthLimit(None)));
        assert_eq!(radii("2"), Ok(Radii { least: 2.0, greatest: 2.0 }));
        assert_eq!(mix("1,0,2"), Ok([1.0, 0.0, 2.0]));
    }
}
