//! Families of deformations with random amplitudes and directions.
//!
//! Theory: page *Sampled fits* of the book.

use nalgebra::{Matrix3, Rotation3, Unit, UnitQuaternion, Vector3};
use std::f64::consts::TAU;

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
    /// Two stretches in a plane, `(λ₁ λ₂)^(−ν/(1 − ν))` across it.
    Biaxial,
    /// λ along one axis and `1/λ` along another.
    PureShear,
    /// Sections rotated about an axis by `2a` over the size of the cell; for solids.
    Torsion,
    /// Circular bending with a strain of about a at the outer fibres.
    Bending,
    /// `I + A`, with an independent amplitude for every entry of A.
    Gradients,
    /// `Q diag(λ) Rᵀ`, with an independent stretch along every axis and random rotations Q and R.
    PrincipalStretches,
}

crate::named!(DeformationFamily {
    "uniaxial" => Uniaxial,
    "equibiaxial" => Equibiaxial,
    "simple-shear" => SimpleShear,
    "volumetric" => Volumetric,
    "biaxial" => Biaxial,
    "pure-shear" => PureShear,
    "torsion" => Torsion,
    "bending" => Bending,
    "gradients" => Gradients,
    "principal-stretches" => PrincipalStretches,
});

impl DeformationFamily {
    /// The least dimension of cells that have such deformations.
    pub fn least_dimension(self) -> usize {
        match self {
            DeformationFamily::Uniaxial
            | DeformationFamily::Volumetric
            | DeformationFamily::Gradients
            | DeformationFamily::PrincipalStretches => 1,
            DeformationFamily::Equibiaxial
            | DeformationFamily::SimpleShear
            | DeformationFamily::Biaxial
            | DeformationFamily::PureShear
            | DeformationFamily::Bending => 2,
            DeformationFamily::Torsion => 3,
        }
    }

    /// Whether the deformation has axes, which directions can give.
    pub fn has_axes(self) -> bool {
        match self {
            DeformationFamily::Volumetric | DeformationFamily::Gradients | DeformationFamily::PrincipalStretches => {
                false
            }
            DeformationFamily::Uniaxial
            | DeformationFamily::Equibiaxial
            | DeformationFamily::SimpleShear
            | DeformationFamily::Biaxial
            | DeformationFamily::PureShear
            | DeformationFamily::Torsion
            | DeformationFamily::Bending => true,
        }
    }
}

/// The cell as far as families see it.
pub struct Resting<'a> {
    /// The positions at rest, `[nodes × dimension]`, m.
    pub rest: &'a [f64],
    pub dimension: usize,
    /// The content to the power of one over the dimension, m.
    pub extent: f64,
    /// The ν of the lateral contraction.
    pub poisson: f64,
}

/// What a shape of a family is drawn from.
pub struct Draw<'a> {
    /// Numbers in [0, 1), by their coordinates.
    pub number: &'a dyn Fn(usize) -> f64,
    /// The least and the largest amplitude.
    pub stretch: [f64; 2],
    /// The share of the deformation that is kept.
    pub scale: f64,
    /// The first axis, `[dimension]`, and after it the second one if it is given; random axes without.
    pub direction: Option<&'a [f64]>,
}

impl Draw<'_> {
    fn amplitude(&self, coordinate: usize) -> f64 {
        let [least, largest] = self.stretch;
        self.scale * (least + (largest - least) * (self.number)(coordinate))
    }

    /// λ of the amplitude from this coordinate.
    fn ratio(&self, coordinate: usize) -> f64 {
        let a = self.amplitude(coordinate);
        // Amplitudes of a and −a are inverse stretches, and no amplitude makes a stretch of zero or below.
        if a < 0.0 { 1.0 / (1.0 - a) } else { 1.0 + a }
    }

    /// A rotation from three coordinates, evenly distributed over all rotations (Shoemake 1992); in the plane
    /// about its normal, and none of a line.
    fn rotation(&self, first: usize, d: usize) -> Rotation3<f64> {
        let [u, v, w] = [0, 1, 2].map(|k| (self.number)(first + k));
        match d {
            1 => return Rotation3::identity(),
            2 => return Rotation3::from_axis_angle(&Vector3::z_axis(), TAU * u),
            _ => {}
        }
        let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
        let (v, w) = (TAU * v, TAU * w);
        let quaternion = nalgebra::Quaternion::new(b * w.cos(), a * v.sin(), a * v.cos(), b * w.sin());
        UnitQuaternion::from_quaternion(quaternion).to_rotation_matrix()
    }

    /// Two axes across each other.
    fn axes(&self, d: usize) -> [Vector3<f64>; 2] {
        let Some(direction) = self.direction else {
            let axes = self.rotation(1, d);
            return [0, 1].map(|k| axes.matrix().column(k).into_owned());
        };
        let vector = |given: &[f64]| Vector3::from_fn(|k, _| given.get(k).copied().unwrap_or(0.0));
        let e = vector(&direction[..d]).normalize();
        let second = match (direction.len() > d, d) {
            (true, _) => vector(&direction[d..]),
            (false, 3) => {
                // Any axis across e, turned about it at random.
                // The axis of the smallest component is farthest from e: the product with it does not vanish.
                let least = (0..3).fold(0, |best, k| if e[k].abs() < e[best].abs() { k } else { best });
                let across = e.cross(&Vector3::from_fn(|k, _| f64::from(u8::from(k == least))));
                Rotation3::from_axis_angle(&Unit::new_normalize(e), TAU * (self.number)(1)) * across
            }
            (false, _) => Vector3::new(-e[1], e[0], 0.0),
        };
        // A second axis that is given need not be across the first.
        [e, (second - e * e.dot(&second)).normalize()]
    }
}

