//! The precision ladder: random rays in regimes where single precision goes wrong, and how often
//! each form of the intersection does.
//!
//! [`run()`] lays out random scenes and rays of each [`Regime`], asks every [`Form`] what the rays
//! hit, and counts where an answer is not that of the [`reference`](mod@reference), which is
//! certain. Spherule itself takes part as it ships: through [`crate::query::SphereTree`] for rays
//! from anywhere, with and without a bound of the distance, and through the renderer's own world and
//! walk for rays that start on a surface.
//! The counts are a function of seed, number of rays and regimes alone.
//!
//! ```
//! use spherule::stress::{Form, Options, Regime, run};
//!
//! let regimes = ["near_unit", "far_1e5"].map(|name| Regime::named(name).expect("a regime"));
//! let report = run(&Options { rays: 2000, seed: 7, regimes: regimes.to_vec() }, &|_| ());
//! assert_eq!(report.wrong(Form::Spherule), 0);
//! assert!(report.regimes[1].form(Form::Naive).wrong_hits > 100);
//! ```

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

pub use forms::Form;
pub use regimes::{REGIMES, Regime};
pub use report::{FormReport, RegimeReport, Report};
pub use run::{Options, run};
