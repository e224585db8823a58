//! Planes as people type them: `z>10`, `x+y<3`, `z=50%`, `1,1,0,2.5`.

use super::{Slice, SliceMode};
use glam::DVec3;
use std::str::FromStr;

/// What is wrong with a plane.
const HELP: &str = "write a condition on x, y and z that is true of what is cut away, as in z>10, \
                    x+y<3, 2x-z>0 or z>50%; or z=50% and NX,NY,NZ,D, which cut away the side that \
                    the normal points to";

/// A plane as it was typed; shares are of a box that is not known yet.
///
/// A condition is true of what is cut away: `z>10`, `x + y < 3`, `0.5x - 2*y > 1`. With `=`, what is
/// cut away is above, as it is for the four numbers of a normal and a distance along it (`0,0,1,10`
/// is `z>10`); a normal of any length counts as one of length 1. A number that ends in `%` is a share
/// of the way through the box, from its lowest point to its highest along the normal.
#[derive(Clone, Debug, PartialEq)]
pub struct SlicePlane {
    text: String,
    /// Unit length.
    normal: DVec3,
    at: At,
}

/// Where a plane is along its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
enum At {
    Distance(f64),
    /// 0 to 1.
    Share(f64),
}

impl FromStr for SlicePlane {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bare: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let (vector, at, scaled) = four(&bare).or_else(|| condition(&bare)).ok_or(HELP)?;
        // Squares of components could overflow or vanish.
        let largest = vector.abs().max_element();
        let length = largest * (vector / largest).length();
        if !(largest > 0.0 && length.is_finite()) {
            return Err(HELP.to_owned());
        }
        let at = match at {
            At::Distance(distance) if scaled => At::Distance(distance / length),
            other => other,
        };
        if let At::Distance(distance) = at
            && !distance.is_finite()
        {
            return Err(HELP.to_owned());
        }
        let normal = (vector / largest).normalize();
        Ok(Self { text: text.trim().to_owned(), normal, at })
    }
}

impl SlicePlane {
    /// As it was typed.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The slice, once the box is known that shares are of: its lower and upper corner.
    pub fn slice(&self, [low, high]: [DVec3; 2], mode: SliceMode) -> Slice {
        let normal = self.normal;
        let distance = match self.at {
            At::Distance(distance) => distance,
            At::Share(share) => {
                let [a, b] = [normal * low, normal * high];
                let (from, to) = (a.min(b).element_sum(), a.max(b).element_sum());
                from + share * (to - from)
            }
        };
        Slice { normal, distance, mode }
    }
}

/// `NX,NY,NZ,D`, whose distance is not in units of the normal's length.
fn four(text: &str) -> Option<(DVec3, At, bool)> {
    let numbers: Vec<&str> = text.split(',').collect();
    let [x, y, z, distance] = numbers.as_slice() else { return None };
    let normal = DVec3::new(number(x)?, number(y)?, number(z)?);
    Some((normal, place(distance)?, false))
}

/// `z>10`.
fn condition(text: &str) -> Option<(DVec3, At, bool)> {
    let sign = text.find(['<', '>', '='])?;
    let (terms, rest) = text.split_at(sign);
    let less = rest.starts_with('<');
    let rest = rest.strip_prefix(['<', '>']).unwrap_or(rest);
    let at = place(rest.strip_prefix('=').unwrap_or(rest))?;
    let normal = linear(terms)?;
    let at = match at {
        At::Distance(distance) if less => At::Distance(-distance),
        At::Share(share) if less => At::Share(1.0 - share),
        other => other,
    };
    Some((if less { -normal } else { normal }, at, true))
}

/// A number, or a share if it ends in `%`.
fn place(text: &str) -> Option<At> {
    match text.strip_suffix('%') {
        Some(percent) => {
            let share = number(percent)? / 100.0;
            (0.0..=1.0).contains(&share).then_some(At::Share(share))
        }
        None => number(text).map(At::Distance),
    }
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// The coefficients of a sum such as `x+2y-0.5*z`.
fn linear(text: &str) -> Option<DVec3> {
    let mut sum = DVec3::ZERO;
    let mut rest = text;
    while !rest.is_empty() {
        let end = rest.find(['x', 'y', 'z'])?;
        let factor = rest[..end].strip_suffix('*').unwrap_or(&rest[..end]);
        // Between terms there is a sign, and nothing else joins them.
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
    fn what_is_typed_is_what_is_cut_away() {
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
    fn cut_points_are_those_of_which_the_condition_is_true() {
        let condition = slice("x - 2y + 0.25z > 1.5");
        for i in 0..100 {
            let i = f64::from(i);
            let point = DVec3::new((i * 12.9).sin(), (i * 78.2).sin(), (i * 37.7).cos()) * 9.0;
            let expected = point.x - 2.0 * point.y + 0.25 * point.z > 1.5;
            assert_eq!(condition.depth(point) > 0.0, expected, "{point}");
        }
    }

    #[test]
    fn what_is_no_plane_is_refused() {
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
