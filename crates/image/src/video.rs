//! Videos: images that are piped to `ffmpeg` as they are rendered.

use crate::atomic::{Pending, check_destination, remove_leftovers};
use crate::image::tone::{Codes8, DisplayTransform};
use crate::image::{Image, WriteOptions};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::thread::{self, JoinHandle};

/// The program that encodes videos.
const PROGRAM: &str = "ffmpeg";

/// Default number of images per second.
pub const FPS: f64 = 30.0;

/// Maximum number of bytes of the encoder's messages that are stored.
const MESSAGES: u64 = 1 << 16;

/// Maximum number of lines of its messages that are shown.
const SHOWN: usize = 8;

/// Container formats of videos.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Container {
    /// MPEG-4.
    Mp4,
    /// `QuickTime`.
    Mov,
    /// `WebM`.
    Webm,
    /// An animated GIF, with a palette of its own.
    Gif,
}

/// A reason why there is no video.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VideoError {
    /// The encoder is missing or cannot be started.
    #[error(
        "videos need {PROGRAM}, but {}; install it (apt install ffmpeg, dnf install ffmpeg-free, brew install ffmpeg, \
         winget install ffmpeg, or from ffmpeg.org)",
        missing(.0)
    )]
    Missing(io::Error),
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] io::Error),
    /// The encoder failed, or images have different sizes.
    #[error("no video is written: {0}")]
    Encoder(String),
}

impl Container {
    /// The formats with the suffixes of their names.
    pub const SUFFIXES: [(&str, Self); 5] = [
        ("mp4", Self::Mp4),
        ("m4v", Self::Mp4),
        ("mov", Self::Mov),
        ("webm", Self::Webm),
        ("gif", Self::Gif),
    ];

    /// Returns the container format for the suffix of a name; `None` for other names.
    pub fn of_suffix(path: &Path) -> Option<Self> {
        let suffix = path.extension()?.to_str()?.to_ascii_lowercase();
        Self::SUFFIXES.iter().find(|(own, _)| *own == suffix).map(|(_, container)| *container)
    }

    /// The name of the format for `ffmpeg -f`.
    fn muxer(self) -> &'static str {
        match self {
            Self::Mp4 => "mp4",
            Self::Mov => "mov",
            Self::Webm => "webm",
            Self::Gif => "gif",
        }
    }

    /// Returns the options for colors: BT.709 for videos, and a palette for GIF.
    fn encoding(self) -> &'static [&'static str] {
        const VIDEO: [&str; 10] = [
            "-vf",
            "scale=out_color_matrix=bt709:out_range=tv",
            "-pix_fmt",
            "yuv420p",
            "-colorspace",
            "bt709",
            "-color_primaries",
            "bt709",
            "-color_trc",
            "bt709",
        ];
        const PALETTE: [&str; 2] =
            ["-vf", "split[a][b];[a]palettegen=stats_mode=diff[p];[b][p]paletteuse"];
        if self == Self::Gif { &PALETTE } else { &VIDEO }
    }
}

/// A video that is written image by image, and gets its final name when it is complete.
#[derive(Debug)]
pub struct Video {
    path: PathBuf,
    container: Container,
    fps: f64,
    encoder: Option<Encoder>,
    images: u64,
}

/// A running encoder.
#[derive(Debug)]
struct Encoder {
    /// Taken when the video is complete.
    pending: Option<Pending>,
    child: Child,
    input: Option<ChildStdin>,
    messages: Option<JoinHandle<String>>,
    size: (u32, u32),
}

impl Video {
    /// Creates an empty video, of [`FPS`] images per second unless `fps` says another number.
    ///
    /// # Errors
    /// The file cannot be written, or the encoder is missing.
    pub fn new(path: &Path, container: Container, fps: Option<f64>) -> Result<Self, VideoError> {
        check_destination(path)?;
        let found = Command::new(PROGRAM)
            .arg("-version")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        found.map_err(VideoError::Missing)?;
        // Leftovers only cost space.
        let _ = remove_leftovers(path);
        let fps = fps.unwrap_or(FPS);
        Ok(Self { path: path.to_owned(), container, fps, encoder: None, images: 0 })
    }

    /// Adds an image of the same size as the first one; of the options, exposure and tone count.
    ///
    /// # Errors
    /// The image has another size, or the encoder failed.
    pub fn add(&mut self, image: &Image, options: &WriteOptions) -> Result<(), VideoError> {
        let size = (image.width.next_multiple_of(2), image.height.next_multiple_of(2));
        if self.encoder.is_none() {
            let started = Encoder::start(&self.path, self.container, self.fps, size);
            self.encoder = Some(started.map_err(|error| of_encoder(&error))?);
        }
        let Some(encoder) = &mut self.encoder else { return Ok(()) };
        if encoder.size != size {
            let (width, height) = encoder.size;
            return Err(VideoError::Encoder(format!(
                "an image of {}x{} pixels cannot follow one of {width}x{height}",
                image.width, image.height
            )));
        }
        let bytes = even_codes(image, options);
        let written = encoder.input.as_mut().map_or(Ok(()), |input| input.write_all(&bytes));
        if let Err(error) = written {
            // The encoder ended early; its messages say why.
            let why = encoder
                .end()
                .map_or(error.to_string(), |(status, messages)| failed(status, &messages));
            return Err(VideoError::Encoder(why));
        }
        self.images += 1;
        Ok(())
    }

