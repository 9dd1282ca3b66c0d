//! The formats of networks, by the endings of their files.

use super::file::{SpecimenFile, SpecimenOptions};
use super::{flex, json, lammps, npz, table};
use crate::error::{Error, ErrorKind, Result};
use std::path::Path;

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
