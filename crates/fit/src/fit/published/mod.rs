//! Spring constants by published formulas, with which fits are compared. They follow from the shape of a cell and the
//! material, without R.
//!
//! In the plane, E and ν are those of the plane, and E contains the thickness h: `E h` and ν in plane stress,
//! `E h/(1 − ν²)` and `ν/(1 − ν)` in plane strain.
//!
//! Theory: page *Least squares* of the book; each formula cites its paper.

mod baudet;
mod cell_shape;
mod corners;
mod delingette;
mod lloyd;
mod maciel;
mod method;
mod pattern;
mod quantity;
mod shape;
mod unmet;
mod van_gelder;

pub use cell_shape::Elasticity;
pub use corners::Joint;
pub use method::{Cover, Method, Ratio};
pub use quantity::Quantity;
pub use shape::Shape;
pub use unmet::{Unmet, unmet};

use super::cells::CellFits;
use super::input::check_cells;
use super::visit::each_cell;
use crate::element::{Cell, Element};
use crate::error::{Error, ErrorKind, Result};
use crate::material::{BlockValues, Material};
use crate::springs::{Springs, distance};
use cell_shape::CellShape;
use corners::Corners;
use pattern::Pattern;

/// The constants of all cells by a published method. `connectivity` is `[cells × nodes]` into `points`,
/// `[points × space]`, m.
///
/// The method uses those length springs in `springs` that it needs, and adds springs on its other measures: sums of two
/// lengths, distances of sides, the content. No spring pulls at rest.
///
/// # Errors
/// An array has a wrong length; a coordinate is not finite; the springs belong to another element; the method has no
/// formula for the cell of the element; the element has nodes other than corners; a length spring is missing; Poisson's
/// ratio is out of the method's range; the material has another dimension; or a cell is reversed, tangled or flat. A
/// cell of another [`Shape`] than the method assumes, or another Poisson's ratio, is not an error: [`unmet`] reports
/// it.
pub fn fit<'a>(
    method: Method,
    element: &Element,
    springs: &Springs,
    points: &[f64],
    connectivity: &[usize],
    material: impl Into<BlockValues<'a, Material>>,
) -> Result<CellFits> {
    fit_block(method, element, springs, points, connectivity, material.into())
}

/// [`fit`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn fit_block<'a>(
    method: Method,
    element: &Element,
    springs: &Springs,
    points: &[f64],
    connectivity: &[usize],
    material: BlockValues<'a, Material>,
) -> Result<CellFits> {
    springs.check(element)?;
    check_cells(element, points, connectivity)?;
    let cover = method.cover(element)?;
    let corners = Corners::of(element)?;
    material.check("material", connectivity.len() / element.nodes())?;
    let mut bulks = Vec::with_capacity(material.values().len());
    for material in material.values() {
        let bulk = Elasticity::of(element, *material)?;
        if let Ratio::AtLeast(least) = cover.poisson
            // The ratio of a plane state is a quotient, so that one at the bound is there up to rounding.
            && bulk.poisson < least - 1e-12
        {
            let expected = format!("a ratio of at least {least:.4} for {}", method.name());
            return Err(Error::expected("poisson", expected, bulk.poisson));
        }
        bulks.push(bulk);
    }
    let bulks = BlockValues::listed(&bulks, matches!(material, BlockValues::Uniform(_)));
    let Pattern { pairs, springs } = Pattern::new(method, cover, &corners, element, springs)?;
    let (m, d) = (springs.len(), element.dimension());
    let mut fits = CellFits::new(springs);
    fits.constants = vec![0.0; connectivity.len() / element.nodes() * m];
    let mut content = 0.0;
    each_cell(element, points, connectivity, 0, |cell, x, geometry| {
        let length = |&[a, b]: &[usize; 2]| distance(&x[a * d..(a + 1) * d], &x[b * d..(b + 1) * d]);
        let shape = CellShape {
            dimension: d,
            corners: &corners,
            pairs: &pairs,
            lengths: pairs.iter().map(length).collect(),
            content: geometry.content(),
        };
        content += shape.content;
        constants(method, cover.cell, &shape, bulks.at(cell), &mut fits.constants[cell * m..(cell + 1) * m]);
    })?;
    // This constant follows from the content of the whole body, which is known only after all cells.
    if method == Method::MacielUniform {
        let BlockValues::Uniform(bulk) = &bulks else {
            let expected = "one material in all cells: the method has one constant for the whole body";
            return Err(Error::expected(method.name(), expected, "several").of_kind(ErrorKind::Unsupported));
        };
        maciel::constants(&fits.springs, points, connectivity, content, bulk, &mut fits.constants);
    }
    Ok(fits)
}

/// The constants of one cell by a published method in any kind of number, with the springs that it uses. `springs` are those
/// that are offered; `length` gives the distance of two nodes in m, `content` is the area or volume in m² or m³.
///
/// # Errors
/// Those of [`fit`] that concern the element and its springs; or the constants depend on other cells.
pub fn constants_of_cell<T: Quantity>(
    method: Method,
    element: &Element,
    springs: &Springs,
    length: impl Fn([usize; 2]) -> T,
    content: T,
    bulk: &Elasticity<T>,
) -> Result<(Springs, Vec<T>)> {
    springs.check(element)?;
    let cover = method.cover(element)?;
    let corners = Corners::of(element)?;
    if method == Method::MacielUniform {
        let problem = "scales its constant with all cells of a body";
        return Err(Error::at(method.name(), problem).of_kind(ErrorKind::Unsupported));
    }
    let Pattern { pairs, springs } = Pattern::new(method, cover, &corners, element, springs)?;
    let mut k = vec![content.clone(); springs.len()];
    let lengths = pairs.iter().map(|&pair| length(pair)).collect();
    let shape = CellShape { dimension: element.dimension(), corners: &corners, pairs: &pairs, lengths, content };
    constants(method, cover.cell, &shape, bulk, &mut k);
    Ok((springs, k))
}

/// Writes the constants of one cell, `[springs]`; nothing if they depend on other cells.
fn constants<T: Quantity>(method: Method, cell: Cell, shape: &CellShape<T>, bulk: &Elasticity<T>, k: &mut [T]) {
    let (own, more) = k.split_at_mut(shape.pairs.len());
    match (method, cell) {
        (Method::VanGelder, Cell::Triangle) => van_gelder::triangle(shape, bulk, own),
        (Method::VanGelder | Method::VanGelderSimple, _) => van_gelder::simple(shape, bulk, own),
        (Method::Lloyd | Method::LloydPreserving, _) => {
            match cell {
                Cell::Triangle => lloyd::triangle(bulk, own),
                Cell::Quadrilateral => lloyd::quadrilateral(shape, bulk, own),
                _ => lloyd::tetrahedron(shape, bulk, own),
            }
            more.fill(lloyd::preserving(shape, bulk));
        }
        (Method::Baudet | Method::BaudetCorrected, _) => {
            match cell {
                Cell::Quadrilateral => baudet::rectangle(shape, bulk, own),
                _ => baudet::cube(shape, bulk, own),
            }
            if !more.is_empty() {
                baudet::correction(shape, bulk, more);
            }
        }
        (Method::DelingetteQuadratic, _) => delingette::quadratic(shape, bulk, k),
        (Method::DelingetteBiquadratic, _) => delingette::biquadratic(shape, bulk, k),
        (Method::MacielUniform, _) => {}
    }
}
