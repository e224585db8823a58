//! The arithmetic of a device, found by test.

use crate::device::{Device, Size};
use crate::error::DeviceError;
use crate::stages::Kernel;
use crate::tree::Params;
use spherule_core::internals::random::Random;

/// Operands that are tried, and operands whose results are near the least number.
const ORDINARY: usize = 1 << 16;
const LEAST: usize = 1 << 10;

/// Results of each triple in double precision.
const DOUBLES: usize = 12;

/// Treatment of results that are too small to be normal numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Subnormals {
    /// They are as on the processor.
    #[default]
    Kept,
    /// Some are 0.
    Flushed,
}

/// Rounding of `fma`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fma {
    /// Once.
    #[default]
    Fused,
    /// The product, and then the sum.
    Unfused,
    /// Sometimes so and sometimes otherwise.
    Mixed,
}

/// One operation: how many results differ from those of the processor, and how many are farther from the true ones than
/// WGSL allows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operation {
    /// The name.
    pub name: &'static str,
    /// Results that are not correctly rounded.
    pub unequal: usize,
    /// Results that break the promise.
    pub broken: usize,
}

/// Results of the operations of a device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Probe {
    /// Sum, difference, product, quotient and square root.
    pub operations: [Operation; 5],
    /// `fma`.
    pub fma: Fma,
    /// Results that are too small.
    pub subnormals: Subnormals,
    /// True if `x * y + z` is fused, sometimes or always, where nobody asks for it.
    pub contracts: bool,
    /// True if kernels of paths leave sums of products to `fma`, and do not compute them in double precision.
    pub fuses: bool,
    /// Whether double precision gives the processor's results; `None` if kernels have none.
    pub doubles: Option<bool>,
    /// Operands that were tried.
    pub tried: usize,
}

impl Probe {
    /// Returns whether sums, differences, products, quotients and roots are those of the processor, `fma` is fused and
    /// small numbers are kept.
    pub fn is_like_the_processor(&self) -> bool {
        let equal = self.operations.iter().all(|operation| operation.unequal == 0);
        equal && self.fma == Fma::Fused && self.subnormals == Subnormals::Kept && !self.contracts
    }

    /// Returns what paths need and the device lacks, if anything. They do not need the least numbers.
    pub(crate) fn lacks_for_paths(&self) -> Option<&'static str> {
        let unequal = self.operations[..3].iter().any(|operation| operation.unequal > 0);
        match self.doubles {
            None => Some("its kernels have no double precision"),
            Some(false) => Some("its double precision is not the processor's"),
            Some(true) if unequal => Some("its single precision is not the processor's"),
            Some(true) => None,
        }
    }

    /// Returns the operations that break the promises of WGSL on which the kernels rely. They do not rely on roots.
    pub(crate) fn broken(&self) -> Option<String> {
        let broken = self.operations[..4].iter().filter(|operation| operation.broken > 0);
        let names: Vec<_> = broken.map(|operation| operation.name).collect();
        (!names.is_empty()).then(|| names.join(", "))
    }
}

/// Tests the arithmetic of a device.
pub(crate) fn run(device: &Device) -> Result<Probe, DeviceError> {
    let operands = operands();
    let mut probe = judge(&operands, &compute(device, &operands)?);
    if device.has_doubles() {
        probe.fuses = probe.fma == Fma::Fused && are_like_the_processor(device, true)?;
        probe.doubles = Some(probe.fuses || are_like_the_processor(device, false)?);
    }
    Ok(probe)
}

/// Returns whether double precision, and what kernels make of it, gives the processor's results; sums of products are those of
/// `fma` if `fused`.
fn are_like_the_processor(device: &Device, fused: bool) -> Result<bool, DeviceError> {
    let operands = double_operands();
    let params = Params { count: operands.len() as u32, ..Params::default() };
    let bytes = (size_of::<[f64; DOUBLES]>() * operands.len()) as u64;
    let storage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
    let numbers = device.buffer("numbers", size_of::<Params>() as u64, storage)?;
    device.write(&numbers, bytemuck::bytes_of(&params));
    let input = device.filled("operands", bytemuck::cast_slice(&operands))?;
    let output = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let output = device.buffer("results", bytes, output)?;
    let copy = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
    let copy = device.buffer("results to read", bytes, copy)?;
    let (mut work, size) = (device.work(), Size::Rows(operands.len()));
    work.run(Kernel::Doubles { fused }, &[&numbers, &input, &output], size)?;
    work.submit();
    let mut results = vec![[0.0; DOUBLES]; operands.len()];
    device.read_rows(&output, &copy, bytemuck::cast_slice_mut(&mut results))?;
    let own = |&[x, y, z]: &[f64; 3]| {
        let [a, b, c] = [x, y, z].map(|x| x as f32);
        let centered = 2.0 * (a - 1.0) - 1.0_f32.next_down();
        let singles = [a, a.mul_add(b, c), a / b, a.abs().sqrt(), centered].map(f64::from);
        let [rounded, fused, quotient, root, centered] = singles;
        let doubles = [x + y, x - y, x * y, x / y, x.abs().sqrt(), x * z + y];
        let [sum, difference, product, ratio, length, plain] = doubles;
        let dot = x * x + y * y + z * z;
        [
            sum, difference, product, ratio, length, plain, rounded, fused, quotient, root, dot,
            centered,
        ]
    };
    let bits = |row: [f64; DOUBLES]| row.map(f64::to_bits);
    Ok(operands.iter().zip(results).all(|(operands, found)| bits(own(operands)) == bits(found)))
}

