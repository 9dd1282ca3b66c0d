//! The sampled fit: its limit for small shapes, its optimality, what it does for a body pulled by a third of its length.

mod shapes;

use nalgebra::{DMatrix, DVector};
use shapes::{Random, distorted};
use springfit::element::Element;
use springfit::fit::{CellFits, Fit, Objective, SampledFits, Sampling, Weight, fit_cells, fit_sampled};
use springfit::material::{Energy, Material, State};
use springfit::mesh::{BoxMesh, Mesh, Selection};
use springfit::model::{Action, Body, Elastic, Network, Support, nodal_forces};
use springfit::solve::{Ending, Newton};
use springfit::springs::Springs;
use springfit::stiffness::Geometry;
use springfit::study::displacement_error;
use std::sync::Arc;

fn every(element: &Element) -> Vec<String> {
    element.springs.iter().map(|g| g.name.clone()).collect()
}

fn sampled(
    element: &Arc<Element>,
    springs: &Springs,
    x: &[f64],
    law: &str,
    sampling: &Sampling,
    bounded: bool,
) -> SampledFits {
    let material = Material::for_body(element.dimension(), 1.0, 0.3, None, None).unwrap();
    let energy = Energy::load(law, material).unwrap();
    let cells: Vec<usize> = (0..element.nodes()).collect();
    fit_sampled(element, springs, x, &cells, &energy, material.state(), sampling, bounded).unwrap()
}

/// For shapes that shrink to rest the forces become `R u` and `g_s g_sᵀ u`, and the fit that of the tangents with the weight
/// `U = Σ u uᵀ` of the displacements sampled: `min Σ_q ‖(R − K) u_q‖²`. The difference falls with the size of the shapes.
#[test]
fn small_shapes_give_the_fit_of_the_tangent() {
    for name in ["tri3", "quad4", "tet4"] {
        let element = Arc::new(Element::load(name).unwrap());
        let springs = Springs::select(&element, None).unwrap();
        let x = distorted(&element, &mut Random(4));
        let d = element.dimension();
        let material = Material::for_body(d, 1.0, 0.3, None, None).unwrap();
        let energy = Energy::load("neo-hookean", material).unwrap();
        let mut geometry = Geometry::new(&element.tabulation);
        geometry.set(&element.tabulation, &x).unwrap();
        let r = geometry.stiffness(material.moduli());
        let mut g = Vec::new();
        springs.gradients(&x, &geometry, &mut g);
        let at = |size: f64| {
            let sampling = Sampling { shapes: 400, held_out: 0, stretch: size, perturbation: size, seed: 3 };
            let cells: Vec<usize> = (0..element.nodes()).collect();
            fit_sampled(&element, &springs, &x, &cells, &energy, material.state(), &sampling, false).unwrap().constants
        };
        // The weight of evenly filled cubes: F − I and the nodes' moves, each with the variance of its size.
        let size = x.len();
        let extent = geometry.content().powf(1.0 / d as f64);
        let mut weight = DMatrix::<f64>::identity(size, size) * extent * extent;
        for k in 0..d {
            for l in 0..d {
                let u = DVector::from_fn(size, |i, _| if i % d == k { x[i / d * d + l] } else { 0.0 });
                weight += &u * u.transpose();
            }
        }
        let m = springs.len();
        let rows: Vec<DVector<f64>> = g.chunks_exact(size).map(DVector::from_column_slice).collect();
        let gram = DMatrix::from_fn(m, m, |s, t| rows[s].dot(&rows[t]) * (rows[s].transpose() * &weight * &rows[t])[0]);
        let rhs = DVector::from_fn(m, |s, _| (rows[s].transpose() * &r * &weight * &rows[s])[0]);
        let expected = gram.lu().solve(&rhs).unwrap();
        let error =
            |k: &[f64]| k.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / expected.amax();
        // A thousandth of the size, and what 400 shapes leave of evenness.
        assert!(error(&at(1e-5)) < 0.05, "{name}: {}", error(&at(1e-5)));
        let (small, smaller) = (at(1e-3), at(1e-5));
        let change = small.iter().zip(&smaller).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / expected.amax();
        assert!(change < 5e-3 && change > 1e-9, "{name}: {change}");
    }
}

