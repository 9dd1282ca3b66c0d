//! The constants of published formulas, as code: the formulas of the kernels run on values.
//!
//! Theory: page *Least squares* of the book.

use super::{Cell, Index, Room, Status, Value, dot};
use crate::error::Result;
use crate::fit::published::{Elasticity, Method, Ratio, constants_of_cell};
use crate::material::Moduli;
use crate::springs::Springs;

/// Writes the constants of one cell, `[springs]`; `offered` are the springs from which the method takes those that it needs.
///
/// # Errors
/// The method has no formula for the element, or a spring is missing.
pub fn published(cell: &Cell, method: Method, offered: &Springs, lambda: &Value, mu: &Value) -> Result<Room> {
    let body = &cell.body;
    let cover = method.cover(cell.element)?;
    // In the plane, these are the constants of the plane: of plane stress and plane strain alike.
    let poisson = match cell.dimension() {
        2 => lambda / &(&(mu + mu) + lambda),
        _ => lambda / &(&(lambda + mu) + &(lambda + mu)),
    };
    let young = &(mu + mu) * &(&poisson + &body.number(1.0));
    if let Ratio::AtLeast(least) = cover.poisson {
        // A few roundings below it are allowed, as by the library.
        body.fail_with(Status::Moduli);
        body.guard(&poisson, &body.number(least - 1e-12));
    }
    let mut content = Room::new(body, "content", 1, !cell.plan.points);
    cell.each_point(|_, geometry| content.add(body, 0, &geometry.volumes[0]));
    let length = |[i, j]: [usize; 2]| {
        let edge = cell.edge(&Index::from(i), &Index::from(j));
        dot(&edge, &edge).root()
    };
    let bulk = Elasticity { young, poisson, moduli: Moduli { lambda: lambda.clone(), mu: mu.clone() } };
    let (_, constants) = constants_of_cell(method, cell.element, offered, length, content.get(body, 0), &bulk)?;
    Ok(Room::Values(constants))
}
