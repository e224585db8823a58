//! Arguments of `spherule view`.

use crate::cli::render::RenderArgs;
use std::path::PathBuf;

#[derive(Debug, clap::Parser)]
pub(in crate::cli) struct ViewerArgs {
    /// Run a script of events without a window, and exit
    #[arg(long, value_name = "FILE")]
    pub(super) headless_script: Option<PathBuf>,
    #[command(flatten)]
    pub(super) render: RenderArgs,
}
