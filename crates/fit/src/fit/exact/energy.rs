//! The energies whose finite elements are networks of springs, and the force laws of their springs on content.
//!
//! Theory: page *Exact networks and patches* of the book.

use crate::error::{Error, ErrorKind, Result};
use crate::material::{Energy, Material, Moduli, State};
use crate::scalar::{Packed, Real};
use crate::springs::Law;
use std::sync::Arc;

/// An energy `μ/2 (|F|² − d) + U(J)` with `U'(1) = −μ`, or one that also contains `|cof F|²`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ExactEnergy {
    /// `U = −μ (J − 1) + (λ + μ)/2 (J − 1)²`: the springs on content are linear. Smith, De Goes, Kim (2018), Stable
    /// neo-Hookean flesh simulation, (14), with their Lamé constants instead of those of the material.
    #[default]
    StableNeoHookean,
    /// `U = −μ ln J + λ/2 ln² J`. Bonet, Wood (2008), 6.4.3.
    NeoHookean,
    /// `μ/2 ((1 − s) (|F|² − 3) + s (|cof F|² − 3)) + U(J)`, `U = −μ (1 + s) (J − 1) + (λ + μ (1 − s))/2 (J − 1)²`,
    /// after Ciarlet and Geymonat (1982). It also has springs on areas; all springs are linear. In plane strain it is
    /// equal to the stable neo-Hookean energy.
    StableMooneyRivlin {
        /// The share s of the shear modulus, from 0 to 1, that belongs to the second invariant.
        share: f64,
    },
    /// `λ/2 (tr E)² + μ E:E` with Green's strain `E = ½ (FᵀF − I)`: the law of Hooke in these strains. On surfaces in space it has springs on strains of the domains of
    /// edges, without stress across them.
    StVenantKirchhoff,
}

crate::named!(ExactEnergy {
    "stable-neo-hookean" => StableNeoHookean,
    "neo-hookean" => NeoHookean,
    "stable-mooney-rivlin" => StableMooneyRivlin { share: 0.25 },
    "st-venant-kirchhoff" => StVenantKirchhoff,
});

/// The deformations at which two energies are compared: `I1`, `I2` and `J` of some deformations that are not rotations.
/// Swelling and shrinking ones differ in every term of the energies, which four points tell apart.
const DEFORMATIONS: [[f64; 3]; 4] = [[3.4, 3.7, 1.1], [2.8, 2.7, 0.9], [4.1, 5.0, 1.3], [3.3, 3.2, 0.7]];
/// The difference that rounding may leave, relative to the moduli.
// Values are sums of a few terms of size one, which rounding changes by some 1e-15. Another energy differs by 1e-3 or more at one of these
// deformations.
const SAME: f64 = 1e-10;

impl ExactEnergy {
    /// The exact energy that is equal to a law apart from its fibres, if there is one.
    pub fn of_law(law: &Energy) -> Option<ExactEnergy> {
        let mu = law.moduli().mu;
        // At equal I1 and J the energy grows with I2 by μ s/2, which gives the share s of a law.
        let [a, b] = [[3.0, 3.0, 1.0], [3.0, 4.0, 1.0]].map(|at| law.of_invariants(at));
        let share = (b? - a?) / (mu / 2.0);
        // A share outside of its range is that of no energy: the default stays and fails the comparison.
        let candidates = ExactEnergy::all().map(|energy| energy.with_share(share).unwrap_or(energy));
        candidates.into_iter().find(|energy| energy.is_that_of(law))
    }

    /// Whether a law is equal to this energy apart from its fibres.
    pub fn is_that_of(&self, law: &Energy) -> bool {
        let Moduli { lambda, mu } = law.moduli();
        let size = SAME * (lambda.abs() + mu);
        let value = |at: [f64; 3]| law.of_invariants(at).map(|value| value - self.value(at, [lambda, mu]));
        // A value that is not a number compares as false, and the law counts as another one.
        DEFORMATIONS.iter().all(|at| value(*at).is_some_and(|difference| difference.abs() <= size))
    }

