//! Values of the cells of a body: one for all cells, or one for each.

use super::{Hooke, Moduli};
use crate::error::{Error, Result};
use std::sync::Arc;

/// A value of each cell of a body, such as its material. Copies share the values.
#[derive(Debug, Clone, PartialEq)]
pub enum CellMap<T> {
    /// All cells of the body have this value.
    Uniform(T),
    /// The values of the cells of each block, `[blocks][cells]`.
    Each(Arc<[Vec<T>]>),
}

/// A value of each cell of one block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BlockValues<'a, T> {
    /// All cells of the block have this value.
    Uniform(T),
    /// One for each, `[cells]`.
    Each(&'a [T]),
}

impl<T: Clone + PartialEq> CellMap<T> {
    /// The values of the cells of each block, `[blocks][cells]`; uniform if they are all the same.
    pub fn of_blocks(blocks: Vec<Vec<T>>) -> CellMap<T> {
        let mut all = blocks.iter().flatten();
        match all.next() {
            // Equal values are one, so that a body takes the same way however its material was given.
            Some(first) if all.all(|value| value == first) => CellMap::Uniform(first.clone()),
            _ => CellMap::Each(blocks.into()),
        }
    }

    /// The values of another kind that follow from these.
    ///
    /// # Errors
    /// This returns the errors of `of`.
    pub fn try_map<U: Clone + PartialEq>(&self, of: impl Fn(&T) -> Result<U>) -> Result<CellMap<U>> {
        match self {
            CellMap::Uniform(value) => of(value).map(CellMap::Uniform),
            CellMap::Each(blocks) => {
                let block = |values: &Vec<T>| values.iter().map(&of).collect();
                Ok(CellMap::of_blocks(blocks.iter().map(block).collect::<Result<_>>()?))
            }
        }
    }

    /// The values of another kind that follow from these and from others.
    ///
    /// # Errors
    /// This returns the errors of `of`.
    pub fn try_zip<V: Clone + PartialEq, U: Clone + PartialEq>(
        &self,
        other: &CellMap<V>,
        of: impl Fn(&T, &V) -> Result<U>,
    ) -> Result<CellMap<U>> {
        let blocks = match (self, other) {
            (CellMap::Uniform(a), CellMap::Uniform(b)) => return of(a, b).map(CellMap::Uniform),
            (CellMap::Each(blocks), _) => blocks.iter().map(Vec::len).collect::<Vec<_>>(),
            (_, CellMap::Each(blocks)) => blocks.iter().map(Vec::len).collect(),
        };
        let block = |(block, cells): (usize, usize)| -> Result<Vec<U>> {
            (0..cells).map(|cell| of(self.at(block, cell), other.at(block, cell))).collect()
        };
        Ok(CellMap::of_blocks(blocks.into_iter().enumerate().map(block).collect::<Result<_>>()?))
    }

    /// Converts the values to those of another kind that follow from them, by a function that cannot fail.
    pub fn map<U: Clone + PartialEq>(&self, of: impl Fn(&T) -> U) -> CellMap<U> {
        match self {
            CellMap::Uniform(value) => CellMap::Uniform(of(value)),
            CellMap::Each(blocks) => {
                CellMap::of_blocks(blocks.iter().map(|values| values.iter().map(&of).collect()).collect())
            }
        }
    }

    /// The values of some of the cells, which are given by block.
    pub fn of_cells(&self, cells: &[Vec<usize>]) -> CellMap<T> {
        match self {
            CellMap::Uniform(value) => CellMap::Uniform(value.clone()),
            CellMap::Each(blocks) => {
                let block =
                    |(values, cells): (&Vec<T>, &Vec<usize>)| cells.iter().map(|&c| values[c].clone()).collect();
                CellMap::of_blocks(blocks.iter().zip(cells).map(block).collect())
            }
        }
    }
}

impl<T: Clone> CellMap<T> {
    /// The values of the cells of one block.
    pub fn block(&self, block: usize) -> BlockValues<'_, T> {
        match self {
            CellMap::Uniform(value) => BlockValues::Uniform(value.clone()),
            CellMap::Each(blocks) => BlockValues::Each(&blocks[block]),
        }
    }
}

impl CellMap<f64> {
    /// The product of both values of each cell.
    pub fn product(&self, other: &CellMap<f64>) -> CellMap<f64> {
        match (self, other) {
            (CellMap::Uniform(a), other) => other.map(|b| a * b),
            (own, CellMap::Uniform(b)) => own.map(|a| a * b),
            (CellMap::Each(own), CellMap::Each(other)) => {
                let block = |(own, other): (&Vec<f64>, &Vec<f64>)| own.iter().zip(other).map(|(a, b)| a * b).collect();
                CellMap::of_blocks(own.iter().zip(&**other).map(block).collect())
            }
        }
    }
}

impl<T> CellMap<T> {
    /// The value of a cell, by its block and its index there.
    pub fn at(&self, block: usize, cell: usize) -> &T {
        match self {
            CellMap::Uniform(value) => value,
            CellMap::Each(blocks) => &blocks[block][cell],
        }
    }

    /// The value of all cells, if they have the same.
    pub fn uniform(&self) -> Option<&T> {
        match self {
            CellMap::Uniform(value) => Some(value),
            CellMap::Each(_) => None,
        }
    }

