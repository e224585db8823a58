//! Tables of the elements: symbols, masses, radii; row 0 of every table is element 1.

/// Symbols of all elements.
#[rustfmt::skip]
pub(super) const SYMBOLS: [&str; 118] = [
    "H", "He", "Li", "Be", "B", "C", "N", "O", "F", "Ne", "Na", "Mg", "Al", "Si", "P", "S", "Cl",
    "Ar", "K", "Ca", "Sc", "Ti", "V", "Cr", "Mn", "Fe", "Co", "Ni", "Cu", "Zn", "Ga", "Ge", "As",
    "Se", "Br", "Kr", "Rb", "Sr", "Y", "Zr", "Nb", "Mo", "Tc", "Ru", "Rh", "Pd", "Ag", "Cd", "In",
    "Sn", "Sb", "Te", "I", "Xe", "Cs", "Ba", "La", "Ce", "Pr", "Nd", "Pm", "Sm", "Eu", "Gd", "Tb",
    "Dy", "Ho", "Er", "Tm", "Yb", "Lu", "Hf", "Ta", "W", "Re", "Os", "Ir", "Pt", "Au", "Hg", "Tl",
    "Pb", "Bi", "Po", "At", "Rn", "Fr", "Ra", "Ac", "Th", "Pa", "U", "Np", "Pu", "Am", "Cm", "Bk",
    "Cf", "Es", "Fm", "Md", "No", "Lr", "Rf", "Db", "Sg", "Bh", "Hs", "Mt", "Ds", "Rg", "Cn", "Nh",
    "Fl", "Mc", "Lv", "Ts", "Og",
];

/// Van der Waals radii in angstrom; 0 where there is none. Alvarez, "A cartography of the van der
/// Waals territories", Dalton Transactions 42 (2013), DOI 10.1039/C3DT50599E, table 1.
#[rustfmt::skip]
pub(super) const VAN_DER_WAALS: [f64; 99] = [
    1.20, 1.43, 2.12, 1.98, 1.91, 1.77, 1.66, 1.50, 1.46, 1.58, 2.50, 2.51, 2.25, 2.19, 1.90, 1.89,
    1.82, 1.94, 2.73, 2.62, 2.58, 2.46, 2.42, 2.45, 2.45, 2.44, 2.40, 2.40, 2.38, 2.39, 2.32, 2.29,
    1.88, 1.82, 1.86, 2.07, 3.21, 2.84, 2.75, 2.52, 2.56, 2.45, 2.44, 2.46, 2.44, 2.15, 2.53, 2.49,
    2.43, 2.42, 2.47, 1.99, 2.04, 2.28, 3.48, 3.03, 2.98, 2.88, 2.92, 2.95, 0.00, 2.90, 2.87, 2.83,
    2.79, 2.87, 2.81, 2.83, 2.79, 2.80, 2.74, 2.63, 2.53, 2.57, 2.49, 2.48, 2.41, 2.29, 2.32, 2.45,
    2.47, 2.60, 2.54, 0.00, 0.00, 2.40, 0.00, 0.00, 2.80, 2.93, 2.88, 2.71, 2.82, 2.81, 2.83, 3.05,
    3.40, 3.05, 2.70,
];

/// Covalent radii in angstrom. Cordero et al., "Covalent radii revisited", Dalton Transactions
/// (2008), DOI 10.1039/B801115J, table 2: carbon that of sp3; manganese, iron and cobalt those of
/// low spin.
#[rustfmt::skip]
pub(super) const COVALENT: [f64; 96] = [
    0.31, 0.28, 1.28, 0.96, 0.84, 0.76, 0.71, 0.66, 0.57, 0.58, 1.66, 1.41, 1.21, 1.11, 1.07, 1.05,
    1.02, 1.06, 2.03, 1.76, 1.70, 1.60, 1.53, 1.39, 1.39, 1.32, 1.26, 1.24, 1.32, 1.22, 1.22, 1.20,
    1.19, 1.20, 1.20, 1.16, 2.20, 1.95, 1.90, 1.75, 1.64, 1.54, 1.47, 1.46, 1.42, 1.39, 1.45, 1.44,
    1.42, 1.39, 1.39, 1.38, 1.39, 1.40, 2.44, 2.15, 2.07, 2.04, 2.03, 2.01, 1.99, 1.98, 1.98, 1.96,
    1.94, 1.92, 1.92, 1.89, 1.90, 1.87, 1.87, 1.75, 1.70, 1.62, 1.51, 1.44, 1.41, 1.36, 1.36, 1.32,
    1.45, 1.46, 1.48, 1.40, 1.50, 1.50, 2.60, 2.21, 2.15, 2.06, 2.00, 1.96, 1.90, 1.87, 1.80, 1.69,
];

