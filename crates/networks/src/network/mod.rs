//! Networks as files: one record for JSON, tables and arrays, and its reader.

mod balance;
mod csv;
mod division;
mod facts;
mod hinges;
mod json;
mod lines;
mod lists;
mod matrix_market;
mod measures;
mod model;
mod npz;
mod origins;
mod part;
mod parts;
mod provenance;
mod reader;
mod record;
mod shard;
mod specimen;

pub use csv::{network_csv, write_points};
pub use division::Division;
pub use facts::NetworkFacts;
pub use json::write_json;
pub use lists::{CellList, ListedRecord, Lists, SpringList};
pub use matrix_market::read_matrix;
pub use measures::cell_terms;
pub use model::Measuring;
pub use npz::{ArrayFile, network_npz, network_npz_with, write_npz};
pub use part::Shard;
pub use parts::{ContentPart, HingePart, LengthPart, Parts, simplex_term};
pub use provenance::{FitSummaryRecord, LoadErrorsRecord, MaterialDataRecord, PlaneRecord, ProvenanceRecord};
pub use reader::read_network;
pub use record::{
    CellBlockRecord, DriveRecord, FORMAT, HeldRecord, MeasureKind, MeasureRecord, NETWORK_VERSION,
    NetworkDampingRecord, NetworkRecord, NodalForceRecord, NodalLoadRecord, OriginRecord, QUADRILATERAL,
    RelaxationRecord, ShareRecord, SpringRecord, TermRecord, TimedForceRecord, TimedPullRecord, network_schema,
};
pub use shard::{Merged, NetworkShard, ShardRun, merge_shards};
pub use specimen::{PointTable, SpecimenFile, SpecimenOptions, read_points, read_specimen, specimen_endings};
