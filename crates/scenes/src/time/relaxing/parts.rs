//! The parts of a stiffness that relax unlike: of shear and of bulk, in each region.
//!
//! Theory: page *Springs that forget* of the book.

use crate::error::{Error, ErrorKind, Result};
use crate::fits::{NamedFit, Reference};
use crate::fitting::fit_without_errors;
use crate::material::{Hooke, Material, MaterialMap, Moduli, Relaxation, expect_strains, with_moduli};
use crate::mesh::Mesh;
use crate::model::{Elastic, Entries, LinearElastic, Network, finite_elements};
use faer::sparse::Triplet;
use nalgebra::Complex;

/// The share of the bulk modulus with which a network is made again, to tell its bulk part from its shear part; and one between, that shows
/// whether it is linear in the moduli.
// Both are exact in binary, and far enough apart that differences keep all but a bit or two.
const OTHER: f64 = 0.5;
const BETWEEN: f64 = 0.75;
/// The least share of a modulus with which a network is made to show the same.
// Without any shear modulus there is no network. With this share of it a material of Poisson's ratio 0.3 has 0.495, which fits still
// take.
const LEAST: f64 = 0.02;
/// The difference that rounding may leave in a network that is linear in the moduli, relative to its forces.
const LINEAR: f64 = 1e-9;

/// What a part of a stiffness belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Share {
    /// The shear modulus of this region, or of all if they relax alike.
    Shear(usize),
    /// The bulk modulus of this region, or of all.
    Bulk(usize),
    /// What does not relax.
    Elastic,
}

impl Share {
    /// The region, and the place of the modulus among shear and bulk; `None` of what does not relax.
    pub fn place(self) -> Option<(usize, usize)> {
        match self {
            Share::Shear(region) => Some((region, 0)),
            Share::Bulk(region) => Some((region, 1)),
            Share::Elastic => None,
        }
    }
}

/// A part of a stiffness.
#[derive(Debug)]
pub struct RelaxingStiffness {
    pub entries: Entries,
    pub share: Share,
}

/// The stiffness of a model of this material.
pub type Made<'a> = dyn Fn(&MaterialMap) -> Result<Entries> + 'a;

/// A body whose regions relax, each by its series.
#[derive(Debug, Clone)]
pub struct RelaxingBody {
    /// The series of each region.
    pub series: Vec<Option<Relaxation>>,
    pub material: MaterialMap,
    /// Whether each point is held in all directions under every load.
    pub held: Vec<bool>,
    /// Whether the body deforms by a law, so that bulk does not relax.
    pub is_large: bool,
}

impl RelaxingBody {
    /// The series of the first region that relaxes.
    pub fn first(&self) -> &Relaxation {
        self.series.iter().flatten().next().expect("a body that relaxes has a series")
    }

    /// Whether all regions relax alike.
    pub fn is_uniform(&self) -> bool {
        self.series.windows(2).all(|pair| pair[0] == pair[1])
    }

    /// Checks that terms of a body without a law are linear, and that its stiffness can be divided into the parts that relax unlike.
    pub fn expect_linear_terms(&self) -> Result<()> {
        for series in self.series.iter().flatten() {
            if let Some(term) = series.first_yield() {
                let expected = "a material with a law: a branch that yields is not linear";
                let error = Error::expected(format!("terms[{term}].yield"), expected, "none");
                return Err(error.of_kind(ErrorKind::Unsupported));
            }
            if !series.is_alike() {
                expect_strains(&self.material)?;
            }
        }
        if !self.is_uniform() && self.material.materials().is_err() {
            let expected = "isotropic materials where regions relax unlike";
            return Err(Error::expected("terms", expected, "an anisotropic one").of_kind(ErrorKind::Unsupported));
        }
        Ok(())
    }

    /// The regions that relax, each of which is a part of a stiffness; the first alone, which then stands for all, where all relax alike.
    fn parts_of_body(&self) -> Vec<usize> {
        let relaxes = |&region: &usize| self.series[region].is_some();
        (0..self.series.len()).filter(relaxes).take(if self.is_uniform() { 1 } else { usize::MAX }).collect()
    }

    /// Whether shear and bulk of a part of the body relax alike.
    fn is_alike(&self, part: usize) -> bool {
        self.series[part].as_ref().is_some_and(Relaxation::is_alike)
    }

    /// Whether the cells of a region belong to this part of the body.
    fn is_part(&self, part: usize, region: usize) -> bool {
        self.is_uniform() || part == region
    }