    /// The energy W at the invariants `I1`, `I2`, `J`, with λ and μ.
    fn value(&self, [i1, i2, j]: [f64; 3], [lambda, mu]: [f64; 2]) -> f64 {
        // The invariants are 3 at rest also in the plane, where they contain the stretch through the thickness.
        let square = (j - 1.0) * (j - 1.0);
        match self {
            ExactEnergy::StableNeoHookean => mu / 2.0 * (i1 - 3.0) - mu * (j - 1.0) + (lambda + mu) / 2.0 * square,
            ExactEnergy::NeoHookean => mu / 2.0 * (i1 - 3.0) - mu * j.ln() + lambda / 2.0 * j.ln() * j.ln(),
            ExactEnergy::StableMooneyRivlin { share } => {
                mu / 2.0 * ((1.0 - share) * (i1 - 3.0) + share * (i2 - 3.0)) - mu * (1.0 + share) * (j - 1.0)
                    + (lambda + mu * (1.0 - share)) / 2.0 * square
            }
            ExactEnergy::StVenantKirchhoff => {
                // `tr E = (I1 − 3)/2` and `4 E:E = tr C² − 2 tr C + 3` with `tr C² = I1² − 2 I2`.
                let trace = (i1 - 3.0) / 2.0;
                lambda / 2.0 * trace * trace + mu / 4.0 * (i1 * i1 - 2.0 * i2 - 2.0 * i1 + 3.0)
            }
        }
    }

    /// The names of the energies of springs on lengths and contents.
    pub fn of_contents() -> Vec<&'static str> {
        let all = ExactEnergy::all().filter(|energy| energy.has_contents().is_ok());
        all.map(|energy| energy.name()).collect()
    }

    /// Checks that the energy is that of springs on lengths and contents.
    ///
    /// # Errors
    /// It is that of springs on strains; the kind is `Unsupported`.
    pub fn has_contents(&self) -> Result<()> {
        match self {
            ExactEnergy::StableNeoHookean | ExactEnergy::NeoHookean | ExactEnergy::StableMooneyRivlin { .. } => Ok(()),
            ExactEnergy::StVenantKirchhoff => Err(self.contents_alone()),
        }
    }

    /// The error of an energy that has no springs on contents.
    pub fn contents_alone(&self) -> Error {
        let expected = "another energy: only shear = \"edges\" on a surface in space has springs on strains";
        Error::expected("energy", expected, format!("\"{}\"", self.name())).of_kind(ErrorKind::Unsupported)
    }

    /// Sets the share of the shear modulus that belongs to the second invariant.
    ///
    /// # Errors
    /// The energy has no second invariant, or the share is not from 0 to 1.
    pub fn with_share(self, share: f64) -> Result<ExactEnergy> {
        match self {
            ExactEnergy::StableMooneyRivlin { .. } if (0.0..=1.0).contains(&share) => {
                Ok(ExactEnergy::StableMooneyRivlin { share })
            }
            ExactEnergy::StableMooneyRivlin { .. } => Err(Error::expected("share", "a share from 0 to 1", share)),
            ExactEnergy::StableNeoHookean | ExactEnergy::NeoHookean | ExactEnergy::StVenantKirchhoff => {
                let found = format!("found with \"{}\"", self.name());
                Err(Error::at("share", format!("belongs to the energy \"stable-mooney-rivlin\", {found}")))
            }
        }
    }
}

/// The form of an exact network: what is the same in all cells of one energy and state.
#[derive(Debug, Clone)]
pub(super) struct Form {
    /// The force law of springs on content, if it is not linear. Its parameters are `a` (μ per content of the spring)
    /// and `b` (λ).
    pub law: Option<Arc<Law>>,
    /// Whether the law contains the stretches across a plane or rod; then it must contain both terms.
    pub is_condensed: bool,
}

