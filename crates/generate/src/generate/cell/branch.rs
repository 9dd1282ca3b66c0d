//! A branch whose stress relaxes at large deformation, as code: constants of springs between all pairs of nodes that relax towards those of the
//! present shape, `k_ab = −μ Σ_q V₀ J^(2/3) ∇_x N_a·∇_x N_b`, and a content that does not relax.
//!
//! Theory: page *Springs that forget* of the book.

use super::{Cell, Index, Role, Room, Value, dot};

/// Writes the cube roots of the volumes at rest of the quadrature points, and `mean k_ab` of the shape at rest.
pub fn branch(cell: &Cell) {
    let (body, points, pairs) = (&cell.body, cell.element.tabulation.points(), cell.springs.pairs().len());
    let [mu, mean] = ["mu", "mean"].map(|name| body.parameter(name));
    let sizes = body.array("sizes", points, Role::Output);
    let state = body.array("branch", pairs, Role::Output);
    let mut roots = Room::new(body, "roots", points, !cell.plan.points);
    let mut present = Present::new(cell);
    let factor = &mu * &mean;
    cell.each_point(|q, geometry| {
        let volume = cell.volumes(geometry)[0].clone();
        roots.set(body, q, &volume.power(1.0 / 3.0));
        present.add(cell, &geometry.gradients, &(&factor * &volume));
    });
    present.guard(cell);
    body.each(cell.plan.points, 0, points, |q| body.store(sizes, q, &roots.get(body, q)));
    body.each(cell.plan.springs, 0, pairs, |s| body.store(state, s, &present.constants.get(body, s)));
}

/// Writes the forces of the branch on the nodes, and its constants after the step: `left k_ab + taken k_ab(x)`.
pub fn relax(cell: &Cell) {
    let (body, d) = (&cell.body, cell.dimension());
    let (points, pairs, size) = (cell.element.tabulation.points(), cell.springs.pairs().len(), cell.x.len());
    let sizes = body.array("sizes", points, Role::Input);
    let state = body.array("branch", pairs, Role::Input);
    let [mu, mean, left, taken] = ["mu", "mean", "left", "taken"].map(|name| body.parameter(name));
    let forces = body.array("forces", size, Role::Output);
    let relaxed = body.array("relaxed", pairs, Role::Output);
    // An array is needed where either loop is one in the code: its index is not known while the code is written.
    let unrolled = cell.plan.springs && cell.plan.points;
    let mut sums = Room::new(body, "forces_of_cell", size, !unrolled);
    let mut present = Present::new(cell);
    cell.each_point(|q, geometry| {
        let volume = cell.volumes(geometry)[0].clone();
        // V₀ J^(2/3) = V₀^(1/3) V^(2/3).
        let factor = &(&mu * &body.entry(sizes, q)) * &volume.power(2.0 / 3.0);
        present.add(cell, &geometry.gradients, &factor);
        let push = &factor * &mean;
        body.each(cell.plan.springs, 0, size, |i| sums.add(body, i, &(&push * &present.gradients.get(body, i))));
    });
    cell.each_length(|s, i, j| {
        let constant = body.entry(state, s);
        for (k, e) in cell.edge(i, j).iter().enumerate() {
            let share = &constant * e;
            sums.add(body, &(i * d) + k, &share);
            sums.add(body, &(j * d) + k, &share.negated());
        }
    });
    present.guard(cell);
    body.each(unrolled, 0, size, |i| body.store(forces, i, &sums.get(body, i)));
    body.each(cell.plan.springs, 0, pairs, |s| {
        let after = &(&left * &body.entry(state, s)) + &(&taken * &present.constants.get(body, s));
        body.store(relaxed, s, &after);
    });
}

/// The constants of the present shape.
struct Present {
    constants: Room,
    gradients: Room,
}

impl Present {
    fn new(cell: &Cell) -> Present {
        let (body, plan) = (&cell.body, cell.plan);
        let pairs = cell.springs.pairs().len();
        Present {
            constants: Room::new(body, "present", pairs, !(plan.springs && plan.points)),
            gradients: Room::unset(body, "gradients", cell.x.len(), !plan.springs),
        }
    }

    /// Adds `−factor ∇N_a·∇N_b` of a point.
    fn add(&mut self, cell: &Cell, gradients: &[Value], factor: &Value) {
        let (body, d) = (&cell.body, cell.dimension());
        gradients.iter().enumerate().for_each(|(i, g)| self.gradients.set(body, i, g));
        let Present { constants, gradients } = self;
        let gradient = |a: &Index| -> Vec<Value> { (0..d).map(|k| gradients.get(body, &(a * d) + k)).collect() };
        let factor = factor.negated();
        cell.each_length(|s, i, j| constants.add(body, s, &(&factor * &dot(&gradient(i), &gradient(j)))));
    }

    /// Ends the function unless all are numbers.
    fn guard(&self, cell: &Cell) {
        let body = &cell.body;
        let mut sum = Room::new(body, "sum", 1, !cell.plan.springs);
        body.each(cell.plan.springs, 0, cell.springs.pairs().len(), |s| {
            let constant = self.constants.get(body, s);
            sum.add(body, 0, &constant.call(crate::symbolic::Function::Abs));
        });
        cell.guard_finite(&sum.get(body, 0));
    }
}
