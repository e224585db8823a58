//! `spherule view` as typed.

use crate::cli::args::RenderArgs;
use std::path::PathBuf;

#[derive(Debug, clap::Parser)]
pub(in crate::cli) struct ViewerArgs {
    /// No window: do what this file of events says, and end
    #[arg(long, value_name = "FILE")]
    pub(super) headless_script: Option<PathBuf>,
    #[command(flatten)]
    pub(super) render: RenderArgs,
}
