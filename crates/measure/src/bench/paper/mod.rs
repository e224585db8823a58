//! The paper's measurements, with its tracer and with Spherule.
//!
//! The paper, "Optimizing Ray Tracing", measures the effect of three optimizations. So do the tables
//! here, in the same order: Russian roulette, threads, the acceleration structure. A last table
//! combines them. [`spherule_paper`] reimplements the paper's program.

mod comparison;
mod scenes;
mod tables;

pub(crate) use comparison::{Program, SceneSetup, TURN, compare_displayed, compare_images, mean};
pub use scenes::PaperScene;

use super::{BenchError, Options, Progress};
use crate::report::Report;
use scenes::{FULL, SHADOW_SAMPLES};

const EXPLANATION: &str = "The paper's tracer, implemented from its description, compared with \
    Spherule: the same scenes, lights and numbers of samples, on this machine. The tracer is \
    recursive, stores spheres in an array of structures and a tree of pointers, and computes in \
    double precision; as in the paper, random numbers and finished pixels are protected by critical \
    sections. It is compiled with the same settings. Images are compared in every row: a difference \
    beyond noise is an error. Tables 1 to 3 and Figure 3 correspond to the paper's: roulette, \
    threads, and the tree with increasing numbers of spheres in the same square. Table 4 combines \
    all optimizations. Light, colors, camera and the layout of the tables are ours.";

/// Image size and samples; smaller than in the paper, so that measurements take minutes, not hours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Scale {
    /// Width and height in pixels; `None` to choose by effort.
    pub size: Option<u32>,
    /// Samples per pixel; `None` to choose by effort.
    pub spp: Option<u32>,
}

impl Scale {
    /// Returns width and height in pixels, and samples per pixel.
    fn resolve(self, options: &Options) -> (u32, u32) {
        let (size, spp) = options.pick([(20, 1), (64, 4), FULL]);
        (self.size.unwrap_or(size), self.spp.unwrap_or(spp))
    }
}

/// Repeats the paper's measurements.
///
/// # Errors
/// Scenes were given, images of the two programs differ by more than noise, threads cannot be
/// started, or a scene does not fit in memory.
pub fn measure(options: &Options, progress: Progress) -> Result<Report, BenchError> {
    if !options.scenes.is_empty() {
        return Err(BenchError::OwnScenes);
    }
    let (size, spp) = options.scale.resolve(options);
    let plan = tables::Plan { options, size, spp, progress };
    let roulette = tables::roulette(&plan)?;
    let (threads, speedups) = tables::threads(&plan)?;
    let (spheres, growth) = tables::spheres(&plan)?;
    let mut settings = options.settings();
    let scaled = format!(
        "{size} x {size} pixels of {spp} samples, 50 bounces, {SHADOW_SAMPLES} shadow samples; the \
         paper's: {full} x {full} of {full_spp}",
        full = FULL.0,
        full_spp = FULL.1,
    );
    settings.push(("scale".to_owned(), scaled));
    Ok(Report {
        name: "paper".to_owned(),
        title: "The paper's tables".to_owned(),
        about: EXPLANATION.to_owned(),
        settings,
        tables: vec![roulette, threads, spheres, tables::combined(&plan)?],
        plots: vec![growth, speedups],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::tests::quick;
    use crate::report::Cell;

    #[test]
    fn all_tables_are_filled() {
        let report = measure(&quick(&[]), &|_| ()).unwrap();
        let rows: Vec<_> = report.tables.iter().map(|table| table.rows.len()).collect();
        assert!(rows[0] == 3 && rows[1] >= 1 && rows[2] == 2 && rows[3] == 6, "{rows:?}");
        let times = report.tables.iter().flat_map(|table| table.rows.iter().flatten());
        let times = times.filter_map(|cell| match cell {
            Cell::Spread(spread) => Some(spread.median),
            _ => None,
        });
        assert!(measure(&quick(&["grid"]), &|_| ()).is_err());
        assert!(times.clone().count() > 20 && times.clone().all(|time| time > 0.0));
    }

    #[test]
    fn explicit_scales_override_the_effort() {
        let of = |size, spp| Scale { size, spp }.resolve(&quick(&[]));
        assert_eq!((of(None, None), of(Some(64), None)), ((20, 1), (64, 1)));
        assert_eq!(of(None, Some(3)), (20, 3));
    }
}
