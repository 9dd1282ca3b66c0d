//! Deformed shapes of a cell: families of homogeneous and bent deformations with random amplitudes and directions, or
//! shapes of a list.
//!
//! Theory: page *Sampled fits* of the book.

use crate::bound::{self, check_count};
use crate::error::{Error, Result};
use crate::fit::input::{check_finite, check_length};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// The length of a sequence of Sobol points; the next shapes use another seed.
const LONGEST: usize = 1 << 16;
/// The number of coordinates of a Sobol point.
const WIDEST: usize = 256;
/// A prime by which the states of different cells are spread.
const STRIDE: usize = 1_000_003;
/// Every fifth shape of a list is held out.
const APART: usize = 5;

/// Kinds of deformation. Their axes are random in every shape, and their amplitudes fill the range evenly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeformationFamily {
    /// `λ = 1 + a` along one axis (`1/(1 − a)` if a < 0), and `λ^(−ν)` across it.
    Uniaxial,
    /// λ in a plane, `λ^(−2ν/(1 − ν))` across it.
    Equibiaxial,
    /// `I + a e fᵀ`, with e ⟂ f.
    SimpleShear,
    /// `λ I`.
    Volumetric,
    /// Sections rotated about an axis by `2a` over the size of the cell; for solids.
    Torsion,
    /// Circular bending with a strain of about a at the outer fibres.
    Bending,
    /// `I + A`, with an independent amplitude for every entry of A.
    Gradients,
}

crate::named!(DeformationFamily {
    "uniaxial" => Uniaxial,
    "equibiaxial" => Equibiaxial,
    "simple-shear" => SimpleShear,
    "volumetric" => Volumetric,
    "torsion" => Torsion,
    "bending" => Bending,
    "gradients" => Gradients,
});

/// The source of the shapes.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// Families of deformations, which take turns.
    Families(Vec<DeformationFamily>),
    /// Deformation gradients, `[shapes × dimension × dimension]`.
    Gradients(Arc<Vec<f64>>),
    /// Positions of all points of the mesh, `[states][points × dimension]`, m. A cell uses those of its own nodes and
    /// of the cells that have its shape.
    States(Arc<Vec<Vec<f64>>>),
}

/// The deformed shapes of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampling {
    /// The source of the shapes.
    pub source: Source,
    /// The number of shapes of the fit, at most. Of a list of gradients each is used once. States are used equally often, with different
    /// displacements of the nodes: once each without them, and as often as this number allows with them.
    pub shapes: usize,
    /// The number of other shapes on which the error is measured, at most, by the same rule. Of a list of at least five shapes, every fifth
    /// is kept for them.
    pub held_out: usize,
    /// The least and the largest amplitude of the families.
    pub stretch: [f64; 2],
    /// How far each node is moved in addition, as a share of the size of the cell.
    pub perturbation: f64,
    /// The seed of the random numbers.
    pub seed: u64,
}

impl Default for Sampling {
    fn default() -> Sampling {
        Sampling {
            source: Source::Families(vec![DeformationFamily::Gradients]),
            shapes: 300,
            held_out: 100,
            stretch: [-0.3, 0.3],
            perturbation: 0.05,
            seed: 1,
        }
    }
}

/// Whether a shape belongs to the fit or to its test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    Trained,
    HeldOut,
}

impl Part {
    /// How many shapes of a list of `count` belong to the part. A list that is too short to hold any out has all of them in both parts.
    fn of(self, count: usize) -> usize {
        match (self, count / APART) {
            (Part::HeldOut, 1..) => count / APART,
            (Part::HeldOut, 0) => count,
            (Part::Trained, apart) => count - apart,
        }
    }
}

