mod molecules;

use super::*;
use crate::scene::particles::{Columns, ParticleStyle, ReadOptions, read};

const ATOMS: &str = "id,element,residue,x,y,z,q\n1,H,x,0,0,0,-1\n2,C,12,1,0,5,0\n3,O,13,2,0,10,\n\
                     4,H,12,3,0,15,2.5\n";

/// Returns the ids of the selected atoms, or the error: the faulty part and a message.
fn select(content: &str, condition: &str) -> Result<Vec<f64>, String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("particles");
    std::fs::write(&path, content).expect("a file");
    let selection: Selection = condition
        .parse()
        .map_err(|fault: Fault| format!("{}: {}", &fault.text[fault.span], fault.message))?;
    let style = ParticleStyle {
        select: Some(selection),
        also_read: vec!["id".to_owned()],
        ..ParticleStyle::default()
    };
    let columns = Columns { wanted: style.columns(), ..Columns::default() };
    let options = ReadOptions { columns, ..ReadOptions::default() };
    let mut particles = read(&path, &options).expect("particles");
    style.apply(&path, &mut particles).map_err(|error| match error.place {
        Some(place) => format!("{}: {}", &place.source_text[place.span], error.message),
        None => format!("{} {}", error.message, error.help.unwrap_or_default()),
    })?;
    assert_eq!(particles.frame.kinds.codes.len(), particles.spheres.len());
    if let Some(ids) = particles.frame.numbers.iter().find(|column| column.name == "id") {
        return Ok(ids.values.clone());
    }
    Ok(particles.spheres.x.iter().map(|x| x + 1.0).collect())
}

fn ids(condition: &str) -> Vec<f64> {
    select(ATOMS, condition).unwrap_or_else(|fault| panic!("{condition}: {fault}"))
}

#[test]
fn conditions_select_rows() {
    for (condition, expected) in [
        ("z > 5", &[3.0, 4.0][..]),
        ("z >= 5 and z < 15", &[2.0, 3.0]),
        ("element != H and z > 1", &[2.0, 3.0]),
        ("H == element", &[1.0, 4.0]),
        ("element == 'C' or element == \"O\"", &[2.0, 3.0]),
        ("not element == H", &[2.0, 3.0]),
        ("!(element == H) || id == 1", &[1.0, 2.0, 3.0]),
        ("id == 1 or id == 2 and z > 100", &[1.0]),
        ("(id == 1 or id == 2) and z <= 0", &[1.0]),
        ("1 + 2 * id - 6 / 2 == 4", &[3.0]),
        ("-z < -5", &[3.0, 4.0]),
        ("10 - 4 - id > 3", &[1.0, 2.0]),
        ("`q` > -1e0 AND .5 < 1E+0", &[2.0, 4.0]),
        ("residue == 12", &[2.0, 4.0]),
        ("residue > 12", &[3.0]),
        ("residue == x", &[1.0]),
        ("Z == 15", &[4.0]),
        ("Position.Z == 15 and charge > 2 and serial == 4 and index == 3", &[4.0]),
        ("resname == 12", &[2.0, 4.0]),
        ("element != 'h'", &[1.0, 2.0, 3.0, 4.0]),
        ("element != Xe", &[1.0, 2.0, 3.0, 4.0]),
        ("radius > 1.5", &[2.0]),
        ("id^2 == 9 or id ** 0.5 == 2", &[3.0, 4.0]),
        ("-id^2 == -4", &[2.0]),
        ("2^-id^2 == 1/16", &[2.0]),
        ("abs(-id) == sqrt(4) or exp(log(q)) > 2", &[2.0, 4.0]),
        ("log10(10 * (id - 1)) >= 1", &[2.0, 3.0, 4.0]),
        ("min(id, 2, x + 5) == 2 and MAX (id, 3) == 3", &[2.0, 3.0]),
        ("norm(id, 0*id, -2*id) > sqrt(5) * 2.5", &[3.0, 4.0]),
    ] {
        assert_eq!(ids(condition), expected, "{condition}");
    }
}

#[test]
fn missing_numbers_are_not_equal_to_any_other() {
    assert_eq!(ids("q == 0 or q < 0 or q > 0"), [1.0, 2.0, 4.0]);
    assert_eq!(ids("q != 0"), [1.0, 3.0, 4.0]);
}

