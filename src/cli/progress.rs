//! Progress reports: a bar on a terminal, occasional lines elsewhere.

use super::output;
use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use spherule_render::render::Progress;
use std::io::{IsTerminal, stderr};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Steps of the bar.
const STEPS: f64 = 1000.0;

/// Fraction of the work between two lines.
const SHARE: f64 = 0.1;

/// Time between two lines.
const PAUSE: Duration = Duration::from_secs(3);

/// Destinations of progress reports.
pub(super) enum Meter {
    /// On a terminal.
    Bar {
        bar: ProgressBar,
        /// The most advanced step that was shown; reports of different threads may be out of order.
        step: AtomicU64,
    },
    /// To a file or a pipe.
    Lines(Mutex<Line>),
    /// Off.
    Silent,
}

/// Progress at the last line.
#[derive(Default)]
pub(super) struct Line {
    done: f64,
    elapsed: Duration,
}

impl Meter {
    pub(super) fn new(quiet: bool) -> Self {
        if quiet {
            Self::Silent
        } else if stderr().is_terminal() {
            Self::Bar { bar: bar(), step: AtomicU64::new(0) }
        } else {
            Self::Lines(Mutex::default())
        }
    }

    /// Shows the progress; may be called from any thread.
    pub(super) fn show(&self, progress: Progress) {
        match self {
            Self::Bar { bar, step } => {
                let now = (progress.done * STEPS) as u64;
                if step.fetch_max(now, Ordering::Relaxed) < now {
                    bar.set_message(message(&progress));
                    bar.set_position(now);
                }
            }
            Self::Lines(line) => {
                // If another thread holds the lock, its report is as recent.
                if let Ok(mut line) = line.try_lock()
                    && line.is_due(&progress)
                {
                    *line = Line { done: progress.done, elapsed: progress.elapsed };
                    output::print_error_line(text(&progress));
                }
            }
            Self::Silent => {}
        }
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        if let Self::Bar { bar, .. } = self {
            bar.finish_and_clear();
        }
    }
}

/// Progress of loading, shown if it takes long.
pub(super) enum LoadMeter {
    /// On a terminal; `None` until there is something to show.
    Bar(Option<ProgressBar>),
    /// To a file or a pipe: the time of the last line, or of the start, and the line.
    Lines(Instant, String),
    /// Off.
    Silent,
}

impl LoadMeter {
    pub(super) fn new(quiet: bool) -> Self {
        if quiet {
            Self::Silent
        } else if stderr().is_terminal() {
            Self::Bar(None)
        } else {
            Self::Lines(Instant::now(), String::new())
        }
    }

    /// Shows a step, and its fraction that is done, if known.
    pub(super) fn show(&mut self, text: &str, done: Option<f64>) {
        match self {
            Self::Bar(bar) => {
                let bar = bar.get_or_insert_with(load_bar);
                bar.set_message(text.to_owned());
                bar.set_position((done.unwrap_or(1.0) * STEPS) as u64);
                bar.tick();
            }
            Self::Lines(last, line) if last.elapsed() >= PAUSE && line != text => {
                *last = Instant::now();
                text.clone_into(line);
                output::print_error_line(text);
            }
            Self::Lines(..) | Self::Silent => (),
        }
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        if let Self::Bar(Some(bar)) = self {
            bar.finish_and_clear();
        }
    }
}

fn load_bar() -> ProgressBar {
    let bar = ProgressBar::new(STEPS as u64);
    let style = ProgressStyle::with_template("{bar:40} {msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

impl Line {
    fn is_due(&self, progress: &Progress) -> bool {
        progress.done < 1.0
            && progress.done >= self.done + SHARE
            && progress.elapsed >= self.elapsed + PAUSE
    }
}

/// Formats rays per second.
pub(super) fn rate(rays: u64, elapsed: Duration) -> String {
    let mega = rays as f64 / elapsed.as_secs_f64().max(1e-9) / 1e6;
    format!("{mega:.1} Mrays/s")
}

/// Formats the speed, and the error of the image if known.
fn message(progress: &Progress) -> String {
    let rate = rate(progress.rays, progress.elapsed);
    match progress.noise {
        Some(noise) => format!("{rate}, error {:.2} %", 100.0 * noise.error),
        None => rate,
    }
}

fn text(progress: &Progress) -> String {
    let left = progress.elapsed.mul_f64((1.0 - progress.done) / progress.done);
    let percent = 100.0 * progress.done;
    format!("{percent:.0} %, {:#} left, {}", HumanDuration(left), message(progress))
}

fn bar() -> ProgressBar {
    let template = "{bar:40} {percent:>3} %  {eta} left  {msg}";
    let style = ProgressStyle::with_template(template);
    let bar = ProgressBar::new(STEPS as u64);
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.tick();
    bar
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule_render::noise::Noise;

    fn at(done: f64, seconds: u64) -> Progress {
        let elapsed = Duration::from_secs(seconds);
        Progress { done, rays: 30_000_000, elapsed, noise: None }
    }

    #[test]
    fn lines_are_rare_and_not_early() {
        let start = Line::default();
        assert!(!start.is_due(&at(0.5, 1)) && !start.is_due(&at(0.05, 100)));
        assert!(start.is_due(&at(0.2, 3)));
        let later = Line { done: 0.2, elapsed: Duration::from_secs(3) };
        assert!(!later.is_due(&at(0.29, 50)) && later.is_due(&at(0.31, 6)));
        assert!(!later.is_due(&at(1.0, 50)));
    }

    #[test]
    fn lines_show_percent_time_left_and_speed() {
        assert_eq!(text(&at(0.25, 10)), "25 %, 30s left, 3.0 Mrays/s");
        let noise = Some(Noise { error: 0.0123, bound: 0.013, expected: 0.0 });
        let text = text(&Progress { noise, ..at(0.25, 10) });
        assert_eq!(text, "25 %, 30s left, 3.0 Mrays/s, error 1.23 %");
    }
}