impl Sampling {
    /// Checks the settings for cells of this dimension.
    ///
    /// # Errors
    /// A number is out of range; a list is empty or has a wrong length; or a family requires a solid.
    pub fn check(&self, dimension: usize) -> Result<()> {
        self.check_numbers()?;
        match &self.source {
            Source::Families(families) if families.contains(&DeformationFamily::Torsion) && dimension < 3 => {
                return Err(Error::expected("families", "families of the plane", "\"torsion\""));
            }
            Source::Gradients(list) if list.is_empty() || list.len() % (dimension * dimension) != 0 => {
                let expected = format!("deformation gradients of {} numbers", dimension * dimension);
                return Err(Error::expected("gradients", expected, format!("{} numbers in all", list.len())));
            }
            Source::Gradients(list) => check_finite("gradients", list)?,
            Source::States(_) | Source::Families(_) => {}
        }
        Ok(())
    }

    /// Checks what does not depend on the cells.
    ///
    /// # Errors
    /// A number is out of range, or there is no family or state.
    pub fn check_numbers(&self) -> Result<()> {
        check_count("shapes", self.shapes as u64, 1, bound::SHAPES)?;
        check_count("held_out", self.held_out as u64, 0, bound::SHAPES)?;
        let [least, largest] = self.stretch;
        if !(-2.0..=2.0).contains(&least) || !(least..=2.0).contains(&largest) {
            return Err(Error::expected("stretch", "a range within -2 to 2", format!("{least} to {largest}")));
        }
        if !(0.0..=2.0).contains(&self.perturbation) {
            return Err(Error::expected("perturbation", "a share from 0 to 2", self.perturbation));
        }
        match &self.source {
            Source::Families(families) if families.is_empty() => {
                Err(Error::expected("families", "at least one family", "none"))
            }
            Source::Families(_) if self.stretch == [0.0; 2] && self.perturbation == 0.0 => {
                Err(Error::expected("stretch", "shapes that differ from the one at rest", "none"))
            }
            Source::States(states) if states.is_empty() => Err(Error::expected("states", "at least one state", "none")),
            Source::Gradients(_) | Source::States(_) | Source::Families(_) => Ok(()),
        }
    }

    /// How many shapes of its list, in a body of this dimension, belong to the fit and to its test. `None` without a list of gradients.
    pub fn listed(&self, dimension: usize) -> Option<[usize; 2]> {
        match &self.source {
            Source::Gradients(list) => {
                let all = list.len() / (dimension * dimension);
                Some([Part::Trained, Part::HeldOut].map(|part| part.of(all)))
            }
            Source::Families(_) | Source::States(_) => None,
        }
    }

    /// Checks that every state has this many numbers, all finite.
    ///
    /// # Errors
    /// A state does not.
    pub(super) fn check_states(&self, numbers: usize) -> Result<()> {
        match &self.source {
            Source::States(states) => states.iter().try_for_each(|state| {
                check_length("states", state.len(), numbers)?;
                check_finite("states", state)
            }),
            Source::Families(_) | Source::Gradients(_) => Ok(()),
        }
    }
}

/// The shapes of one cell.
pub struct Shapes<'a> {
    pub sampling: &'a Sampling,
    /// The positions at rest, `[nodes × dimension]`, m.
    pub rest: &'a [f64],
    /// The nodes of all cells of this shape.
    pub cells: Vec<&'a [usize]>,
    /// The points of the mesh at rest.
    pub points: &'a [f64],
    pub dimension: usize,
    /// The content to the power of one over the dimension, m.
    pub extent: f64,
    /// The ν of the lateral contraction.
    pub poisson: f64,
}

