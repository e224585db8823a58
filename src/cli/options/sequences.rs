//! Options for image sequences.

/// Options for image sequences.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
#[command(next_help_heading = "Sequences (--frame all or --turntable)")]
pub(in crate::cli) struct SequenceArgs {
    /// Skip images that already exist, if their metadata has the same scene, settings and samples; for PNG,
    /// PPM and EXR
    #[arg(long)]
    pub(in crate::cli) skip_existing: bool,
    /// Frame rate of a video: -o video.mp4, .mov, .webm or .gif, which needs ffmpeg [default: 30]
    #[arg(long, value_name = "N", value_parser = fps)]
    pub(in crate::cli) fps: Option<f64>,
    /// Number of the first image, from 0; set by checkpoints
    #[arg(long, value_name = "N", hide = true)]
    pub(in crate::cli) first_picture: Option<u64>,
}

fn fps(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate| (0.01..=1000.0).contains(rate));
    rate.ok_or_else(|| {
        "give a frame rate from 0.01 to 1000 images per second, as in 30 or 29.97".to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_rates_have_limits() {
        assert_eq!((fps("30"), fps("29.97"), fps("0.5")), (Ok(30.0), Ok(29.97), Ok(0.5)));
        for text in ["", "0", "-1", "NaN", "inf", "1e9", "30000/1001"] {
            assert!(fps(text).is_err(), "{text}");
        }
    }
}
