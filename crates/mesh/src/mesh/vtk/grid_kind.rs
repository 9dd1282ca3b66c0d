//! The kinds of grid in XML files, and where a regular one is.

use super::image::Image;
use super::lattice::Lattice;
use super::xml_tag::{Tag, number, shown_value};
use crate::error::{Error, Result};

/// What `VTKFile.type` names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum GridKind {
    #[default]
    Unstructured,
    Polygonal,
    Image,
    Structured,
    Rectilinear,
}

// The names of their tags.
crate::named!(GridKind {
    "UnstructuredGrid" => Unstructured,
    "PolyData" => Polygonal,
    "ImageData" => Image,
    "StructuredGrid" => Structured,
    "RectilinearGrid" => Rectilinear,
});

impl GridKind {
    /// The kind with this name.
    ///
    /// # Errors
    /// No kind that is read has it.
    pub fn called(name: Option<String>) -> Result<GridKind> {
        let found = GridKind::all().find(|kind| Some(kind.name()) == name.as_deref());
        let names = GridKind::NAMES.join(", ");
        found.ok_or_else(|| Error::expected("VTKFile.type", format!("one of {names}"), shown_value(name)))
    }

    /// Whether the cells are those of a lattice.
    pub fn is_lattice(self) -> bool {
        matches!(self, GridKind::Image | GridKind::Structured | GridKind::Rectilinear)
    }
}

/// The points of a piece of a lattice.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    first: [i64; 3],
    pub lattice: Lattice,
}

impl Extent {
    /// The attribute `Extent` of a piece.
    ///
    /// # Errors
    /// It is missing, or no box.
    pub fn read(tag: &Tag) -> Result<Extent> {
        let numbers =
            numbers::<i64, 6>(tag, "Extent", "six whole numbers, the first and the last point along each axis")?
                .ok_or_else(|| Error::expected("Piece.Extent", "six whole numbers", "none"))?;
        let count = |k: usize| numbers[2 * k + 1].checked_sub(numbers[2 * k]).and_then(|count| count.checked_add(1));
        let counts = std::array::from_fn(|k| count(k).and_then(|count| u64::try_from(count).ok()).unwrap_or(0));
        let lattice = Lattice::new(counts).map_err(|error| error.under("Piece.Extent"))?;
        Ok(Extent { first: [numbers[0], numbers[2], numbers[4]], lattice })
    }

    /// The box of the extents of all pieces, whose cells fill it.
    ///
    /// # Errors
    /// There are fewer or more cells than places.
    pub fn around(pieces: &[Extent]) -> Result<Extent> {
        let last = |extent: &Extent, k: usize| extent.first[k] + (extent.lattice.0[k] as i64 - 1);
        let low: [i64; 3] = std::array::from_fn(|k| pieces.iter().map(|extent| extent.first[k]).min().unwrap_or(0));
        let high: [i64; 3] = std::array::from_fn(|k| pieces.iter().map(|extent| last(extent, k)).max().unwrap_or(0));
        let count = |k: usize| u64::try_from(high[k].checked_sub(low[k])?.checked_add(1)?).ok();
        let lattice = Lattice::new(std::array::from_fn(|k| count(k).unwrap_or(0)));
        let whole = Extent { first: low, lattice: lattice.map_err(|error| error.under("Piece.Extent"))? };
        let (places, found) = (whole.lattice.cell_count(), pieces.iter().map(|extent| extent.lattice.cell_count()));
        let found = found.fold(0, usize::saturating_add);
        if places != found {
            let expected = format!("pieces whose cells fill {:?} to {high:?}, which are {places}", low);
            return Err(Error::expected("Piece.Extent", expected, format!("{found} cells")));
        }
        Ok(whole)
    }

    /// The index among the cells or points of this extent of each of those of a piece.
    pub fn places_of(&self, piece: &Extent, is_of_cells: bool) -> impl Iterator<Item = usize> {
        let counts = |extent: &Extent| if is_of_cells { extent.lattice.cells() } else { extent.lattice.0 };
        let (whole, own) = (counts(self), counts(piece));
        let shift: [usize; 3] = std::array::from_fn(|k| (piece.first[k] - self.first[k]) as usize);
        (0..own.iter().product()).map(move |index| {
            let at = Lattice::place(own, index);
            let [x, y, z] = std::array::from_fn(|k| at[k] + shift[k]);
            (z * whole[1] + y) * whole[0] + x
        })
    }

    /// The place of the points, of which `grid` has those of the whole image.
    pub fn image(&self, grid: &Regular) -> Image {
        let steps: [[f64; 3]; 3] =
            std::array::from_fn(|k| std::array::from_fn(|axis| grid.direction[3 * axis + k] * grid.spacing[k]));
        let origin = std::array::from_fn(|axis| {
            (0..3).fold(grid.origin[axis], |x, k| x + self.first[k] as f64 * steps[k][axis])
        });
        Image { lattice: self.lattice, origin, steps }
    }
}

/// Where the points of an image are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Regular {
    origin: [f64; 3],
    spacing: [f64; 3],
    direction: [f64; 9],
}

impl Default for Regular {
    fn default() -> Regular {
        Regular { origin: [0.0; 3], spacing: [1.0; 3], direction: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0] }
    }
}

impl Regular {
    /// The attributes of `ImageData`.
    ///
    /// # Errors
    /// One is no list of numbers.
    pub fn read(tag: &Tag) -> Result<Regular> {
        let usual = Regular::default();
        Ok(Regular {
            origin: numbers(tag, "Origin", "three numbers")?.unwrap_or(usual.origin),
            spacing: numbers(tag, "Spacing", "three numbers")?.unwrap_or(usual.spacing),
            direction: numbers(tag, "Direction", "nine numbers")?.unwrap_or(usual.direction),
        })
    }
}

/// The counts of the four kinds of cells of a piece of polygons; a missing one is zero.
///
/// # Errors
/// One is no whole number.
pub(super) fn polygon_counts(tag: &Tag) -> Result<[u64; 4]> {
    let count = |name: &str| tag.attribute(name).map_or(Ok(0), |_| number(tag, name));
    Ok([count("NumberOfVerts")?, count("NumberOfLines")?, count("NumberOfPolys")?, count("NumberOfStrips")?])
}

/// An attribute of `N` numbers, if there is one.
fn numbers<T: std::str::FromStr + Copy, const N: usize>(
    tag: &Tag,
    name: &str,
    expected: &str,
) -> Result<Option<[T; N]>> {
    let Some(text) = tag.attribute(name) else { return Ok(None) };
    let values: Option<Vec<T>> = text.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
    let array = values.and_then(|values| <[T; N]>::try_from(values).ok());
    array.map(Some).ok_or_else(|| Error::expected(name, expected, shown_value(Some(text))))
}
