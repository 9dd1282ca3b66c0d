//! Stiff motions, and elements that are stretched to twice their length or compressed to nothing.

use super::elements::PROMISED;
use super::outcome::{Family, StabilityRow, Verdict, worst};
use crate::dynamics::{Integrator, LinearSolver, Motion, Options, Simulation};
use crate::element::Element;
use crate::error::Result;
use crate::material::{Energy, Material, State};
use crate::model::{LengthSpring, Network};
use crate::stiffness::Geometry;
use nalgebra::{Complex, Matrix3};

/// The time steps, s.
const STEPS: [f64; 4] = [1e-6, 1e-4, 1e-2, 1.0];
/// The ratios of stiffness to mass, 1/s².
const SQUARES: [f64; 5] = [1.0, 1e4, 1e8, 1e12, 1e14];
/// The number of steps of each motion.
const COUNT: i32 = 40;
/// The lengths of the compressed or stretched body, relative to that at rest.
const LENGTHS: [f64; 7] = [2.0, 1.5, 0.5, 0.1, 1e-3, 1e-6, 0.0];

/// Stiff motions of two masses, and the straight elements among `elements` under stretch and compression.
///
/// # Errors
/// None but those of shipped files, which are tested.
pub fn sweep_motions(elements: &[Element]) -> Result<Vec<StabilityRow>> {
    let mut rows = Vec::new();
    for square in SQUARES {
        for step in STEPS {
            for (kind, masses) in [("alike", [1.0, 1.0]), ("1e-9 and 1e3 kg", [1e-9, 1e3])] {
                for solver in [LinearSolver::Factor, LinearSolver::ConjugateGradients { tolerance: 1e-14 }] {
                    rows.push(implicit(square, step, kind, masses, solver));
                }
                rows.push(explicit(square, step, kind, masses));
            }
        }
    }
    for element in elements.iter().filter(|element| element.has_corners_alone()) {
        rows.extend(collapse(element)?);
    }
    Ok(rows)
}

/// Two masses on a spring with `k/m = square`, where m is the reduced mass.
fn pair(square: f64, masses: [f64; 2]) -> Network {
    let reduced = 1.0 / (1.0 / masses[0] + 1.0 / masses[1]);
    let lengths = vec![LengthSpring { points: [0, 1], constant: square * reduced, rest: 1.0 }];
    Network { dimension: 2, lengths, others: Vec::new() }
}

fn case(square: f64, step: f64, kind: &str) -> String {
    format!("k/m = {square:.0e}/s2, step {step:.0e} s, masses {kind}")
}

/// Implicit Euler on a spring that is stretched by one, compared with its closed form `Re (1 − iωh)⁻ⁿ`.
fn implicit(square: f64, step: f64, kind: &str, masses: [f64; 2], solver: LinearSolver) -> StabilityRow {
    let method = match solver {
        LinearSolver::Factor => "implicit Euler, factor",
        LinearSolver::ConjugateGradients { .. } => "implicit Euler, conjugate gradients",
    };
    let of = |verdict| StabilityRow::new("two masses", Family::Motion, &case(square, step, kind), method, verdict);
    let network = pair(square, masses);
    let points = [0.0, 0.0, 1.0, 0.0];
    let options = Options { step, integrator: Integrator::ImplicitEuler, linear: true, solver, ..Options::default() };
    let mut simulation = match Simulation::new(Motion::free(&network, &points, &masses), options) {
        Ok(simulation) => simulation,
        Err(e) => return of(Verdict::Refused(e.to_string())).with_way_out("take a shorter step"),
    };
    let share = masses[1] / (masses[0] + masses[1]);
    let stretch = 1e-3;
    // The centre of mass is at rest, so that the spring alone moves the masses.
    let start = [-share * stretch, 0.0, (1.0 - share) * stretch, 0.0];
    if let Err(e) = simulation.start(&start, &[0.0; 4]) {
        return of(Verdict::Refused(e.to_string())).with_way_out("take a shorter step");
    }
    let (mut errors, mut iterations) = (Vec::new(), 0);
    // A step of implicit Euler divides the complex amplitude, whose real part is the stretch, by `1 − iωΔt`.
    let root = Complex::new(1.0, -step * square.sqrt());
    for n in 1..=COUNT {
        iterations += simulation.step().solver_iterations;
        let u = &simulation.state().displacement;
        let exact = root.powi(-n).re;
        errors.push(((u[2] - u[0]) / stretch - exact).abs());
    }
    let error = worst(errors);
    let mut row = of(judge(error)).with_error(error, PROMISED);
    row.iterations = Some(iterations);
    row.step = Some(simulation.longest_step());
    row
}

