//! Models of molecules: particles as spheres of their radii, or as balls and sticks.

use super::Particles;
use crate::scene::{Cones, NamedMaterial, Sticks};
use glam::DVec3;

/// The way in which particles and their bonds are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Model {
    /// Spheres of the particles' radii, without bonds.
    #[default]
    SpaceFilling,
    /// Small spheres, with sticks for bonds.
    BallAndStick,
    /// Sticks for bonds; particles are no thicker than they.
    Licorice,
}

/// Radius of a ball, relative to that of its particle, as in `PyMOL`'s preset of the same name.
const BALL: f64 = 0.25;

/// Radius of sticks between balls, relative to the median radius of particles.
const STICK: f64 = 0.1;

/// Maximum radius of sticks between balls, relative to that of the smallest ball, which they would hide; and the least one of
/// them, relative to the usual radius.
const OF_BALL: f64 = 0.6;
const THINNEST: f64 = 0.25;

/// Radius of sticks without balls, likewise: 0.25 angstrom for carbon, as in `PyMOL`.
const LICORICE: f64 = 0.15;

/// Radius of the sticks of trails, relative to that of the particle.
const TRAIL: f64 = 0.25;

impl Model {
    /// All models, with their names in options.
    pub const ALL: [(&'static str, Self); 3] = [
        ("space-filling", Self::SpaceFilling),
        ("ball-and-stick", Self::BallAndStick),
        ("licorice", Self::Licorice),
    ];

    /// Returns the name in options.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, model)| *model == self).map_or("", |(name, _)| name)
    }

    /// Returns whether bonds are drawn.
    pub fn draws_bonds(self) -> bool {
        self != Self::SpaceFilling
    }

    /// Returns the model with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(own, _)| *own == name).map(|(_, model)| *model)
    }

    /// Returns the radius of a particle of radius `radius` that is drawn with sticks of radius `stick`.
    fn radius(self, radius: f64, stick: f64) -> f64 {
        match self {
            Self::SpaceFilling => radius,
            Self::BallAndStick => radius * BALL,
            Self::Licorice => stick,
        }
    }

    /// Returns the usual radius of sticks among particles of this median and this least radius.
    fn stick(self, median: f64, least: f64) -> f64 {
        match self {
            Self::Licorice => LICORICE * median,
            _ => (OF_BALL * BALL * least).clamp(THINNEST * STICK * median, STICK * median),
        }
    }
}

/// Rows of particles with a model of their own, or with bonds of their own.
pub(super) struct Part<'a> {
    pub(super) rows: &'a [usize],
    pub(super) model: Option<Model>,
    /// True if bonds are drawn, also by a model without them; false if none is.
    pub(super) bonds: Option<bool>,
    /// Radius of the sticks of bonds.
    pub(super) bond_radius: Option<f64>,
}

/// Changes the radii of particles to those of their models, and sets those of sticks: `base` and `bond_radius`, if it is given,
/// are for all, `parts` for some, of which later ones win.
pub(super) fn apply(
    particles: &mut Particles,
    base: Model,
    bond_radius: Option<f64>,
    parts: &[Part],
) {
    if parts.is_empty() && !base.draws_bonds() {
        return;
    }
    let Some(median) = median(&particles.spheres.radius) else { return };
    let radii = &mut particles.spheres.radius;
    let least = radii.iter().copied().fold(f64::INFINITY, f64::min);
    if parts.is_empty() {
        let stick = bond_radius.unwrap_or_else(|| base.stick(median, least));
        for radius in radii.iter_mut() {
            *radius = base.radius(*radius, stick);
        }
        particles.stick_radius = stick;
        return;
    }
    let count = radii.len();
    let mut models = vec![base; count];
    let mut bonded: Vec<Option<bool>> = vec![None; count];
    let mut sticks = vec![bond_radius; count];
    for part in parts {
        for &row in part.rows {
            if let Some(model) = part.model {
                (models[row], bonded[row]) = (model, None);
            }
            bonded[row] = part.bonds.or(bonded[row]);
            sticks[row] = part.bond_radius.or(sticks[row]);
        }
    }
    particles.stick_radii = vec![0.0; count];
    for (row, radius) in radii.iter_mut().enumerate() {
        let model = models[row];
        let stick = sticks[row].unwrap_or_else(|| model.stick(median, least));
        *radius = model.radius(*radius, stick);
        if bonded[row].unwrap_or(model.draws_bonds()) {
            particles.stick_radii[row] = stick;
            particles.stick_radius = particles.stick_radius.max(stick);
        }
    }
    if let Some(bonds) = &mut particles.frame.bonds {
        bonds.keep(|ends| ends.iter().all(|&row| bonded[row as usize] != Some(false)));
    }
}

