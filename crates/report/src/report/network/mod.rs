//! Networks of runs and fits as files.

mod file;
mod format;
mod json;
mod points;

pub use crate::network::{
    ArrayFile, CellBlockRecord, ContentPart, Division, DriveRecord, FORMAT, FitSummaryRecord, HeldRecord, HingePart,
    LengthPart, LoadErrorsRecord, MaterialDataRecord, MeasureKind, MeasureRecord, Measuring, Merged, NETWORK_VERSION,
    NetworkDampingRecord, NetworkFacts, NetworkRecord, NetworkShard, NodalForceRecord, NodalLoadRecord, OriginRecord,
    Parts, PlaneRecord, PointTable, ProvenanceRecord, Shard, ShardRun, ShareRecord, SpecimenFile, SpecimenOptions,
    SpringRecord, TermRecord, TimedForceRecord, TimedPullRecord, cell_terms, merge_shards, network_csv, network_npz,
    network_npz_with, network_schema, read_matrix, read_network, read_points, read_specimen, simplex_term,
    specimen_endings,
};
pub use file::NetworkFile;
pub use format::{NETWORK_FORMATS, NetworkFormat};
pub use json::network_json;
pub use points::points_csv;
