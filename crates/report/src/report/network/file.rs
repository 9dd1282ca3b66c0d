//! A network and all that belongs to it, from which its files are made.

use crate::dynamics::{Dampers, largest_square, largest_square_of_blocks};
use crate::element::SpringKind;
use crate::material::{CellMap, RelaxationTerm};
use crate::mesh::Mesh;
use crate::model::{Elastic, Network, Support, cell_places};
use crate::network::{
    DriveRecord, FORMAT, FitSummaryRecord, HeldRecord, ListedRecord, Lists, LoadErrorsRecord, MaterialDataRecord,
    NETWORK_VERSION, NetworkDampingRecord, NetworkFacts, NetworkRecord, NodalForceRecord, NodalLoadRecord, PlaneRecord,
    ProvenanceRecord, RelaxationRecord, TimedForceRecord, TimedPullRecord,
};
use crate::number::finite;
use crate::report::fit_record::FitRecord;
use crate::report::notes::notes;
use crate::study::{BodyLoad, DampingRecipe, FitOutcome, LoadOutcome, MotionOutcome, Outcome};
use crate::text::printable;
use std::collections::BTreeMap;

/// A network on the points of its mesh, and the study that it comes from, if there is one.
#[derive(Debug, Clone, Copy)]
pub struct NetworkFile<'a> {
    /// The mesh of the network.
    pub mesh: &'a Mesh,
    /// The network.
    pub network: &'a Network,
    /// The run and the fit from which the network comes.
    pub study: Option<(&'a Outcome, &'a FitOutcome)>,
    /// Masses of its points where there is no study, `[points]`, kg.
    pub own_masses: Option<&'a [f64]>,
    /// What is known of it where there is no study.
    pub own_facts: Option<&'a NetworkFacts>,
}