impl Resting<'_> {
    /// The nodes of a shape of the family, `[nodes × dimension]`.
    pub fn deformed(&self, family: DeformationFamily, draw: &Draw) -> Vec<f64> {
        let (d, nu) = (self.dimension, self.poisson);
        let across = |normal: Vector3<f64>, along: f64, beside: f64| {
            Matrix3::identity() * beside + (along - beside) * normal * normal.transpose()
        };
        let axes = || draw.axes(d);
        match family {
            DeformationFamily::Gradients => {
                let entry = |k: usize, l: usize| f64::from(u8::from(k == l)) + draw.amplitude(k * d + l);
                self.homogeneous(&within(d, entry))
            }
            DeformationFamily::PrincipalStretches => {
                let stretches = within(d, |k, l| if k == l { draw.ratio(k) } else { 0.0 });
                let [left, right] = [3, 6].map(|first| draw.rotation(first, d));
                self.homogeneous(&(left.matrix() * stretches * right.matrix().transpose()))
            }
            DeformationFamily::Uniaxial => {
                let ratio = draw.ratio(0);
                self.homogeneous(&across(axes()[0], ratio, ratio.powf(-nu)))
            }
            // In the plane both axes are in the plane.
            DeformationFamily::Equibiaxial if d == 3 => {
                let ratio = draw.ratio(0);
                self.homogeneous(&across(axes()[0], ratio.powf(-2.0 * nu / (1.0 - nu)), ratio))
            }
            DeformationFamily::Equibiaxial | DeformationFamily::Volumetric => {
                self.homogeneous(&(Matrix3::identity() * draw.ratio(0)))
            }
            DeformationFamily::Biaxial => {
                let ([e, f], [first, second]) = (axes(), [0, 4].map(|k| draw.ratio(k)));
                let beside = (first * second).powf(-nu / (1.0 - nu));
                let rest = Matrix3::identity() * beside;
                let along = (first - beside) * e * e.transpose() + (second - beside) * f * f.transpose();
                self.homogeneous(&(rest + along))
            }
            DeformationFamily::PureShear => {
                let ([e, f], ratio) = (axes(), draw.ratio(0));
                let along = (ratio - 1.0) * e * e.transpose() + (1.0 / ratio - 1.0) * f * f.transpose();
                self.homogeneous(&(Matrix3::identity() + along))
            }
            DeformationFamily::SimpleShear => {
                let ([e, f], a) = (axes(), draw.amplitude(0));
                self.homogeneous(&(Matrix3::identity() + a * e * f.transpose()))
            }
            DeformationFamily::Torsion => {
                let ([e, _], a) = (axes(), draw.amplitude(0));
                self.moved(|x| Rotation3::new(e * (2.0 * a * e.dot(&x) / self.extent)) * x)
            }
            DeformationFamily::Bending => {
                let ([e, f], curvature) = (axes(), 2.0 * draw.amplitude(0) / self.extent);
                self.moved(|x| {
                    let (along, over) = (e.dot(&x), f.dot(&x));
                    let (sine, cosine) = (curvature * along).sin_cos();
                    // sin(κs)/κ and (cos(κs) − 1)/κ, also at κ = 0.
                    // `cos x − 1 = −2 sin²(x/2)` keeps its digits where x is small.
                    let half = (curvature * along / 2.0).sin();
                    let (arc, sag) = if curvature == 0.0 {
                        (along, 0.0)
                    } else {
                        (sine / curvature, -2.0 * half * half / curvature)
                    };
                    x + e * (arc + over * sine - along) + f * (sag + over * cosine - over)
                })
            }
        }
    }

    pub fn homogeneous(&self, gradient: &Matrix3<f64>) -> Vec<f64> {
        self.moved(|x| gradient * x)
    }

    /// The nodes moved by `map`, relative to the mean of the nodes.
    fn moved(&self, map: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Vec<f64> {
        let d = self.dimension;
        let nodes = self.rest.len() / d;
        // Torsion and bending turn about the middle of the cell; homogeneous deformations differ by a translation only.
        let centre = |k: usize| self.rest.iter().skip(k).step_by(d).sum::<f64>() / nodes as f64;
        let centre = Vector3::from_fn(|k, _| if k < d { centre(k) } else { 0.0 });
        let place = |x: &[f64]| {
            let x = Vector3::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0));
            let x = centre + map(x - centre);
            (0..d).map(move |k| x[k]).collect::<Vec<f64>>()
        };
        self.rest.chunks_exact(d).flat_map(place).collect()
    }
}

/// A matrix with these entries in its first d rows and columns, and the identity beyond.
pub fn within(d: usize, entry: impl Fn(usize, usize) -> f64) -> Matrix3<f64> {
    Matrix3::from_fn(|k, l| match (k < d && l < d, k == l) {
        (true, _) => entry(k, l),
        (false, same) => f64::from(u8::from(same)),
    })
}
