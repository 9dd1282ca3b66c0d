//! The models of a body whose stress relaxes: what is left of them, and what they remember.
//!
//! Theory: page *Springs that forget* of the book.

use crate::dynamics::{BranchForm, BranchTerm, FlowMemory, LargeMemory, LinearMemory, Memory, RelaxingPart};
use crate::error::{Error, ErrorKind, Result};
use crate::fit::{ExactEnergy, ShearSprings};
use crate::material::{
    EnergyMap, Hooke, Material, MaterialMap, Moduli, Relaxation, RelaxationTerm, expect_strains, relaxed_material,
    with_moduli,
};
use crate::mesh::Mesh;
use crate::model::{
    Elastic, Entries, LinearElastic, MaterialPoints, Network, check_body, exact_network, finite_elements,
};
use crate::study::fits::{ExactRecipe, NamedFit, Recipe, Reference};
use crate::study::fitting::fit_without_errors;
use faer::sparse::Triplet;
use nalgebra::Complex;

/// The share of the bulk modulus with which a network is made again, to tell its bulk part from its shear part; and one between, that shows
/// whether it is linear in the moduli.
const OTHER: f64 = 0.5;
const BETWEEN: f64 = 0.75;
/// The least share of a modulus with which a network is made to show the same.
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

/// A part of a stiffness.
#[derive(Debug)]
pub struct HarmonicPart {
    pub entries: Entries,
    pub share: Share,
}

impl HarmonicPart {
    fn of((entries, is_shear): (Entries, bool)) -> HarmonicPart {
        HarmonicPart { entries, share: if is_shear { Share::Shear(0) } else { Share::Bulk(0) } }
    }
}

/// A body that relaxes.
#[derive(Debug, Clone)]
pub struct Relaxing {
    /// The series of each region; a linear body has the same in all.
    series: Vec<Option<Relaxation>>,
    material: MaterialMap,
    /// The material and the laws in which all that relaxes has relaxed, at large deformation.
    rest: Option<(MaterialMap, EnergyMap)>,
    /// Whether each point is held in all directions under every load.
    held: Vec<bool>,
}

impl Relaxing {
    /// A body of this material, with these laws at large deformation.
    ///
    /// # Errors
    /// The material or a law does not relax so, or a fit does not serve it. Keys are those of `[material.relaxation]`.
    pub fn new(
        series: Vec<Option<Relaxation>>,
        material: &MaterialMap,
        laws: Option<&EnergyMap>,
        fits: &[NamedFit],
        held: Vec<bool>,
    ) -> Result<Relaxing> {
        let rest = laws.map(|laws| rest_of(&series, material, laws)).transpose()?;
        let mut relaxing = Relaxing { series, material: material.clone(), rest, held };
        let (relaxation, rest) = (relaxing.first().clone(), relaxing.rest.take());
        if let (None, Some(term)) = (&rest, relaxation.first_yield()) {
            let expected = "a material with a law: a branch that yields is not linear";
            let error = Error::expected(format!("terms[{term}].yield"), expected, "none");
            return Err(error.of_kind(ErrorKind::Unsupported));
        }
        if rest.is_none() && !relaxation.is_alike() {
            expect_strains(material)?;
        }
        for fit in fits {
            let (serves, expected) = match (&fit.recipe, rest.is_some()) {
                (Recipe::Exact(recipe), true) => {
                    let energy = recipe.energy.unwrap_or_default();
                    let serves = energy == ExactEnergy::StableNeoHookean && recipe.positive.is_none();
                    (serves, "exact networks of the stable neo-Hookean energy at large deformation")
                }
                (_, true) => (false, "exact networks of the stable neo-Hookean energy at large deformation"),
                (Recipe::Sampled(_) | Recipe::Whole(_), false) => (
                    relaxation.is_alike(),
                    "shares of shear and bulk that are alike for fits to shapes or to the whole object",
                ),
                (Recipe::Stiffness(_) | Recipe::Published(_) | Recipe::Exact(_), false) => (true, ""),
            };
            if !serves || fit.engine.is_some() {
                let expected = if serves { "fits without an engine" } else { expected };
                let found = format!("the fit \"{}\"", fit.name);
                return Err(Error::expected("terms", expected, found).of_kind(ErrorKind::Unsupported));
            }
        }
        Ok(Relaxing { rest, ..relaxing })
    }