    /// The finite elements in parts of shear and of bulk; one part for both where they relax alike.
    pub fn split_body(&self, mesh: &Mesh) -> Result<Vec<RelaxingStiffness>> {
        let moduli = self.material.moduli();
        let of_part = |part: usize, share: Share| {
            let own = |hooke: &Hooke, region: usize| {
                if !self.is_part(part, region) {
                    return Hooke::Isotropic(Moduli { lambda: 0.0, mu: 0.0 });
                }
                // Shares that are alike scale the whole stiffness, so that the material may also be anisotropic.
                if self.is_alike(part) {
                    return hooke.clone();
                }
                // That every cell is isotropic was checked.
                let Moduli { lambda, mu } = hooke.moduli().unwrap_or(Moduli { lambda: 0.0, mu: 0.0 });
                Hooke::Isotropic(match share {
                    // The energy of a change of volume is K/2 tr²: λ alone with the value of K. The rest of the energy
                    // is that of the deviator, for which λ is −2/3 μ.
                    Share::Bulk(_) => Moduli { lambda: lambda + 2.0 / 3.0 * mu, mu: 0.0 },
                    Share::Shear(_) | Share::Elastic => Moduli { lambda: -2.0 / 3.0 * mu, mu },
                })
            };
            let moduli = moduli.try_zip(self.material.region(), |hooke, region| Ok(own(hooke, *region)))?;
            Ok(RelaxingStiffness { entries: finite_elements(mesh, moduli), share })
        };
        let shares =
            self.parts_of_body().into_iter().flat_map(|part| self.shares(part).map(move |share| (part, share)));
        let parts = shares.map(|(part, share)| of_part(part, share)).collect::<Result<_>>()?;
        Ok(self.with_rest(&|| finite_elements(mesh, self.material.moduli()), parts))
    }

    /// The parts of shear and of bulk of a part of the body, one where both relax alike; at large deformation bulk does not relax.
    fn shares(&self, part: usize) -> impl Iterator<Item = Share> + use<> {
        let is_one = self.is_large || self.is_alike(part);
        [Share::Shear(part), Share::Bulk(part)].into_iter().take(if is_one { 1 } else { 2 })
    }

    /// The parts and what does not relax, if there is such a part.
    fn with_rest(&self, own: &dyn Fn() -> Entries, mut parts: Vec<RelaxingStiffness>) -> Vec<RelaxingStiffness> {
        if self.is_large || self.series.iter().any(Option::is_none) {
            let own = own();
            let less = parts.iter().map(|part| (-1.0, &part.entries));
            let entries = combined(&std::iter::once((1.0, &own)).chain(less).collect::<Vec<_>>());
            parts.push(RelaxingStiffness { entries, share: Share::Elastic });
        }
        parts
    }

    /// A network in parts of shear and of bulk; one part for both where they relax alike.
    pub fn split_network(&self, mesh: &Mesh, fit: &NamedFit, network: &Network) -> Result<Vec<RelaxingStiffness>> {
        let own = network.stiffness(&mesh.points);
        if self.is_uniform() && self.first().is_alike() {
            return Ok(vec![RelaxingStiffness { entries: own, share: Share::Shear(0) }]);
        }
        let made = |material: &MaterialMap| -> Result<Entries> {
            let reference = Reference { held: &self.held, ..Reference::default() };
            let (made, _) = fit_without_errors(mesh, material, &reference, fit, &mut |_| {})?;
            Ok(made.network.stiffness(&mesh.points))
        };
        let parts = self.split(&own, &made)?;
        let linear = self.is_linear(mesh, (&own, &parts), &made)?;
        if !linear {
            let expected = format!(
                "one series of the whole body, whose shares of shear and bulk are alike, for \"{}\", whose springs are not linear in the moduli",
                fit.name
            );
            return Err(Error::expected("terms", expected, "others").of_kind(ErrorKind::Unsupported));
        }
        Ok(parts)
    }

    /// A stiffness that is linear in the moduli of each part of the body, `K(s) = K(1) − (1 − s) K_part` for the share s of a modulus.
    pub fn split(&self, own: &Entries, made: &Made) -> Result<Vec<RelaxingStiffness>> {
        // From `K(s) = K(1) − (1 − s) K_part` follows `K_part = (K(1) − K(s))/(1 − s)`.
        let slope = 1.0 / (1.0 - OTHER);
        let mut parts = Vec::new();
        for part in self.parts_of_body() {
            for share in self.shares(part) {
                let other = made(&self.softened(share, OTHER)?)?;
                let entries = combined(&[(slope, own), (-slope, &other)]);
                parts.push(RelaxingStiffness { entries, share });
            }
        }
        Ok(self.with_rest(&|| own.clone(), parts))
    }

