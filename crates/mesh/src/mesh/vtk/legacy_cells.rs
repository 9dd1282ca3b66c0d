//! The nodes of cells in legacy files.

use super::polydata::Cells;
use super::scalar_type::ScalarType;
use crate::error::Result;
use crate::mesh::reader::Reader;

/// Reads the nodes of cells, in the form of VTK 5 or in that before it.
pub(super) fn read(reader: &mut Reader) -> Result<Cells> {
    let count: u64 = reader.text_number()?;
    let size: u64 = reader.text_number()?;
    if reader.next_is("OFFSETS") {
        reader.word();
        let offsets = indices(reader, count)?;
        let ends = match offsets.split_first() {
            Some((0, ends)) => ends.to_vec(),
            Some((first, _)) => return Err(reader.expected("offsets from 0", &first.to_string())),
            None => Vec::new(),
        };
        if !reader.next_is("CONNECTIVITY") {
            return Err(reader.unexpected("CONNECTIVITY"));
        }
        reader.word();
        return Ok(Cells { ends, connectivity: indices(reader, size)? });
    }
    reader.start_data()?;
    reader.announce("cells", count);
    let mut cells = Cells::default();
    cells.ends.reserve(reader.capacity::<i32>(count, 2));
    cells.connectivity.reserve(reader.capacity::<i32>(size, 1));
    for _ in 0..count {
        for _ in 0..reader.number::<u32>()? {
            cells.connectivity.push(reader.number::<u32>()?.into());
        }
        cells.ends.push(cells.connectivity.len() as u64);
        reader.count_one();
    }
    let found = cells.connectivity.len() as u64 + count;
    if found == size { Ok(cells) } else { Err(reader.expected(&format!("{size} numbers"), &found.to_string())) }
}

fn indices(reader: &mut Reader, count: u64) -> Result<Vec<u64>> {
    let indices = scalar_type(reader)?.whole_numbers(reader, count, "indices")?;
    indices.ok_or_else(|| reader.expected("a type of whole numbers", "another"))
}

/// Reads the name of the type of the numbers that follow.
pub(super) fn scalar_type(reader: &mut Reader) -> Result<ScalarType> {
    let scalar = ScalarType::read(reader)?;
    reader.start_data()?;
    Ok(scalar)
}