    /// The series of the first region that relaxes.
    fn first(&self) -> &Relaxation {
        self.series.iter().flatten().next().expect("a body that relaxes has a series")
    }

    /// Whether all regions relax alike.
    pub fn is_uniform(&self) -> bool {
        self.series.windows(2).all(|pair| pair[0] == pair[1])
    }

    /// The terms, each with its region if regions relax unlike.
    pub fn terms(&self) -> Vec<(Option<usize>, RelaxationTerm)> {
        if self.is_uniform() {
            return self.first().terms().iter().map(|term| (None, *term)).collect();
        }
        let of = |(region, series): (usize, &Option<Relaxation>)| -> Vec<(Option<usize>, RelaxationTerm)> {
            series.iter().flat_map(Relaxation::terms).map(|term| (Some(region), *term)).collect()
        };
        self.series.iter().enumerate().flat_map(of).collect()
    }

    /// The shortest relaxation time, s.
    pub fn shortest(&self) -> f64 {
        self.series.iter().flatten().map(Relaxation::shortest).fold(f64::INFINITY, f64::min)
    }

    /// The laws of the finite elements in which all that relaxes has relaxed, at large deformation.
    pub fn laws(&self) -> Option<&EnergyMap> {
        self.rest.as_ref().map(|(_, laws)| laws)
    }

    /// What the finite elements remember, beside those of [`Relaxing::laws`] at large deformation.
    ///
    /// # Errors
    /// The equations do not fit into memory, or the mesh is a surface or a curve in space.
    pub fn of_body(&self, mesh: &Mesh) -> Result<Memory> {
        if self.rest.is_some() {
            return self.branches(mesh, ShearSprings::Cells, BranchForm::Tensors);
        }
        check_body(mesh)?;
        self.parts(mesh, self.split_body(mesh))
    }

    /// The finite elements in a part of shear and one of bulk; one part where both relax alike.
    fn split_body(&self, mesh: &Mesh) -> Vec<(Entries, bool)> {
        let moduli = self.material.moduli();
        if self.first().is_alike() {
            return vec![(finite_elements(mesh, moduli), true)];
        }
        let split = |hooke: &Hooke, is_shear: bool| {
            // That every cell is isotropic was checked.
            let Moduli { lambda, mu } = hooke.moduli().unwrap_or(Moduli { lambda: 0.0, mu: 0.0 });
            Hooke::Isotropic(match is_shear {
                true => Moduli { lambda: -2.0 / 3.0 * mu, mu },
                false => Moduli { lambda: lambda + 2.0 / 3.0 * mu, mu: 0.0 },
            })
        };
        let part = |is_shear| (finite_elements(mesh, moduli.map(|hooke| split(hooke, is_shear))), is_shear);
        vec![part(true), part(false)]
    }

    /// What a network remembers, and at large deformation the network of what is left when all that relaxes has relaxed, which takes its place.
    ///
    /// # Errors
    /// Its springs are not linear in the moduli, and shear and bulk do not relax alike; or the equations do not fit into memory.
    pub fn of_network(&self, mesh: &Mesh, fit: &NamedFit, network: &Network) -> Result<(Option<Network>, Memory)> {
        if let (Some((material, laws)), Recipe::Exact(recipe)) = (&self.rest, &fit.recipe) {
            let exact = ExactRecipe::resolve_all(recipe, Some(laws))?;
            let rest = exact_network(mesh, material, &exact, &self.held)?;
            return Ok((Some(rest), self.branches(mesh, exact.shear, BranchForm::Edges)?));
        }
        Ok((None, self.parts(mesh, self.split_network(mesh, fit, network)?)?))
    }

