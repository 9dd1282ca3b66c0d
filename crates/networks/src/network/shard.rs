//! Springs of some of the cells of a body, in files that are merged into one network.
//!
//! A shard is a line of JSON, the shares of its cells in the springs between two points, sorted by the points, in records of 64 bytes, and
//! a table of all other springs, which belong to one cell each, and the CRC-32 of all that.

use super::csv::{COLUMNS, SpringRow, SpringTable};
use super::part::Shard;
use crate::error::{Error, ErrorKind, Result};
use crate::file::write_with;
use crate::model::{LengthShare, MeasureSpring, SharedSpring};
use crate::springs::distance;
use flate2::{CrcReader, CrcWriter};
use serde::{Deserialize, Serialize};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

const FORMAT: &str = "springfit shard";
const VERSION: u32 = 3;
/// Bytes of a share.
const RECORD: usize = 64;
/// Bytes of the checksum.
const CHECKSUM: u64 = 4;
/// The longest first line that is read, bytes. A file of another kind has no line end that soon, and must not fill the
/// memory.
const LONGEST: u64 = 1_000_000;
/// The most files that are open at the same time. Linux allows a process 1024, of which others are in use.
const MOST: usize = 1000;

/// What the shards of one network have in common.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShardRun {
    /// The program that wrote them.
    pub program: String,
    /// The checksum of the mesh, as files of networks have it.
    pub mesh: String,
    /// The numbers of points and of cells of the body.
    pub points: usize,
    /// The number of cells.
    pub cells: usize,
    /// The fit and the material: a line `key = value` for each setting.
    pub fit: String,
    /// Whether the network is exact, so that its springs have no rest lengths.
    pub is_exact: bool,
    /// Whether points have numbers in the mesh file.
    pub is_numbered: bool,
}

/// The springs of some cells. Points are those of the mesh of these cells.
pub struct NetworkShard<'a> {
    /// Which of the shards it is.
    pub shard: Shard,
    /// What all shards have.
    pub run: ShardRun,
    /// The positions of the points, `[points × dimension]`, m.
    pub points: &'a [f64],
    /// The number of coordinates of a point.
    pub dimension: usize,
    /// The places of the points in the mesh of the body, ascending; the same if there are none.
    pub places: Option<&'a [usize]>,
    /// The numbers of the points in the mesh file.
    pub numbers: Option<&'a [u64]>,
    /// The shares of the springs between two points, sorted by the points.
    pub shares: &'a [LengthShare],
    /// The other springs, each of one cell.
    pub others: &'a [&'a MeasureSpring],
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    format: String,
    version: u32,
    shard: usize,
    count: usize,
    run: ShardRun,
    shares: usize,
    /// Bytes of the table of other springs.
    others: usize,
    has_laws: bool,
    has_slack: bool,
}

/// What a merge made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Merged {
    /// The number of springs.
    pub springs: usize,
    /// The number of constants below zero.
    pub negative: usize,
}

