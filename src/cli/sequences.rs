//! Options for sequences of pictures.

/// Options for the pictures of a sequence.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
#[command(next_help_heading = "Sequences, of --frame all or --turntable")]
pub(super) struct SequenceArgs {
    /// Keep pictures that exist if their files say that they show the same scene with the same
    /// settings and samples, and render only the others; for PNG, PPM and EXR
    #[arg(long)]
    pub(super) skip_existing: bool,
    /// Pictures per second of a film: -o film.mp4, .mov, .webm or .gif, which takes ffmpeg
    /// [default: 30]
    #[arg(long, value_name = "N", value_parser = fps)]
    pub(super) fps: Option<f64>,
    /// The picture to begin with, from 0; checkpoints say it
    #[arg(long, value_name = "N", hide = true)]
    pub(super) first_picture: Option<u64>,
}

fn fps(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate| (0.01..=1000.0).contains(rate));
    rate.ok_or_else(|| "give pictures per second, 0.01 to 1000, as in 30 or 29.97".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_have_limits() {
        assert_eq!((fps("30"), fps("29.97"), fps("0.5")), (Ok(30.0), Ok(29.97), Ok(0.5)));
        for text in ["", "0", "-1", "NaN", "inf", "1e9", "30000/1001"] {
            assert!(fps(text).is_err(), "{text}");
        }
    }
}