    /// A network in a part of shear and one of bulk; one part where both relax alike.
    fn split_network(&self, mesh: &Mesh, fit: &NamedFit, network: &Network) -> Result<Vec<(Entries, bool)>> {
        let own = network.stiffness(&mesh.points);
        if self.first().is_alike() {
            return Ok(vec![(own, true)]);
        }
        let with = |shear: f64, bulk: f64| -> Result<Entries> {
            let material = self.material.of_isotropic(|material: Material| with_moduli(material, shear, bulk))?;
            let reference = Reference { held: &self.held, ..Reference::default() };
            let (made, _) = fit_without_errors(mesh, &material, &reference, fit, &mut |_| {})?;
            Ok(made.network.stiffness(&mesh.points))
        };
        let (other, between) = (with(1.0, OTHER)?, with(1.0, BETWEEN)?);
        // K(s) = K_shear + s K_bulk for the share s of the bulk modulus.
        let weight = (BETWEEN - OTHER) / (1.0 - OTHER);
        let curved = combined(&[(1.0, &between), (-weight, &own), (weight - 1.0, &other)]);
        let slope = 1.0 / (1.0 - OTHER);
        let bulk = combined(&[(slope, &own), (-slope, &other)]);
        let shear = combined(&[(1.0 - slope, &own), (slope, &other)]);
        // Constants that may not be negative change as they do for the material where it has relaxed alone.
        let [left, left_bulk] = self.first().sums().map(|sum| (1.0 - sum).max(LEAST));
        let relaxed = with(left, left_bulk)?;
        let bent = combined(&[(1.0, &relaxed), (-left, &shear), (-left_bulk, &bulk)]);
        let [off, bent, size] = [&curved, &bent, &own].map(|entries| size(mesh, entries));
        if !(off <= LINEAR * size && bent <= LINEAR * size) {
            let expected = format!(
                "shares of shear and bulk that are alike for \"{}\", whose springs are not linear in the moduli",
                fit.name
            );
            return Err(Error::expected("terms", expected, "others").of_kind(ErrorKind::Unsupported));
        }
        Ok(vec![(shear, true), (bulk, false)])
    }

    /// The finite elements in parts that resist harmonic strains.
    ///
    /// # Errors
    /// There is no material with a part of the moduli.
    pub fn harmonic_of_body(&self, mesh: &Mesh) -> Result<Vec<HarmonicPart>> {
        match self.rest {
            Some(_) => self.shear_of_regions(&|material| Ok(finite_elements(mesh, material.moduli()))),
            None => Ok(self.split_body(mesh).into_iter().map(HarmonicPart::of).collect()),
        }
    }

    /// A network in parts that resist harmonic strains.
    ///
    /// # Errors
    /// It fails as [`Relaxing::of_network`] does.
    pub fn harmonic_of_network(&self, mesh: &Mesh, fit: &NamedFit, network: &Network) -> Result<Vec<HarmonicPart>> {
        if let (Some((_, laws)), Recipe::Exact(recipe)) = (&self.rest, &fit.recipe) {
            let exact = ExactRecipe::resolve_all(recipe, Some(laws))?;
            let made =
                |material: &MaterialMap| Ok(exact_network(mesh, material, &exact, &self.held)?.stiffness(&mesh.points));
            return self.shear_of_regions(&made);
        }
        Ok(self.split_network(mesh, fit, network)?.into_iter().map(HarmonicPart::of).collect())
    }

    /// The part of shear of each region that relaxes, and what is left of the stiffness, which is linear in the moduli of each region.
    fn shear_of_regions(&self, made: &dyn Fn(&MaterialMap) -> Result<Entries>) -> Result<Vec<HarmonicPart>> {
        let own = made(&self.material)?;
        let slope = 1.0 / (1.0 - OTHER);
        let relaxes = (0..self.series.len()).filter(|&region| self.series[region].is_some());
        let groups: Vec<usize> = if self.is_uniform() { vec![0] } else { relaxes.collect() };
        let shear = |&region: &usize| -> Result<HarmonicPart> {
            let softer = self.material.of_isotropic_in(|at, material: Material| {
                let is_meant = self.is_uniform() || at == region;
                if is_meant { with_moduli(material, OTHER, 1.0) } else { Ok(material) }
            })?;
            let entries = combined(&[(slope, &own), (-slope, &made(&softer)?)]);
            Ok(HarmonicPart { entries, share: Share::Shear(region) })
        };
        let mut parts: Vec<HarmonicPart> = groups.iter().map(shear).collect::<Result<_>>()?;
        let less = parts.iter().map(|part| (-1.0, &part.entries));
        let entries = combined(&std::iter::once((1.0, &own)).chain(less).collect::<Vec<_>>());
        parts.push(HarmonicPart { entries, share: Share::Elastic });
        Ok(parts)
    }