/// The coefficients of an exact network, per volume of the cell, thickness included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coefficients<C = f64> {
    /// The coefficient of `½ |F|²`, which the springs between nodes represent.
    pub lengths: C,
    /// The coefficient of `½ |cof F|²`, which the springs on areas represent.
    pub areas: C,
    /// `−U'(1)`: the force with which springs on content pull at rest.
    pub tension: C,
    /// `slope + lambda = U''(1)`. `slope` remains in the cells if λ is given to patches of cells.
    pub slope: C,
    pub lambda: C,
    /// The λ in the law.
    pub law_lambda: C,
}

/// `T = U'(J)/c₀` of the compressible neo-Hookean energy.
const NEO_HOOKEAN: &str = "(-a + b*ln(c/c0))*c0/c";

/// The stable neo-Hookean energy with the stretch g through the thickness that leaves no stress there,
/// `g = (λ + 2 μ) J/(μ + (λ + μ) J²)`. What remains is a function of J alone with the slope
/// `g (−μ + (λ + μ) (J g − 1))`.
const STABLE_IN_PLANE_STRESS: &str = "-(a - (a + b)*(c/c0*g - 1))*g";
/// The stretch g through the thickness.
const ACROSS_PLANE: &str = "((b + 2*a)*c/c0/(a + (a + b)*(c/c0)^2))";

/// The stable neo-Hookean energy with the stretches g across a rod that leave no stress there, `g² = ((λ + 2 μ) J − μ)/((λ + μ) J²)`. What
/// remains has the slope `−μ g²/J`.
const STABLE_IN_ROD: &str = "-a*((b + 2*a)*c/c0 - a)/((a + b)*(c/c0)^3)";

impl Form {
    /// The form for small deformations or, with `is_large`, for any deformation.
    ///
    /// # Errors
    /// The energy has no form with springs in this state; the kind is `Unsupported`.
    pub fn of(energy: ExactEnergy, state: State, is_large: bool) -> Result<Form> {
        energy.has_contents()?;
        let law = |text: &str| Some(Arc::new(Law::parse(text).expect("the laws of this file are expressions")));
        if !is_condensed(state, is_large) {
            let law = if energy == ExactEnergy::NeoHookean { law(NEO_HOOKEAN) } else { None };
            return Ok(Form { law, is_condensed: false });
        }
        let text = match (energy, state) {
            (ExactEnergy::StableNeoHookean, State::Rod { .. }) => STABLE_IN_ROD.to_string(),
            (ExactEnergy::StableNeoHookean, _) => STABLE_IN_PLANE_STRESS.replace('g', ACROSS_PLANE),
            (ExactEnergy::NeoHookean | ExactEnergy::StableMooneyRivlin { .. } | ExactEnergy::StVenantKirchhoff, _) => {
                let expected = "\"stable-neo-hookean\": the stretch across planes and rods without stress has no formula in others";
                return Err(Error::expected("energy", expected, format!("\"{}\"", energy.name()))
                    .of_kind(ErrorKind::Unsupported));
            }
        };
        Ok(Form { law: law(&text), is_condensed: true })
    }
}

/// Whether the network has the stretches across a plane or rod.
fn is_condensed(state: State, is_large: bool) -> bool {
    match state {
        State::PlaneStress { .. } | State::Rod { .. } => is_large,
        State::PlaneStrain { .. } | State::Solid => false,
    }
}

impl<C: Clone> Coefficients<C> {
    /// Those without springs on areas.
    pub fn plain(Moduli { lambda, mu }: Moduli<C>, zero: &C) -> Coefficients<C> {
        let [lengths, tension, slope] = [mu.clone(), mu.clone(), mu];
        Coefficients { lengths, areas: zero.clone(), tension, slope, lambda: lambda.clone(), law_lambda: lambda }
    }
}