    /// Gives the video its final name, and returns a message about it.
    ///
    /// # Errors
    /// There is no image, the encoder failed, or the file cannot be written.
    pub fn finish(mut self) -> Result<String, VideoError> {
        let Some(mut encoder) = self.encoder.take() else {
            return Err(VideoError::Encoder("it has no images".to_owned()));
        };
        let (status, messages) = encoder.end().map_err(|error| of_encoder(&error))?;
        if !status.success() {
            return Err(VideoError::Encoder(failed(status, &messages)));
        }
        if let Some(pending) = encoder.pending.take() {
            if pending.path().metadata().is_ok_and(|file| file.len() == 0) {
                return Err(VideoError::Encoder(format!("{PROGRAM} wrote nothing")));
            }
            pending.persist()?;
        }
        let (path, images, fps) = (self.path.display(), self.images, self.fps);
        Ok(format!("{path}: video of {images} images, {fps} per second"))
    }
}

/// The error of an encoder that cannot be started or awaited.
fn of_encoder(error: &io::Error) -> VideoError {
    VideoError::Encoder(error.to_string())
}

impl Encoder {
    fn start(path: &Path, container: Container, fps: f64, size: (u32, u32)) -> io::Result<Self> {
        let pending = Pending::create(path)?;
        let mut command = Command::new(PROGRAM);
        command.args(["-hide_banner", "-loglevel", "error", "-y"]);
        command.args(["-f", "rawvideo", "-pixel_format", "rgb24"]);
        command.args(["-video_size", &format!("{}x{}", size.0, size.1)]);
        command.args(["-framerate", &fps.to_string(), "-i", "-", "-an"]);
        command.args(container.encoding()).args(["-f", container.muxer()]);
        // A name that starts with a dash is not an option.
        command.arg(Path::new(".").join(pending.path()));
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn()?;
        let input = child.stdin.take();
        let messages = child.stderr.take().map(|stderr| thread::spawn(|| listen(stderr)));
        Ok(Self { pending: Some(pending), child, input, messages, size })
    }

    /// Waits for the encoder to end, and returns its status and messages.
    fn end(&mut self) -> io::Result<(ExitStatus, String)> {
        drop(self.input.take());
        let status = self.child.wait()?;
        let messages = self.messages.take().and_then(|messages| messages.join().ok());
        Ok((status, messages.unwrap_or_default()))
    }
}

impl Drop for Encoder {
    fn drop(&mut self) {
        // Nothing is kept of an interrupted video. The encoder may have ended already.
        if self.messages.is_some() {
            let _ = self.child.kill();
            let _ = self.end();
        }
    }
}

/// Stores the encoder's messages, and discards what exceeds the limit.
fn listen(mut stderr: impl Read) -> String {
    let mut bytes = Vec::new();
    let _ = stderr.by_ref().take(MESSAGES).read_to_end(&mut bytes);
    let _ = io::copy(&mut stderr, &mut io::sink());
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Returns the error message for a failure of the encoder, with the last lines of its messages.
fn failed(status: ExitStatus, messages: &str) -> String {
    let lines: Vec<&str> = messages.lines().filter(|line| !line.trim().is_empty()).collect();
    let last = &lines[lines.len().saturating_sub(SHOWN)..];
    let indented: Vec<String> = last.iter().map(|line| format!("\n  {line}")).collect();
    format!("{PROGRAM} failed ({status}){}", indented.concat())
}

/// Returns the reason why an encoder cannot be started.
fn missing(error: &io::Error) -> String {
    if error.kind() == ErrorKind::NotFound {
        format!("{PROGRAM} was not found in PATH")
    } else {
        format!("{PROGRAM} cannot be started: {error}")
    }
}

/// Converts an image to 8-bit RGB, row by row. The last column or row is repeated if the width or height is
/// odd, because videos need even sizes.
fn even_codes(image: &Image, options: &WriteOptions) -> Vec<u8> {
    let codes = Codes8::new(DisplayTransform::nearest(options.exposure, options.tone));
    let width = image.width as usize;
    let mut bytes = Vec::new();
    let rows = image.pixels.chunks_exact(width);
    let odd = rows.clone().next_back().filter(|_| image.height % 2 == 1);
    for row in rows.chain(odd) {
        let odd = row.last().filter(|_| width % 2 == 1);
        for pixel in row.iter().chain(odd) {
            bytes.extend(pixel.map(|value| codes.code(value)));
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suffixes_distinguish_videos_from_images() {
        let of = |name: &str| Container::of_suffix(Path::new(name));
        assert_eq!((of("a.mp4"), of("a.MOV")), (Some(Container::Mp4), Some(Container::Mov)));
        assert_eq!((of("a.webm"), of("b/a.gif")), (Some(Container::Webm), Some(Container::Gif)));
        assert_eq!((of("a.png"), of("mp4"), of("a.mp4.png")), (None, None, None));
    }

    #[test]
    fn odd_sizes_repeat_their_last_row_and_column() {
        let pixels = (0..3).map(|i| [i as f32 / 2.0; 3]).collect();
        let image = Image::new(3, 1, pixels).unwrap();
        let row = [0, 0, 0, 188, 188, 188, 255, 255, 255, 255, 255, 255];
        assert_eq!(even_codes(&image, &WriteOptions::default()), [row, row].concat());
        let even = Image::filled(2, 2, [0.0; 3]).unwrap();
        assert_eq!(even_codes(&even, &WriteOptions::default()), [0; 12]);
    }

    #[test]
    fn the_last_lines_are_shown() {
        let lines: Vec<String> = (0..20).map(|i| format!("line {i}\n\n")).collect();
        let text = failed(ExitStatus::default(), &lines.concat());
        assert!(text.contains("\n  line 19") && !text.contains("line 11"), "{text}");
    }
}