/// Symplectic Euler: refused beyond its limit, and bounded within it.
fn explicit(square: f64, step: f64, kind: &str, masses: [f64; 2]) -> StabilityRow {
    let of = |verdict| {
        StabilityRow::new("two masses", Family::Motion, &case(square, step, kind), "symplectic Euler", verdict)
    };
    let network = pair(square, masses);
    let points = [0.0, 0.0, 1.0, 0.0];
    let options = Options { step, integrator: Integrator::SymplecticEuler, ..Options::default() };
    // Symplectic Euler is stable up to `2/ω`, with `ω² = k/m`.
    let limit = 2.0 / square.sqrt();
    match Simulation::new(Motion::free(&network, &points, &masses), options) {
        // The limit of the program is an upper bound of ω, so that it refuses steps up to a thousandth early.
        Err(e) if step > 0.999 * limit => of(Verdict::Refused(e.to_string()))
            .with_way_out("take the step that the error names, or an implicit integrator"),
        Err(_) => of(Verdict::Lost),
        Ok(_) if step > 1.001 * limit => of(Verdict::Lost),
        Ok(simulation) => {
            let longest = simulation.longest_step();
            let error = (longest / limit - 1.0).abs();
            // The limit is an upper bound with an error of a thousandth.
            let mut row = of(if error <= 1e-3 { Verdict::Accurate } else { Verdict::Lost }).with_error(error, 1e-3);
            row.step = Some(longest);
            row
        }
    }
}

/// An element of a neo-Hookean material under uniform stretch along x, its energy compared with `W(F) V`; it is
/// compressed down to zero length.
fn collapse(element: &Element) -> Result<Vec<StabilityRow>> {
    let d = element.dimension();
    let plane = (d == 2).then_some(crate::material::Plane::Strain);
    let material = Material::for_body(d, 10e3, 0.3, plane, None)?;
    let energy = Energy::load("neo-hookean", material)?;
    let state = if d == 2 { State::PlaneStrain { thickness: 1.0 } } else { State::Solid };
    let mut geometry = Geometry::new(&element.tabulation);
    let rest = &element.positions;
    if geometry.set(&element.tabulation, rest).is_err() {
        return Ok(Vec::new());
    }
    let volume = geometry.content();
    let row = |length: f64| {
        let name = format!("to {length} of its length");
        let of = |verdict| StabilityRow::new(&element.name, Family::Collapse, &name, "neo-Hookean", verdict);
        let x: Vec<f64> = rest.iter().enumerate().map(|(i, x)| if i % d == 0 { length * x } else { *x }).collect();
        let mut f = Matrix3::identity();
        f[(0, 0)] = length;
        let exact = volume * energy.respond(&f).0;
        match geometry.respond(&energy, state, &x) {
            None if exact.is_finite() => of(Verdict::Lost),
            None => of(Verdict::Refused("no response: the energy is not finite".into()))
                .with_way_out("load in smaller steps, so that no cell loses its content"),
            Some(found) => {
                let finite = found.force.iter().chain(found.tangent.iter()).all(|v| v.is_finite());
                let error = if finite { (found.energy - exact).abs() / exact.abs() } else { f64::INFINITY };
                of(judge(error)).with_error(error, PROMISED)
            }
        }
    };
    Ok(LENGTHS.into_iter().map(row).collect())
}

fn judge(error: f64) -> Verdict {
    if error <= PROMISED { Verdict::Accurate } else { Verdict::Lost }
}
