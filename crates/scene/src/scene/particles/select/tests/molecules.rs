//! Tests of the words of VMD and MDAnalysis, on two residues, a ligand, two waters and an ion.

use super::select;

const MOLECULES: &str = "\
id,element,name,resname,resid,chain,x,y,z
1,N,N,ALA,-1,A,0,0,0
2,C,CA,ALA,-1,A,1,0,0
3,C,CB,ALA,-1,A,1,1,0
4,H,HB1,ALA,-1,A,1,2,0
5,C,C,ALA,-1,A,2,0,0
6,O,O,ALA,-1,A,2,1,0
7,P,P,DA,5,B,10,0,0
8,O,O5',DA,5,B,11,0,0
9,N,N9,DA,5,B,12,0,0
10,C,C1,LIG,7,C,0,0,4
11,H,1H,LIG,7,C,0,0,5
12,O,OW,SOL,8,W,0,0,8
13,H,HW1,SOL,8,W,0,0,9
14,O,OW,SOL,9,W,9,9,9
15,Na,NA,NA,10,W,3,0,0
";

fn ids(condition: &str) -> Vec<f64> {
    select_ids(condition).unwrap_or_else(|fault| panic!("{condition}: {fault}"))
}

fn select_ids(condition: &str) -> Result<Vec<f64>, String> {
    select(MOLECULES, condition)
}

#[test]
fn groups_lists_and_neighborhoods_select_atoms() {
    for (condition, expected) in [
        ("protein", &[1, 2, 3, 4, 5, 6][..]),
        ("backbone", &[1, 2, 5, 6]),
        ("sidechain", &[3, 4]),
        ("sidechain and noh", &[3]),
        ("calpha", &[2]),
        ("nucleic", &[7, 8, 9]),
        ("nucleicbackbone", &[7, 8]),
        ("nucleicbase", &[9]),
        ("Water or ions", &[12, 13, 14, 15]),
        ("not (protein or nucleic or water) and not ion", &[10, 11]),
        ("hydrogen", &[4, 11, 13]),
        ("all and not noh", &[4, 11, 13]),
        ("none or id == 3", &[3]),
        ("name CA CB", &[2, 3]),
        ("name CA C* and protein", &[2, 3, 5]),
        ("name 1H O5'", &[8, 11]),
        ("name \"O5'\" or name 'P'", &[7, 8]),
        ("resname LIG", &[10, 11]),
        ("resid 5 to 7", &[7, 8, 9, 10, 11]),
        ("resid 5:7 9", &[7, 8, 9, 10, 11, 14]),
        ("resid 5-7", &[7, 8, 9, 10, 11]),
        ("resid -5 to 5", &[1, 2, 3, 4, 5, 6, 7, 8, 9]),
        ("resid 7 -1", &[1, 2, 3, 4, 5, 6, 10, 11]),
        ("chain A and element N C", &[1, 2, 3, 5]),
        ("element Na", &[15]),
        ("index 0 2", &[1, 3]),
        ("id 3 to 4", &[3, 4]),
        ("`chain` B", &[7, 8, 9]),
        ("within 1.5 of resname LIG", &[10, 11]),
        ("exwithin 4.5 of resname LIG", &[1, 2, 3, 5, 12, 13]),
        ("around 4.5 resname LIG", &[1, 2, 3, 5, 12, 13]),
        ("within 4.5 of resname LIG and protein", &[1, 2, 3, 5]),
        ("protein and within 4.5 of (resname LIG or water)", &[1, 2, 3, 5]),
        ("not within 20 of protein", &[]),
        ("byres id == 12", &[12, 13]),
        ("same residue as within 1.5 of name CB", &[1, 2, 3, 4, 5, 6]),
        ("same chain as name OW", &[12, 13, 14, 15]),
        ("same element as id == 15", &[15]),
        ("within 3 of none or id == 1", &[1]),
    ] {
        let found = select_ids(condition);
        let expected: Vec<f64> = expected.iter().copied().map(f64::from).collect();
        match found {
            Ok(found) => assert_eq!(found, expected, "{condition}"),
            Err(fault) => assert!(
                expected.is_empty() && fault.contains("none of its"),
                "{condition}: {fault}"
            ),
        }
    }
    assert_eq!(ids("resname == LIG and z > 4.5"), [11.0]);
}

