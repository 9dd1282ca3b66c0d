//! A network and all that belongs to it, from which its files are made.

use super::measures::Measures;
use super::origins::Origins;
use super::record::{
    CellBlockRecord, DriveRecord, FORMAT, FitSummaryRecord, HeldRecord, MaterialDataRecord, NETWORK_VERSION,
    NetworkDampingRecord, NetworkRecord, NodalForceRecord, NodalLoadRecord, ProvenanceRecord, SpringRecord,
    TimedForceRecord, TimedPullRecord,
};
use crate::dynamics::{Dampers, largest_square, largest_square_of_blocks};
use crate::element::SpringKind;
use crate::material::{CellMap, State};
use crate::mesh::{CellBlock, Mesh};
use crate::model::{Elastic, MeasureSpring, Network, SpringLaw, Support};
use crate::report::fit_record::FitRecord;
use crate::report::table::notes;
use crate::study::{BodyLoad, DampingRecipe, FitOutcome, MotionOutcome, Outcome};
use serde::{Serialize, Serializer};
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
}

/// The springs of a network; their records are made while they are written.
pub(super) struct SpringList<'a> {
    network: &'a Network,
    measures: Vec<u32>,
    origins: Origins,
    /// `[springs]`; none without dampers.
    dampers: Option<Vec<f64>>,
}

/// The points of each cell of a block.
pub(super) struct CellList<'a>(&'a CellBlock);