#[test]
fn errors_are_reported_at_their_position() {
    for (condition, expected) in [
        ("z > ", ": expected a number or a name here"),
        ("", ": expected a number or a name here"),
        ("z > and q", "and: expected a number or a name before this"),
        ("z = 5", "=: use `==` for equality"),
        ("z > 5 q", "q: expected `and`, `or` or an operator before this"),
        ("0 < z < 5", "<: comparisons cannot be chained"),
        ("(z > 5", "(: unclosed parenthesis"),
        ("z > 5)", "): unmatched `)`"),
        ("element == 'C", "'C: unclosed `'`"),
        ("z > 5nm", "5nm: `5nm` is not a number"),
        ("z > 1e999", "1e999: `1e999` is not a number"),
        ("z > 5 ä$", "$: unexpected `$`"),
        ("z $ 5", "$: unexpected `$`"),
        ("z", "z: expected a comparison"),
        ("z > 5 and not q", "q: expected a comparison"),
        ("(z > 5) > 1", "(z > 5): expected a number, but this is a condition"),
        ("speed > 5", "speed: no column is named `speed`; there are id, element, residue, x"),
        ("q == hot", "hot: no column is named `hot`"),
        ("q == 'hot'", "'hot': only a column of texts"),
        ("element > C", "element > C: texts can only be compared"),
        ("element > 5", "element: the column `element` holds texts"),
        ("z > 99", "none of its 4 particles is selected"),
        ("elemnt == C", "elemnt: no column is named `elemnt`; did you mean `element`?"),
        ("z > sqr(5)", "sqr: no function is named `sqr`; did you mean `sqrt`?"),
        ("z > sqrt(5", "(: unclosed parenthesis"),
        ("z > sqrt(5 6)", "6: expected an operator, `,` or `)` before this"),
        ("z > sqrt(1, 2)", "sqrt(1, 2): `sqrt` takes one number"),
        ("z > max(1)", "max(1): `max` takes two numbers or more"),
        ("norm(x, y) > 1", "norm(x, y): `norm` takes a vector or three numbers"),
        ("norm(velocity) > 1", "velocity: no column is named `vx`"),
        ("norm(x) > 1", "norm(x): `x` is a number and no vector: write `abs(x)`"),
        ("sqrt(z > 5) > 1", ">: expected an operator, `,` or `)` before this"),
        ("sqrt(element) > 1", "element: the column `element` holds texts"),
        ("element == C, O", ",: unexpected `,`"),
        ("z > ,", ",: unexpected `,`"),
        ("z > 2 ^", ": expected a number or a name here"),
        ("element == c", "c: no particle has `c` in this column; did you mean `C`?"),
        ("element != h or z > 5", "h: no particle has `h` in this column; did you mean `H`?"),
        ("'Cl' == element", "none of its 4 particles is selected"),
    ] {
        let fault = select(ATOMS, condition).expect_err(condition);
        assert!(fault.starts_with(expected), "{condition}: {fault}");
    }
}

#[test]
fn conditions_may_be_long_but_not_deep() {
    let long = vec!["id + 1 - 1 == 2"; 20_000].join(" or ");
    assert_eq!(ids(&long), [2.0]);
    for (open, close) in [("(", ")"), ("not ", ""), ("-", ""), ("1^", "")] {
        let deep = |depth| format!("{}id == 2{}", open.repeat(depth), close.repeat(depth));
        let fault = deep(100_000).parse::<Selection>().expect_err("too deep");
        assert!(fault.message.starts_with("more than 64"), "{fault}");
        assert!(deep(64).parse::<Selection>().is_ok());
    }
    let deep = |depth| format!("{}id{} == 2", "abs(".repeat(depth), ")".repeat(depth));
    assert!(deep(64).parse::<Selection>().is_ok() && deep(65).parse::<Selection>().is_err());
}

#[test]
fn errors_show_the_condition() {
    let fault = "ä > 5 und".parse::<Selection>().expect_err("a fault");
    let shown = "expected `and`, `or` or an operator before this\n  ä > 5 und\n        ^^^";
    assert_eq!(fault.to_string(), shown);
}

#[test]
fn texts_that_no_particle_has_are_named() {
    for condition in [
        "element == Xx",
        "Xx == element",
        "not (element != Xx)",
        "z > 0 and element == Xx",
        "element == Xx or element == Yy",
    ] {
        let fault = select(ATOMS, condition).expect_err(condition);
        assert!(fault.contains("no particle has `Xx`"), "{condition}: {fault}");
    }
    let fault = select(ATOMS, "element == C and z > 100").expect_err("nothing");
    assert!(fault.contains("none of its 4 particles") && !fault.contains('`'), "{fault}");
}

#[test]
fn conditions_side_by_side_are_not_deep() {
    for one in ["(id == 2)", "not (id != 2)", "-id == -2"] {
        assert_eq!(ids(&vec![one; 200].join(" or ")), [2.0], "{one}");
    }
}

#[test]
fn only_nesting_is_deep() {
    for (open, close) in [("(", ")"), ("not ", ""), ("-", "")] {
        let condition = format!("{}id == 2{}", open.repeat(65), close.repeat(65));
        let fault = condition.parse::<Selection>().expect_err("too deep");
        assert!(fault.message.starts_with("more than 64"), "{fault}");
    }
    for (part, joint, end) in
        [("(id)", " + ", " > 0"), ("--id", " + ", " > 0"), ("not id < 0", " and ", "")]
    {
        let condition = vec![part; 70].join(joint) + end;
        assert_eq!(ids(&condition), [1.0, 2.0, 3.0, 4.0], "{part}");
    }
}
