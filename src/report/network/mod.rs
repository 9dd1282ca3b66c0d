//! Networks as files: one record for JSON, tables and arrays, and its reader.

mod csv;
mod file;
mod format;
mod json;
mod measures;
mod npz;
mod origins;
mod parts;
mod reader;
mod record;
mod shard;

pub use csv::{network_csv, points_csv};
pub use file::NetworkFile;
pub use format::{NETWORK_FORMATS, NetworkFormat};
pub use json::network_json;
pub use npz::{ArrayFile, network_npz};
pub use parts::{ContentPart, LengthPart, Parts};
pub use reader::read_network;
pub use record::{
    CellBlockRecord, DriveRecord, FORMAT, FitSummaryRecord, HeldRecord, LoadErrorsRecord, MaterialDataRecord,
    MeasureKind, MeasureRecord, NETWORK_VERSION, NetworkDampingRecord, NetworkRecord, NodalForceRecord,
    NodalLoadRecord, OriginRecord, ProvenanceRecord, ShareRecord, SpringRecord, TermRecord, TimedForceRecord,
    TimedPullRecord, network_schema,
};
pub use shard::{Merged, NetworkShard, ShardRun, merge_shards};