/// Returns triples of numbers, of which single precision holds some, and some are in the middle between two that it
/// holds.
fn double_operands() -> Vec<[f64; 3]> {
    let mut random = Random::new(12);
    let mut number = |kind: usize| {
        let x = random.sign() * random.decades([-4.0, 4.0]) * random.between([1.0, 2.0]);
        let single = x as f32;
        match kind {
            0 => x,
            1 => f64::from(single),
            2 => f64::midpoint(f64::from(single), f64::from(single.next_up())),
            _ => f64::from(single).next_up(),
        }
    };
    let triple = |row: usize| {
        let [x, y, z] = [row % 4, row / 4 % 2, row / 8 % 2].map(&mut number);
        // Also such as cancel.
        [x, y, if row.is_multiple_of(3) { f64::from((-x * y) as f32) } else { z }]
    };
    (0..ORDINARY).map(triple).collect()
}

/// Returns triples of numbers.
fn operands() -> Vec<[f32; 4]> {
    let mut random = Random::new(11);
    let number = |random: &mut Random, decades: [f64; 2]| {
        (random.sign() * random.decades(decades) * random.between([1.0, 2.0])) as f32
    };
    let ordinary = |random: &mut Random| {
        let x = number(random, [-4.0, 4.0]);
        // Also such as cancel.
        let y = if random.coin() {
            number(random, [-4.0, 4.0])
        } else {
            -x * (1.0 + 1e-3 * random.unit() as f32)
        };
        let z = if random.coin() { number(random, [-4.0, 4.0]) } else { -x * y };
        [x, y, z, 0.0]
    };
    let least = |random: &mut Random| {
        let x = number(random, [-20.0, -19.0]);
        [x, number(random, [-20.0, -19.0]), 0.0, 0.0]
    };
    let mut operands: Vec<_> = (0..ORDINARY).map(|_| ordinary(&mut random)).collect();
    operands.extend((0..LEAST).map(|_| least(&mut random)));
    operands
}

/// Computes all operations on the device.
fn compute(device: &Device, operands: &[[f32; 4]]) -> Result<Vec<[f32; 8]>, DeviceError> {
    let kernel = device.kernel("probe", include_str!("probe.wgsl"), &[])?;
    let bytes = (size_of::<[f32; 8]>() * operands.len()) as u64;
    let input = device.filled("operands", bytemuck::cast_slice(operands))?;
    let output = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let output = device.buffer("results", bytes, output)?;
    let copy = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
    let copy = device.buffer("results to read", bytes, copy)?;
    let kernel = device.bind(&kernel, &[&input, &output]);
    let submitted = device.dispatch(&kernel, operands.len(), &output, &copy, bytes);
    let mut results = vec![[0.0; 8]; operands.len()];
    device.read(&copy, bytes, submitted, |view| {
        bytemuck::cast_slice_mut(&mut results).copy_from_slice(view);
    })?;
    Ok(results)
}

