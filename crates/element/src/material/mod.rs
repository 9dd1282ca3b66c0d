//! Isotropic linear elasticity: Young's modulus and Poisson's ratio, the moduli λ and μ, and the state of a plane or a
//! rod.
//!
//! Hyperelastic energies are in [`Energy`].
//!
//! Theory: page *Stiffness and the reduced space* of the book.

mod anisotropy;
mod cell_map;
mod energy;
mod energy_map;
mod hooke;
mod map;
mod region;
mod relaxation;
mod response;
mod rest;

pub use anisotropy::Anisotropy;
pub use cell_map::{BlockValues, CellMap};
pub use energy::{Energy, schema};
pub use energy_map::EnergyMap;
pub use hooke::{Hooke, Stiffness, strains, voigt};
pub use map::{LinearMaterial, MaterialMap};
pub use region::RegionMaterial;
pub use relaxation::{Relaxation, RelaxationTerm, expect_strains, relaxed_material, with_moduli};
pub use response::Tangent;
pub use springfit_shipped::MATERIALS as SHIPPED;

use crate::error::{Error, Result};
use crate::range::positive;
use crate::scalar::Scalar;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a body of fewer than three dimensions stands for a solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum State {
    /// A rod without stress across it.
    Rod {
        /// The cross-section, in m².
        area: f64,
    },
    /// A body of three dimensions.
    Solid,
    /// A plate without stress through its thickness.
    PlaneStress {
        /// The thickness, in m.
        thickness: f64,
    },
    /// A plate without strain through its thickness.
    PlaneStrain {
        /// The thickness, in m.
        thickness: f64,
    },
}

impl State {
    /// The factor that makes the content of a cell a volume: the thickness in m, the cross-section of a rod in m², 1
    /// for a solid.
    pub fn thickness(self) -> f64 {
        match self {
            State::Solid => 1.0,
            State::Rod { area } => area,
            State::PlaneStress { thickness } | State::PlaneStrain { thickness } => thickness,
        }
    }

    /// The dimension of the body.
    pub fn dimension(self) -> usize {
        match self {
            State::Rod { .. } => 1,
            State::PlaneStress { .. } | State::PlaneStrain { .. } => 2,
            State::Solid => 3,
        }
    }

    /// The state in words.
    pub fn words(self) -> &'static str {
        match self {
            State::Rod { .. } => "rod",
            State::Solid => "solid",
            State::PlaneStress { .. } => "plane stress",
            State::PlaneStrain { .. } => "plane strain",
        }
    }

    /// Which of the two plane states it is, if it is one.
    pub fn plane(self) -> Option<Plane> {
        match self {
            State::PlaneStress { .. } => Some(Plane::Stress),
            State::PlaneStrain { .. } => Some(Plane::Strain),
            State::Rod { .. } | State::Solid => None,
        }
    }

    /// Checks that bodies of this dimension can be in this state.
    ///
    /// # Errors
    /// They cannot, or the thickness is not positive.
    pub fn check(self, dimension: usize) -> Result<()> {
        if self.dimension() != dimension {
            return Err(Error::expected("state", format!("one of a body of {dimension} dimensions"), self.dimension()));
        }
        if !(self.thickness() > 0.0 && self.thickness().is_finite()) {
            return Err(Error::expected("thickness", "a positive number", self.thickness()));
        }
        Ok(())
    }
}

/// The two plane states, by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Plane {
    /// Plane stress.
    Stress,
    /// Plane strain.
    Strain,
}

impl Plane {
    /// The name, as files and arguments have it.
    pub fn name(self) -> &'static str {
        match self {
            Plane::Stress => "stress",
            Plane::Strain => "strain",
        }
    }

    /// The state of a body with this thickness, in m.
    pub fn state(self, thickness: f64) -> State {
        match self {
            Plane::Stress => State::PlaneStress { thickness },
            Plane::Strain => State::PlaneStrain { thickness },
        }
    }

    /// The plane state of this name.
    ///
    /// # Errors
    /// There is none; the error has the key `plane`.
    pub fn named(name: &str) -> Result<Plane> {
        let all = [Plane::Stress, Plane::Strain];
        let unknown = || Error::expected("plane", "\"stress\" or \"strain\"", format!("\"{name}\""));
        all.into_iter().find(|plane| plane.name() == name).ok_or_else(unknown)
    }
}

/// An isotropic material whose constants have been checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    young: f64,
    poisson: f64,
    state: State,
}

/// The two constants of `σ = λ tr(ε) I + 2μ ε`, in Pa; in two dimensions multiplied by the thickness, in N/m.
///
/// In plane stress λ is `Eν/(1−ν²) = 2λμ/(λ+2μ)` (on the right the λ of the solid), for which no stress acts through
/// the thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moduli<C = f64> {
    /// Lamé's first constant λ.
    pub lambda: C,
    /// The shear modulus μ.
    pub mu: C,
}

