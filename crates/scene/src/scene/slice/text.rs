//! Slice planes as text: `z>10`, `x+y<3`, `z=50%`, `1,1,0,2.5`.

use super::{Slice, SliceMode};
use crate::settings::share;
use glam::DVec3;
use std::str::FromStr;

/// Error message for text that is not a plane.
const HELP: &str = "expected a condition on x, y and z that is true for the part to cut away, as in z>10, \
                    x+y<3, 2x-z>0 or z>50%; or z=50% or NX,NY,NZ,D, which cut away the side that \
                    the normal points to";

/// A slice plane as it was typed; percentages refer to a box that is not known yet.
///
/// A condition is true for the part that is cut away: `z>10`, `x + y < 3`, `0.5x - 2*y > 1`. With `=`,
/// the part above is cut away, as with the four numbers of a normal and a distance along it (`0,0,1,10`
/// is `z>10`); normals are normalized. A number that ends in `%` is a fraction of the extent of the box
/// along the normal.
#[derive(Clone, Debug, PartialEq)]
pub struct SlicePlane {
    text: String,
    /// Unit length.
    normal: DVec3,
    at: Offset,
}

/// Position of a plane along its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Offset {
    Distance(f64),
    /// Fraction of the extent of the box, 0 to 1.
    Fraction(f64),
}

impl FromStr for SlicePlane {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bare: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let (vector, at, scaled) =
            parse_numbers(&bare).or_else(|| parse_condition(&bare)).ok_or(HELP)?;
        // Squares of components could overflow or vanish.
        let largest = vector.abs().max_element();
        let length = largest * (vector / largest).length();
        if !(largest > 0.0 && length.is_finite()) {
            return Err(HELP.to_owned());
        }
        let at = match at {
            Offset::Distance(distance) if scaled => Offset::Distance(distance / length),
            other => other,
        };
        if let Offset::Distance(distance) = at
            && !distance.is_finite()
        {
            return Err(HELP.to_owned());
        }
        let normal = (vector / largest).normalize();
        Ok(Self { text: text.trim().to_owned(), normal, at })
    }
}

impl SlicePlane {
    /// Returns the text as it was typed.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the slice for a box, given by its lower and upper corner, to which percentages refer.
    pub fn slice(&self, [low, high]: [DVec3; 2], mode: SliceMode) -> Slice {
        let normal = self.normal;
        let distance = match self.at {
            Offset::Distance(distance) => distance,
            Offset::Fraction(fraction) => {
                let [a, b] = [normal * low, normal * high];
                let (from, to) = (a.min(b).element_sum(), a.max(b).element_sum());
                from + fraction * (to - from)
            }
        };
        Slice { normal, distance, mode }
    }
}

/// Parses `NX,NY,NZ,D`, whose distance is not in units of the normal's length.
fn parse_numbers(text: &str) -> Option<(DVec3, Offset, bool)> {
    let numbers: Vec<&str> = text.split(',').collect();
    let [x, y, z, distance] = numbers.as_slice() else { return None };
    let normal = DVec3::new(number(x)?, number(y)?, number(z)?);
    Some((normal, parse_offset(distance)?, false))
}

/// Parses a condition such as `z>10`.
fn parse_condition(text: &str) -> Option<(DVec3, Offset, bool)> {
    let sign = text.find(['<', '>', '='])?;
    let (terms, rest) = text.split_at(sign);
    let less = rest.starts_with('<');
    let rest = rest.strip_prefix(['<', '>']).unwrap_or(rest);
    let at = parse_offset(rest.strip_prefix('=').unwrap_or(rest))?;
    let normal = parse_sum(terms)?;
    let at = match at {
        Offset::Distance(distance) if less => Offset::Distance(-distance),
        Offset::Fraction(fraction) if less => Offset::Fraction(1.0 - fraction),
        other => other,
    };
    Some((if less { -normal } else { normal }, at, true))
}