/// Compares results with those of the processor.
fn judge(operands: &[[f32; 4]], results: &[[f32; 8]]) -> Probe {
    let mut probe = Probe { tried: operands.len(), ..Probe::default() };
    for (operation, name) in probe.operations.iter_mut().zip(["+", "-", "*", "/", "sqrt"]) {
        operation.name = name;
    }
    let (mut fused, mut unfused) = (true, true);
    for (&[x, y, z, _], &[sum, difference, product, quotient, fma, plain, root, _]) in
        operands[..ORDINARY].iter().zip(results)
    {
        let [a, b] = [x, y].map(f64::from);
        // In double precision sums and products of these numbers do not round, and others round too little to matter.
        let truths = [a + b, a - b, a * b, a / b, a.abs().sqrt()];
        let found = [sum, difference, product, quotient, root];
        let allowed = [1.0, 1.0, 1.0, 2.5, 5.0];
        for (i, operation) in probe.operations.iter_mut().enumerate() {
            let right = [x + y, x - y, x * y, x / y, x.abs().sqrt()][i];
            operation.unequal += usize::from(found[i] != right);
            let unit = f64::from(right.abs().next_up() - right.abs());
            let close = (f64::from(found[i]) - truths[i]).abs() < allowed[i] * unit * (1.0 + 1e-6);
            operation.broken += usize::from(!close);
        }
        let (once, twice) = (x.mul_add(y, z), x * y + z);
        fused &= fma == once;
        unfused &= fma == twice;
        probe.contracts |= plain != twice;
    }
    probe.fma = match (fused, unfused) {
        (true, _) => Fma::Fused,
        (false, true) => Fma::Unfused,
        (false, false) => Fma::Mixed,
    };
    let small = operands[ORDINARY..].iter().zip(&results[ORDINARY..]);
    let kept = small.clone().all(|(operand, result)| result[2] == operand[0] * operand[1]);
    probe.subnormals = if kept { Subnormals::Kept } else { Subnormals::Flushed };
    for (&[x, y, ..], result) in small {
        // Flushed, or off by no more than the least normal number.
        let error = (f64::from(result[2]) - f64::from(x) * f64::from(y)).abs();
        probe.operations[2].broken +=
            usize::from(error.is_nan() || error > f64::from(f32::MIN_POSITIVE));
    }
    probe
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The processor's own results.
    fn own(operands: &[[f32; 4]]) -> Vec<[f32; 8]> {
        let row = |&[x, y, z, _]: &[f32; 4]| {
            [x + y, x - y, x * y, x / y, x.mul_add(y, z), x * y + z, x.abs().sqrt(), 0.0]
        };
        operands.iter().map(row).collect()
    }

    #[test]
    fn the_processor_is_like_the_processor() {
        let operands = operands();
        let probe = judge(&operands, &own(&operands));
        assert!(probe.is_like_the_processor(), "{probe:?}");
        assert_eq!((probe.broken(), probe.tried), (None, ORDINARY + LEAST));
    }

    #[test]
    fn what_paths_lack_is_named() {
        let operands = operands();
        let lacks = |doubles: Option<bool>, change: &dyn Fn(&mut [f32; 8])| {
            let mut results = own(&operands);
            results.iter_mut().for_each(change);
            Probe { doubles, ..judge(&operands, &results) }.lacks_for_paths()
        };
        assert_eq!(lacks(Some(true), &|_| ()), None);
        assert_eq!(lacks(None, &|_| ()), Some("its kernels have no double precision"));
        let unlike = Some("its double precision is not the processor's");
        assert_eq!(lacks(Some(false), &|_| ()), unlike);
        let single = Some("its single precision is not the processor's");
        assert_eq!(lacks(Some(true), &|row| row[0] = row[0].next_up()), single);
        let flush = |row: &mut [f32; 8]| row[2] = if row[2].is_normal() { row[2] } else { 0.0 };
        // Numbers that small make no picture, and kernels make quotients, roots and fused sums themselves.
        assert_eq!(lacks(Some(true), &flush), None);
        assert_eq!(lacks(Some(true), &|row| row[3] = row[3].next_up()), None);
        assert_eq!(lacks(Some(true), &|row| row[4] = row[5]), None);
    }

    #[test]
    fn what_differs_is_found_and_what_breaks_promises_is_named() {
        let operands = operands();
        let changed = |change: &dyn Fn(&[f32; 4], &mut [f32; 8])| {
            let mut results = own(&operands);
            results.iter_mut().zip(&operands).for_each(|(row, operand)| change(operand, row));
            judge(&operands, &results)
        };
        let next = changed(&|_, row| row[3] = row[3].next_up().next_up());
        assert!(next.operations[3].unequal >= ORDINARY && next.broken().is_none());
        assert!(!next.is_like_the_processor());
        let far = changed(&|_, row| row[2] = row[2].next_up().next_up());
        assert_eq!(far.broken().as_deref(), Some("*"));
        let flushed = changed(&|_, row| row[2] = if row[2].is_normal() { row[2] } else { 0.0 });
        assert_eq!((flushed.subnormals, flushed.broken()), (Subnormals::Flushed, None));
        let unfused = changed(&|_, row| row[4] = row[5]);
        assert_eq!((unfused.fma, unfused.is_like_the_processor()), (Fma::Unfused, false));
        let fused = changed(&|_, row| row[5] = row[4]);
        assert!(fused.contracts && fused.fma == Fma::Fused);
        let wild = changed(&|operand, row| row[4] += operand[2]);
        assert_eq!(wild.fma, Fma::Mixed);
    }

    #[test]
    #[ignore = "needs a GPU, or Vulkan in software"]
    fn sums_of_products_are_left_to_the_device_only_if_they_are_the_processors() {
        let device = Device::best(true).unwrap();
        assert!(device.has_doubles());
        let like = [false, true].map(|fused| are_like_the_processor(&device, fused));
        let [own, fused] = like.map(Result::unwrap_or_default);
        let probe = device.probe();
        // Software rounds `fma` twice.
        assert_eq!((probe.fuses, fused), (probe.fma == Fma::Fused, probe.fma == Fma::Fused));
        assert_eq!(probe.doubles, Some(own || fused));
    }
}
