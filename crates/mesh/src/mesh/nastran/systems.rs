//! The coordinate systems of grid points.

use super::card::Card;
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::frame::{BASIC, Frame, System};
use std::collections::{BTreeMap, HashMap};

/// A system as its card states it.
#[derive(Clone, Copy)]
struct Stated {
    system: System,
    by: By,
    line: usize,
}

#[derive(Clone, Copy)]
enum By {
    /// Three grid points.
    Points([u64; 3]),
    /// Three points of another system.
    Places(u64, [[f64; 3]; 3]),
}

/// A grid point as its card states it: the number of its system, and its coordinates there.
#[derive(Clone, Copy)]
pub(super) struct Grid {
    pub system: u64,
    pub at: [f64; 3],
    pub line: usize,
}

/// The coordinate systems by their numbers.
#[derive(Default)]
pub(super) struct Systems {
    stated: BTreeMap<u64, Stated>,
    found: HashMap<u64, Frame>,
}

impl Systems {
    /// Reads the card of a system; whether it is one.
    ///
    /// # Errors
    /// A field is wrong.
    pub fn read(&mut self, card: &Card) -> Result<bool> {
        let Some(rest) = card.name.strip_prefix("CORD") else { return Ok(false) };
        let system = match rest.as_bytes() {
            [_, b'R'] => System::Rectangular,
            [_, b'C'] => System::Cylindrical,
            [_, b'S'] => System::Spherical,
            _ => return Ok(true),
        };
        card.check()?;
        match rest.as_bytes()[0] {
            // One card has one or two of them.
            b'1' => {
                for first in [0, 4] {
                    if card.field(first).is_empty() {
                        continue;
                    }
                    let number = |index: usize| card.whole(first + index, "a number");
                    let by = By::Points([number(1)?, number(2)?, number(3)?]);
                    self.stated.insert(number(0)?, Stated { system, by, line: card.line });
                }
            }
            b'2' => {
                let around = if card.field(1).is_empty() { 0 } else { card.whole(1, "the number of a system")? };
                let mut places = [[0.0; 3]; 3];
                for (i, x) in places.as_flattened_mut().iter_mut().enumerate() {
                    *x = card.real(2 + i, "a coordinate")?;
                }
                let number = card.whole(0, "the number of a system")?;
                self.stated.insert(number, Stated { system, by: By::Places(around, places), line: card.line });
            }
            _ => {}
        }
        Ok(true)
    }

    /// The place of a grid point in the basic system; `grids` has all by their numbers.
    ///
    /// # Errors
    /// A system is not in the file, is defined by itself, or its points are on one line.
    pub fn place(&mut self, grid: &Grid, grids: &HashMap<u64, Grid>) -> Result<[f64; 3]> {
        Ok(self.frame(grid.system, grid.line, grids, &mut Vec::new())?.place(grid.at))
    }

    fn frame(&mut self, number: u64, line: usize, grids: &HashMap<u64, Grid>, open: &mut Vec<u64>) -> Result<Frame> {
        if number == 0 {
            return Ok(BASIC);
        }
        if let Some(frame) = self.found.get(&number) {
            return Ok(*frame);
        }
        let fault = |line: usize, problem: String| {
            Error::at(format!("system {number}"), problem).of_kind(ErrorKind::Syntax).on_line(line)
        };
        let Some(stated) = self.stated.get(&number).copied() else {
            return Err(fault(line, "is named by a grid point or a system, and is not in the file".into()));
        };
        if open.contains(&number) {
            return Err(fault(stated.line, "is defined by itself".into()));
        }
        // The systems on the way down are kept, because a chain of systems that closes would be followed without end.
        open.push(number);
        let places = match stated.by {
            By::Places(around, places) => {
                let around = self.frame(around, stated.line, grids, open)?;
                places.map(|place| around.place(place))
            }
            By::Points(points) => {
                let mut places = [[0.0; 3]; 3];
                for (place, point) in places.iter_mut().zip(points) {
                    let Some(grid) = grids.get(&point) else {
                        return Err(fault(stated.line, format!("names grid point {point}, which the file lacks")));
                    };
                    *place = self.frame(grid.system, stated.line, grids, open)?.place(grid.at);
                }
                places
            }
        };
        open.pop();
        let [origin, on_z, in_xz] = places;
        let frame = Frame::of_axis(stated.system, origin, on_z, in_xz)
            .ok_or_else(|| fault(stated.line, "expected three points that are not on one line".into()))?;
        self.found.insert(number, frame);
        Ok(frame)
    }
}