impl NetworkShard<'_> {
    /// Writes the shard.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let (d, place) = (self.dimension, |p: usize| self.places.map_or(p, |places| places[p]));
        let numbers = |points: &[usize]| self.numbers.map(|own| points.iter().map(|&p| own[p]).collect::<Vec<u64>>());
        let failed = |e| Error::io("cannot be written", e).in_file(path);
        // The header states the length of this table, so that it is made first.
        let mut table = SpringTable::bare(Vec::new());
        for spring in self.others {
            let points: Vec<usize> = spring.points.iter().map(|&p| place(p)).collect();
            let nodes = numbers(&spring.points).unwrap_or_default();
            table.write(&SpringRow::of_other(spring, &points), &nodes).map_err(failed)?;
        }
        let others = table.into_inner().map_err(failed)?;
        let header = Header {
            format: FORMAT.into(),
            version: VERSION,
            shard: self.shard.number,
            count: self.shard.count,
            run: self.run.clone(),
            shares: self.shares.len(),
            others: others.len(),
            has_laws: self.others.iter().any(|spring| spring.law.is_some()),
            has_slack: self.shares.iter().any(|share| share.slack != 0.0),
        };
        write_with(path, |to| {
            let mut to = CrcWriter::new(to);
            // The lengths are in the header, so that a reader finds the table without reading the shares.
            serde_json::to_writer(&mut to, &header)?;
            to.write_all(b"\n")?;
            let at = |p: usize| &self.points[p * d..(p + 1) * d];
            for share in self.shares {
                let [i, j] = share.points;
                let length = distance(at(i), at(j));
                let nodes = numbers(&share.points).unwrap_or_else(|| vec![0; 2]);
                [place(i) as u64, place(j) as u64].into_iter().try_for_each(|p| to.write_all(&p.to_le_bytes()))?;
                let values = [share.constant, share.size, share.slack, length];
                values.into_iter().try_for_each(|value| to.write_all(&value.to_le_bytes()))?;
                nodes.into_iter().try_for_each(|number| to.write_all(&number.to_le_bytes()))?;
            }
            to.write_all(&others)?;
            let checksum = to.crc().sum();
            to.into_inner().write_all(&checksum.to_le_bytes())
        })
    }
}

/// A share as a file has it.
#[derive(Clone, Copy)]
struct Stored {
    share: LengthShare,
    length: f64,
    nodes: [u64; 2],
}

/// A shard that is being read.
struct Source {
    path: PathBuf,
    header: Header,
    /// Where the shares begin.
    start: u64,
}

impl Source {
    fn open(path: &Path) -> Result<Source> {
        let failed = |e| Error::io("cannot be read", e).in_file(path);
        let mut line = Vec::new();
        let mut file = BufReader::new(File::open(path).map_err(failed)?);
        file.by_ref().take(LONGEST).read_until(b'\n', &mut line).map_err(failed)?;
        let wrong = |found: String| {
            let expected = format!("a shard of version {VERSION}, as springfit fit --shard writes it");
            Error::new(format!("expected {expected}, found {found}")).of_kind(ErrorKind::Syntax).in_file(path)
        };
        let header: Header = serde_json::from_slice(&line).map_err(|e| wrong(format!("another file: {e}")))?;
        if header.format != FORMAT || header.version != VERSION {
            return Err(wrong(format!("\"{}\" of version {}", header.format, header.version)));
        }
        // A header may state any counts: their product must not overflow. The length tells a file that was cut off
        // without reading it.
        let expected = (header.shares as u128) * RECORD as u128
            + header.others as u128
            + line.len() as u128
            + u128::from(CHECKSUM);
        let found = file.get_ref().metadata().map_err(failed)?.len();
        if u128::from(found) != expected {
            return Err(wrong(format!("one of {found} bytes in place of {expected}")));
        }
        if !(1..=header.count).contains(&header.shard) {
            return Err(wrong(format!("shard {} of {}", header.shard, header.count)));
        }
        let source = Source { path: path.to_path_buf(), start: line.len() as u64, header };
        // The whole file before any of it is used, because a merge writes while it reads.
        match source.is_whole(found).map_err(failed)? {
            true => Ok(source),
            false => Err(wrong("one that is damaged: its checksum is not that of its contents".into())),
        }
    }

    /// Whether the checksum at the end of a file of this length is that of what is before it.
    fn is_whole(&self, length: u64) -> io::Result<bool> {
        let mut file = BufReader::new(File::open(&self.path)?);
        // The length has been compared with the header, which has room for the checksum: the difference is not below zero.
        let mut contents = CrcReader::new(file.by_ref().take(length - CHECKSUM));
        io::copy(&mut contents, &mut io::sink())?;
        let sum = contents.crc().sum();
        let mut stated = [0; CHECKSUM as usize];
        file.read_exact(&mut stated)?;
        Ok(stated == sum.to_le_bytes())
    }

