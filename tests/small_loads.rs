//! Newton's method under loads of any size: the rounding of the internal forces is no end of it.

use crate::shapes::loaded;
use crate::shapes::statics::support_at;
use springfit_bodies::model::{Action, Body, Elastic, LengthSpring, Network, Support, finite_elements, nodal_forces};
use springfit_bodies::solve::{Ending, Equilibrium, Newton, System};
use springfit_element::material::{Energy, Material};
use springfit_element::springs::Springs;
use springfit_fit::fit::{Fit, Objective, Weight, fit_cells};
use springfit_mesh::mesh::{BoxMesh, Mesh, Selection};

fn block(name: &str, origin: f64) -> Mesh {
    let element = loaded(name);
    let d = element.dimension();
    BoxMesh { element, size: vec![1.0; d], cells: vec![2; d], origin: vec![origin; d] }.build().unwrap()
}

/// Held at one side, pulled at the other and along it by 1 Pa.
fn pulled(mesh: &Mesh) -> (Support, Vec<f64>) {
    let d = mesh.dimension;
    let support = support_at(mesh, &Selection::Group("xmin".into()).points(mesh).unwrap());
    let mut traction = vec![0.3; d];
    traction[0] = 1.0;
    let forces = nodal_forces(mesh, &Selection::Group("xmax".into()), &Action::traction(&traction), 1.0).unwrap();
    (support, forces)
}

fn network(mesh: &Mesh, material: Material) -> Network {
    let block = &mesh.blocks[0];
    let springs = Springs::select(&block.element, None).unwrap();
    let fit = Fit { nonnegative: true, ..Fit::new(Objective::Frobenius(Weight::None)) };
    let moduli = material.moduli();
    let fits = fit_cells(&block.element, &springs, &mesh.points, &block.connectivity, moduli, &fit, &mut |_| {});
    Network::assemble(mesh, &[fits.unwrap()])
}

/// The answer to a linear system of the model's tangent at rest.
fn linear(model: &dyn Elastic, mesh: &Mesh, support: &Support, forces: &[f64]) -> Vec<f64> {
    let system = System::new(&model.respond(&mesh.points).unwrap().tangent, support).unwrap();
    system.solve(&system.factorize().unwrap().unwrap(), forces).0
}

fn solved(model: &dyn Elastic, mesh: &Mesh, support: &Support, forces: &[f64], steps: usize) -> Equilibrium {
    Newton { steps, ..Newton::default() }.solve(model, &mesh.points, support, forces).unwrap()
}