/// Effective ionic radii in angstrom at a coordination of 6, of manganese, iron and cobalt those of high spin; 0 where there is none.
/// Shannon, "Revised effective ionic radii", Acta Crystallographica A32 (1976), DOI 10.1107/S0567739476001551, table 1. Of
/// each element the commonest state of oxidation:
/// - +1: the alkali metals, silver and thallium;
/// - +2: the alkaline earths, manganese, cobalt, nickel, copper, zinc, palladium, cadmium, mercury and lead;
/// - +3: boron, aluminum, scandium, chromium, iron, gallium, arsenic, yttrium, rhodium, indium, antimony, gold, bismuth, the
///   lanthanides, actinium, and the actinides from americium on;
/// - +4: carbon, silicon, titanium, germanium, zirconium, ruthenium, tin, hafnium, osmium, iridium, platinum, polonium, thorium
///   and plutonium;
/// - +5: phosphorus, vanadium, niobium, tantalum, protactinium and neptunium;
/// - +6: molybdenum, tungsten and uranium; +7: technetium and rhenium;
/// - -1: halogens; -2: oxygen, sulfur, selenium and tellurium; -3: nitrogen, at a coordination of 4.
#[rustfmt::skip]
pub(super) const IONIC: [f64; 98] = [
    0.00, 0.00, 0.76, 0.45, 0.27, 0.16, 1.46, 1.40, 1.33, 0.00, 1.02, 0.72, 0.535, 0.40, 0.38, 1.84, 1.81,
    0.00, 1.38, 1.00, 0.745, 0.605, 0.54, 0.615, 0.83, 0.645, 0.745, 0.69, 0.73, 0.74, 0.62, 0.53, 0.58, 1.98,
    1.96, 0.00, 1.52, 1.18, 0.90, 0.72, 0.64, 0.59, 0.56, 0.62, 0.665, 0.86, 1.15, 0.95, 0.80, 0.69, 0.76,
    2.21, 2.20, 0.00, 1.67, 1.35, 1.032, 1.01, 0.99, 0.983, 0.97, 0.958, 0.947, 0.938, 0.923, 0.912, 0.901, 0.89,
    0.88, 0.868, 0.861, 0.71, 0.64, 0.60, 0.53, 0.63, 0.625, 0.625, 0.85, 1.02, 1.50, 1.19, 1.03, 0.94, 0.00,
    0.00, 1.80, 0.00, 1.12, 0.94, 0.78, 0.73, 0.75, 0.86, 0.975, 0.97, 0.96, 0.95,
];

/// Standard atomic weights, abridged (IUPAC 2021), as far as uranium; of elements without any, the
/// mass number of the isotope that lives longest.
#[rustfmt::skip]
pub(super) const MASSES: [f64; 92] = [
    1.008, 4.0026, 6.94, 9.0122, 10.81, 12.011, 14.007, 15.999, 18.998, 20.180, 22.990, 24.305,
    26.982, 28.085, 30.974, 32.06, 35.45, 39.95, 39.098, 40.078, 44.956, 47.867, 50.942, 51.996,
    54.938, 55.845, 58.933, 58.693, 63.546, 65.38, 69.723, 72.630, 74.922, 78.971, 79.904, 83.798,
    85.468, 87.62, 88.906, 91.224, 92.906, 95.95, 97.0, 101.07, 102.91, 106.42, 107.87, 112.41,
    114.82, 118.71, 121.76, 127.60, 126.90, 131.29, 132.91, 137.33, 138.91, 140.12, 140.91, 144.24,
    145.0, 150.36, 151.96, 157.25, 158.93, 162.50, 164.93, 167.26, 168.93, 173.05, 174.97, 178.49,
    180.95, 183.84, 186.21, 190.23, 192.22, 195.08, 196.97, 200.59, 204.38, 207.2, 208.98, 209.0,
    210.0, 222.0, 223.0, 226.0, 227.0, 232.04, 231.04, 238.03,
];
