//! Programs that are built with GPUs.

use super::summary::DeviceSummary;
use crate::cli::options::names::Device as Choice;
use crate::cli::output;
use indicatif::BinaryBytes;
use serde::Serialize;
use spherule_gpu::{
    AdapterSummary, Adapters, Answered, Device, DeviceError, DeviceTree, Fma, Integrator,
    Operation, Probe, Subnormals,
};
use spherule_render::World;
use spherule_render::bvh::Tree;
use spherule_render::render::not_followed;
use spherule_render::scene::Settings;
use std::sync::{Arc, OnceLock};

/// The device of this process. Once it is lost, the processor does all that follows.
static DEVICE: OnceLock<Result<Arc<Device>, DeviceError>> = OnceLock::new();

/// The device that follows the paths of a world's renders.
#[derive(Debug)]
pub(in crate::cli) struct Attached {
    choice: Choice,
    tree: Option<Arc<DeviceTree>>,
    refusal: Option<String>,
    /// True once it was told that the device is lost.
    told: bool,
}

impl Attached {
    /// Copies a world's spheres to a device if that is wanted and possible, and lets it follow the paths of a render.
    pub(in crate::cli) fn to(world: &mut World, settings: &Settings, choice: Choice) -> Self {
        let mut attached = Self { choice, tree: None, refusal: None, told: false };
        if choice != Choice::Gpu {
            return attached;
        }
        match on_device(world, settings) {
            Ok((tree, paths)) => {
                world.device_paths = Some(Arc::new(paths));
                attached.tree = Some(tree);
            }
            Err(why) => attached.refusal = Some(format!("--device gpu has no effect: {why}")),
        }
        attached
    }

    /// Does for another world what was done for the last one.
    pub(in crate::cli) fn renew(&mut self, world: &mut World, settings: &Settings) {
        *self = Self { told: self.told, ..Self::to(world, settings, self.choice) };
    }

    /// The reason why there is no device, if one was asked for.
    pub(in crate::cli) fn refusal(&self) -> Option<String> {
        self.refusal.clone()
    }

    /// Returns lines about the device.
    pub(in crate::cli) fn facts(&self) -> Vec<String> {
        let Some(tree) = &self.tree else { return Vec::new() };
        let device = tree.device();
        let AdapterSummary { name, backend, .. } = device.summary();
        let bytes = BinaryBytes(tree.bytes());
        let but = match device.probe().subnormals {
            Subnormals::Kept => "",
            Subnormals::Flushed => ", unless light below 1.2e-38 matters",
        };
        vec![
            format!(
                "device: {name} ({backend}), with {bytes} of spheres and tree, follows paths from the camera to their ends, and so does the processor"
            ),
            format!(
                "its arithmetic: {}; the processor follows the paths that the device is not certain of, and images are the processor's to the byte{but}",
                arithmetic(device.probe())
            ),
        ]
    }

    /// Returns the fault of the device, if it has one.
    pub(in crate::cli) fn fault(&self) -> Option<String> {
        let error = self.tree.as_ref()?.device().fault()?;
        Some(format!("{error}; the processor rendered what was left"))
    }

    /// [`Attached::fault`], once.
    pub(in crate::cli) fn new_fault(&mut self) -> Option<String> {
        let fault = self.fault().filter(|_| !self.told)?;
        self.told = true;
        Some(fault)
    }

    /// Returns the counts of the device's rays.
    pub(in crate::cli) fn summary(&self) -> Option<DeviceSummary> {
        let tree = self.tree.as_ref()?;
        let name = tree.device().summary().name.clone();
        let Answered { rays, unknown, paths, unknown_paths, .. } = tree.tally();
        Some(DeviceSummary { name, rays, unknown, paths, unknown_paths })
    }
}

/// Copies the spheres, the tree and the materials of a world to the device, or says why it cannot follow the paths of a
/// render.
fn on_device(world: &World, settings: &Settings) -> Result<(Arc<DeviceTree>, Integrator), String> {
    if let Some(why) = not_followed(world, settings) {
        return Err(format!("no GPU follows these paths yet: {why}"));
    }
    let device = open()?;
    let tree = Tree { bvh: &world.bvh, spheres: &world.spheres };
    let tree = DeviceTree::new(&device, tree).map(Arc::new).map_err(|error| error.to_string())?;
    let paths = Integrator::new(&tree, world)?;
    Ok((tree, paths))
}

/// Returns the device of this process, or why there is none.
pub(in crate::cli) fn open() -> Result<Arc<Device>, String> {
    let device = DEVICE.get_or_init(|| Device::best(true).map(Arc::new));
    device.clone().map_err(|error| error.to_string())
}