impl<'a> NetworkFile<'a> {
    /// The network of a fit of `outcome`.
    pub fn of(outcome: &'a Outcome, fit: &'a FitOutcome) -> NetworkFile<'a> {
        NetworkFile { mesh: &outcome.mesh, network: &fit.network, study: Some((outcome, fit)) }
    }

    /// A network without masses, supports and loads.
    pub fn bare(mesh: &'a Mesh, network: &'a Network) -> NetworkFile<'a> {
        NetworkFile { mesh, network, study: None }
    }

    /// The masses that were fitted, or those of the motion, or of the density, `[points]`, kg.
    pub fn masses(&self) -> Option<&'a [f64]> {
        let (outcome, fit) = self.study?;
        if let Some(fitted) = fit.masses() {
            return Some(fitted);
        }
        outcome.motion.as_ref().map(|motion| &motion.masses[..]).or(outcome.masses.as_deref())
    }

    pub(super) fn support(&self) -> Support {
        let given = self.study.and_then(|(outcome, _)| outcome.support.clone());
        given.unwrap_or_else(|| Support::free(self.mesh))
    }

    /// What a reader must know of the fit.
    pub fn notes(&self) -> Vec<String> {
        self.study.map_or(Vec::new(), |(outcome, _)| notes(outcome))
    }

    /// The record without its springs, and the springs; the cells are made while they are written.
    pub(super) fn unsprung(&self) -> (NetworkRecord<[(); 0], CellList<'a>>, SpringList<'a>) {
        self.listed().apart()
    }

    /// The record with all its springs.
    pub fn record(&self) -> NetworkRecord {
        let (record, springs) = self.parted();
        NetworkRecord { springs: springs.iter().map(SpringRecord::into_owned).collect(), ..record }
    }

    /// The record without its springs, and the springs.
    pub(super) fn parted(&self) -> (NetworkRecord, SpringList<'a>) {
        self.listed().parted()
    }

    /// The record whose cells and springs are made while they are written.
    pub(super) fn listed(&self) -> NetworkRecord<SpringList<'a>, CellList<'a>> {
        let measures = Measures::of(self.network);
        let springs = self.study.map_or(&[][..], |(_, fit)| &fit.springs);
        let origins = Origins::of(self.mesh, self.network, springs);
        let (mesh, support) = (self.mesh, self.support());
        let d = mesh.dimension;
        let outcome = self.study.map(|(outcome, _)| outcome);
        let motion = outcome.and_then(|outcome| outcome.motion.as_ref());
        let gravity = motion.map(|motion| &motion.recipe.gravity).filter(|gravity| !gravity.is_empty());
        NetworkRecord {
            format: FORMAT.into(),
            version: NETWORK_VERSION,
            provenance: self.provenance(),
            dimension: d,
            units: units(),
            points: mesh.points.chunks_exact(d).map(<[f64]>::to_vec).collect(),
            numbering: mesh.numbering.as_ref().map(|numbering| numbering.title().into()),
            nodes: mesh.numbering.as_ref().map(|numbering| numbering.nodes.clone()),
            masses: self.masses().map(<[f64]>::to_vec),
            cells: mesh.blocks.iter().map(CellList::record).collect(),
            surface: mesh.surface_triangles(),
            held: held(&support, d),
            loads: outcome
                .map_or(Vec::new(), |outcome| outcome.loads.iter().map(|load| NodalLoadRecord::of(load, d)).collect()),
            gravity: gravity.cloned(),
            damping: damping(motion),
            motion: motion.map(DriveRecord::of),
            largest_step: self.largest_step(&support),
            groups: origins.records.clone(),
            measures: measures.records,
            notes: self.notes(),
            springs: SpringList { network: self.network, measures: measures.places, origins, dampers: self.dampers() },
        }
    }

    fn provenance(&self) -> ProvenanceRecord {
        let outcome = self.study.map(|(outcome, _)| outcome);
        let material = outcome.and_then(|outcome| {
            let material = outcome.material.uniform()?;
            Some(MaterialDataRecord {
                young: material.young(),
                poisson: material.poisson(),
                state: match material.state() {
                    State::Rod { .. } => "rod",
                    State::Solid => "solid",
                    State::PlaneStress { .. } => "plane stress",
                    State::PlaneStrain { .. } => "plane strain",
                }
                .into(),
                thickness: material.thickness(),
                density: outcome.material.density().and_then(CellMap::uniform).copied(),
                law: outcome.law.clone(),
            })
        });
        let fit = self.study.map(|(outcome, fit)| {
            let record = FitRecord::of(fit, self.mesh.cell_count(), outcome.material.thicknesses().uniform().copied());
            FitSummaryRecord::of(&record)
        });
        ProvenanceRecord {
            program: concat!("springfit ", env!("CARGO_PKG_VERSION")).into(),
            command: outcome.and_then(|outcome| outcome.command.clone()),
            scene: outcome.map(|outcome| outcome.scene.clone()).filter(|scene| !scene.is_empty()),
            settings: outcome.map_or(Vec::new(), |outcome| outcome.settings.clone()),
            mesh: outcome.map(|outcome| outcome.source.clone()).filter(|source| !source.is_empty()),
            mesh_checksum: format!("{:08x}", self.mesh.checksum()),
            material,
            fit,
        }
    }

    /// `2/ω` of the fastest motion at rest, s; `None` where a point that moves has no mass, or nothing resists.
    pub fn largest_step(&self, support: &Support) -> Option<f64> {
        let masses = self.masses()?;
        let d = self.mesh.dimension;
        let held: Vec<bool> = (0..self.mesh.points.len()).map(|dof| support.is_fixed(dof)).collect();
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

impl<'a> NetworkRecord<SpringList<'a>, CellList<'a>> {
    fn parted(self) -> (NetworkRecord, SpringList<'a>) {
        let all = |cells: Vec<CellBlockRecord<CellList>>| cells.into_iter().map(CellBlockRecord::with_all).collect();
        self.with(Vec::new(), all)
    }

    fn apart(self) -> (NetworkRecord<[(); 0], CellList<'a>>, SpringList<'a>) {
        self.with([], |cells| cells)
    }

    /// The record with these springs and with what `cells` makes of its own, and its own springs.
    fn with<S, C>(
        self,
        springs: S,
        cells: impl FnOnce(Vec<CellBlockRecord<CellList<'a>>>) -> Vec<CellBlockRecord<C>>,
    ) -> (NetworkRecord<S, C>, SpringList<'a>) {
        let record = NetworkRecord {
            springs,
            format: self.format,
            version: self.version,
            provenance: self.provenance,
            dimension: self.dimension,
            units: self.units,
            points: self.points,
            numbering: self.numbering,
            nodes: self.nodes,
            masses: self.masses,
            cells: cells(self.cells),
            surface: self.surface,
            held: self.held,
            loads: self.loads,
            gravity: self.gravity,
            damping: self.damping,
            motion: self.motion,
            largest_step: self.largest_step,
            groups: self.groups,
            measures: self.measures,
            notes: self.notes,
        };
        (record, self.springs)
    }
}

impl SpringList<'_> {
    /// The springs one after the other, as they are written.
    pub fn iter(&self) -> impl Iterator<Item = SpringRecord<'_>> {
        let lengths = self.network.lengths.iter().enumerate().map(|(s, spring)| SpringRecord {
            kind: SpringKind::Length.name().into(),
            points: (&spring.points[..]).into(),
            constant: spring.constant,
            rest: spring.rest,
            measure: 0,
            law: None,
            parameters: BTreeMap::new(),
            damper: self.damper(s),
            groups: self.origins.groups(s).into(),
        });
        let others = (self.network.lengths.len()..).zip(self.network.others.iter().zip(&self.measures));
        lengths.chain(others.map(|(s, (spring, measure))| self.other(s, spring, *measure as usize)))
    }

    fn other<'s>(&'s self, s: usize, spring: &'s MeasureSpring, measure: usize) -> SpringRecord<'s> {
        let named = |own: &SpringLaw| own.law.parameters.iter().cloned().zip(own.parameters.iter().copied()).collect();
        SpringRecord {
            kind: spring.kind.name().into(),
            points: (&spring.points[..]).into(),
            constant: spring.constant,
            rest: spring.rest,
            measure,
            law: spring.law.as_deref().map(|own| own.law.text.as_str().into()),
            parameters: spring.law.as_deref().map(named).unwrap_or_default(),
            damper: self.damper(s),
            groups: self.origins.groups(s).into(),
        }
    }

    fn damper(&self, s: usize) -> f64 {
        self.dampers.as_ref().map_or(0.0, |dampers| dampers[s])
    }
}