/// Parses a number, or a fraction if it ends in `%`.
fn parse_offset(text: &str) -> Option<Offset> {
    let number = share(text)?;
    if !text.ends_with('%') {
        return Some(Offset::Distance(number));
    }
    (0.0..=1.0).contains(&number).then_some(Offset::Fraction(number))
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Parses the coefficients of a sum such as `x+2y-0.5*z`.
fn parse_sum(text: &str) -> Option<DVec3> {
    let mut sum = DVec3::ZERO;
    let mut rest = text;
    while !rest.is_empty() {
        let end = rest.find(['x', 'y', 'z'])?;
        let factor = rest[..end].strip_suffix('*').unwrap_or(&rest[..end]);
        // Terms are joined by a sign and nothing else.
        let joined = rest.len() == text.len() || factor.starts_with(['+', '-']);
        let factor = match factor {
            "" | "+" => 1.0,
            "-" => -1.0,
            digits => number(digits)?,
        };
        let axis = match rest.as_bytes()[end] {
            b'x' => DVec3::X,
            b'y' => DVec3::Y,
            _ => DVec3::Z,
        };
        sum += joined.then_some(axis * factor)?;
        rest = &rest[end + 1..];
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slice(text: &str) -> Slice {
        let box_of = [DVec3::new(0.0, -1.0, 10.0), DVec3::new(4.0, 1.0, 20.0)];
        text.parse::<SlicePlane>().expect(text).slice(box_of, SliceMode::Caps)
    }

    #[test]
    fn conditions_describe_the_part_that_is_cut_away() {
        let half = 0.5_f64.sqrt();
        for (text, normal, distance) in [
            ("z>10", DVec3::Z, 10.0),
            (" z >= 10 ", DVec3::Z, 10.0),
            ("z<10", DVec3::NEG_Z, -10.0),
            ("z=50%", DVec3::Z, 15.0),
            ("z<20%", DVec3::NEG_Z, -12.0),
            ("-z>20%", DVec3::NEG_Z, -18.0),
            ("x=25%", DVec3::X, 1.0),
            ("x+y<3", DVec3::new(-half, -half, 0.0), -3.0 * half),
            (
                "2*x - 0.5y > 1e1",
                DVec3::new(4.0, -1.0, 0.0) / 17.0_f64.sqrt(),
                20.0 / 17.0_f64.sqrt(),
            ),
            ("0,0,2,10", DVec3::Z, 10.0),
            ("0, 0, -2, 25%", DVec3::NEG_Z, -17.5),
            ("1e200x>1e200", DVec3::X, 1.0),
        ] {
            let found = slice(text);
            assert!((found.normal - normal).length() < 1e-15, "{text}: {found:?}");
            assert!((found.distance - distance).abs() < 1e-13, "{text}: {found:?}");
        }
    }

    #[test]
    fn cut_points_satisfy_the_condition() {
        let condition = slice("x - 2y + 0.25z > 1.5");
        for i in 0..100 {
            let i = f64::from(i);
            let point = DVec3::new((i * 12.9).sin(), (i * 78.2).sin(), (i * 37.7).cos()) * 9.0;
            let expected = point.x - 2.0 * point.y + 0.25 * point.z > 1.5;
            assert_eq!(condition.depth(point) > 0.0, expected, "{point}");
        }
    }

    #[test]
    fn invalid_planes_are_refused() {
        for text in [
            "",
            "z",
            "z>",
            ">10",
            "z>a",
            "10>z",
            "z>inf",
            "z>10>5",
            "xy>1",
            "x2y>1",
            "x y > 1",
            "w>1",
            "0x>1",
            "0,0,0,1",
            "0,0,1",
            "0,0,1,2,3",
            "z=101%",
            "z=-1%",
            "z==10",
            "1e999x>1",
            "1e-300x>1e300",
            "z>nan",
            "x+>1",
            "+>1",
            "x-x>1",
        ] {
            let read = text.parse::<SlicePlane>();
            assert!(read.is_err(), "{text}: {read:?}");
        }
    }
}