impl Coefficients {
    /// The coefficients for small deformations or, with `is_large`, for any deformation.
    ///
    /// # Errors
    /// Poisson's ratio is 0.5 where the stretch across a plane or rod has no formula then, or the energy is no sum of springs on lengths and contents.
    pub fn of(energy: ExactEnergy, material: Material, is_large: bool) -> Result<Coefficients> {
        energy.has_contents()?;
        let Moduli { lambda, mu } = material.moduli();
        let (nu, t) = (material.poisson(), material.thickness());
        // The moduli of a plane or rod without stress across it have the stretch across condensed by the linear theory.
        // Laws at large deformation condense that stretch themselves, and take the moduli of the solid.
        let solid_mu = t * material.young() / (2.0 * (1.0 + nu));
        let solid_lambda = 2.0 * solid_mu * nu / (1.0 - 2.0 * nu);
        let plain = Coefficients::plain(Moduli { lambda, mu }, &0.0);
        if !is_condensed(material.state(), is_large) {
            return Ok(match (energy, material.state()) {
                (ExactEnergy::StableMooneyRivlin { share }, State::Solid) => Coefficients {
                    lengths: mu * (1.0 - share),
                    areas: mu * share,
                    tension: mu * (1.0 + share),
                    slope: mu * (1.0 - share),
                    ..plain
                },
                (
                    ExactEnergy::NeoHookean
                    | ExactEnergy::StableNeoHookean
                    | ExactEnergy::StableMooneyRivlin { .. }
                    | ExactEnergy::StVenantKirchhoff,
                    _,
                ) => plain,
            });
        }
        // Only 1/2 itself, which plane stress and rods may have, leaves the λ of the solid without a finite value.
        if nu == 0.5 {
            let expected = "a ratio below 0.5 for exact networks at large deformation";
            return Err(Error::expected("poisson", expected, nu));
        }
        // In the linear theory a rod has only λ + 2 μ, so that μ is arbitrary.
        let lambda = if let State::Rod { .. } = material.state() { 2.0 * mu - 2.0 * solid_mu } else { lambda };
        let (lengths, tension, slope) = (solid_mu, solid_mu, solid_mu);
        Ok(Coefficients { lengths, areas: 0.0, tension, slope, lambda, law_lambda: solid_lambda })
    }

    /// The mean of coefficients with these shares.
    pub fn mean<'a>(parts: impl Iterator<Item = (&'a Coefficients, f64)>) -> Coefficients {
        let zero = Coefficients { lengths: 0.0, areas: 0.0, tension: 0.0, slope: 0.0, lambda: 0.0, law_lambda: 0.0 };
        parts.fold(zero, |sum, (of, share)| Coefficients {
            lengths: sum.lengths + share * of.lengths,
            areas: sum.areas + share * of.areas,
            tension: sum.tension + share * of.tension,
            slope: sum.slope + share * of.slope,
            lambda: sum.lambda + share * of.lambda,
            law_lambda: sum.law_lambda + share * of.law_lambda,
        })
    }

    /// The coefficients as numbers of the kind of `any`.
    pub fn of_kind<T: Real>(&self, any: &T) -> Coefficients<T> {
        let Coefficients { lengths, areas, tension, slope, lambda, law_lambda } = self;
        Coefficients {
            lengths: any.constant(lengths),
            areas: any.constant(areas),
            tension: any.constant(tension),
            slope: any.constant(slope),
            lambda: any.constant(lambda),
            law_lambda: any.constant(law_lambda),
        }
    }
}

impl<T: Packed> Coefficients<T> {
    /// Sets the coefficients of one lane.
    pub fn set_lane(&mut self, lane: usize, of: &Coefficients) {
        let lanes = [
            (&mut self.lengths, of.lengths),
            (&mut self.areas, of.areas),
            (&mut self.tension, of.tension),
            (&mut self.slope, of.slope),
            (&mut self.lambda, of.lambda),
            (&mut self.law_lambda, of.law_lambda),
        ];
        lanes.into_iter().for_each(|(lanes, value)| lanes.as_mut_slice()[lane] = value);
    }
}
