//! The cells and springs of a network as lists whose records are made while they are written.

use super::measures::Measures;
use super::origins::Origins;
use super::record::{CellBlockRecord, MeasureRecord, NetworkRecord, OriginRecord, SpringRecord};
use crate::element::SpringKind;
use crate::mesh::{CellBlock, Mesh};
use crate::model::{MeasureSpring, Network, SpringLaw};
use crate::springs::Springs;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// The record of a network whose cells and springs are made while they are written.
pub type ListedRecord<'a> = NetworkRecord<SpringList<'a>, CellList<'a>>;

/// What the lists of a record have of a network.
pub struct Lists<'a> {
    /// The cells of each block.
    pub cells: Vec<CellBlockRecord<CellList<'a>>>,
    /// The groups of springs in the element files.
    pub groups: Vec<OriginRecord>,
    /// What springs measure.
    pub measures: Vec<MeasureRecord>,
    /// The springs.
    pub springs: SpringList<'a>,
}

impl<'a> Lists<'a> {
    /// The lists of a network of a mesh. `springs` are those of the element of each block, if they are known; `dampers` are the coefficients
    /// of the springs' dampers, `[springs]`, kg/s.
    pub fn of(mesh: &'a Mesh, network: &'a Network, springs: &[Springs], dampers: Option<Vec<f64>>) -> Lists<'a> {
        let Measures { records, places } = Measures::of(network);
        let origins = Origins::of(mesh, network, springs);
        Lists {
            cells: mesh.blocks.iter().map(CellList::record).collect(),
            groups: origins.records.clone(),
            measures: records,
            springs: SpringList { network, measures: places, origins, dampers },
        }
    }
}

/// The springs of a network; their records are made while they are written.
pub struct SpringList<'a> {
    network: &'a Network,
    measures: Vec<u32>,
    origins: Origins,
    /// `[springs]`; none without dampers.
    dampers: Option<Vec<f64>>,
}

/// The points of each cell of a block.
pub struct CellList<'a>(&'a CellBlock);

impl<'a> ListedRecord<'a> {
    fn parted(self) -> (NetworkRecord, SpringList<'a>) {
        let all = |cells: Vec<CellBlockRecord<CellList>>| cells.into_iter().map(CellBlockRecord::with_all).collect();
        self.with(Vec::new(), all)
    }

    /// The record without its springs, and the springs; the cells are made while they are written.
    pub(super) fn apart(self) -> (NetworkRecord<[(); 0], CellList<'a>>, SpringList<'a>) {
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
            engine: self.engine,
            plane: self.plane,
            groups: self.groups,
            measures: self.measures,
            notes: self.notes,
        };
        (record, self.springs)
    }
}

impl ListedRecord<'_> {
    /// The record with all its springs.
    pub fn whole(self) -> NetworkRecord {
        let (record, springs) = self.parted();
        NetworkRecord { springs: springs.iter().map(SpringRecord::into_owned).collect(), ..record }
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