impl CellList<'_> {
    fn record(block: &CellBlock) -> CellBlockRecord<CellList<'_>> {
        CellBlockRecord {
            element: block.element.name.clone(),
            vtk: block.element.formats.vtk.as_ref().map(|vtk| vtk.cell_type),
            points: CellList(block),
        }
    }
}

impl Serialize for CellList<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(self.0.cells())
    }
}

impl CellBlockRecord<CellList<'_>> {
    fn with_all(self) -> CellBlockRecord {
        let points = self.points.0.cells().map(<[usize]>::to_vec).collect();
        CellBlockRecord { element: self.element, vtk: self.vtk, points }
    }
}

/// Of lengths, masses and the constants of each kind of springs.
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

impl NodalLoadRecord {
    fn of(load: &BodyLoad, d: usize) -> NodalLoadRecord {
        let forces = load.forces.chunks_exact(d).enumerate();
        let acting = forces.filter(|(_, force)| force.iter().any(|f| *f != 0.0));
        NodalLoadRecord {
            name: load.name.clone(),
            forces: acting.map(|(point, force)| NodalForceRecord { point, force: force.to_vec() }).collect(),
            held: held(&load.support, d),
        }
    }
}

impl DriveRecord {
    fn of(motion: &MotionOutcome) -> DriveRecord {
        let recipe = &motion.recipe;
        DriveRecord {
            duration: recipe.duration,
            step: recipe.options.step,
            every: recipe.every,
            steps: recipe.steps,
            integrator: recipe.options.integrator.name().into(),
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
        }
    }
}
