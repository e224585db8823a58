use super::*;
use crate::columns::Columns;
use crate::observations::{ID, WEIGHT};
use crate::regression::{SQUARE, predict, predict_by_squares};
use crate::rows::MARGIN;
use spherule_transport::lanes::{F32x16, Lanes, MAX_LANES};
use spherule_transport::sampling::{mix, unit};

const WIDTH: u32 = 150;
const HEIGHT: u32 = 70;

/// Returns a number in -1/2..1/2 for a pixel.
fn noise_at(pixel: u32) -> f32 {
    unit(mix(pixel.into()) as u32) - 0.5
}

/// An image, the variance of its pixels, and their features.
struct Sample {
    image: Image,
    variance: Image,
    features: Vec<Features>,
}

impl Sample {
    fn input(&self) -> Input<'_> {
        let values = self.image.pixels.as_flattened();
        let floor = values.iter().map(|x| x * x).sum::<f32>() / values.len() as f32;
        Input { image: &self.image, variance: &self.variance, features: &self.features, floor }
    }

    fn denoised(&self) -> Denoised {
        let mut denoised = Denoised::black(self.image.width, self.image.height);
        assert!(self.input().denoise(&mut denoised, || false));
        denoised
    }
}

/// An image of two surfaces, on the left and on the right, with noise of this size.
fn sample(noise: f32) -> Sample {
    let pixels: Vec<u32> = (0..WIDTH * HEIGHT).collect();
    let is_left = |pixel: u32| pixel % WIDTH < WIDTH / 2;
    let radiance = |&pixel: &u32| {
        let light = 1.0 + noise * noise_at(pixel);
        if is_left(pixel) { [0.5 * light, 0.1 * light, 0.0] } else { [0.25 * light; 3] }
    };
    let features = |&pixel: &u32| {
        let (albedo, normal) = if is_left(pixel) {
            ([1.0, 0.2, 0.0], [1.0, 0.0, 0.0])
        } else {
            ([0.5; 3], [0.0, 0.0, 1.0])
        };
        let id = u32::from(is_left(pixel));
        Features { albedo, normal, depth: 1.0, coverage: 1.0, ground: 0.0, id }
    };
    let image =
        Image { width: WIDTH, height: HEIGHT, pixels: pixels.iter().map(radiance).collect() };
    let of_pixel = |pixel: &[f32; 3]| pixel.map(|x| (noise * x).powi(2) / 12.0);
    let variance = Image { pixels: image.pixels.iter().map(of_pixel).collect(), ..image.clone() };
    let features = pixels.iter().map(features).collect();
    Sample { image, variance, features }
}

#[test]
fn pictures_without_noise_stay_as_they_are() {
    let sample = sample(0.0);
    let denoised = sample.denoised();
    assert_eq!(denoised.image, sample.image);
    assert!(denoised.squared_error.iter().all(|&error| error == 0.0));
}

#[test]
fn cancelled_denoising_leaves_the_tiles_that_remain() {
    let sample = sample(0.4);
    let until = |flag| {
        let image = sample.image.clone();
        let mut denoised = Denoised { squared_error: vec![0.0; image.pixels.len()], image };
        let is_whole = sample.input().denoise(&mut denoised, || flag);
        (is_whole, denoised)
    };
    let (is_whole, denoised) = until(true);
    assert!(!is_whole && denoised.image == sample.image);
    let (is_whole, denoised) = until(false);
    assert!(is_whole && denoised == sample.denoised());
}

#[test]
fn noise_falls_and_edges_stay() {
    let truth = sample(0.0).image;
    let sample = sample(0.4);
    let denoised = sample.denoised();
    let error = |image: &Image| {
        let pairs = image.pixels.as_flattened().iter().zip(truth.pixels.as_flattened());
        pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>() / f64::from(3 * WIDTH * HEIGHT)
    };
    let (before, after) = (error(&sample.image), error(&denoised.image));
    assert!(after < before / 20.0, "{before} {after}");
    // The surfaces differ in both features, so neither pixel beside the edge has any of the other's green. Squares across the
    // edge have some of its blue.
    let column = (WIDTH / 2) as usize;
    for row in denoised.image.pixels.chunks(WIDTH as usize) {
        assert!((row[column - 1][1] - 0.1).abs() < 0.03 && (row[column][1] - 0.25).abs() < 0.06);
        assert!((0.0..1e-4).contains(&row[column - 1][2]));
    }
    let stated = denoised.squared_error.iter().map(|&x| f64::from(x)).sum::<f64>();
    let stated = stated / f64::from(WIDTH * HEIGHT);
    // Estimates of single pixels are uncertain by some hundredths of the noise, and not below 0, so their mean is above the
    // true error.
    assert!(after < stated && stated < after + before / 20.0, "{stated} {after} {before}");
}

#[test]
fn rare_bright_pixels_leave_no_stain() {
    let mut sample = sample(0.1);
    let at = (40 * WIDTH + 100) as usize;
    sample.image.pixels[at] = [50.0; 3];
    // One bright sample of sixteen, of a sequence with less noise than independent samples.
    sample.variance.pixels[at] = [0.4 * 50.0 * 50.0; 3];
    let denoised = sample.denoised().image;
    assert!(denoised.pixels.iter().all(|pixel| pixel.iter().all(|&x| x < 1.0)));
}