/// An adapter in JSON.
#[derive(Serialize)]
struct Listed {
    name: String,
    backend: String,
    kind: &'static str,
    driver: String,
    max_buffer_bytes: u64,
    max_binding_bytes: u64,
    storage_buffers: u32,
    subgroup_sizes: [u32; 2],
    /// Results of the probe; null if the device cannot be used.
    arithmetic: Option<String>,
    /// True if its operations give the processor's results.
    like_the_processor: bool,
    /// Why it cannot be used.
    error: Option<String>,
}

impl Listed {
    fn new(adapters: &Adapters, place: usize, summary: AdapterSummary) -> Self {
        let (probe, error) = match adapters.open(place) {
            Ok(device) => (Some(device.probe().clone()), None),
            Err(error) => (None, Some(error.to_string())),
        };
        Self {
            name: summary.name,
            backend: summary.backend,
            kind: summary.kind,
            driver: summary.driver,
            max_buffer_bytes: summary.max_buffer,
            max_binding_bytes: summary.max_binding,
            storage_buffers: summary.max_storage_buffers,
            subgroup_sizes: summary.subgroups,
            arithmetic: probe.as_ref().map(arithmetic),
            like_the_processor: probe.is_some_and(|probe| probe.is_like_the_processor()),
            error,
        }
    }

    fn print(&self) {
        let [least, most] = self.subgroup_sizes;
        output::print(format_args!(
            "{}: {}, {}\n\
             driver       {}\n\
             buffers      {}, bound {}, {} at once\n\
             subgroups    {least} to {most} lanes",
            self.name,
            self.kind,
            self.backend,
            self.driver,
            BinaryBytes(self.max_buffer_bytes),
            BinaryBytes(self.max_binding_bytes),
            self.storage_buffers,
        ));
        if let Some(arithmetic) = &self.arithmetic {
            output::print(format_args!("arithmetic   {arithmetic}"));
        }
        if let Some(error) = &self.error {
            output::print(format_args!("unusable     {error}"));
        }
    }
}

/// Lists all adapters.
pub(in crate::cli) fn list(json: bool) {
    let adapters = Adapters::find();
    let summaries = adapters.summaries().into_iter().enumerate();
    let listed: Vec<_> =
        summaries.map(|(place, summary)| Listed::new(&adapters, place, summary)).collect();
    if json {
        return output::print_json(&listed);
    }
    if listed.is_empty() {
        output::note(DeviceError::NoAdapter);
    }
    listed.iter().for_each(Listed::print);
}

/// Returns what a probe found, in a line.
fn arithmetic(probe: &Probe) -> String {
    let [equal, others]: [Vec<&Operation>; 2] = [true, false]
        .map(|wanted| probe.operations.iter().filter(|o| (o.unequal == 0) == wanted).collect());
    let mut facts = Vec::new();
    if !equal.is_empty() {
        let names: Vec<_> = equal.iter().map(|operation| operation.name).collect();
        facts.push(format!("{} as on the processor", names.join(" ")));
    }
    for Operation { name, unequal, .. } in others {
        facts.push(format!("{name} differs in {unequal} of {} results", probe.tried));
    }
    facts.push(match probe.fma {
        Fma::Fused => "fma rounds once".to_owned(),
        Fma::Unfused => "fma rounds twice".to_owned(),
        Fma::Mixed => "fma rounds once or twice".to_owned(),
    });
    if probe.contracts {
        facts.push("products and sums are fused unasked".to_owned());
    }
    facts.push(match probe.subnormals {
        Subnormals::Kept => "subnormal numbers are kept".to_owned(),
        Subnormals::Flushed => "subnormal numbers become 0".to_owned(),
    });
    facts.push(match probe.doubles {
        Some(true) => "double precision as on the processor".to_owned(),
        Some(false) => "double precision differs".to_owned(),
        None => "no double precision".to_owned(),
    });
    facts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probes_are_told_in_a_line() {
        let mut probe = Probe { tried: 9, ..Probe::default() };
        for (operation, name) in probe.operations.iter_mut().zip(["+", "-", "*", "/", "sqrt"]) {
            operation.name = name;
        }
        let same = "+ - * / sqrt as on the processor, fma rounds once, subnormal numbers are kept, no double precision";
        assert_eq!(arithmetic(&probe), same);
        probe.operations[3].unequal = 4;
        (probe.fma, probe.subnormals, probe.contracts) = (Fma::Mixed, Subnormals::Flushed, true);
        probe.doubles = Some(false);
        let other = "+ - * sqrt as on the processor, / differs in 4 of 9 results, fma rounds once or twice, \
                     products and sums are fused unasked, subnormal numbers become 0, double precision differs";
        assert_eq!(arithmetic(&probe), other);
    }
}
