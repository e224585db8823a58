//! Tests of GSD.

use super::*;

/// A chunk: frame, name, type, width, bytes.
type Chunk<'c> = (u64, &'c str, u8, u32, Vec<u8>);

/// A file of these chunks, in version 2 of the format.
fn gsd(chunks: &[Chunk]) -> Vec<u8> {
    let mut names: Vec<&str> = Vec::new();
    let (mut index, mut data) = (Vec::new(), vec![0; 256]);
    for &(frame, name, kind, width, ref bytes) in chunks {
        if !names.contains(&name) {
            names.push(name);
        }
        let id = names.iter().position(|own| *own == name).unwrap_or(0) as u16;
        let size = [1, 1, 2, 4, 8, 1, 2, 4, 8, 4, 8][usize::from(kind)];
        let rows = bytes.len() as u64 / size / u64::from(width);
        index.extend([frame, rows, data.len() as u64].map(u64::to_le_bytes).concat());
        index.extend(width.to_le_bytes());
        index.extend(id.to_le_bytes());
        index.extend([kind, 0]);
        data.extend(bytes);
    }
    let (index_at, entries) = (data.len() as u64, chunks.len() as u64 + 1);
    data.extend(index);
    data.extend([0; 32]);
    let names_at = data.len() as u64;
    let mut list =
        names.iter().flat_map(|name| [name.as_bytes(), &[0]].concat()).collect::<Vec<_>>();
    list.resize(list.len().div_ceil(64) * 64, 0);
    let fields = list.len() as u64 / 64;
    data.extend(list);
    let header = [0x65DF_65DF_65DF_65DF, index_at, entries, names_at, fields];
    data[..40].copy_from_slice(&header.map(u64::to_le_bytes).concat());
    data[40..48].copy_from_slice(&[4, 0, 1, 0, 0, 0, 2, 0]);
    data[112..117].copy_from_slice(b"hoomd");
    data
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

fn words(values: &[u32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// Two frames of two particles: only the first has types, diameters and box.
pub(super) fn example() -> Vec<u8> {
    gsd(&[
        (0, "configuration/step", 4, 1, 10_u64.to_le_bytes().to_vec()),
        (0, "configuration/box", 9, 1, floats(&[2.0, 4.0, 8.0, 0.5, 0.0, 0.0])),
        (0, "particles/N", 3, 1, words(&[2])),
        (0, "particles/types", 5, 4, b"A\0\0\0Long".to_vec()),
        (0, "particles/typeid", 3, 1, words(&[1, 0])),
        (0, "particles/diameter", 9, 1, floats(&[0.5, 2.0])),
        (0, "particles/position", 9, 3, floats(&[0.5, 1.0, 1.5, -0.5, -1.0, -1.5])),
        (0, "log/particles/pressure", 10, 1, [1.5_f64, 2.5].map(f64::to_le_bytes).concat()),
        (1, "configuration/step", 4, 1, 20_u64.to_le_bytes().to_vec()),
        (1, "particles/position", 9, 3, floats(&[1.0, 1.0, 1.5, -0.5, -1.0, -1.5])),
        (1, "particles/velocity", 9, 3, floats(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0])),
    ])
}

pub(super) fn one_frame() -> Vec<u8> {
    gsd(&[
        (0, "particles/N", 3, 1, words(&[1])),
        (0, "particles/position", 9, 3, floats(&[1.0, 2.0, 3.0])),
    ])
}

#[test]
fn frames_have_defaults_and_values_of_the_first_frame() {
    let options = columns("charge,mass,log/particles/pressure,vy");
    let first = frame_with(example(), &options).expect("a frame");
    assert_eq!((&first.x[..], &first.radius[..]), (&[0.5, -0.5][..], &[0.25, 1.0][..]));
    assert_eq!(kinds(&first), [("Long", "-"), ("A", "-")]);
    let numbers = first.numbers.iter().map(|column| &column.values[..]);
    let expected = [[0.0, 0.0], [1.0, 1.0], [1.5, 2.5], [0.0, 0.0]];
    assert_eq!(numbers.collect::<Vec<_>>(), expected);
    let last = frame_with(example(), &ReadOptions { frame: FrameChoice::Last, ..options });
    let last = last.expect("a frame");
    assert_eq!((last.step, last.x[0], last.radius[1]), (Some(20), 1.0, 1.0));
    assert_eq!(last.numbers[3].values, [2.0, 5.0]);
    let cell = last.cell.expect("a box");
    assert_eq!(
        (cell.origin, cell.vectors[1]),
        (DVec3::new(-2.0, -2.0, -4.0), DVec3::new(2.0, 4.0, 0.0))
    );
    assert_eq!(frames(example()).len(), 2);
    let radius = ReadOptions { radii: Radii::Column("mass".to_owned()), ..ReadOptions::default() };
    assert_eq!(frame_with(example(), &radius).expect("a frame").radius, [1.0, 1.0]);
}

#[test]
fn faulty_files_are_refused() {
    let cut = example();
    let message = fault(&cut[..300]).2;
    assert!(message.starts_with("is cut off"), "{message}");
    let mut schema = example();
    schema[112] = b'x';
    assert_eq!(fault(schema).2, "holds `xoomd`, not particles");
    let mut version = example();
    version[46] = 9;
    assert_eq!(fault(version).2, "is GSD of version 9, but 1 and 2 are read");
    let many = gsd(&[(0, "particles/N", 3, 1, words(&[u32::MAX]))]);
    assert_eq!(fault(many).2, "frame 0 has no positions");
    let few = gsd(&[
        (0, "particles/N", 3, 1, words(&[3])),
        (0, "particles/position", 9, 3, floats(&[0.0; 6])),
    ]);
    assert!(fault(few).2.contains("is 2 x 3, but there are 3 particles"));
    let types = gsd(&[
        (0, "particles/N", 3, 1, words(&[1])),
        (0, "particles/position", 9, 3, floats(&[0.0; 3])),
        (0, "particles/typeid", 3, 1, words(&[7])),
    ]);
    assert_eq!(fault(types).2, "particle 0 is of type 7, but there are 1");
    assert_eq!(fault(gsd(&[])).2, "holds no particles");
    let far = gsd(&[(1 << 40, "particles/N", 3, 1, words(&[1]))]);
    assert_eq!(fault(far).2, "has an index of 1099511627777 frames, but of 1 chunks");
    assert!(frame_with(example(), &columns("nothing")).is_err());
}

#[test]
fn requested_columns_are_kept() {
    let wanted = ["mass", "speed", "x"].map(str::to_owned).into();
    let options =
        ReadOptions { columns: Columns { wanted, ..Columns::default() }, ..ReadOptions::default() };
    let frame = frame_with(example(), &options).expect("a frame");
    let names: Vec<&str> = frame.numbers.iter().map(|column| column.name.as_str()).collect();
    assert_eq!((names, &frame.numbers[0].values), (vec!["mass"], &vec![1.0; 2]));
}

#[test]
fn radii_come_from_the_columns_that_the_user_names() {
    let radius = |text: &str| frame_with(example(), &columns(text)).expect("a frame").radius;
    assert_eq!(radius("radius=log/particles/pressure"), [1.5, 2.5]);
    assert_eq!(radius("diameter=log/particles/pressure"), [0.75, 1.25]);
}

#[test]
fn columns_are_chunks_with_a_row_for_each_particle() {
    let more = [
        (0, "particles/N", 3, 1, words(&[2])),
        (0, "particles/position", 9, 3, floats(&[0.0; 6])),
        (0, "particles/mine", 9, 1, floats(&[5.0, 6.0])),
        (0, "log/particles/stress", 9, 2, floats(&[1.0, 2.0, 3.0, 4.0])),
        (0, "log/energy", 9, 1, floats(&[7.0, 8.0])),
        (0, "particles/short", 9, 1, floats(&[7.0])),
        // Texts of as many types as there are particles.
        (0, "particles/type_shapes", 5, 2, b"{\0}\0".to_vec()),
    ];
    let frame = frame_with(gsd(&more), &columns("mine")).expect("a frame");
    assert_eq!(frame.numbers[0].values, [5.0, 6.0]);
    for name in ["mine", "log/particles/stress"] {
        assert!(frame.columns.iter().any(|own| own.starts_with(name)), "{:?}", frame.columns);
    }
    for name in ["energy", "short", "type_shapes"] {
        assert!(!frame.columns.iter().any(|own| own.contains(name)), "{:?}", frame.columns);
    }
}

#[test]
fn other_shapes_are_counted() {
    let with = |shapes: &[u8]| {
        let shapes = (0, "particles/type_shapes", 5, shapes.len() as u32 / 2, shapes.to_vec());
        let content = gsd(&[
            (0, "particles/N", 3, 1, words(&[3])),
            (0, "particles/position", 9, 3, floats(&[0.0; 9])),
            (0, "particles/types", 5, 2, b"A\0B\0".to_vec()),
            (0, "particles/typeid", 3, 1, words(&[1, 0, 1])),
            shapes,
        ]);
        particles(content).frame.warnings.concat()
    };
    let shape = |kind: &str| format!("{:\0<24}", format!("{{\"type\": \"{kind}\"}}"));
    let both = |a: &str, b: &str| with((shape(a) + &shape(b)).as_bytes());
    assert!(both("Sphere", "Polygon").contains("2 "), "{}", both("Sphere", "Polygon"));
    assert!(both("Ellipsoid", "Sphere").contains("1 "), "{}", both("Ellipsoid", "Sphere"));
    assert!(!both("Sphere", "Sphere").contains("shape"), "{}", both("Sphere", "Sphere"));
}

#[test]
fn other_columns_are_kept_within_the_memory_limit() {
    let kept = |rest: usize| {
        let columns = Columns { rest: Some(rest), ..columns("mass").columns };
        let options = ReadOptions { columns, ..ReadOptions::default() };
        let frame = frame_with(example(), &options).expect("a frame");
        frame.numbers.into_iter().map(|column| column.name).collect::<Vec<_>>()
    };
    let all = kept(1000);
    let mut once = all.clone();
    once.sort();
    once.dedup();
    assert!(all.len() > 2 && once.len() == all.len() && !all.contains(&"x".to_owned()), "{all:?}");
    // For two particles each; `mass` was asked for by name.
    let numbers = 2 * (all.len() - 1);
    assert_eq!(kept(numbers), all);
    assert_eq!(kept(numbers - 1), ["mass"]);
}

#[test]
fn chunks_of_more_than_64_numbers_are_not_columns() {
    let chunk = |name, width: u32| (0, name, 1, width, vec![7; width as usize]);
    let content = gsd(&[
        (0, "particles/N", 3, 1, words(&[1])),
        (0, "particles/position", 9, 3, floats(&[1.0, 2.0, 3.0])),
        chunk("log/particles/wide", 64),
        chunk("log/particles/wider", 65),
    ]);
    let columns = frame(content).columns;
    let begin = |start: &str| columns.iter().filter(|name| name.starts_with(start)).count();
    assert_eq!((begin("log/particles/wide_"), begin("log/particles/wider")), (64, 0));
}
