//! Headers of saved renders: everything except the sums of the film.

use super::part::ImagePart;
use super::state::{State, Step};
use super::status::Status;
use super::{End, ResumableRender, Totals};
use crate::film::{Film, Region, TILE, TileHeader};
use crate::noise::{Slope, StopCondition};
use crate::scene::Settings;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Upper limit of counts, far above those of any render, and small enough that sums do not overflow.
const MAX_COUNT: u64 = 1 << 60;

/// Upper limit of times, likewise.
const MAX_TIME: Duration = Duration::from_secs(1 << 40);

/// The state of an unfinished render except for the sums of its film.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RenderHeader {
    settings: Settings,
    stop_conditions: Vec<StopCondition>,
    met: usize,
    pub(crate) statistics: bool,
    totals: Totals,
    end: End,
    pub(crate) region: Region,
    part: ImagePart,
    round: u32,
    plan: Vec<Step>,
    begun: usize,
    refined: Vec<u32>,
    steps: Slope,
    slope: Slope,
    tiles: Vec<TileHeader>,
}

impl RenderHeader {
    /// Returns the header of an unfinished render.
    pub(crate) fn of(render: &ResumableRender) -> Self {
        let state = &render.state;
        Self {
            settings: render.settings.clone(),
            stop_conditions: render.stop_conditions.clone(),
            met: render.met,
            statistics: render.statistics,
            totals: render.totals,
            end: render.end,
            region: state.film.region,
            part: render.part.clone(),
            round: state.round,
            plan: state.plan.clone(),
            begun: state.begun,
            refined: state.refined.clone(),
            steps: state.steps,
            slope: state.slope,
            tiles: state.film.tile_headers(),
        }
    }

    /// Checks the header; the error says what is invalid. A render that resumes from a valid header may
    /// give a wrong image, but does not fail.
    pub(crate) fn check(&self) -> Result<(), &'static str> {
        require(self.settings.check().is_ok(), "invalid settings")?;
        let inside = self.region.check_in(self.settings.width, self.settings.height);
        require(inside.is_ok(), "a region that is not in the picture")?;
        let whole = ImagePart::whole(self.region, self.settings.spp);
        let part = self.part.common(&whole).filter(|common| *common == self.part);
        let part = part.filter(|part| !self.settings.has_target() || *part == whole);
        let tiles = part.map(|part| part.tiles.len());
        require(tiles == Some(self.tiles.len()), "a wrong number of tiles")?;
        let spp = self.stop_conditions.iter().map(|stop| stop.spp);
        let most = spp.chain([self.part.samples.len() as u32]).max().unwrap_or(0);
        let valid = |tile: &TileHeader| {
            tile.samples.max(tile.probe_samples) <= most && tile.probe_rays <= MAX_COUNT
        };
        require(self.tiles.iter().all(valid), "more samples than requested")?;
        require(self.tiles.iter().all(TileHeader::is_valid), "sums of invalid length")?;
        self.check_plan(most)?;
        require(is_small(&self.totals), "implausible counts")
    }

    fn check_plan(&self, most: u32) -> Result<(), &'static str> {
        let exists = |tile: u32| (tile as usize) < self.tiles.len();
        let steps = self.plan.iter().all(|step| exists(step.tile) && step.samples <= most);
        let refined = self.refined.iter().all(|tile| exists(*tile));
        require(steps && refined && self.begun <= self.plan.len(), "a plan for missing tiles")?;
        let last = self.stop_conditions.last().copied();
        let expected = self.settings.has_target().then(|| StopCondition::of(&self.settings));
        require(last == expected && self.met <= self.stop_conditions.len(), "inconsistent targets")
    }

    /// Returns the progress of a render whose header has passed [`RenderHeader::check`].
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

    /// Returns the number of pixels that have sums: those of the tiles of the part.
    pub(crate) fn pixels(&self) -> u64 {
        let tiles = Film::tile_regions(self.region).skip(self.part.tiles.start as usize);
        tiles.take(self.part.tiles.len()).map(Region::area).sum()
    }

    /// Returns the maximum bytes of the sums of the film.
    pub(crate) fn film_bytes(&self) -> u64 {
        let tile = u64::from(TILE * TILE) * size_of::<[f64; 3]>() as u64;
        self.tiles.iter().map(|kept| kept.levels() * tile).sum()
    }

    /// Returns the render of a header that has passed [`RenderHeader::check`]; the sums of its film are
    /// still to be filled.
    pub(crate) fn begin(self) -> ResumableRender {
        let mut film = Film::with_tiles(self.region, self.part.tiles.clone(), self.statistics);
        film.restore_tiles(&self.tiles, self.settings.seed);
        let state = State {
            film,
            round: self.round,
            plan: self.plan,
            begun: self.begun,
            refined: self.refined,
            steps: self.steps,
            slope: self.slope,
        };
        ResumableRender {
            settings: self.settings,
            stop_conditions: self.stop_conditions,
            met: self.met,
            statistics: self.statistics,
            part: self.part,
            state,
            totals: self.totals,
            end: self.end,
        }
    }
}

fn require(holds: bool, what: &'static str) -> Result<(), &'static str> {
    if holds { Ok(()) } else { Err(what) }
}

fn is_small(totals: &Totals) -> bool {
    let counters = totals.counters.all();
    let mut times = totals.tasks.times().chain([totals.elapsed, totals.times.longest()]);
    counters.into_iter().all(|count| count <= MAX_COUNT)
        && totals.tasks.count <= MAX_COUNT
        && times.all(|time| time <= MAX_TIME)
}
