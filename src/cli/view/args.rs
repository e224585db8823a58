//! Arguments of `spherule view`.

use crate::cli::render::RenderArgs;
use std::path::PathBuf;

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
    #[command(flatten)]
    pub(super) render: RenderArgs,
}
