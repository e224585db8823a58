//! Arguments of `spherule view`.

use crate::cli::render::RenderArgs;
use clap::Arg;
use std::path::PathBuf;

/// Options of `spherule render` that the viewer always refuses, and hides from its help.
const REFUSED: [&str; 11] = [
    "output_format",
    "region",
    "layers",
    "part",
    "split",
    "turntable",
    "fps",
    "checkpoint",
    "checkpoint_every",
    "resume",
    "terminal",
];

/// Hides an option from the viewer's help if the viewer refuses it.
pub(in crate::cli) fn hide_refused(option: Arg) -> Arg {
    if REFUSED.contains(&option.get_id().as_str()) { option.hide(true) } else { option }
}

#[derive(Debug, clap::Parser)]
pub(in crate::cli) struct ViewerArgs {
    /// Run a script of events without a page, and exit
    #[arg(long, value_name = "FILE", help_heading = "Page")]
    pub(super) headless_script: Option<PathBuf>,
    /// Listen at this address, so that other machines can look; what is sent is not encrypted [default: this machine alone,
    /// 127.0.0.1]
    #[arg(long, value_name = "ADDRESS", help_heading = "Page", conflicts_with = "headless_script")]
    pub(super) address: Option<String>,
    /// Port of the page [default: a free one]
    #[arg(long, value_name = "N", help_heading = "Page", conflicts_with = "headless_script")]
    pub(super) port: Option<u16>,
    /// Print the page's address, and open no browser
    #[arg(long, help_heading = "Page", conflicts_with = "headless_script")]
    pub(super) no_browser: bool,
    /// Read commands from standard input, and write messages to standard output, for the program that started this one
    #[arg(long, hide = true, conflicts_with_all = ["headless_script", "address", "port", "no_browser"])]
    pub(super) pipe: bool,
    #[command(flatten)]
    pub(super) render: RenderArgs,
}