    /// The block and the index of the first cell whose value satisfies a condition.
    pub fn position(&self, is_meant: impl Fn(&T) -> bool) -> Option<(usize, usize)> {
        match self {
            CellMap::Uniform(value) => is_meant(value).then_some((0, 0)),
            CellMap::Each(blocks) => {
                let found = |(block, values): (usize, &Vec<T>)| Some((block, values.iter().position(&is_meant)?));
                blocks.iter().enumerate().find_map(found)
            }
        }
    }

    /// The values: one if it is that of all cells, otherwise one for each cell.
    pub fn values(&self) -> impl Iterator<Item = &T> {
        let (one, each) = match self {
            CellMap::Uniform(value) => (Some(value), &[][..]),
            CellMap::Each(blocks) => (None, &blocks[..]),
        };
        one.into_iter().chain(each.iter().flatten())
    }

    /// Checks that there is a value for each cell; `cells` has the number of cells of each block.
    ///
    /// # Errors
    /// There is another number of blocks, or of values of a block.
    pub fn check(&self, key: &str, cells: &[usize]) -> Result<()> {
        let CellMap::Each(blocks) = self else { return Ok(()) };
        let found: Vec<usize> = blocks.iter().map(Vec::len).collect();
        if found == cells {
            return Ok(());
        }
        Err(Error::expected(key, format!("values of {cells:?} cells"), format!("{found:?}")))
    }
}

impl CellMap<f64> {
    /// The least and the largest value.
    pub fn range(&self) -> [f64; 2] {
        let least = |[least, largest]: [f64; 2], value: &f64| [least.min(*value), largest.max(*value)];
        self.values().fold([f64::INFINITY, f64::NEG_INFINITY], least)
    }

    /// The least and the largest value of the cells of one block.
    pub fn range_of(&self, block: usize) -> [f64; 2] {
        match self {
            CellMap::Uniform(value) => [*value; 2],
            CellMap::Each(blocks) => {
                let least = |[least, largest]: [f64; 2], value: &f64| [least.min(*value), largest.max(*value)];
                blocks[block].iter().fold([f64::INFINITY, f64::NEG_INFINITY], least)
            }
        }
    }
}

impl<'a, T> BlockValues<'a, T> {
    /// The value of a cell.
    pub fn at(&self, cell: usize) -> &T {
        match self {
            BlockValues::Uniform(value) => value,
            BlockValues::Each(values) => &values[cell],
        }
    }

    /// The values: one if it is that of all cells, otherwise one for each cell.
    pub fn values(&self) -> &[T] {
        match self {
            BlockValues::Uniform(value) => std::slice::from_ref(value),
            BlockValues::Each(values) => values,
        }
    }

    /// Checks that there is a value for each cell.
    ///
    /// # Errors
    /// There is another number of values.
    pub fn check(&self, key: &str, cells: usize) -> Result<()> {
        match self {
            BlockValues::Each(values) if values.len() != cells => {
                Err(Error::expected(key, format!("one value or {cells}, one of each cell"), values.len()))
            }
            BlockValues::Uniform(_) | BlockValues::Each(_) => Ok(()),
        }
    }
}

impl<'a, T: Clone> BlockValues<'a, T> {
    /// Those of `count` cells from `first` on.
    pub fn part(&self, first: usize, count: usize) -> BlockValues<'a, T> {
        match self {
            BlockValues::Uniform(value) => BlockValues::Uniform(value.clone()),
            BlockValues::Each(values) => BlockValues::Each(&values[first..first + count]),
        }
    }

    /// The values of some cells; one if it is that of all cells.
    pub fn of_cells(&self, cells: &[usize]) -> Vec<T> {
        match self {
            BlockValues::Uniform(value) => vec![value.clone()],
            BlockValues::Each(values) => cells.iter().map(|&cell| values[cell].clone()).collect(),
        }
    }

    /// The values that [`BlockValues::of_cells`] lists.
    pub fn listed(values: &'a [T], is_uniform: bool) -> BlockValues<'a, T> {
        match values {
            [value] if is_uniform => BlockValues::Uniform(value.clone()),
            _ => BlockValues::Each(values),
        }
    }
}

impl<T> From<T> for CellMap<T> {
    fn from(value: T) -> CellMap<T> {
        CellMap::Uniform(value)
    }
}

impl<T: Clone> From<&CellMap<T>> for CellMap<T> {
    fn from(map: &CellMap<T>) -> CellMap<T> {
        map.clone()
    }
}

impl<T> From<T> for BlockValues<'_, T> {
    fn from(value: T) -> Self {
        BlockValues::Uniform(value)
    }
}

impl From<Moduli> for CellMap<Hooke> {
    fn from(moduli: Moduli) -> CellMap<Hooke> {
        CellMap::Uniform(moduli.into())
    }
}

impl From<Moduli> for BlockValues<'_, Hooke> {
    fn from(moduli: Moduli) -> Self {
        BlockValues::Uniform(moduli.into())
    }
}

impl<'a, T> From<&'a [T]> for BlockValues<'a, T> {
    fn from(values: &'a [T]) -> Self {
        BlockValues::Each(values)
    }
}
