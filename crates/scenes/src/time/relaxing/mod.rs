//! The models of a body whose stress relaxes: what is left of them, and what they remember.
//!
//! Theory: page *Springs that forget* of the book.

mod parts;

pub use parts::{RelaxingStiffness, Share};

use crate::dynamics::{BranchForm, BranchTerm, FlowMemory, LargeMemory, LinearMemory, Memory, RelaxingPart};
use crate::error::{Error, ErrorKind, Result};
use crate::fit::{ExactEnergy, ShearSprings};
use crate::fits::{ExactRecipe, NamedFit, Recipe};
use crate::material::{EnergyMap, Material, MaterialMap, Relaxation, RelaxationTerm, relaxed_material, with_moduli};
use crate::mesh::Mesh;
use crate::model::{MaterialPoints, Network, check_body, exact_network, finite_elements};
use crate::order::distinct;
use nalgebra::Complex;
use parts::RelaxingBody;

/// A body that relaxes.
#[derive(Debug, Clone)]
pub struct Relaxing {
    body: RelaxingBody,
    /// The material and the laws in which all that relaxes has relaxed, at large deformation.
    rest: Option<(MaterialMap, EnergyMap)>,
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
        let body = RelaxingBody { series, material: material.clone(), held, is_large: rest.is_some() };
        if rest.is_none() {
            body.expect_linear_terms()?;
        }
        for fit in fits {
            let (serves, expected) = match (&fit.recipe, rest.is_some()) {
                (Recipe::Exact(recipe), true) => {
                    let energy = recipe.energy.unwrap_or_default();
                    let serves = energy == ExactEnergy::StableNeoHookean && recipe.positive.is_none();
                    (serves, "exact networks of the stable neo-Hookean energy at large deformation")
                }
                (_, true) => (false, "exact networks of the stable neo-Hookean energy at large deformation"),
                // What a search finds need not be linear in the moduli. A factor that all moduli share is one of the
                // network as well.
                (Recipe::Sampled(_) | Recipe::Whole(_), false) => (
                    body.is_uniform() && body.first().is_alike(),
                    "one series of the whole body, whose shares of shear and bulk are alike, for fits to shapes or to the whole object",
                ),
                (Recipe::Stiffness(_) | Recipe::Published(_) | Recipe::Exact(_), false) => (true, ""),
            };
            if !serves || fit.engine.is_some() {
                let expected = if serves { "fits without an engine" } else { expected };
                let found = format!("the fit \"{}\"", fit.name);
                return Err(Error::expected("terms", expected, found).of_kind(ErrorKind::Unsupported));
            }
        }
        Ok(Relaxing { body, rest })
    }

    /// Whether all regions relax alike.
    pub fn is_uniform(&self) -> bool {
        self.body.is_uniform()
    }

    /// The terms, each with its region if regions relax unlike.
    pub fn terms(&self) -> Vec<(Option<usize>, RelaxationTerm)> {
        if self.body.is_uniform() {
            return self.body.first().terms().iter().map(|term| (None, *term)).collect();
        }
        let of = |(region, series): (usize, &Option<Relaxation>)| -> Vec<(Option<usize>, RelaxationTerm)> {
            series.iter().flat_map(Relaxation::terms).map(|term| (Some(region), *term)).collect()
        };
        self.body.series.iter().enumerate().flat_map(of).collect()
    }

    /// The shortest relaxation time, s.
    pub fn shortest(&self) -> f64 {
        self.body.series.iter().flatten().map(Relaxation::shortest).fold(f64::INFINITY, f64::min)
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
        self.remembered(mesh, self.body.split_body(mesh)?)
    }

    /// What a network remembers, and at large deformation the network of what is left when all that relaxes has relaxed, which takes its place.
    ///
    /// # Errors
    /// Its springs are not linear in the moduli, and shear and bulk do not relax alike; or the equations do not fit into memory.
    pub fn of_network(&self, mesh: &Mesh, fit: &NamedFit, network: &Network) -> Result<(Option<Network>, Memory)> {
        if let (Some((material, laws)), Recipe::Exact(recipe)) = (&self.rest, &fit.recipe) {
            let exact = ExactRecipe::resolve_all(recipe, Some(laws))?;
            let rest = exact_network(mesh, material, &exact, &self.body.held)?;
            return Ok((Some(rest), self.branches(mesh, exact.shear, BranchForm::Edges)?));
        }
        Ok((None, self.remembered(mesh, self.body.split_network(mesh, fit, network)?)?))
    }

    /// The finite elements in parts that resist harmonic strains.
    ///
    /// # Errors
    /// There is no material with a part of the moduli.
    pub fn harmonic_of_body(&self, mesh: &Mesh) -> Result<Vec<RelaxingStiffness>> {
        match self.rest {
            Some(_) => self.body.split(&finite_elements(mesh, self.body.material.moduli()), &|material| {
                Ok(finite_elements(mesh, material.moduli()))
            }),
            None => self.body.split_body(mesh),
        }
    }

    /// A network in parts that resist harmonic strains.
    ///
    /// # Errors
    /// It fails as [`Relaxing::of_network`] does.
    pub fn harmonic_of_network(
        &self,
        mesh: &Mesh,
        fit: &NamedFit,
        network: &Network,
    ) -> Result<Vec<RelaxingStiffness>> {
        if let (Some((_, laws)), Recipe::Exact(recipe)) = (&self.rest, &fit.recipe) {
            let exact = ExactRecipe::resolve_all(recipe, Some(laws))?;
            let made = |material: &MaterialMap| {
                Ok(exact_network(mesh, material, &exact, &self.body.held)?.stiffness(&mesh.points))
            };
            return self.body.split(&made(&self.body.material)?, &made);
        }
        self.body.split_network(mesh, fit, network)
    }

    /// The complex coefficient of a part under harmonic strains, see [`RelaxingBody::harmonic`].
    pub fn harmonic(&self, share: Share, beta: f64, w: f64) -> Complex<f64> {
        self.body.harmonic(share, beta, w)
    }

    fn branches(&self, mesh: &Mesh, shear: ShearSprings, form: BranchForm) -> Result<Memory> {
        let points = MaterialPoints::of(mesh, &self.body.material, shear)?;
        if !self.body.is_uniform() || self.body.first().first_yield().is_some() {
            let terms = BranchTerm::of(&self.body.series);
            return Ok(Memory::Flow(Box::new(FlowMemory::new(points, &mesh.points, &terms)?)));
        }
        Ok(Memory::Large(Box::new(LargeMemory::new(points, form, &mesh.points, self.body.first())?)))
    }

    /// What a linear model remembers: one state of the body for each relaxation time, whatever the regions that have it.
    fn remembered(&self, mesh: &Mesh, parts: Vec<RelaxingStiffness>) -> Result<Memory> {
        // Terms of equal times share one history. Equal times of a scene have the same digits, and the same bits.
        let times = distinct(self.body.series.iter().flatten().flat_map(Relaxation::terms).map(|term| term.time));
        let relaxing = |RelaxingStiffness { entries, share }| {
            let (region, place) = share.place()?;
            let terms = self.body.series[region].as_ref()?.terms();
            let of_time = |time: &f64| {
                terms.iter().filter(|term| term.time == *time).map(|term| [term.shear, term.bulk][place]).sum()
            };
            Some(RelaxingPart::new(&entries, mesh.points.len(), times.iter().map(of_time).collect()))
        };
        let parts: Result<Vec<RelaxingPart>> = parts.into_iter().filter_map(relaxing).collect();
        let (parts, dofs) = (parts?, mesh.points.len());
        Ok(Memory::Linear(LinearMemory::new(times, parts, dofs)?))
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
