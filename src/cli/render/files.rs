//! Files that a render reads and writes.

use super::args::RenderArgs;
use crate::cli::files::Files;
use crate::cli::options::appearance::BarPlace;

/// Returns the files of a render, without numbered images, whose count is not known yet.
pub(in crate::cli) fn files(args: &RenderArgs) -> Files {
    let mut files = Files::new("render");
    if let Some(scene) = &args.scene {
        files.reads_particles(scene, &args.particles);
    }
    if let Some(camera) = args.views.camera_file() {
        files.reads("--camera", camera);
    }
    let many = args.is_sequence();
    let part = args.part.resolved().is_some() && !many;
    if let Some(prepared) = &args.prepare {
        files.writes("--prepare", prepared);
    } else if !part && !many {
        files.writes("--output", &args.output);
    }
    if let Some(BarPlace::File(bar, _)) = &args.looks.color_bar {
        files.writes("--color-bar", bar);
    }
    match (&args.checkpoints.checkpoint, &args.checkpoints.resume) {
        (Some(kept), _) if part => files.writes("--part", kept),
        (Some(kept), resumed) => {
            files.writes("--checkpoint", kept);
            if let Some(resumed) =
                resumed.as_ref().filter(|_| !args.checkpoints.resumes_into_itself())
            {
                files.reads("the checkpoint of --resume", resumed);
            }
        }
        (None, Some(resumed)) => files.writes("--resume", resumed),
        (None, None) => (),
    }
    files
}