pub(super) fn median(values: &[f64]) -> Option<f64> {
    let mut values = values.to_vec();
    let half = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(half, f64::total_cmp).1)
}

impl Particles {
    /// Returns the bonds as sticks with the colors of both ends, and trails and the shafts of arrows; `materials` are those of the
    /// scene, and `rows` the row there of each material of the particles.
    ///
    /// A bond that crosses the cell becomes two halves, one at each end, and so does one between different materials. Halves of
    /// bonds that leave what is drawn are sticks, too.
    /// Materials that sticks cannot have are replaced by the first one.
    pub(in crate::scene) fn sticks(&self, materials: &[NamedMaterial], rows: &[u32]) -> Sticks {
        let mut sticks = Sticks::default();
        let material = |sphere: usize| self.solid_material(sphere, materials, rows);
        if !self.frame.trails.is_empty() {
            self.append_trails(material, &mut sticks);
        }
        for row in 0..self.arrows.vectors.len() {
            let Some(arrow) = self.arrows.of(row, self.spheres.center(row)) else { continue };
            let color = self.arrows.color.unwrap_or_else(|| self.spheres.color_of(row));
            sticks.push(arrow.shaft, arrow.radius, material(row), [color; 2]);
        }
        let Some(bonds) = self.frame.bonds.as_ref().filter(|_| self.stick_radius > 0.0) else {
            return sticks;
        };
        for stub in &self.added.stubs {
            let row = stub.row as usize;
            let (at, color) = (self.spheres.center(row), self.spheres.color_of(row));
            let radius = self.stick_radii.get(row).copied().unwrap_or(self.stick_radius);
            if radius > 0.0 {
                sticks.push([at, at + stub.half], radius, material(row), [color; 2]);
            }
        }
        for bond in 0..bonds.len() {
            let ends = [bonds.first[bond], bonds.second[bond]].map(|row| row as usize);
            let Some(radii) = self.stick_radii_of(ends) else { continue };
            let at = ends.map(|row| self.spheres.center(row));
            let along = bonds.vector(bond, at, self.frame.cell.as_ref());
            let (of, colors) = (ends.map(material), ends.map(|row| self.spheres.color_of(row)));
            if bonds.shift_of(bond) == [0; 3] && of[0] == of[1] && radii[0] == radii[1] {
                sticks.push(at, radii[0], of[0], colors);
                continue;
            }
            for (end, half) in [along / 2.0, along / -2.0].into_iter().enumerate() {
                let ends: [DVec3; 2] = [at[end], at[end] + half];
                sticks.push(ends, radii[end], of[end], [colors[end]; 2]);
            }
        }
        sticks
    }

    /// Returns the radii of the halves of a bond; `None` if it is not drawn, as neither end draws bonds. If one does, all of
    /// the bond has its radius.
    fn stick_radii_of(&self, ends: [usize; 2]) -> Option<[f64; 2]> {
        if self.stick_radii.is_empty() {
            return Some([self.stick_radius; 2]);
        }
        match ends.map(|row| self.stick_radii[row]) {
            [0.0, 0.0] => None,
            [0.0, radius] | [radius, 0.0] => Some([radius; 2]),
            radii => Some(radii),
        }
    }

    /// Returns the heads of arrows; arguments are those of [`Particles::sticks`].
    pub(in crate::scene) fn cones(&self, materials: &[NamedMaterial], rows: &[u32]) -> Cones {
        let mut cones = Cones::default();
        for row in 0..self.arrows.vectors.len() {
            let Some(arrow) = self.arrows.of(row, self.spheres.center(row)) else { continue };
            let color = self.arrows.color.unwrap_or_else(|| self.spheres.color_of(row));
            let ([apex, base], material) = (arrow.head, self.solid_material(row, materials, rows));
            cones.push(apex, base, arrow.head_radius, material, color);
        }
        cones
    }

    /// Returns the row of the material that a sphere's sticks and arrows have: the sphere's, or the first one if only spheres can
    /// have that.
    pub(super) fn solid_material(
        &self,
        sphere: usize,
        materials: &[NamedMaterial],
        rows: &[u32],
    ) -> u32 {
        let row = rows.get(self.spheres.material_of(sphere) as usize).copied().unwrap_or(0);
        let solid = materials.get(row as usize).is_none_or(|named| named.material.is_solid());
        if solid { row } else { 0 }
    }

