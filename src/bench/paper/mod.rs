//! The paper's measurements, its tracer beside Spherule.
//!
//! The paper, "Optimizing Ray Tracing", measures what each of its three changes is worth. So do the
//! tables here, in its order: Russian roulette, threads, the tree; a last one puts them on top of
//! one another. The tracer that stands in for the paper's program is [`crate::paper`].

mod contest;
mod scenes;
mod tables;

pub(crate) use contest::{Program, Stage, TURN, held_against, mean, shown_against};
pub use scenes::PaperScene;

use super::{BenchError, Options, Tell};
use crate::report::Report;
use scenes::{FULL, SHADOW_SAMPLES};

const EXPLANATION: &str = "The paper's tracer, as it is described, beside Spherule: the same \
    scenes, lights and numbers of samples, on this machine. It calls itself for every mirrored \
    ray, keeps spheres in an array of structures and a tree of pointers, computes in double \
    precision, and, as in the paper, random numbers and finished pixels go through critical \
    sections. It is compiled with the same settings. Pictures are compared in every row: a \
    difference beyond noise is an error. Tables 1 to 3 and Figure 3 stand for the paper's: \
    roulette, threads, and the tree with more and more spheres, which fill the same square at any \
    number; Table 4 puts all changes on top of one another. Light, colors, camera and the layout \
    of the tables are ours.";

/// What is made smaller than in the paper, so that it takes minutes and not hours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Scale {
    /// Pixels along each side; `None` for what the effort says.
    pub size: Option<u32>,
    /// Samples in each pixel, likewise.
    pub spp: Option<u32>,
}

impl Scale {
    /// Pixels along each side, and samples in each.
    fn of(self, options: &Options) -> (u32, u32) {
        let (size, spp) = options.pick([(20, 1), (64, 4), FULL]);
        (self.size.unwrap_or(size), self.spp.unwrap_or(spp))
    }
}

/// Measures what the paper measured.
///
/// # Errors
/// Scenes were chosen, the pictures of the two programs differ by more than noise, threads cannot
/// be started, or a scene does not fit in memory.
pub fn measure(options: &Options, tell: Tell) -> Result<Report, BenchError> {
    if !options.scenes.is_empty() {
        return Err(BenchError::OwnScenes);
    }
    let (size, spp) = options.scale.of(options);
    let plan = tables::Plan { options, size, spp, tell };
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
        tables: vec![roulette, threads, spheres, tables::together(&plan)?],
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
    fn what_is_typed_replaces_what_the_effort_says() {
        let of = |size, spp| Scale { size, spp }.of(&quick(&[]));
        assert_eq!((of(None, None), of(Some(64), None)), ((20, 1), (64, 1)));
        assert_eq!(of(None, Some(3)), (20, 3));
    }
}
