//! Channels beside the picture's colors: the layers of an EXR file.

use super::ImageError;

/// The longest name, in bytes, that every reader of EXR takes.
const LONGEST: usize = 31;

/// One number for each pixel of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Its name in the file: the layer's, a dot, and the part, as in `normal.X`. 1 to 31 printable
    /// ASCII characters without spaces, and none of `R`, `G` and `B`, which are the picture.
    pub name: String,
    /// The numbers, row by row from the top left.
    pub values: Values,
}

/// The numbers of a channel, by type.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Any numbers, infinite ones and NaN included.
    Floats(Vec<f32>),
    /// Whole numbers. Programs that read them as floats see them exactly up to 2^24.
    Integers(Vec<u32>),
}

impl Values {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Floats(values) => values.len(),
            Self::Integers(values) => values.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The name of the channel that holds alpha: how much of each pixel is not background, 0..=1.
pub(super) const ALPHA: &str = "A";

/// Refuses channels that cannot lie beside a picture of so many pixels.
pub(super) fn check(channels: &[Channel], pixels: usize) -> Result<(), ImageError> {
    for (i, Channel { name, values }) in channels.iter().enumerate() {
        let refuse = |reason| Err(ImageError::Channel { name: name.clone(), reason });
        if name.is_empty() || name.len() > LONGEST || !name.bytes().all(|b| b.is_ascii_graphic()) {
            return refuse(format!("give a name of 1 to {LONGEST} printable ASCII characters"));
        }
        let earlier = channels[..i].iter().map(|channel| channel.name.as_str());
        if ["R", "G", "B"].into_iter().chain(earlier).any(|other| other == name) {
            return refuse("there is one of this name; give another".to_owned());
        }
        if values.len() != pixels {
            let count = values.len();
            return refuse(format!("it has {count} values; give one for each of {pixels} pixels"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{WriteOptions, tests::ramp};

    fn floats(name: &str, count: usize) -> Channel {
        Channel { name: name.to_owned(), values: Values::Floats(vec![0.5; count]) }
    }

    #[test]
    fn names_and_lengths_are_checked() {
        assert!(check(&[floats("a.X", 6), floats("a.Y", 6), floats("A", 6)], 6).is_ok());
        let long = "n".repeat(32);
        for name in ["", "a b", "\u{e9}", "R", "B", &long] {
            assert!(check(&[floats(name, 6)], 6).is_err(), "{name:?}");
        }
        let twice = check(&[floats("a.X", 6), floats("a.X", 6)], 6).unwrap_err().to_string();
        assert!(twice.contains("\"a.X\"") && twice.contains("another"), "{twice}");
        let short = check(&[floats("a.X", 5)], 6).unwrap_err().to_string();
        assert!(short.contains("5 values") && short.contains("6 pixels"), "{short}");
    }

    #[test]
    fn other_formats_refuse_channels_before_the_file_is_touched() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.png", "a.pfm", "a.ppm"] {
            let path = folder.path().join(name);
            let written =
                ramp(3, 2).write_layers(&path, &[floats("a.X", 6)], &WriteOptions::default());
            let message = written.unwrap_err().to_string();
            assert!(message.contains("EXR"), "{name}: {message}");
            assert!(!path.exists());
        }
    }
}