    /// Appends the trails as chains of sticks, from each sphere back. A chain ends at a position that is not finite.
    fn append_trails(&self, material: impl Fn(usize) -> u32, sticks: &mut Sticks) {
        for row in 0..self.spheres.len() {
            let center = self.spheres.center(row);
            let (radius, color) = (self.spheres.radius[row], self.spheres.color_of(row));
            let mut last = center;
            for place in self.frame.trails.of(row).map(|vector| center + vector) {
                if !place.is_finite() {
                    break;
                }
                if place != last {
                    sticks.push([last, place], TRAIL * radius, material(row), [color; 2]);
                }
                last = place;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::particles::{Bonds, Cell};
    use crate::scene::{Rgb, Scene};

    /// Three particles in a row, the last of which is bonded to the first over the cell.
    fn particles() -> Particles {
        let mut particles = Particles::default();
        particles.frame.bonds = Some(Bonds {
            first: vec![0, 0],
            second: vec![1, 2],
            shift: vec![[0; 3], [-1, 0, 0]],
            ..Bonds::default()
        });
        particles.frame.cell = Some(Cell {
            origin: DVec3::ZERO,
            vectors: [DVec3::X * 10.0, DVec3::Y * 10.0, DVec3::Z * 10.0],
            periodic: [true; 3],
        });
        for (x, color) in [(1.0, Rgb::X), (3.0, Rgb::Y), (9.0, Rgb::Z)] {
            particles.spheres.push(DVec3::new(x, 5.0, 5.0), 0.8, 0, color);
        }
        particles
    }

    #[test]
    fn bonds_become_sticks_of_both_colors_and_halves_at_the_border() {
        let mut own = particles();
        assert!(Scene::of_particles(own.clone(), "").sticks.is_empty());
        apply(&mut own, Model::BallAndStick, None, &[]);
        assert_eq!(own.spheres.radius, [0.2; 3]);
        let sticks = Scene::of_particles(own, "").sticks;
        let x: Vec<[f64; 2]> = (0..3).map(|row| sticks.ends(row).map(|end| end.x)).collect();
        assert_eq!(x, [[1.0, 3.0], [1.0, 0.0], [9.0, 10.0]]);
        assert_eq!(sticks.colors, [[Rgb::X, Rgb::Y], [Rgb::X; 2], [Rgb::Z; 2]]);
        assert!(sticks.radius.iter().all(|radius| (radius - 0.08).abs() < 1e-12));
    }

    #[test]
    fn sticks_do_not_hide_the_smallest_balls() {
        for (radii, stick) in [
            ([1.7, 1.7, 1.2], 0.17),
            ([0.76, 0.76, 0.31], 0.6 * 0.25 * 0.31),
            ([1.0, 1.0, 1e-9], 0.025),
        ] {
            let mut own = particles();
            own.spheres.radius = radii.into();
            apply(&mut own, Model::BallAndStick, None, &[]);
            assert!((own.stick_radius - stick).abs() < 1e-12, "{radii:?} {}", own.stick_radius);
            apply(&mut own, Model::BallAndStick, Some(0.4), &[]);
            assert_eq!(own.stick_radius, 0.4);
        }
    }

    #[test]
    fn licorice_has_one_radius() {
        let mut own = particles();
        own.spheres.radius[1] = 3.0;
        apply(&mut own, Model::Licorice, Some(0.3), &[]);
        let scene = Scene::of_particles(own, "");
        assert_eq!((scene.spheres.radius, scene.sticks.radius), (vec![0.3; 3], vec![0.3; 3]));
    }

    #[test]
    fn trails_become_chains_of_sticks() {
        let mut own = particles();
        own.frame.bonds = None;
        // The second particle stands still in the last frame, and the third has no known position before that.
        own.frame.trails.steps = vec![
            [vec![-1.0, 0.0, 1.0], vec![0.0; 3], vec![0.0; 3]],
            [vec![-3.0, 2.0, f64::NAN], vec![1.0; 3], vec![0.0; 3]],
        ];
        let scene = Scene::of_particles(own, "");
        let sticks = &scene.sticks;
        let ends: Vec<[[f64; 3]; 2]> =
            (0..sticks.len()).map(|row| sticks.ends(row).map(|end| end.to_array())).collect();
        assert_eq!(
            ends,
            [
                [[1.0, 5.0, 5.0], [0.0, 5.0, 5.0]],
                [[0.0, 5.0, 5.0], [-2.0, 6.0, 5.0]],
                [[3.0, 5.0, 5.0], [5.0, 6.0, 5.0]],
                [[9.0, 5.0, 5.0], [10.0, 5.0, 5.0]],
            ]
        );
        assert_eq!(sticks.colors[2], [Rgb::Y; 2]);
        let thin = |(row, radius): (usize, &f64)| {
            *radius == TRAIL * scene.spheres.radius[[0, 0, 1, 2][row]]
        };
        assert!(sticks.radius.iter().enumerate().all(thin));
    }

    #[test]
    fn space_filling_leaves_particles_as_they_are() {
        let mut own = particles();
        apply(&mut own, Model::SpaceFilling, Some(0.3), &[]);
        assert_eq!(own, particles());
    }
}