impl<'a> NetworkFile<'a> {
    /// The network of a fit of `outcome`.
    pub fn of(outcome: &'a Outcome, fit: &'a FitOutcome) -> NetworkFile<'a> {
        NetworkFile {
            mesh: &outcome.mesh,
            network: &fit.network,
            study: Some((outcome, fit)),
            own_masses: None,
            own_facts: None,
        }
    }

    /// A network without masses, supports and loads.
    pub fn bare(mesh: &'a Mesh, network: &'a Network) -> NetworkFile<'a> {
        NetworkFile::with_masses(mesh, network, None)
    }

    /// A network with these masses, `[points]`, kg, without supports and loads.
    pub fn with_masses(mesh: &'a Mesh, network: &'a Network, masses: Option<&'a [f64]>) -> NetworkFile<'a> {
        NetworkFile { mesh, network, study: None, own_masses: masses, own_facts: None }
    }

    /// Returns the same network with these facts.
    pub fn knowing(self, facts: &'a NetworkFacts) -> NetworkFile<'a> {
        NetworkFile { own_facts: Some(facts), ..self }
    }

    /// What is known beside points and springs.
    pub fn facts(&self) -> NetworkFacts {
        let Some((outcome, fit)) = self.study else { return self.own_facts.cloned().unwrap_or_default() };
        let motion = outcome.motion.as_ref();
        // The gravity of the motion goes first, then that of the first load that has one.
        let of_motion = motion.map(|motion| &motion.recipe.gravity).filter(|gravity| !gravity.is_empty());
        let of_loads = || outcome.loads.iter().find_map(|load| load.gravity.as_ref());
        let d = self.mesh.dimension;
        NetworkFacts {
            material: material(outcome),
            plane: plane(outcome),
            engine: fit.fit.engine,
            held: held(&self.support(), d),
            loads: outcome.loads.iter().map(|load| nodal_load(load, d)).collect(),
            gravity: of_motion.or_else(of_loads).cloned(),
            damping: damping(motion),
            motion: motion.map(drive),
            dampers: self.dampers(),
        }
    }

    /// The masses that were fitted, or those of the motion, or of the density, `[points]`, kg.
    pub fn masses(&self) -> Option<&'a [f64]> {
        let Some((outcome, fit)) = self.study else { return self.own_masses };
        if let Some(fitted) = fit.masses() {
            return Some(fitted);
        }
        let of_motion = outcome.motion.as_ref().map(|motion| &motion.masses[..]);
        // Without inertia a motion needs none.
        of_motion.filter(|masses| masses.iter().any(|mass| *mass != 0.0)).or(outcome.masses.as_deref())
    }

    pub(super) fn support(&self) -> Support {
        let given = self.study.and_then(|(outcome, _)| outcome.support.clone());
        let mut support = given.unwrap_or_else(|| Support::free(self.mesh));
        let d = self.mesh.dimension;
        for held in self.own_facts.iter().flat_map(|facts| &facts.held) {
            support.prescribed[held.point * d..][..d].copy_from_slice(&held.displacement);
        }
        support
    }

    /// What a reader must know of the fit.
    pub fn notes(&self) -> Vec<String> {
        self.study.map_or(Vec::new(), |(outcome, _)| notes(outcome))
    }

    /// The record with all its springs.
    pub fn record(&self) -> NetworkRecord {
        self.listed().whole()
    }

    /// The record whose cells and springs are made while they are written.
    pub(super) fn listed(&self) -> ListedRecord<'a> {
        let springs = self.study.map_or(&[][..], |(_, fit)| &fit.springs);
        let facts = self.facts();
        let lists = Lists::of(self.mesh, self.network, springs, facts.dampers);
        let mesh = self.mesh;
        let d = mesh.dimension;
        NetworkRecord {
            format: FORMAT.into(),
            version: NETWORK_VERSION,
            provenance: self.provenance(facts.material),
            dimension: d,
            units: units(),
            points: mesh.points.chunks_exact(d).map(<[f64]>::to_vec).collect(),
            numbering: mesh.numbering.as_ref().map(|numbering| numbering.title().into()),
            nodes: mesh.numbering.as_ref().map(|numbering| numbering.nodes.clone()),
            masses: self.masses().map(<[f64]>::to_vec),
            cells: lists.cells,
            surface: mesh.surface_triangles(),
            held: facts.held,
            loads: facts.loads,
            gravity: facts.gravity,
            damping: facts.damping,
            motion: facts.motion,
            largest_step: self.longest_step(),
            engine: facts.engine,
            plane: facts.plane,
            groups: lists.groups,
            measures: lists.measures,
            notes: self.notes(),
            springs: lists.springs,
        }
    }

    fn provenance(&self, material: Option<MaterialDataRecord>) -> ProvenanceRecord {
        let outcome = self.study.map(|(outcome, _)| outcome);
        // Paths, and what was typed, need not be printable lines; what is read again is.
        let line = |text: &str| printable(text).into_owned();
        let fit = self.study.map(|(outcome, fit)| summary(&FitRecord::of(outcome, fit)));
        ProvenanceRecord {
            program: concat!("springfit ", env!("CARGO_PKG_VERSION")).into(),
            command: outcome.and_then(|outcome| outcome.command.as_deref().map(line)),
            scene: outcome.map(|outcome| line(&outcome.scene)).filter(|scene| !scene.is_empty()),
            settings: outcome.map_or(Vec::new(), |outcome| outcome.settings.iter().map(|text| line(text)).collect()),
            mesh: outcome.map(|outcome| line(&outcome.source)).filter(|source| !source.is_empty()),
            mesh_checksum: format!("{:08x}", self.mesh.checksum()),
            material,
            fit,
        }
    }

    /// The longest step of symplectic Euler with the support of the run, s; `None` where nothing moves or resists.
    pub fn longest_step(&self) -> Option<f64> {
        self.largest_step(&self.support())
    }

    /// `2/ω` of the fastest motion at rest, s; `None` where a point that moves has no mass, or nothing resists.
    pub fn largest_step(&self, support: &Support) -> Option<f64> {
        let masses = self.masses()?;
        let d = self.mesh.dimension;
        let held: Vec<bool> = (0..self.mesh.points.len()).map(|dof| support.is_fixed(dof)).collect();
        // A point without mass that moves has an infinite frequency, and no explicit step.
        let is_sound = held.iter().enumerate().all(|(dof, held)| *held || masses[dof / d] > 0.0);
        if !is_sound {
            return None;
        }
        let masses: Vec<f64> = masses.iter().flat_map(|m| std::iter::repeat_n(*m, d)).collect();
        let square = match self.network.blocks(&self.mesh.points) {
            Some(blocks) => largest_square_of_blocks(&blocks, &masses, &held),
            None => {
                self.network.check_size().ok()?;
                let entries = self.network.stiffness(&self.mesh.points);
                largest_square(entries.iter().map(|e| (e.row, e.col, e.val)), &masses, &held)
            }
        };
        Some(2.0 / square.sqrt()).filter(|step| step.is_finite())
    }

    /// The coefficients of the dampers, `[springs]`.
    fn dampers(&self) -> Option<Vec<f64>> {
        let motion = self.study.and_then(|(outcome, _)| outcome.motion.as_ref())?;
        let DampingRecipe::Ratio(ratio) = motion.recipe.damping else { return None };
        let (masses, support) = (self.masses()?, &motion.support);
        Dampers::coefficients_of_ratio(self.network, &self.mesh.points, masses, support, ratio).ok()
    }
}

/// The material of a body that has the same everywhere.
fn material(outcome: &Outcome) -> Option<MaterialDataRecord> {
    let material = outcome.material.uniform()?;
    Some(MaterialDataRecord {
        young: material.young(),
        poisson: material.poisson(),
        state: material.state().words().into(),
        thickness: material.thickness(),
        density: outcome.material.density().and_then(CellMap::uniform).copied(),
        law: outcome.law.clone(),
    })
}