    /// The complex coefficient of a part under harmonic strains of the frequency ω, rad/s, with Rayleigh's β, s, times the stiffness of the model that
    /// moves: at large deformation that of what is left when all has relaxed.
    pub fn harmonic(&self, share: Share, beta: f64, w: f64) -> Complex<f64> {
        let (region, place) = match share {
            Share::Shear(region) => (region, 0),
            Share::Bulk(region) => (region, 1),
            Share::Elastic => return Complex::new(1.0, w * beta),
        };
        let Some(series) = self.series.get(region).and_then(Option::as_ref) else { return Complex::new(1.0, w * beta) };
        let [real, imaginary] = series.harmonic(w)[place];
        let left = if self.rest.is_some() { 1.0 - series.sums()[place] } else { 1.0 };
        Complex::new(real, imaginary + w * beta * left)
    }

    fn branches(&self, mesh: &Mesh, shear: ShearSprings, form: BranchForm) -> Result<Memory> {
        let points = MaterialPoints::of(mesh, &self.material, shear)?;
        if !self.is_uniform() || self.first().first_yield().is_some() {
            let terms = BranchTerm::of(&self.series);
            return Ok(Memory::Flow(Box::new(FlowMemory::new(points, &mesh.points, &terms)?)));
        }
        Ok(Memory::Large(Box::new(LargeMemory::new(points, form, &mesh.points, self.first())?)))
    }

    /// The memory of parts of a stiffness, each of shear or not.
    fn parts(&self, mesh: &Mesh, parts: Vec<(Entries, bool)>) -> Result<Memory> {
        let terms = self.first().terms();
        let part = |(entries, is_shear): (Entries, bool)| {
            let shares = terms.iter().map(|term| if is_shear { term.shear } else { term.bulk }).collect();
            RelaxingPart::new(&entries, mesh.points.len(), shares)
        };
        let parts: Result<Vec<RelaxingPart>> = parts.into_iter().map(part).collect();
        let times = terms.iter().map(|term| term.time).collect();
        Ok(Memory::Linear(LinearMemory::new(times, parts?, mesh.points.len())?))
    }
}

/// The material and the laws in which all that relaxes has relaxed.
fn rest_of(
    series: &[Option<Relaxation>],
    material: &MaterialMap,
    laws: &EnergyMap,
) -> Result<(MaterialMap, EnergyMap)> {
    let rest = relaxed_material(material, series)?;
    let laws = laws.try_map_in(material.region(), |region, law, state| {
        let Some(relaxation) = series.get(region).and_then(Option::as_ref) else { return Ok(law.clone()) };
        let left = 1.0 - relaxation.sums()[0];
        if law.has_fibres() || ExactEnergy::of_law(law) != Some(ExactEnergy::StableNeoHookean) {
            let expected = "the law \"stable-neo-hookean\" in a material that relaxes";
            return Err(
                Error::expected("terms", expected, format!("\"{}\"", law.name())).of_kind(ErrorKind::Unsupported)
            );
        }
        law.of(with_moduli(Material::new(law.young(), law.poisson(), state)?, left, 1.0)?, &[], None)
    })?;
    Ok((rest, laws))
}

/// A sum of multiples of matrices.
fn combined(parts: &[(f64, &Entries)]) -> Entries {
    let scaled = |(factor, entries): &(f64, &Entries)| -> Entries {
        entries.iter().map(|e| Triplet::new(e.row, e.col, factor * e.val)).collect()
    };
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
