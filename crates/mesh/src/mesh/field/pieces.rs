//! Numbers in a point or cell array of a grid.

use super::raw::{Holder, Raw};
use crate::error::{Error, Result};
use crate::mesh::reader::quoted;
use crate::mesh::vtk::{DataArray, Piece};

/// Reads the array called `array`, or the only one with that many components.
///
/// # Errors
/// The grid has no such array or several, a piece lacks it, or a cell names a point that its piece lacks.
pub(super) fn read(pieces: &[Piece], array: Option<&str>, components: usize) -> Result<Raw> {
    let (holder, name) = named(pieces, array, components)?;
    let mut raw = Raw { holder, places: Vec::new(), components, values: Vec::new(), starts: Vec::new() };
    for piece in pieces {
        let places = match holder {
            Holder::Points => piece.points.clone(),
            Holder::Cells => middles(piece)?,
        };
        if places.is_empty() {
            continue;
        }
        let own = arrays(piece, holder).iter().find(|array| array.name == name);
        let own =
            own.and_then(|array| array.values.as_ref()).filter(|values| values.len() == places.len() * components);
        let Some(values) = own else {
            let found = format!("a piece of {} without", places.len());
            return Err(Error::expected("pieces", format!("{} in every one", quoted(name.as_bytes())), found));
        };
        raw.places.extend(places);
        raw.values.extend_from_slice(values);
    }
    Ok(raw)
}

fn arrays(piece: &Piece, holder: Holder) -> &[DataArray] {
    match holder {
        Holder::Points => &piece.point_arrays,
        Holder::Cells => &piece.cell_arrays,
    }
}

/// The means of the nodes of each cell.
fn middles(piece: &Piece) -> Result<Vec<[f64; 3]>> {
    let mut start = 0;
    let middle = |(cell, end): (usize, &u64)| {
        // An end beyond the machine's numbers is one that the list of nodes does not have.
        let end = usize::try_from(*end).unwrap_or(usize::MAX);
        let nodes = piece.connectivity.get(start..end).filter(|nodes| !nodes.is_empty());
        start = end;
        let point = |node: &u64| usize::try_from(*node).ok().and_then(|node| piece.points.get(node));
        let points: Option<Vec<&[f64; 3]>> = nodes.and_then(|nodes| nodes.iter().map(point).collect());
        let points = points.ok_or_else(|| Error::at(format!("cells[{cell}]"), "names a point that is not there"))?;
        Ok(std::array::from_fn(|k| points.iter().map(|x| x[k]).sum::<f64>() / points.len() as f64))
    };
    piece.ends.iter().enumerate().map(middle).collect()
}

fn named<'a>(pieces: &'a [Piece], wanted: Option<&str>, components: usize) -> Result<(Holder, &'a str)> {
    let mut all: Vec<(Holder, &DataArray)> = Vec::new();
    for piece in pieces {
        for holder in [Holder::Points, Holder::Cells] {
            for array in arrays(piece, holder) {
                if !all.iter().any(|(known, other)| *known == holder && other.name == array.name) {
                    all.push((holder, array));
                }
            }
        }
    }
    let fits = |array: &DataArray| array.components == components as u64 && array.values.is_some();
    let named = |array: &DataArray| wanted.is_none_or(|wanted| array.name == wanted);
    let found: Vec<&(Holder, &DataArray)> = all.iter().filter(|(_, array)| fits(array) && named(array)).collect();
    if let [(holder, array)] = found[..] {
        return Ok((*holder, &array.name));
    }
    let numbers = if components == 1 { "one number".to_string() } else { format!("{components} numbers") };
    let expected = match wanted {
        Some(wanted) => format!("one array {} with {numbers} at each point or cell", quoted(wanted.as_bytes())),
        None => format!("a single array with {numbers} at each point or cell, or its name as \"array\""),
    };
    let about = |(holder, array): &(Holder, &DataArray)| {
        let place = match holder {
            Holder::Points => "points",
            Holder::Cells => "cells",
        };
        format!("{} of {place} (components: {})", quoted(array.name.as_bytes()), array.components)
    };
    let list = all.iter().map(about).collect::<Vec<_>>().join(", ");
    Err(Error::expected("array", expected, if list.is_empty() { "none" } else { &list }))
}