/// The state of a plane body or a surface, with its mean thickness `Σ A_e t_e/Σ A_e`.
fn plane(outcome: &Outcome) -> Option<PlaneRecord> {
    let state = outcome.material.state().plane()?;
    let thicknesses = outcome.material.thicknesses();
    if let Some(&thickness) = thicknesses.uniform() {
        return Some(PlaneRecord { state, thickness, varies: false });
    }
    let (mut area, mut volume) = (0.0, 0.0);
    for (block, cells) in cell_places(&outcome.mesh).iter().enumerate() {
        for (cell, (content, _)) in cells.iter().enumerate() {
            area += content;
            volume += content * thicknesses.at(block, cell);
        }
    }
    Some(PlaneRecord { state, thickness: volume / area, varies: true })
}

/// Names the units of lengths, masses, times, forces and the constants of each kind of springs.
fn units() -> BTreeMap<String, String> {
    let kinds = SpringKind::all().map(|kind| (format!("{} spring", kind.name()), kind.properties().unit.to_string()));
    let plain = [("length", "m"), ("mass", "kg"), ("time", "s"), ("force", "N")];
    plain.map(|(name, unit)| (name.to_string(), unit.to_string())).into_iter().chain(kinds).collect()
}

fn held(support: &Support, d: usize) -> Vec<HeldRecord> {
    let points = support.prescribed.chunks_exact(d).enumerate();
    let held = points.filter(|(_, given)| given.iter().any(Option::is_some));
    held.map(|(point, given)| HeldRecord { point, displacement: given.to_vec() }).collect()
}

fn damping(motion: Option<&MotionOutcome>) -> NetworkDampingRecord {
    let (mass, stiffness, ratio) = match motion.map(|motion| motion.recipe.damping) {
        None => (0.0, 0.0, 0.0),
        Some(DampingRecipe::Rayleigh([mass, stiffness])) => (mass, stiffness, 0.0),
        Some(DampingRecipe::Ratio(ratio)) => (0.0, 0.0, ratio),
    };
    NetworkDampingRecord { mass, stiffness, ratio }
}

fn nodal_load(load: &BodyLoad, d: usize) -> NodalLoadRecord {
    let forces = load.forces.chunks_exact(d).enumerate();
    let acting = forces.filter(|(_, force)| force.iter().any(|f| *f != 0.0));
    NodalLoadRecord {
        name: load.name.clone(),
        forces: acting.map(|(point, force)| NodalForceRecord { point, force: force.to_vec() }).collect(),
        gravity: load.gravity.clone(),
        is_gravity: load.is_gravity,
        held: held(&load.support, d),
    }
}

fn drive(motion: &MotionOutcome) -> DriveRecord {
    let recipe = &motion.recipe;
    DriveRecord {
        duration: recipe.duration,
        step: recipe.options.step,
        every: recipe.every,
        steps: recipe.steps,
        integrator: recipe.options.method().into(),
        linear: recipe.options.linear,
        watched: motion.watched.clone(),
        forces: motion
            .forces
            .iter()
            .map(|force| TimedForceRecord {
                axis: force.axis,
                force: force.curve.clone(),
                points: force.shares.iter().map(|(point, _)| *point).collect(),
                shares: force.shares.iter().map(|(_, share)| *share).collect(),
            })
            .collect(),
        pulls: motion
            .pulls
            .iter()
            .map(|pull| TimedPullRecord {
                axis: pull.axis,
                displacement: pull.curve.clone(),
                points: pull.points.clone(),
            })
            .collect(),
        relaxation: motion
            .relaxation
            .iter()
            .map(|&(region, RelaxationTerm { shear, bulk, time, yield_stress })| RelaxationRecord {
                region,
                shear,
                bulk,
                time,
                yield_stress,
            })
            .collect(),
    }
}

fn summary(fit: &FitRecord) -> FitSummaryRecord {
    let settings = serde_json::to_value(&fit.kind).ok();
    let settings: BTreeMap<String, serde_json::Value> =
        settings.and_then(|value| Some(value.as_object()?.clone())).into_iter().flatten().collect();
    let objective = settings.get("objective").and_then(|name| name.as_str()).unwrap_or_default();
    let frobenius = &fit.relative_frobenius;
    let load_errors = |load: &LoadOutcome| LoadErrorsRecord {
        name: load.name.clone(),
        e_rms: load.error.map(|e| e.rms),
        e_max: load.error.map(|e| e.max),
        e_tip: load.error.map(|e| e.tip),
        e_energy: load.work_error,
    };
    FitSummaryRecord {
        name: fit.name.clone(),
        objective: objective.into(),
        settings,
        status: fit.status.clone(),
        negative_springs: fit.negative_springs,
        relative_frobenius: finite(frobenius.mean).zip(finite(frobenius.max)).map(|(mean, max)| [mean, max]),
        relative_tensor: finite(fit.as_material.distance),
        loads: fit.loads.iter().map(load_errors).collect(),
    }
}