/// The columns of a tile of the image with noise of this size, as far as predictions of row `y` need them.
fn columns_of(noise: f32, y: usize) -> Columns {
    let sample = sample(noise);
    let mut columns = Columns::default();
    columns.begin();
    for y in 0..=y {
        columns.advance(
            &sample.input(),
            Region { x: 0, y: 0, width: 120, height: 64 },
            MARGIN[1] + y,
        );
    }
    columns
}

#[test]
fn squares_are_means_of_their_pixels() {
    // At a corner of the image, on a surface, and across the edge of both.
    for (x, y) in [(0, 0), (20, 30), (75, 30)] {
        let columns = columns_of(0.3, y);
        let (x, y) = (MARGIN[0] + x, MARGIN[1] + y);
        let value = |column: usize, [x, y]: [usize; 2]| columns.pixels.row(y)[column][x];
        let around = (0..SQUARE * SQUARE)
            .map(|i| [x + i % SQUARE - SQUARE / 2, y + i / SQUARE - SQUARE / 2]);
        let squares = columns.squares.row(y);
        let weight: f32 = around.clone().map(|at| value(WEIGHT, at)).sum();
        let count = (SQUARE * SQUARE) as f32;
        assert!((squares[WEIGHT][x] - weight / count).abs() < 1e-6);
        for (column, squares) in squares.iter().enumerate().take(WEIGHT) {
            let product = |at| value(WEIGHT, at) * value(column, at);
            let mean = around.clone().map(product).sum::<f32>() / weight;
            assert!((squares[x] - mean).abs() < 1e-6, "{column}");
        }
        assert_eq!(squares[ID][x].to_bits(), value(ID, [x, y]).to_bits());
    }
}

#[test]
fn rows_are_denoised_alike_after_rows_without_noise() {
    // The image with noise, a part without, and the image again: all in a tile, or from the middle of that part on.
    let Sample { mut image, mut variance, mut features } = sample(0.3);
    let count = image.pixels.len();
    let repeat = |pixels: &mut Vec<[f32; 3]>, between: [f32; 3]| {
        let noisy = pixels.clone();
        pixels.resize(2 * count, between);
        pixels.extend(noisy);
    };
    repeat(&mut image.pixels, [0.5; 3]);
    repeat(&mut variance.pixels, [0.0; 3]);
    let noisy = features.clone();
    features.resize(2 * count, noisy[0]);
    features.extend(noisy);
    let below = |pixels: &[[f32; 3]], rows| Image {
        width: WIDTH,
        height: rows,
        pixels: pixels[pixels.len() - (rows * WIDTH) as usize..].to_vec(),
    };
    let denoised = |rows: u32| {
        let (image, variance) = (below(&image.pixels, rows), below(&variance.pixels, rows));
        let features = &features[3 * count - image.pixels.len()..];
        let input = Input { image: &image, variance: &variance, features, floor: 0.1 };
        let region = Region { x: 0, y: 0, width: 120, height: rows };
        let pixels = Workspace::default().denoise(&input, region);
        pixels[pixels.len() - 120 * HEIGHT as usize..].to_vec()
    };
    assert!(denoised(3 * HEIGHT) == denoised(HEIGHT + HEIGHT / 2));
}

#[test]
fn much_noise_is_averaged_over_squares() {
    let truth = sample(0.0).image;
    let mut sample = sample(1.0);
    let of_light = |light: &[f32; 3]| light.map(|x| x * x / 12.0);
    sample.variance.pixels = truth.pixels.iter().map(of_light).collect();
    let denoised = sample.denoised();
    // Of the surface on the right, far from its edges.
    let error = |image: &Image| {
        let rows = image.pixels.chunks(WIDTH as usize).zip(truth.pixels.chunks(WIDTH as usize));
        let inner = rows.skip(20).take(30).flat_map(|(a, b)| a[100..130].iter().zip(&b[100..130]));
        inner.map(|(a, b)| f64::from(a[0] - b[0]).powi(2)).sum::<f64>()
    };
    // A window of pixels alone would leave a 49th.
    let (before, after) = (error(&sample.image), error(&denoised.image));
    assert!(after < before / 80.0, "{before} {after}");
}

#[test]
fn lanes_do_not_change_predictions() {
    const Y: usize = 30;
    let columns = columns_of(0.3, Y);
    for first in [0, 64, 96] {
        let (y, x) = (MARGIN[1] + Y, MARGIN[0] + first);
        let wide = [&predict::<F32x16>(&columns, y, x)[..], &[predict_by_squares(&columns, y, x)]];
        for lane in 0..MAX_LANES {
            let [near, far] = predict::<f32>(&columns, y, x + lane);
            let one = [near, far, predict_by_squares(&columns, y, x + lane)];
            for (wide, one) in wide.concat().iter().zip(one) {
                let mut row = [0.0; MAX_LANES];
                Lanes::store(wide.leverage, &mut row);
                assert_eq!(row[lane].to_bits(), one.leverage.to_bits());
                Lanes::store(wide.irradiance[0], &mut row);
                assert_eq!(row[lane].to_bits(), one.irradiance[0].to_bits());
            }
        }
    }
}
