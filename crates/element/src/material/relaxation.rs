//! Stress that relaxes: Prony series of the shear modulus and of the bulk modulus.
//!
//! Theory: page *Springs that forget* of the book.

use super::{Material, MaterialMap, Moduli, State};
use crate::error::{Error, ErrorKind, Result};
use crate::range;

/// One term of a Prony series: shares of the moduli that relax with one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelaxationTerm {
    /// The share g of the shear modulus, from 0 to 1.
    pub shear: f64,
    /// The share k of the bulk modulus, from 0 to 1.
    pub bulk: f64,
    /// The relaxation time τ, s.
    pub time: f64,
    /// The von Mises stress of the term up to which it does not flow, Pa; without one it always flows.
    pub yield_stress: Option<f64>,
}

/// `μ(t) = μ (1 − Σ g_i (1 − e^(−t/τ_i)))`, `K(t) = K (1 − Σ k_i (1 − e^(−t/τ_i)))`, with the moduli μ and K of the material: those against a
/// strain that has just been applied.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxation {
    terms: Vec<RelaxationTerm>,
}

/// Rounding of shares that are written as decimals and add up to one.
const SLACK: f64 = 1e-12;

impl Relaxation {
    /// The terms of a series.
    ///
    /// # Errors
    /// There is no term, a share is negative, all shares of a term are zero, the shares of a modulus add up to more than one, or a time is not
    /// above zero. The key names the term.
    pub fn new(terms: Vec<RelaxationTerm>) -> Result<Relaxation> {
        if terms.is_empty() {
            return Err(Error::expected("terms", "at least one { shear, bulk, time }", "none"));
        }
        for (i, term) in terms.iter().enumerate() {
            let under = |e: Error| e.under(format!("terms[{i}]"));
            for (key, share) in [("shear", term.shear), ("bulk", term.bulk)] {
                if !(0.0..=1.0).contains(&share) {
                    return Err(under(Error::expected(key, "a share of the modulus from 0 to 1", share)));
                }
            }
            // Such a term would cost its memory in every step and change nothing.
            if term.shear == 0.0 && term.bulk == 0.0 {
                return Err(Error::expected(format!("terms[{i}]"), "a share of shear or bulk above 0", "none"));
            }
            range::positive("time", term.time, "s").map_err(under)?;
            if let Some(stress) = term.yield_stress {
                range::positive("yield", stress, "Pa").map_err(under)?;
                if term.shear == 0.0 || term.bulk > 0.0 {
                    let expected = "a term of shear alone, whose stress is compared with \"yield\"";
                    let found = if term.shear == 0.0 { "none of shear" } else { "one of bulk too" };
                    return Err(under(Error::expected("yield", expected, found)));
                }
            }
        }
        let relaxation = Relaxation { terms };
        for (key, sum) in ["shear", "bulk"].into_iter().zip(relaxation.sums()) {
            // Shares of more than one would leave a modulus below zero in the end.
            if sum > 1.0 + SLACK {
                return Err(Error::expected("terms", format!("shares of {key} that add up to at most 1"), sum));
            }
        }
        Ok(relaxation)
    }

    /// The terms.
    pub fn terms(&self) -> &[RelaxationTerm] {
        &self.terms
    }

    /// The sums of the shares of shear and of bulk.
    pub fn sums(&self) -> [f64; 2] {
        [self.terms.iter().map(|term| term.shear).sum(), self.terms.iter().map(|term| term.bulk).sum()]
    }

    /// Whether shear and bulk relax alike, so that every force does.
    pub fn is_alike(&self) -> bool {
        self.terms.iter().all(|term| term.shear == term.bulk)
    }

    /// The number of the first term that yields.
    pub fn first_yield(&self) -> Option<usize> {
        self.terms.iter().position(|term| term.yield_stress.is_some())
    }

    /// The shortest relaxation time, s.
    pub fn shortest(&self) -> f64 {
        self.terms.iter().fold(f64::INFINITY, |least, term| least.min(term.time))
    }

    /// The shares of the moduli μ and K that are left at the time t, s, after a strain was applied.
    pub fn left(&self, t: f64) -> [f64; 2] {
        self.terms.iter().fold([1.0; 2], |[shear, bulk], term| {
            // `expm1` keeps the digits at times far below τ.
            let gone = -(-t / term.time).exp_m1();
            [shear - term.shear * gone, bulk - term.bulk * gone]
        })
    }