    fn shares(&self) -> io::Result<Shares<'_>> {
        let mut file = File::open(&self.path)?;
        file.seek(SeekFrom::Start(self.start))?;
        Ok(Shares { source: self, file: BufReader::new(file), read: 0, last: [0, 0] })
    }

    /// The rows of the other springs, with all columns.
    fn others(&self) -> io::Result<impl Iterator<Item = io::Result<csv::StringRecord>> + use<'_>> {
        let mut file = File::open(&self.path)?;
        file.seek(SeekFrom::Start(self.start + (self.header.shares * RECORD) as u64))?;
        let rows = BufReader::new(file.take(self.header.others as u64));
        let table = csv::ReaderBuilder::new().has_headers(false).from_reader(rows);
        let checked = |row: csv::Result<csv::StringRecord>| {
            let row = row.map_err(|e| e.to_string())?;
            let is_whole = row.len() == COLUMNS.len();
            is_whole.then_some(row).ok_or_else(|| "a row has columns too few or too many".to_string())
        };
        let damaged = |problem| self.damaged(&format!("the table of springs is damaged: {problem}"));
        Ok(table.into_records().map(move |row| checked(row).map_err(damaged)))
    }

    fn damaged(&self, what: &str) -> io::Error {
        io::Error::new(io::ErrorKind::InvalidData, format!("{}: {what}", self.path.display()))
    }
}

/// The shares of a shard, one after the other.
struct Shares<'a> {
    source: &'a Source,
    file: BufReader<File>,
    read: usize,
    last: [usize; 2],
}

impl Shares<'_> {
    fn next(&mut self) -> io::Result<Option<Stored>> {
        if self.read == self.source.header.shares {
            return Ok(None);
        }
        let mut bytes = [0; RECORD];
        self.file.read_exact(&mut bytes)?;
        self.read += 1;
        let (words, _) = bytes.as_chunks::<8>();
        let count = self.source.header.run.points as u64;
        let [i, j, constant, size, slack, length, first, second] =
            std::array::from_fn(|at| u64::from_le_bytes(words[at]));
        let [constant, size, slack, length] = [constant, size, slack, length].map(f64::from_bits);
        let points = [i as usize, j as usize];
        // The merge relies on the order of the points.
        let is_sound =
            i < j && j < count && points >= self.last && [constant, size, slack, length].iter().all(|x| x.is_finite());
        if !is_sound {
            return Err(self.source.damaged(&format!("share {} is damaged", self.read)));
        }
        self.last = points;
        Ok(Some(Stored { share: LengthShare { points, constant, size, slack }, length, nodes: [first, second] }))
    }
}

/// Visits the sums of the shares of all shards, sorted by the points: a merge of sorted files, which has one share of each in memory.
/// Shares are added in the order of the shards, which is that of the cells.
fn each_sum(sources: &[Source], mut visit: impl FnMut(&Stored) -> io::Result<()>) -> io::Result<()> {
    let mut files = sources.iter().map(Source::shares).collect::<io::Result<Vec<_>>>()?;
    let mut heads = files.iter_mut().map(Shares::next).collect::<io::Result<Vec<_>>>()?;
    // Of equal points the shard with the lower number comes first: sums do not depend on the order in which files are named.
    let order = |(file, head): (usize, &Option<Stored>)| Some(Reverse((head.as_ref()?.share.points, file)));
    let mut waiting: BinaryHeap<_> = heads.iter().enumerate().filter_map(order).collect();
    let mut sum: Option<Stored> = None;
    while let Some(Reverse((points, file))) = waiting.pop() {
        if let Some(share) = std::mem::replace(&mut heads[file], files[file].next()?) {
            match &mut sum {
                Some(sum) if sum.share.points == points => sum.share.add(&share.share),
                _ => {
                    // Files are sorted: once other points come, a sum has all of its shares.
                    sum.iter().try_for_each(&mut visit)?;
                    sum = Some(share);
                }
            }
        }
        waiting.extend(order((file, &heads[file])));
    }
    sum.iter().try_for_each(&mut visit)
}

