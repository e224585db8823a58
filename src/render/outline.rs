//! All of an unfinished render but the sums of its film, as it is kept outside the program.

use super::part::ImagePart;
use super::state::{State, Step};
use super::status::Status;
use super::target::Stage;
use super::{End, ResumableRender, Totals};
use crate::film::{Film, KeptTile, Region, TILE};
use crate::noise::Slope;
use crate::scene::Settings;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// More of anything than any render does, and so few that sums of them do not overflow.
const MOST: u64 = 1 << 60;

/// Longer than any render takes, likewise.
const LONGEST: Duration = Duration::from_secs(1 << 40);

/// All of an unfinished render but the sums of its film.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Outline {
    settings: Settings,
    stages: Vec<Stage>,
    met: usize,
    pub(crate) statistics: bool,
    totals: Totals,
    end: End,
    pub(crate) region: Region,
    part: ImagePart,
    round: u32,
    plan: Vec<Step>,
    begun: usize,
    doubled: Vec<u32>,
    variance: f64,
    slope: Slope,
    tiles: Vec<KeptTile>,
}

impl Outline {
    /// Of a render that goes on.
    pub(crate) fn of(render: &ResumableRender) -> Self {
        let state = &render.state;
        Self {
            settings: render.settings.clone(),
            stages: render.stages.clone(),
            met: render.met,
            statistics: render.statistics,
            totals: render.totals,
            end: render.end,
            region: state.film.region,
            part: render.part.clone(),
            round: state.round,
            plan: state.plan.clone(),
            begun: state.begun,
            doubled: state.doubled.clone(),
            variance: state.variance,
            slope: state.slope,
            tiles: state.film.kept_tiles(),
        }
    }

    /// What is wrong with it, if it is none that any render has: whatever it says, a render that
    /// goes on from it may show nonsense, but does not fail.
    pub(crate) fn check(&self) -> Result<(), &'static str> {
        demand(self.settings.check().is_ok(), "settings that no render has")?;
        let inside = self.region.check_in(self.settings.width, self.settings.height);
        demand(inside.is_ok(), "a region that is not in the picture")?;
        let whole = ImagePart::whole(self.region, self.settings.spp);
        let part = self.part.common(&whole).filter(|common| *common == self.part);
        let part = part.filter(|part| !self.settings.has_target() || *part == whole);
        let tiles = part.map(|part| part.tiles.len());
        demand(tiles == Some(self.tiles.len()), "other tiles than its part has")?;
        let stages = self.stages.iter().map(|stage| stage.spp);
        let most = stages.chain([self.part.samples.len() as u32]).max().unwrap_or(0);
        let sound = |tile: &KeptTile| {
            tile.samples.max(tile.probe_samples) <= most && tile.probe_rays <= MOST
        };
        demand(self.tiles.iter().all(sound), "more samples than were asked for")?;
        demand(self.tiles.iter().all(KeptTile::is_sound), "sums of no or too many numbers")?;
        self.check_plan(most)?;
        demand(is_small(&self.totals), "counts that no render has")
    }

    fn check_plan(&self, most: u32) -> Result<(), &'static str> {
        let there = |tile: u32| (tile as usize) < self.tiles.len();
        let steps = self.plan.iter().all(|step| there(step.tile) && step.samples <= most);
        let doubled = self.doubled.iter().all(|tile| there(*tile));
        demand(steps && doubled && self.begun <= self.plan.len(), "a plan for other tiles")?;
        let last = self.stages.last().copied();
        let expected = self.settings.has_target().then(|| Stage::of(&self.settings));
        demand(last == expected && self.met <= self.stages.len(), "other targets than it has")
    }

    /// Progress of the render. It has passed [`Outline::check`].
    pub(crate) fn status(&self) -> Status {
        let tiles = Film::tile_regions(self.region).skip(self.part.tiles.start as usize);
        let pixels = tiles.map(|tile| u64::from(tile.width) * u64::from(tile.height));
        let wanted = self.part.samples.len() as u64;
        let counts = pixels.zip(&self.tiles).map(|(pixels, tile)| {
            (pixels.saturating_mul(tile.samples.into()), pixels.saturating_mul(wanted))
        });
        let (samples, wanted) = counts.fold((0_u64, 0_u64), |sum, count| {
            (sum.0.saturating_add(count.0), sum.1.saturating_add(count.1))
        });
        Status {
            settings: self.settings.clone(),
            region: self.region,
            part: self.part.clone(),
            statistics: self.statistics,
            samples,
            wanted,
            complete: self.end != End::Cancelled,
            elapsed: self.totals.elapsed,
        }
    }

    /// Bytes of the sums of the film, at most.
    pub(crate) fn film_bytes(&self) -> u64 {
        let tile = u64::from(TILE * TILE) * size_of::<[f64; 3]>() as u64;
        self.tiles.iter().map(|kept| kept.levels() * tile).sum()
    }

    /// The render, with a film whose sums are still to be filled. It has passed [`Outline::check`].
    pub(crate) fn begin(self) -> ResumableRender {
        let mut film = Film::with_tiles(self.region, self.part.tiles.clone(), self.statistics);
        film.restore_tiles(&self.tiles, self.settings.seed);
        let state = State {
            film,
            round: self.round,
            plan: self.plan,
            begun: self.begun,
            doubled: self.doubled,
            variance: self.variance,
            slope: self.slope,
        };
        ResumableRender {
            settings: self.settings,
            stages: self.stages,
            met: self.met,
            statistics: self.statistics,
            part: self.part,
            state,
            totals: self.totals,
            end: self.end,
        }
    }
}

fn demand(holds: bool, what: &'static str) -> Result<(), &'static str> {
    if holds { Ok(()) } else { Err(what) }
}

fn is_small(totals: &Totals) -> bool {
    let counters = totals.counters.all();
    let mut times = totals.tasks.times().chain([totals.elapsed, totals.times.longest()]);
    counters.into_iter().all(|count| count <= MOST)
        && totals.tasks.count <= MOST
        && times.all(|time| time <= LONGEST)
}
