//! Number formats for people.

/// Number format of a column, for people. Files for programs have all digits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// Three significant digits, without exponent from 0.0001 to a million.
    #[default]
    Usual,
    /// A number of digits after the point.
    Fixed(usize),
    /// Scientific notation with a number of digits after the point.
    Power(usize),
    /// A fraction in percent; only zero is written as 0.
    Percent,
    /// A magnitude: one digit after the point, or a power of ten.
    Size,
}

/// Significant digits of [`Style::Usual`].
const DIGITS: i32 = 3;

impl Style {
    /// Formats a number; `-` for NaN.
    pub fn write(self, number: f64) -> String {
        if number.is_nan() {
            return "-".to_owned();
        }
        match self {
            Self::Usual => usual(number),
            Self::Fixed(digits) => format!("{number:.digits$}"),
            Self::Power(digits) => format!("{number:.digits$e}"),
            Self::Percent => percent(100.0 * number),
            Self::Size if number == 0.0 || (0.1..1e4).contains(&number) => format!("{number:.1}"),
            Self::Size => format!("{number:.0e}"),
        }
    }
}

fn usual(number: f64) -> String {
    if number == 0.0 || number.is_infinite() {
        return number.to_string();
    }
    if !(1e-4..1e6).contains(&number.abs()) {
        return format!("{number:.2e}");
    }
    let digits = (DIGITS - 1 - number.abs().log10().floor() as i32).max(0) as usize;
    format!("{number:.digits$}")
}

fn percent(percent: f64) -> String {
    if percent == 0.0 {
        "0".to_owned()
    } else if percent.abs() >= 0.01 {
        format!("{percent:.2} %")
    } else {
        format!("{percent:.0e} %")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_only_zero_is_zero() {
        let percent = |number| Style::Percent.write(number);
        assert_eq!([percent(0.0), percent(1.0 / 3.0), percent(1e-6)], ["0", "33.33 %", "1e-4 %"]);
        let sizes = [0.0, 0.25, 1234.5, 1.2e-9, 3e7, f64::INFINITY];
        let written = sizes.map(|number| Style::Size.write(number));
        assert_eq!(written, ["0.0", "0.2", "1234.5", "1e-9", "3e7", "inf"]);
        assert_eq!(Style::Size.write(f64::NAN), "-");
    }

    #[test]
    fn three_digits_are_significant() {
        let numbers = [0.0, 0.001_234, 1.2345, 12.345, 123.45, 12_345.6, 1.5e6, -0.5, 2e-9];
        let written = numbers.map(|number| Style::Usual.write(number));
        let expected =
            ["0", "0.00123", "1.23", "12.3", "123", "12346", "1.50e6", "-0.500", "2.00e-9"];
        assert_eq!(written, expected);
        assert_eq!(Style::Fixed(1).write(2.25), "2.2");
        assert_eq!(Style::Power(1).write(0.0123), "1.2e-2");
    }
}