fn away(a: &[f64], b: &[f64]) -> f64 {
    let largest = b.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

/// From 1e-14 to 1e-1 of the modulus each load has its equilibrium, away from the linear answer by a few times its strain, and where
/// that is nothing by the tolerance times the condition of these equations, far below 1e-8.
#[test]
fn loads_of_any_size_have_their_equilibrium() {
    let check = |what: &str, model: &dyn Elastic, mesh: &Mesh, young: f64| {
        let (support, unit) = pulled(mesh);
        let expected = linear(model, mesh, &support, &unit);
        for decade in 1..=14 {
            let share = 10f64.powi(-decade);
            let forces: Vec<f64> = unit.iter().map(|f| f * share * young).collect();
            let found = solved(model, mesh, &support, &forces, 1);
            assert_eq!((found.ending, found.load), (Ending::Converged, 1.0), "{what} {share:e}: {:?}", found.residuals);
            assert!(!found.is_rounded, "{what} {share:e}: {:?}", found.residuals);
            let wanted: Vec<f64> = expected.iter().map(|u| u * share * young).collect();
            let error = away(&found.displacement, &wanted);
            assert!(decade < 3 || error < 100.0 * share + 1e-8, "{what} {share:e}: {error:e}");
        }
    };
    for (name, laws) in [
        ("hex8", &["neo-hookean", "corotational", "mooney-rivlin", "stable-neo-hookean", "fung"][..]),
        ("tet10", &["neo-hookean"]),
        ("tet4", &["neo-hookean", "ogden"]),
        ("quad4", &["neo-hookean", "yeoh"]),
    ] {
        for (young, poisson) in [(2e11, 0.3), (1e3, 0.49), (1e-3, 0.0)] {
            let mesh = block(name, 0.0);
            let material = Material::for_body(mesh.dimension, young, poisson, None, None).unwrap();
            for law in laws {
                let energy = Energy::load(law, material).unwrap();
                let laws = (energy.clone(), material.state()).into();
                let body = Body::new(&mesh, &laws);
                check(&format!("{name} {law} {young} {poisson}"), &body, &mesh, young);
            }
            if name != "tet10" {
                check(&format!("network of {name} {young}"), &network(&mesh, material), &mesh, young);
            }
        }
    }
}

/// Far from the origin the positions have fewer digits; the displacements do not lose them.
#[test]
fn a_body_far_from_the_origin_is_as_exact() {
    let mesh = block("hex8", 1000.0);
    let material = Material::for_body(3, 2e11, 0.3, None, None).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let laws = (energy.clone(), material.state()).into();
    let body = Body::new(&mesh, &laws);
    let (support, unit) = pulled(&mesh);
    let expected = linear(&body, &mesh, &support, &unit);
    for load in [1.0, 1e5] {
        let forces: Vec<f64> = unit.iter().map(|f| load * f).collect();
        let found = solved(&body, &mesh, &support, &forces, 1);
        assert_eq!(found.ending, Ending::Converged, "{:?}", found.residuals);
        let wanted: Vec<f64> = expected.iter().map(|u| load * u).collect();
        assert!(away(&found.displacement, &wanted) < 1e-4, "{load}");
    }
}

/// Many steps are as many small loads; so are displacements of a size that nobody sees.
#[test]
fn small_steps_and_displacements_are_followed() {
    let mesh = block("tet4", 0.0);
    let material = Material::for_body(3, 1e4, 0.3, None, None).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let laws = (energy.clone(), material.state()).into();
    let body = Body::new(&mesh, &laws);
    let (support, unit) = pulled(&mesh);
    let forces: Vec<f64> = unit.iter().map(|f| 1e-3 * f).collect();
    let (whole, parts) = (solved(&body, &mesh, &support, &forces, 1), solved(&body, &mesh, &support, &forces, 300));
    assert_eq!((whole.ending, parts.ending), (Ending::Converged, Ending::Converged));
    assert!(parts.path.len() >= 300 && away(&parts.displacement, &whole.displacement) < 1e-8);
    let mut moved = support.clone();
    let free = vec![0.0; forces.len()];
    for p in Selection::Group("xmax".into()).points(&mesh).unwrap() {
        moved.prescribed[3 * p] = Some(1e-13);
    }
    let system = System::new(&finite_elements(&mesh, material.moduli()), &moved).unwrap();
    let expected = system.solve(&system.factorize().unwrap().unwrap(), &free).0;
    let found = solved(&body, &mesh, &moved, &free, 1);
    assert_eq!(found.ending, Ending::Converged, "{:?}", found.residuals);
    assert!(away(&found.displacement, &expected) < 1e-8);
    // No load at all is rest.
    let rest = solved(&body, &mesh, &support, &free, 1);
    assert_eq!(rest.ending, Ending::Converged, "{:?}", rest.residuals);
    assert!(rest.displacement.iter().all(|u| u.abs() < 1e-20));
}

/// Springs under tension at rest: two in a line of length one each, pulled across by so little that the tension alone resists,
/// `f = 2 T u / L`.
#[test]
fn tension_at_rest_is_not_lost() {
    let points = vec![-1.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    let lengths = [[0, 2], [1, 2]].map(|points| LengthSpring { points, constant: 1e6, rest: 0.9 }).into();
    let network = Network { dimension: 2, lengths, others: Vec::new() };
    let support = Support { prescribed: vec![Some(0.0), Some(0.0), Some(0.0), Some(0.0), None, None] };
    for load in [1e-6, 1e-2, 1.0] {
        let found = Newton::default().solve(&network, &points, &support, &[0.0, 0.0, 0.0, 0.0, 0.0, load]).unwrap();
        assert_eq!(found.ending, Ending::Converged, "{:?}", found.residuals);
        let expected = load / 2e5;
        assert!((found.displacement[5] / expected - 1.0).abs() < 1e-8, "{load}: {}", found.displacement[5]);
    }
}