impl Shapes<'_> {
    /// The number of shapes of the list; `None` without one.
    fn listed(&self) -> Option<usize> {
        match &self.sampling.source {
            Source::Families(_) => None,
            Source::Gradients(list) => Some(list.len() / (self.dimension * self.dimension)),
            Source::States(states) => Some(states.len() * self.cells.len()),
        }
    }

    /// Whether there are shapes that the fit does not use.
    pub fn has_others(&self) -> bool {
        let are_apart = self.listed().is_none_or(|listed| listed >= APART);
        self.sampling.held_out > 0 && (are_apart || self.sampling.perturbation > 0.0)
    }

    /// The number of shapes of the part: no shape of a list counts more often than another.
    pub fn count(&self, part: Part) -> usize {
        let most = match part {
            Part::Trained => self.sampling.shapes,
            Part::HeldOut => self.sampling.held_out,
        };
        let Some(own) = self.listed().map(|listed| part.of(listed)) else { return most };
        match &self.sampling.source {
            // Displacements of the nodes differ each time, so that states that are used again are other shapes.
            Source::States(_) if most > own && self.sampling.perturbation > 0.0 => most - most % own,
            Source::Families(_) | Source::Gradients(_) | Source::States(_) => most.min(own),
        }
    }

    /// The positions of the nodes in shape `i`, with the share `scale` of its deformation; `[nodes × dimension]`.
    pub fn place(&self, part: Part, i: usize, scale: f64) -> Vec<f64> {
        let d = self.dimension;
        let numbers = Numbers { index: i, seed: 2 * self.sampling.seed + u64::from(part == Part::HeldOut) };
        let move_of = |k: usize| scale * self.sampling.perturbation * self.extent * numbers.symmetric(9 + k);
        let mut x = match &self.sampling.source {
            Source::Families(families) => {
                let family = families[i % families.len()];
                self.family(family, scale, &numbers)
            }
            Source::Gradients(list) => {
                let gradient = &list[d * d * chosen(list.len() / (d * d), part, i)..][..d * d];
                let entry = |k: usize, l: usize| {
                    let identity = f64::from(u8::from(k == l));
                    identity + scale * (gradient[k * d + l] - identity)
                };
                self.homogeneous(&within(d, entry))
            }
            Source::States(states) => {
                let count = states.len() * self.cells.len();
                let place = chosen(count, part, i) * STRIDE % count;
                let (state, nodes) = (&states[place % states.len()], self.cells[place / states.len()]);
                let dofs = nodes.iter().flat_map(|&p| p * d..(p + 1) * d);
                self.rest.iter().zip(dofs).map(|(rest, i)| rest + scale * (state[i] - self.points[i])).collect()
            }
        };
        x.iter_mut().enumerate().for_each(|(k, x)| *x += move_of(k));
        x
    }

    fn homogeneous(&self, gradient: &Matrix3<f64>) -> Vec<f64> {
        self.moved(|x| gradient * x)
    }

    /// The nodes moved by `map`, relative to the mean of the nodes.
    fn moved(&self, map: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Vec<f64> {
        let d = self.dimension;
        let nodes = self.rest.len() / d;
        let centre = |k: usize| self.rest.iter().skip(k).step_by(d).sum::<f64>() / nodes as f64;
        let centre = Vector3::from_fn(|k, _| if k < d { centre(k) } else { 0.0 });
        let place = |x: &[f64]| {
            let x = Vector3::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0));
            let x = centre + map(x - centre);
            (0..d).map(move |k| x[k]).collect::<Vec<f64>>()
        };
        self.rest.chunks_exact(d).flat_map(place).collect()
    }

    fn family(&self, family: DeformationFamily, scale: f64, numbers: &Numbers) -> Vec<f64> {
        let d = self.dimension;
        let [least, largest] = self.sampling.stretch;
        let amplitude = |coordinate: usize| scale * (least + (largest - least) * numbers.number(coordinate));
        if family == DeformationFamily::Gradients {
            let entry = |k: usize, l: usize| f64::from(u8::from(k == l)) + amplitude(k * d + l);
            return self.homogeneous(&within(d, entry));
        }
        let a = amplitude(0);
        let ratio = if a < 0.0 { 1.0 / (1.0 - a) } else { 1.0 + a };
        let axes = numbers.rotation(d);
        let [e, f] = [0, 1].map(|k| axes.matrix().column(k).into_owned());
        let across = |normal: Vector3<f64>, along: f64, beside: f64| {
            Matrix3::identity() * beside + (along - beside) * normal * normal.transpose()
        };
        let nu = self.poisson;
        match family {
            DeformationFamily::Uniaxial => self.homogeneous(&across(e, ratio, ratio.powf(-nu))),
            // In the plane both axes are in the plane.
            DeformationFamily::Equibiaxial if d == 3 => {
                self.homogeneous(&across(e, ratio.powf(-2.0 * nu / (1.0 - nu)), ratio))
            }
            DeformationFamily::Equibiaxial | DeformationFamily::Volumetric => {
                self.homogeneous(&(Matrix3::identity() * ratio))
            }
            DeformationFamily::SimpleShear => self.homogeneous(&(Matrix3::identity() + a * e * f.transpose())),
            DeformationFamily::Torsion => self.moved(|x| Rotation3::new(e * (2.0 * a * e.dot(&x) / self.extent)) * x),
            DeformationFamily::Bending => {
                let curvature = 2.0 * a / self.extent;
                self.moved(|x| {
                    let (along, over) = (e.dot(&x), f.dot(&x));
                    let (sine, cosine) = (curvature * along).sin_cos();
                    // sin(κs)/κ and (cos(κs) − 1)/κ, also at κ = 0.
                    let half = (curvature * along / 2.0).sin();
                    let (arc, sag) = if curvature == 0.0 {
                        (along, 0.0)
                    } else {
                        (sine / curvature, -2.0 * half * half / curvature)
                    };
                    x + e * (arc + over * sine - along) + f * (sag + over * cosine - over)
                })
            }
            DeformationFamily::Gradients => unreachable!("placed above"),
        }
    }
}

