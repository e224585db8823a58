//! Limits of numbers, and their description in messages.

/// Numbers that a setting or a key of a scene file accepts. Infinity and NaN are never accepted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limits {
    /// Every finite number.
    Any,
    /// More than 0.
    Positive,
    /// 0 or more.
    NotNegative,
    /// 0..=1.
    Share,
    /// At least the first, at most the second.
    Within(f64, f64),
    /// At least the first, less than the second.
    Below(f64, f64),
    /// More than the first, at most the second.
    AboveTo(f64, f64),
    /// Strictly between the two.
    Between(f64, f64),
}

impl Limits {
    /// Returns whether the number is accepted.
    pub fn contain(self, number: f64) -> bool {
        number.is_finite()
            && match self {
                Self::Any => true,
                Self::Positive => number > 0.0,
                Self::NotNegative => number >= 0.0,
                Self::Share => (0.0..=1.0).contains(&number),
                Self::Within(low, high) => (low..=high).contains(&number),
                Self::Below(low, high) => (low..high).contains(&number),
                Self::AboveTo(low, high) => low < number && number <= high,
                Self::Between(low, high) => low < number && number < high,
            }
    }

    /// Returns whether the numbers are shares of a whole.
    pub fn is_share(self) -> bool {
        matches!(self, Self::Share | Self::AboveTo(0.0, 1.0))
    }

    /// Returns the limits in words, to follow "must be".
    pub fn describe(self) -> String {
        match self {
            Self::Any => "a finite number".to_owned(),
            Self::Positive => "finite and more than 0".to_owned(),
            Self::NotNegative => "finite and 0 or more".to_owned(),
            Self::Share => "from 0 to 1".to_owned(),
            Self::Within(low, high) if high >= 1e16 => format!("from {low} to {:e}", high as f32),
            Self::Within(low, high) => format!("from {low} to {high}"),
            Self::Below(low, high) => format!("{low} or more and less than {high}"),
            Self::AboveTo(low, f64::MAX) => format!("finite and more than {low}"),
            Self::AboveTo(low, high) => format!("more than {low} and at most {high}"),
            Self::Between(low, high) => format!("more than {low} and less than {high}"),
        }
    }
}

/// Parses a share of a whole: a number, or a percentage, as in `0.3` and `30%`. It may be any number, also NaN.
pub fn share(text: &str) -> Option<f64> {
    let text = text.trim();
    match text.strip_suffix('%') {
        Some(percent) => percent.trim_end().parse().ok().map(|percent: f64| percent / 100.0),
        None => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_numbers_or_percentages() {
        let cases = [("0.3", 0.3), ("30%", 0.3), (" 30 % ", 0.3), ("2.5%", 0.025), ("-1", -1.0)];
        for (text, expected) in cases {
            assert_eq!(share(text), Some(expected), "{text}");
        }
        for text in ["", "%", "30%%", "% 30", "x", "0.3x"] {
            assert_eq!(share(text), None, "{text}");
        }
    }

    #[test]
    fn limits_hold_at_their_ends() {
        let cases = [
            (Limits::Positive, 0.0, false),
            (Limits::NotNegative, 0.0, true),
            (Limits::Share, 1.0, true),
            (Limits::Share, 1.000_000_1, false),
            (Limits::Below(0.0, 90.0), 90.0, false),
            (Limits::AboveTo(0.0, 1.0), 1.0, true),
            (Limits::AboveTo(0.0, 1.0), 0.0, false),
            (Limits::Between(0.0, 180.0), 180.0, false),
            (Limits::Within(-1.0, 1.0), -1.0, true),
            (Limits::Any, f64::NAN, false),
            (Limits::Any, f64::INFINITY, false),
        ];
        for (limits, number, inside) in cases {
            assert_eq!(limits.contain(number), inside, "{number} {}", limits.describe());
        }
    }
}
