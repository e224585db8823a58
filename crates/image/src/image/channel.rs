//! Additional channels of an image: the layers of an EXR file.

use super::ImageError;

/// Maximum length of a name in bytes that every EXR reader supports.
const MAX_NAME_LENGTH: usize = 31;

/// An additional channel: one number per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name in the file: the layer's name, a dot, and the part, as in `normal.X`. 1 to 31 printable
    /// ASCII characters without spaces, and not `R`, `G` or `B`, which are the image.
    pub name: String,
    /// Values, row by row from the top left.
    pub values: Values,
}

/// The values of a channel, by type.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Any numbers, including infinity and NaN.
    Floats(Vec<f32>),
    /// Integers. Programs that read them as floats get exact values up to 2^24.
    Integers(Vec<u32>),
}

impl Values {
    /// Returns the number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Floats(values) => values.len(),
            Self::Integers(values) => values.len(),
        }
    }

    /// Returns whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Name of the alpha channel: the fraction of each pixel that is not background, 0..=1.
pub(super) const ALPHA: &str = "A";

/// Returns an error for channels that cannot be stored with an image of `pixels` pixels.
pub(super) fn check(channels: &[Channel], pixels: usize) -> Result<(), ImageError> {
    for (i, Channel { name, values }) in channels.iter().enumerate() {
        let refuse = |reason| Err(ImageError::Channel { name: name.clone(), reason });
        if name.is_empty()
            || name.len() > MAX_NAME_LENGTH
            || !name.bytes().all(|b| b.is_ascii_graphic())
        {
            return refuse(format!(
                "give a name of 1 to {MAX_NAME_LENGTH} printable ASCII characters"
            ));
        }
        let earlier = channels[..i].iter().map(|channel| channel.name.as_str());
        if ["R", "G", "B"].into_iter().chain(earlier).any(|other| other == name) {
            return refuse("the name is in use; give another".to_owned());
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