impl<C> Moduli<C> {
    /// The moduli as numbers of the kind of `any`.
    pub fn of_kind<T: Scalar<Constant = C>>(&self, any: &T) -> Moduli<T> {
        Moduli { lambda: any.constant(&self.lambda), mu: any.constant(&self.mu) }
    }
}

impl Material {
    /// A material with Young's modulus `young` (Pa) and Poisson's ratio `poisson`.
    ///
    /// # Errors
    /// `E ≤ 0`, `ν ≤ −1`, `ν ≥ 1/2` (plane stress: `ν > 1/2`), thickness not positive, or a value that is not finite.
    pub fn new(young: f64, poisson: f64, state: State) -> Result<Material> {
        positive("young", young, "Pa")?;
        let in_range = match state {
            // At 1/2 the λ of plane stress is `E ν/(1 − ν²) = 2 E/3`, and a rod has no λ, whereas that of a solid and
            // of plane strain is infinite.
            State::PlaneStress { .. } | State::Rod { .. } => poisson > -1.0 && poisson <= 0.5,
            _ => poisson > -1.0 && poisson < 0.5,
        };
        if !in_range {
            let incompressible = if poisson == 0.5 {
                "; for a nearly incompressible solid take 0.4999 and exact networks with volume = \"patches\" (triangles, tetrahedra) or \"cells\""
            } else {
                ""
            };
            return Err(Error::expected("poisson", format!("a ratio above -1 and below 0.5{incompressible}"), poisson));
        }
        if let State::PlaneStress { thickness } | State::PlaneStrain { thickness } = state {
            positive("thickness", thickness, "m")?;
        }
        if let State::Rod { area } = state {
            positive("area", area, "m²")?;
        }
        Ok(Material { young, poisson, state })
    }

    /// The material of a body of this dimension. In the plane, `plane` defaults to plane stress and `thickness` to 1 m;
    /// a rod has a cross-section of 1 m².
    ///
    /// # Errors
    /// A constant is out of range, or a plane state or a thickness is given for a solid or a rod.
    pub fn for_body(
        dimension: usize,
        young: f64,
        poisson: f64,
        plane: Option<Plane>,
        thickness: Option<f64>,
    ) -> Result<Material> {
        let state = match (dimension, plane) {
            (2, plane) => plane.unwrap_or(Plane::Stress).state(thickness.unwrap_or(1.0)),
            (_, Some(_)) => {
                return Err(Error::at("plane", format!("expected a plane mesh, found {}", body(dimension))));
            }
            (_, None) if thickness.is_some() => {
                return Err(Error::at("thickness", format!("expected a plane mesh, found {}", body(dimension))));
            }
            (1, _) => State::Rod { area: 1.0 },
            _ => State::Solid,
        };
        Material::new(young, poisson, state)
    }

    /// Gives a rod another cross-section, in m².
    ///
    /// # Errors
    /// The body is not a rod, or the area is not positive.
    pub fn with_area(self, area: f64) -> Result<Material> {
        match self.state {
            State::Rod { .. } => Material::new(self.young, self.poisson, State::Rod { area }),
            State::Solid => Err(Error::at("area", "expected a mesh of lines, found a solid one")),
            _ => Err(Error::at("area", "expected a mesh of lines, found a plane one")),
        }
    }

    /// Young's modulus, in Pa.
    pub fn young(&self) -> f64 {
        self.young
    }

    /// Poisson's ratio.
    pub fn poisson(&self) -> f64 {
        self.poisson
    }

    /// The state of the body.
    pub fn state(&self) -> State {
        self.state
    }

    /// The factor that makes the content of a cell a volume, see [`State::thickness`].
    pub fn thickness(&self) -> f64 {
        self.state.thickness()
    }

    /// The moduli in the dimensions of the body: in Pa for a solid, in N/m in the plane, in N for a rod.
    pub fn moduli(&self) -> Moduli {
        let (e, nu, t) = (self.young, self.poisson, self.thickness());
        let lambda = match self.state {
            // A rod has only λ + 2μ = E A; how it is divided does not matter.
            State::Rod { area } => return Moduli { lambda: 0.0, mu: area * e / 2.0 },
            State::PlaneStress { .. } => e * nu / ((1.0 + nu) * (1.0 - nu)),
            _ => e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        };
        Moduli { lambda: t * lambda, mu: t * e / (2.0 * (1.0 + nu)) }
    }
}

fn body(dimension: usize) -> &'static str {
    if dimension == 1 { "one of lines" } else { "a solid one" }
}
