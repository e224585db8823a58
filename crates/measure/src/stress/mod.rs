//! Robustness tests: error rates of ray-sphere intersection tests for random rays in numerically hard
//! cases.
//!
//! [`run()`] generates random scenes and rays of each [`Regime`], intersects them with every [`Form`] of
//! the test, and counts answers that differ from the exact [`reference`](mod@reference). Spherule is
//! tested as it ships: by [`spherule_render::query::SphereTree`] for rays from any point, with and
//! without a maximum distance, and by the renderer's world and traversal for rays that start on a
//! surface. The counts depend only on the seed, the number of rays and the regimes.
//!
//! ```
//! use spherule_measure::stress::{Form, Options, Regime, run};
//!
//! let regimes = ["near_unit", "far_1e5"].map(|name| Regime::named(name).expect("a regime"));
//! let report = run(&Options { rays: 2000, seed: 7, regimes: regimes.to_vec() }, &|_| ());
//! assert_eq!(report.wrong(Form::Spherule), 0);
//! assert!(report.regimes[1].form(Form::Naive).wrong_hits > 100);
//! ```

pub mod bodies;
mod bounds;
pub mod forms;
mod integers;
mod interval;
pub mod rays;
pub mod reference;
pub mod regimes;
pub mod report;
pub mod run;
mod scenes;
mod surface;

pub use bodies::BodyReport;
pub use forms::Form;
pub use regimes::{REGIMES, Regime};
pub use report::{FormReport, RegimeReport, Report};
pub use run::{Options, run, sample};