/// No other constants do better on the shapes of the fit; bounded ones are not below zero; a seed repeats itself.
#[test]
fn the_fit_is_the_least_of_its_sum() {
    for name in ["tri3", "quad4", "tet4", "hex8"] {
        let element = Arc::new(Element::load(name).unwrap());
        let springs = Springs::select(&element, Some(&every(&element))).unwrap();
        let x = distorted(&element, &mut Random(8));
        for law in ["neo-hookean", "corotational", "ogden"] {
            let sampling = Sampling::default();
            let free = sampled(&element, &springs, &x, law, &sampling, false);
            let bounded = sampled(&element, &springs, &x, law, &sampling, true);
            assert_eq!(free, sampled(&element, &springs, &x, law, &sampling, false));
            assert!(bounded.constants.iter().all(|k| *k >= 0.0));
            assert!(free.trained[0] <= bounded.trained[0] + 1e-12 && free.trained[0] < 1.0, "{name} {law}");
            // Shapes that were not seen are as well fitted as those that were, nearly.
            let ratio = free.held_out[0] / free.trained[0];
            assert!((0.7..1.5).contains(&ratio), "{name} {law}: {ratio}");
        }
    }
}

#[test]
fn samplings_out_of_range_are_told() {
    let element = Arc::new(Element::load("tri3").unwrap());
    let springs = Springs::select(&element, None).unwrap();
    let material = Material::for_body(2, 1.0, 0.3, None, None).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let x = element.positions.clone();
    for (sampling, error) in [
        (Sampling { shapes: 0, ..Sampling::default() }, "shapes: expected at least one shape, found 0"),
        (Sampling { stretch: 3.0, ..Sampling::default() }, "stretch: expected a share from 0 to 2, found 3"),
        (
            Sampling { stretch: 0.0, perturbation: 0.0, ..Sampling::default() },
            "stretch: expected shapes that differ from the one at rest, found none",
        ),
    ] {
        let found = fit_sampled(&element, &springs, &x, &[0, 1, 2], &energy, material.state(), &sampling, false);
        assert_eq!(found.unwrap_err().to_string(), error);
    }
}

/// A neo-Hookean cube of tetrahedra pulled by more than a third: springs fitted to forces at shapes of that size follow it
/// better than springs fitted to the stiffness at rest, of which the best is taken. On hexahedra linear springs do not: what
/// they lack there is another law of force.
#[test]
fn sampled_springs_follow_large_stretches() {
    let element = Arc::new(Element::load("tet4").unwrap());
    let mesh: Mesh = BoxMesh { element, size: vec![1.0; 3], cells: vec![3; 3], origin: vec![0.0; 3] }.build().unwrap();
    let block = &mesh.blocks[0];
    let material = Material::new(1.0, 0.3, State::Solid).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let mut support = Support::free(&mesh);
    support.fix(&Selection::Group("zmin".into()).points(&mesh).unwrap(), &[0, 1, 2], 3);
    let pull = Action::Traction(vec![0.0, 0.0, 0.35]);
    let forces = nodal_forces(&mesh, &Selection::Group("zmax".into()), &pull, 1.0).unwrap();
    let newton = Newton { steps: 2, ..Newton::default() };
    let solve = |model: &dyn Elastic| {
        let found = newton.solve(model, &mesh.points, &support, &forces).unwrap();
        assert_eq!(found.ending, Ending::Converged, "{:?}", found.residuals);
        found.displacement
    };
    let body = solve(&Body { mesh: &mesh, energy: &energy, state: State::Solid });
    let stretch = body.iter().skip(2).step_by(3).fold(0.0f64, |a, u| a.max(*u));
    assert!((0.3..0.6).contains(&stretch), "{stretch}");
    let error = |fits: CellFits| {
        let u = solve(&Network::assemble(&mesh, &[fits]));
        displacement_error(&body, &u, 3).unwrap().rms
    };
    for names in [None, Some(every(&block.element))] {
        let springs = Springs::select(&block.element, names.as_deref()).unwrap();
        let (points, cells) = (&mesh.points, &block.connectivity);
        let linear = |objective: Objective| {
            let fit = Fit { nonnegative: true, ..Fit::new(objective) };
            fit_cells(&block.element, &springs, points, cells, material.moduli(), &fit, &mut |_| {}).unwrap()
        };
        let plain = Objective::Frobenius(Weight::None);
        let best = [plain, Objective::Frobenius(Weight::OffDiagonal), Objective::Divergence { balance: 0.25 }]
            .map(|objective| error(linear(objective)))
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        let sampling = Sampling { stretch: 0.3, perturbation: 0.02, ..Sampling::default() };
        let fits =
            fit_sampled(&block.element, &springs, points, cells, &energy, State::Solid, &sampling, true).unwrap();
        let sampled = error(CellFits { constants: fits.constants, ..linear(plain) });
        println!("{} springs: best of the linear theory {best:.2}, sampled {sampled:.2}", springs.len());
        assert!(sampled < best, "sampled {sampled}, best of the linear theory {best}");
    }
}