    /// The shares of the moduli μ and K under small harmonic strains `e^(iωt)`, ω in rad/s, each with its real part, of storage, and its imaginary part,
    /// of loss: `1 − Σ g_i/(1 + iωτ_i)`. A term with a yield stress is elastic there.
    pub fn harmonic(&self, w: f64) -> [[f64; 2]; 2] {
        let flowing = || self.terms.iter().filter(|term| term.yield_stress.is_none());
        let of = |share: fn(&RelaxationTerm) -> f64| {
            let left = 1.0 - flowing().map(share).sum::<f64>();
            flowing().fold([left, 0.0], |[real, imaginary], term| {
                let x = w * term.time;
                // `1/(1 + ix) = (1 − ix)/(1 + x²)`, and the real part is counted from what is left at rest.
                let part = share(term) * x / (1.0 + x * x);
                [real + part * x, imaginary + part]
            })
        };
        [of(|term| term.shear), of(|term| term.bulk)]
    }

    /// Checks that a body can relax so at large deformation.
    ///
    /// # Errors
    /// Bulk relaxes too, or all of the shear modulus relaxes.
    pub fn check_large(&self) -> Result<()> {
        let [shear, bulk] = self.sums();
        if bulk > 0.0 {
            let expected =
                "0 at large deformation, where the constants of springs relax and the content keeps its stiffness";
            return Err(Error::expected("bulk", expected, bulk).of_kind(ErrorKind::Unsupported));
        }
        if shear > 1.0 - SLACK {
            let expected =
                "shares of shear that add up to less than 1 at large deformation: what is left holds the body together";
            return Err(Error::expected("terms", expected, shear).of_kind(ErrorKind::Unsupported));
        }
        Ok(())
    }
}

/// The material in which all that relaxes has relaxed: `μ (1 − Σ g_i)` beside the whole bulk modulus, with the series of each region.
///
/// # Errors
/// A region does not relax so, the state is one without stress in some direction, or some cell is anisotropic.
pub fn relaxed_material(material: &MaterialMap, series: &[Option<Relaxation>]) -> Result<MaterialMap> {
    series.iter().flatten().try_for_each(Relaxation::check_large)?;
    expect_strains(material)?;
    material.of_isotropic_in(|region, material| match series.get(region).and_then(Option::as_ref) {
        Some(relaxation) => with_moduli(material, 1.0 - relaxation.sums()[0], 1.0),
        None => Ok(material),
    })
}

/// Checks that shear and bulk are apart: no direction is without stress, and every cell is isotropic.
///
/// # Errors
/// They are not; the kind is `Unsupported`.
pub fn expect_strains(material: &MaterialMap) -> Result<()> {
    let isotropic =
        |_| Error::expected("terms", "isotropic materials", "an anisotropic one").of_kind(ErrorKind::Unsupported);
    for own in material.materials().map_err(isotropic)?.values() {
        let found = match own.state() {
            State::Solid | State::PlaneStrain { .. } => continue,
            State::PlaneStress { .. } => "plane stress, in which shear and bulk act together",
            State::Rod { .. } => "rods, in which shear and bulk act together",
        };
        let expected = "a solid or plane strain, or shares of shear and bulk that are alike";
        return Err(Error::expected("terms", expected, found).of_kind(ErrorKind::Unsupported));
    }
    Ok(())
}

/// A solid, or a plane in plane strain, with these multiples of the shear modulus and of the bulk modulus; in any state, if they are alike.
///
/// # Errors
/// There is no such material.
pub fn with_moduli(material: Material, shear: f64, bulk: f64) -> Result<Material> {
    // One factor for both keeps Poisson's ratio to the last bit, and holds in any state.
    if shear == bulk {
        return Material::new(shear * material.young(), material.poisson(), material.state());
    }
    let Moduli { lambda, mu } = material.moduli();
    let thickness = material.thickness();
    // The moduli of a plane contain its thickness, those of a material do not.
    let (k, mu) = ((lambda + mu * 2.0 / 3.0) / thickness * bulk, mu / thickness * shear);
    let (young, poisson) = (9.0 * k * mu / (3.0 * k + mu), (3.0 * k - 2.0 * mu) / (2.0 * (3.0 * k + mu)));
    Material::new(young, poisson, material.state())
}
