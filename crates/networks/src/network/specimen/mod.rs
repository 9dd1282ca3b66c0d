//! Reads networks of anyone: files of springfit, PhysTwin, LAMMPS, MuJoCo, and tables of springs.

mod arrays;
mod flex;
mod flex_places;
mod json;
mod lammps;
mod npz;
mod table;

pub use table::{PointTable, read_points};

use crate::element::Element;
use crate::engine::Setting;
use crate::error::{Error, ErrorKind, Result};
use crate::material::Plane;
use crate::model::Specimen;
use nalgebra::DMatrix;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A network as a file holds it.
#[derive(Debug)]
pub struct SpecimenFile {
    /// The network.
    pub specimen: Specimen,
    /// What the file is, in words.
    pub format: &'static str,
    /// The plane state and the thickness in m, where the file says them.
    pub state: Option<(Plane, f64)>,
    /// The settings of the engine for which the constants are, where the file says them.
    pub engine: Option<Setting>,
    /// What a reader must know of how the file was read, a sentence each.
    pub notes: Vec<String>,
}

/// What a file does not say of its network.
#[derive(Debug, Default)]
pub struct SpecimenOptions {
    /// A table of the points, for files without them.
    pub points: Option<PathBuf>,
    /// The vectors of the cell with which the network repeats itself, one in each row, m.
    pub cell: Option<DMatrix<f64>>,
    /// Whether a file with a box repeats itself in it; `None` lets the springs tell.
    pub is_periodic: Option<bool>,
    /// Elements of the cells that are not shipped.
    pub elements: Vec<Arc<Element>>,
}

impl SpecimenFile {
    /// A lattice by name.
    pub fn of_lattice(specimen: Specimen) -> SpecimenFile {
        SpecimenFile::plain(specimen, "a lattice by name")
    }

    fn plain(specimen: Specimen, format: &'static str) -> SpecimenFile {
        SpecimenFile { specimen, format, state: None, engine: None, notes: Vec::new() }
    }
}

/// A format, known by the ending of its files.
struct Format {
    endings: &'static [&'static str],
    read: fn(&[u8], &SpecimenOptions) -> Result<SpecimenFile>,
}

/// A new format is a row here.
const FORMATS: [Format; 5] = [
    Format { endings: &["json"], read: json::read },
    Format { endings: &["npz"], read: npz::read },
    Format { endings: &["csv"], read: table::read },
    Format { endings: &["data", "lmp", "lammps"], read: lammps::read },
    Format { endings: &["xml", "mjcf"], read: flex::read },
];

/// The endings of the files that are read: `.a, .b or .c`.
pub fn specimen_endings() -> String {
    let all: Vec<String> = FORMATS.iter().flat_map(|f| f.endings).map(|ending| format!(".{ending}")).collect();
    let (last, others) = all.split_last().expect("there are formats");
    format!("{} or {last}", others.join(", "))
}

/// Reads a network: of springfit (JSON, arrays, a table), of PhysTwin (arrays), of LAMMPS (a data file), of MuJoCo (flexes in MJCF), or a table of
/// springs.
///
/// # Errors
/// The file cannot be read, has no ending that is known, or is not a network; the error names the line, the array or the element.
pub fn read_specimen(path: &Path, options: &SpecimenOptions) -> Result<SpecimenFile> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    // LAMMPS names its files data.NAME as well.
    let is_data = path.file_name().and_then(|name| name.to_str()).is_some_and(|name| name.starts_with("data."));
    let known = FORMATS.iter().find(|format| format.endings.contains(&ending.as_str()));
    let format = known.or_else(|| FORMATS.iter().find(|format| is_data && format.endings.contains(&"data")));
    let Some(format) = format else {
        let expected = format!("a network in a file ending in {}", specimen_endings());
        let error = Error::new(format!("expected {expected}, found {}", path.display()));
        return Err(error.of_kind(ErrorKind::Unsupported));
    };
    let bytes = std::fs::read(path).map_err(|e| Error::io("cannot be read", e).in_file(path))?;
    let mut file = (format.read)(&bytes, options).map_err(|e| e.placed(|e| e.in_file(path)))?;
    if let Some(cell) = options.cell.as_ref().filter(|_| file.specimen.period.is_none()) {
        file.specimen = file.specimen.repeated(cell.clone()).map_err(|e| e.placed(|e| e.in_file(path)))?;
    }
    file.check().map_err(|e| e.placed(|e| e.in_file(path)))?;
    Ok(file)
}

impl SpecimenFile {
    /// That there are springs, all of them finite and between different places.
    fn check(&self) -> Result<()> {
        let Specimen { network, points, masses, .. } = &self.specimen;
        let d = network.dimension;
        if network.is_empty() {
            return Err(Error::expected("springs", "at least one spring", "none"));
        }
        if let Some(at) = points.iter().position(|x| !x.is_finite()) {
            return Err(Error::expected(format!("points[{}]", at / d), "finite coordinates", points[at]));
        }
        for (s, spring) in network.lengths.iter().enumerate() {
            let key = |name: &str| format!("springs[{s}].{name}");
            if !spring.constant.is_finite() {
                return Err(Error::expected(key("constant"), "a finite number", spring.constant));
            }
            if !(spring.rest >= 0.0 && spring.rest.is_finite()) {
                return Err(Error::expected(key("rest"), "a length of at least zero", spring.rest));
            }
            let [a, b] = spring.points.map(|p| &points[p * d..(p + 1) * d]);
            if spring.rest > 0.0 && crate::springs::distance(a, b) == 0.0 {
                let found = format!("points {} and {} at one place", spring.points[0], spring.points[1]);
                return Err(Error::expected(key("points"), "two points at different places", found));
            }
        }
        if let Some(p) = masses.iter().flatten().position(|mass| !(*mass >= 0.0 && mass.is_finite())) {
            let found = masses.as_ref().map_or(f64::NAN, |masses| masses[p]);
            return Err(Error::expected(format!("masses[{p}]"), "a mass of at least zero, kg", found));
        }
        Ok(())
    }
}

/// The place of a point that a file counts from `first`.
fn place(key: &str, number: i64, first: i64, count: usize) -> Result<usize> {
    let place = number.checked_sub(first).and_then(|place| usize::try_from(place).ok()).filter(|place| *place < count);
    place.ok_or_else(|| {
        let last = count as i64 + first - 1;
        let hint = if first == 0 && number == count as i64 { "; are points numbered from 1?" } else { "" };
        Error::expected(key, format!("a point from {first} to {last}"), number).followed_by(hint)
    })
}
