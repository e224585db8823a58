//! Videos: images that are piped to `ffmpeg` as they are rendered.

use crate::cli::failure::Failure;
use crate::cli::write_file::check_destination;
use spherule_render::atomic::{Pending, remove_leftovers};
use spherule_render::image::tone::{Codes8, DisplayTransform};
use spherule_render::image::{Image, WriteOptions};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::thread::{self, JoinHandle};

/// The program that encodes videos.
const PROGRAM: &str = "ffmpeg";

/// Default frame rate.
const FPS: f64 = 30.0;

/// Maximum number of bytes of the encoder's messages that are stored.
const MESSAGES: u64 = 1 << 16;

/// Maximum number of lines of its messages that are shown.
const SHOWN: usize = 8;

/// Container formats of videos.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::cli) enum Container {
    Mp4,
    Mov,
    Webm,
    Gif,
}

impl Container {
    /// Returns the container format for the suffix of a name; `None` for other names.
    pub(in crate::cli) fn of_suffix(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "mp4" | "m4v" => Some(Self::Mp4),
            "mov" => Some(Self::Mov),
            "webm" => Some(Self::Webm),
            "gif" => Some(Self::Gif),
            _ => None,
        }
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
pub(super) struct Video {
    path: PathBuf,
    container: Container,
    fps: f64,
    encoder: Option<Encoder>,
    pictures: u64,
}

/// A running encoder.
struct Encoder {
    /// Taken when the video is complete.
    pending: Option<Pending>,
    child: Child,
    input: Option<ChildStdin>,
    messages: Option<JoinHandle<String>>,
    size: (u32, u32),
}

impl Video {
    /// Creates an empty video; an error if it cannot be written or the encoder is missing.
    pub(super) fn new(
        path: &Path,
        container: Container,
        fps: Option<f64>,
    ) -> Result<Self, Failure> {
        check_destination(path)?;
        let fps = fps.unwrap_or(FPS);
        let found = Command::new(PROGRAM)
            .arg("-version")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        if let Err(error) = found {
            return Err(Failure::Video(path.to_owned(), missing(path, fps, &error)));
        }
        // Leftovers only cost space.
        let _ = remove_leftovers(path);
        Ok(Self { path: path.to_owned(), container, fps, encoder: None, pictures: 0 })
    }

    /// Adds an image of the same size as the first one.
    pub(super) fn add(&mut self, image: &Image, options: &WriteOptions) -> Result<(), Failure> {
        let size = (image.width.next_multiple_of(2), image.height.next_multiple_of(2));
        if self.encoder.is_none() {
            let started = Encoder::start(&self.path, self.container, self.fps, size);
            self.encoder = Some(started.map_err(|error| self.failure(&error.to_string()))?);
        }
        let Some(encoder) = &mut self.encoder else { return Ok(()) };
        if encoder.size != size {
            let (width, height) = encoder.size;
            return Err(self.failure(&format!(
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
            return Err(self.failure(&why));
        }
        self.pictures += 1;
        Ok(())
    }

    /// Gives the video its final name, and returns a message about it.
    pub(super) fn finish(mut self) -> Result<String, Failure> {
        let Some(mut encoder) = self.encoder.take() else {
            return Err(self.failure("it has no images"));
        };
        let (status, messages) = encoder.end().map_err(|error| self.failure(&error.to_string()))?;
        if !status.success() {
            return Err(self.failure(&failed(status, &messages)));
        }
        if let Some(pending) = encoder.pending.take() {
            if pending.path().metadata().is_ok_and(|file| file.len() == 0) {
                return Err(self.failure(&format!("{PROGRAM} wrote nothing")));
            }
            pending.persist().map_err(|error| Failure::Write(self.path.clone(), error))?;
        }
        let (path, pictures, fps) = (self.path.display(), self.pictures, self.fps);
        Ok(format!("{path}: video of {pictures} images, {fps} per second"))
    }

    fn failure(&self, why: &str) -> Failure {
        Failure::Video(self.path.clone(), format!("no video is written: {why}"))
    }
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

/// Returns the error message for an encoder that cannot be started.
fn missing(path: &Path, fps: f64, error: &io::Error) -> String {
    let why = if error.kind() == ErrorKind::NotFound {
        format!("{PROGRAM} was not found in PATH")
    } else {
        format!("{PROGRAM} cannot be started: {error}")
    };
    let video = path.file_name().unwrap_or_default().to_string_lossy();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    format!(
        "videos need {PROGRAM}, but {why}; install it (apt install ffmpeg, dnf install ffmpeg-free, brew \
         install ffmpeg, winget install ffmpeg, or from ffmpeg.org), or write numbered images with -o \
         {stem}-%04d.png and encode the video elsewhere:\n  {PROGRAM} -framerate {fps} -pattern_type glob -i \
         '{stem}-*.png' -vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2' -pix_fmt yuv420p {video}"
    )
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