#[test]
fn names_of_ions_have_charges() {
    let ions = "id,element,resname,x,y,z\n1,Na,NA+,0,0,0\n2,Cl,CL-,1,0,0\n3,Mg,MG2+,2,0,0\n4,Na,NA,3,0,0\n";
    for (condition, expected) in [
        ("resname NA+", &[1.0][..]),
        ("resname CL- NA+ and x > 0.5", &[2.0]),
        ("(resname MG2+) or resname NA", &[3.0, 4.0]),
        ("within 1 of resname CL-", &[1.0, 2.0, 3.0]),
    ] {
        assert_eq!(select(ions, condition).expect(condition), expected, "{condition}");
    }
    for condition in ["resname NA+1", "resname NA +", "resname NA-CL"] {
        assert!(select(ions, condition).is_err(), "{condition}");
    }
}

#[test]
fn faults_are_reported_at_their_place() {
    for (condition, expected) in [
        ("within 5 protein", "protein: expected `of` here"),
        ("within 5 of", ": expected a number or a name here"),
        ("within 0 of protein", "0: a distance is more than 0"),
        ("same residue protein", "protein: expected `as` here"),
        ("name CA within 5 of protein", "within: expected `and`, `or`"),
        ("protein water", "water: expected `and`, `or`"),
        ("resid 5 to x", "x: expected a number here"),
        ("resid 5:x", "5:x: `5:x` is not a number"),
        ("z > 5:7", "5:7: `5:7` is not a number"),
        ("x CA", "x: `CA` is not a number, but `x` has numbers"),
        ("spin up", "spin: no column is named `spin`"),
        ("same spin as protein", "same spin as protein: no column is named `spin`"),
        ("name XX", "none of its 15 particles is selected no particle has `XX`"),
        ("prtein", "prtein: `prtein` is no condition; did you mean `protein`?"),
        ("protein > 5", "protein: no column is named `protein`"),
    ] {
        let fault = select_ids(condition).expect_err(condition);
        assert!(fault.starts_with(expected), "{condition}: {fault}");
    }
    let atoms = "id,element,x,y,z\n1,H,0,0,0\n";
    for (condition, expected) in [
        ("protein", "protein: the file has no names of residues"),
        ("same residue as id == 1", "same residue as id == 1: the file has no numbers of residues"),
    ] {
        let fault = select(atoms, condition).expect_err(condition);
        assert!(fault.starts_with(expected), "{condition}: {fault}");
    }
    for (open, close) in [("within 1 of (", ")"), ("byres ", ""), ("same x as ", "")] {
        let deep = format!("{}id == 1{}", open.repeat(100), close.repeat(100));
        assert!(select(atoms, &deep).is_err_and(|fault| fault.contains("more than 64 levels")));
    }
}

#[test]
fn neighborhoods_extend_over_the_periodic_cell() {
    let xyz = "3\nLattice=\"10 0 0 5 10 0 0 0 10\" Properties=species:S:1:pos:R:3\n\
               C 0.5 0.5 5\nO 9.6 0.5 5\nH 5.4 9.7 5\n";
    let count = |condition: &str| select(xyz, condition).expect(condition).len();
    assert_eq!(count("within 0.8 of element C"), 1);
    assert_eq!(count("within 1 of element C"), 3);
    let open = xyz.replace("Properties", "pbc=\"F F F\" Properties");
    assert_eq!(select(&open, "within 1 of element C").expect("atoms").len(), 1);
}