    /// The material of which a share of one modulus is left, in the part of the body that has it; or of both, where both relax alike.
    fn softened(&self, share: Share, left: f64) -> Result<MaterialMap> {
        let (part, moduli) = match share {
            Share::Shear(part) if self.is_alike(part) && !self.is_large => (part, [left, left]),
            Share::Shear(part) => (part, [left, 1.0]),
            Share::Bulk(part) => (part, [1.0, left]),
            Share::Elastic => return Ok(self.material.clone()),
        };
        self.of_moduli(|region| if self.is_part(part, region) { moduli } else { [1.0, 1.0] })
    }

    /// The material with these multiples of the shear modulus and of the bulk modulus in each region.
    fn of_moduli(&self, of: impl Fn(usize) -> [f64; 2]) -> Result<MaterialMap> {
        self.material.of_isotropic_in(|region, material: Material| {
            let [shear, bulk] = of(region);
            with_moduli(material, shear, bulk)
        })
    }

    /// Whether a stiffness is the sum of its parts at other moduli too: with one modulus changed, and where all has relaxed. Constants that may not be
    /// negative can be linear in each modulus alone.
    fn is_linear(&self, mesh: &Mesh, (own, parts): (&Entries, &[RelaxingStiffness]), made: &Made) -> Result<bool> {
        let limit = LINEAR * size(mesh, own);
        let mut relaxed: Vec<(f64, &Entries)> = vec![(1.0, own)];
        for part in parts {
            let Some(left) = self.left(part.share) else { continue };
            relaxed.push((left - 1.0, &part.entries));
            let between = made(&self.softened(part.share, BETWEEN)?)?;
            let curved = combined(&[(1.0, own), (BETWEEN - 1.0, &part.entries), (-1.0, &between)]);
            // The comparison is negated, so that NaN is not linear.
            if !(size(mesh, &curved) <= limit) {
                return Ok(false);
            }
        }
        let material = self.of_moduli(|region| {
            [Share::Shear(region), Share::Bulk(region)].map(|share| self.left(share).unwrap_or(1.0))
        })?;
        let made = made(&material)?;
        relaxed.push((-1.0, &made));
        Ok(size(mesh, &combined(&relaxed)) <= limit)
    }

    /// The share of a modulus that is left when all has relaxed, at least [`LEAST`]; `None` of what does not relax.
    fn left(&self, share: Share) -> Option<f64> {
        let (region, place) = share.place()?;
        let sums = self.series.get(region)?.as_ref()?.sums();
        Some((1.0 - sums[place]).max(LEAST))
    }

    /// The complex coefficient of a part under harmonic strains of the frequency ω, rad/s, with Rayleigh's β, s, times the stiffness of the model that
    /// moves: at large deformation that of what is left when all has relaxed.
    pub fn harmonic(&self, share: Share, beta: f64, w: f64) -> Complex<f64> {
        let Some((region, place)) = share.place() else { return Complex::new(1.0, w * beta) };
        let Some(series) = self.series.get(region).and_then(Option::as_ref) else { return Complex::new(1.0, w * beta) };
        let [real, imaginary] = series.harmonic(w)[place];
        let left = if self.is_large { 1.0 - series.sums()[place] } else { 1.0 };
        Complex::new(real, imaginary + w * beta * left)
    }
}

/// A sum of multiples of matrices.
fn combined(parts: &[(f64, &Entries)]) -> Entries {
    let scaled = |(factor, entries): &(f64, &Entries)| -> Entries {
        entries.iter().map(|e| Triplet::new(e.row, e.col, factor * e.val)).collect()
    };
    // Entries of one place stay apart, because whoever assembles them adds them up.
    parts.iter().flat_map(scaled).collect()
}

/// The size of the forces at displacements that are as large at each point, in no direction that a body prefers.
fn size(mesh: &Mesh, stiffness: &Entries) -> f64 {
    let still = vec![0.0; mesh.points.len()];
    let shape: Vec<f64> = (0..still.len()).map(|dof| (1.0 + 7.0 * (dof as f64).sqrt()).sin()).collect();
    let mut force = vec![0.0; still.len()];
    LinearElastic { points: &still, stiffness: stiffness.clone() }.forces(&shape, &mut force);
    force.iter().map(|f| f * f).sum::<f64>().sqrt()
}