/// Merges all shards of a network into one table of springs, as that of a fit of all cells at once. The memory does not grow with the
/// network.
///
/// # Errors
/// A file is no shard or is damaged, a shard is missing or there twice, shards are of different runs, or the output cannot be written.
pub fn merge_shards(shards: &[PathBuf], output: &Path) -> Result<Merged> {
    if shards.len() > MOST {
        let expected = format!("at most {MOST} shards");
        return Err(Error::expected("shards", expected, shards.len()).of_kind(ErrorKind::Limit));
    }
    let mut sources = shards.iter().map(|path| Source::open(path)).collect::<Result<Vec<_>>>()?;
    sources.sort_by_key(|source| source.header.shard);
    let run = check(&sources)?.clone();
    let mut merged = Merged { springs: 0, negative: 0 };
    let may_be_steady = sources.iter().any(|source| source.header.has_slack);
    let written = write_with(output, |to| {
        let mut steady = 0;
        // The header of a table has its columns: whether some springs have laws is found by summing all shares once
        // before.
        if may_be_steady {
            each_sum(&sources, |sum| {
                steady += usize::from(matches!(sum.share.spring(|| sum.length, run.is_exact), SharedSpring::Steady(_)));
                Ok(())
            })?;
        }
        let lawful = steady > 0 || sources.iter().any(|source| source.header.has_laws);
        let mut table = SpringTable::new(to, lawful, run.is_numbered)?;
        let mut count = |constant: f64| {
            merged.springs += 1;
            merged.negative += usize::from(constant < 0.0);
        };
        each_sum(&sources, |sum| match sum.share.spring(|| sum.length, run.is_exact) {
            SharedSpring::Length(spring) => {
                count(spring.constant);
                table.write(&SpringRow::of_length(&spring), &sum.nodes)
            }
            SharedSpring::None | SharedSpring::Steady(_) => Ok(()),
        })?;
        // Springs on lengths come first, as in a network that is written at once; the others are summed again for that.
        if steady > 0 {
            each_sum(&sources, |sum| match sum.share.spring(|| sum.length, run.is_exact) {
                SharedSpring::Steady(spring) => {
                    count(spring.constant);
                    table.write(&SpringRow::of_other(&spring, &spring.points), &sum.nodes)
                }
                SharedSpring::None | SharedSpring::Length(_) => Ok(()),
            })?;
        }
        for source in &sources {
            for row in source.others()? {
                count(table.copy(&row?)?);
            }
        }
        table.flush()
    });
    written.map(|()| merged)
}

/// That these are all shards of one run, each once, sorted by their numbers.
fn check(sources: &[Source]) -> Result<&ShardRun> {
    let Some(first) = sources.first() else {
        return Err(Error::expected("shards", "all shards of a network", "none"));
    };
    let (run, count) = (&first.header.run, first.header.count);
    for source in sources {
        let own = &source.header;
        if &own.run != run || own.count != count {
            let expected = format!("a shard of the same run as {}", first.path.display());
            let found = match (own.run.mesh != run.mesh, own.run.fit != run.fit, own.run.program != run.program) {
                (true, ..) => "one of another mesh".into(),
                (_, true, _) => "one of another fit or material".into(),
                (.., true) => format!("one of {}", own.run.program),
                _ => format!("one of {} shards", own.count),
            };
            return Err(Error::new(format!("expected {expected}, found {found}")).in_file(&source.path));
        }
    }
    for pair in sources.windows(2) {
        if pair[0].header.shard == pair[1].header.shard {
            let problem = format!("is shard {} of {count}, as is {}", pair[0].header.shard, pair[1].path.display());
            return Err(Error::new(problem).in_file(&pair[0].path));
        }
    }
    match (1..=count).find(|number| !sources.iter().any(|source| source.header.shard == *number)) {
        Some(missing) => {
            Err(Error::expected("shards", format!("all {count} shards"), format!("none of number {missing}")))
        }
        None => Ok(run),
    }
}