/// The index of the shape of a list that is number `i` of its part.
fn chosen(count: usize, part: Part, i: usize) -> usize {
    let apart = count / APART;
    match part {
        _ if apart == 0 => i % count,
        Part::HeldOut => (i % apart) * APART + APART - 1,
        Part::Trained => {
            let i = i % (count - apart);
            // Each run of four shapes is followed by one that is held out.
            if i / (APART - 1) < apart { i + i / (APART - 1) } else { i + apart }
        }
    }
}

fn within(d: usize, entry: impl Fn(usize, usize) -> f64) -> Matrix3<f64> {
    Matrix3::from_fn(|k, l| match (k < d && l < d, k == l) {
        (true, _) => entry(k, l),
        (false, same) => f64::from(u8::from(same)),
    })
}

/// A point of a scrambled Sobol sequence (Burley 2020), coordinate by coordinate.
pub struct Numbers {
    pub index: usize,
    pub seed: u64,
}

impl Numbers {
    /// A number in [0, 1).
    pub fn number(&self, coordinate: usize) -> f64 {
        let block = (self.index / LONGEST + 7919 * (coordinate / WIDEST)) as u64;
        // Sequences of neighbouring seeds must not be similar.
        let seed = (self.seed.wrapping_add(block << 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        f64::from(sobol_burley::sample((self.index % LONGEST) as u32, (coordinate % WIDEST) as u32, seed as u32))
    }

    /// A number in [−1, 1).
    fn symmetric(&self, coordinate: usize) -> f64 {
        2.0 * self.number(coordinate) - 1.0
    }

    /// A rotation from the coordinates 1 to 3, evenly distributed over all rotations (Shoemake 1992); in the plane
    /// about its normal.
    fn rotation(&self, d: usize) -> Rotation3<f64> {
        let [u, v, w] = [1, 2, 3].map(|k| self.number(k));
        if d < 3 {
            return Rotation3::from_axis_angle(&Vector3::z_axis(), TAU * u);
        }
        let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
        let (v, w) = (TAU * v, TAU * w);
        let quaternion = nalgebra::Quaternion::new(b * w.cos(), a * v.sin(), a * v.cos(), b * w.sin());
        UnitQuaternion::from_quaternion(quaternion).to_rotation_matrix()
    }
}
