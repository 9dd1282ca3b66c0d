//! A cube of springs in a tensile test: fits to the test alone and to other shapes.

use super::{fit, markdown};
use nalgebra::Matrix3;
use springfit_bodies::model::{Elastic, Network};
use springfit_element::element::Element;
use springfit_element::material::{Energy, EnergyMap, Material};
use springfit_element::stiffness::Hyperelastic;
use springfit_mesh::mesh::{BoxMesh, Mesh};
use springfit_studies::study::{FitEntry, LargeBody, Reference, fit_without_errors};
use std::sync::Arc;
use toml::Value;

const POISSON: f64 = 0.3;
/// The stretches of the test.
const STRETCHES: [f64; 11] = [0.8, 0.85, 0.9, 0.95, 0.98, 1.02, 1.05, 1.1, 1.15, 1.2, 1.3];

/// The zero of a function that rises, between these two.
fn zero(of: impl Fn(f64) -> f64, mut below: f64, mut above: f64) -> f64 {
    for _ in 0..100 {
        let middle = 0.5 * (below + above);
        if of(middle) > 0.0 { above = middle } else { below = middle }
    }
    0.5 * (below + above)
}

fn stress(energy: &Energy, f: Matrix3<f64>) -> Matrix3<f64> {
    let mut all = [f];
    energy.stresses(springfit_element::material::State::Solid, &mut all).unwrap();
    all[0]
}

/// The lateral stretch with free sides and the nominal stress of the law.
fn of_law(energy: &Energy, along: f64) -> [f64; 2] {
    let at = |beside: f64| Matrix3::from_diagonal(&[along, beside, beside].into());
    let beside = zero(|beside| stress(energy, at(beside))[(1, 1)], 0.5, 1.5);
    [beside, stress(energy, at(beside))[(0, 0)]]
}

/// The forces of the springs of the unit cube at `F x`.
fn forces(network: &Network, mesh: &Mesh, f: &Matrix3<f64>) -> Vec<f64> {
    let place = |x: &[f64]| (0..3).map(|k| (0..3).map(|l| f[(k, l)] * x[l]).sum::<f64>()).collect::<Vec<_>>();
    network.respond(&mesh.points.chunks_exact(3).flat_map(place).collect::<Vec<_>>()).unwrap().force
}

/// The nominal stress of the springs: `Σ f xᵀ` over the nodes of the unit cube.
fn stress_of_springs(network: &Network, mesh: &Mesh, f: &Matrix3<f64>) -> Matrix3<f64> {
    let own = forces(network, mesh, f);
    let each = own.chunks_exact(3).zip(mesh.points.chunks_exact(3));
    each.map(|(f, x)| Matrix3::from_fn(|k, l| f[k] * x[l])).sum()
}

fn of_springs(network: &Network, mesh: &Mesh, along: f64) -> [f64; 2] {
    let at = |beside: f64| Matrix3::from_diagonal(&[along, beside, beside].into());
    let beside = zero(|beside| stress_of_springs(network, mesh, &at(beside))[(1, 1)], 0.5, 1.5);
    [beside, stress_of_springs(network, mesh, &at(beside))[(0, 0)]]
}

pub fn table() -> String {
    let element = Arc::new(Element::load("hex8").unwrap());
    let cube = BoxMesh { element, size: vec![1.0; 3], cells: vec![1; 3], origin: vec![0.0; 3] };
    let mesh = cube.build().unwrap();
    let material = Material::for_body(3, 1.0, POISSON, None, None).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let known: Vec<[f64; 2]> = STRETCHES.iter().map(|along| of_law(&energy, *along)).collect();
    // The states of the test, with each axis of the cube along the pull.
    let state = |(along, [beside, _]): (&f64, &[f64; 2]), axis: usize| {
        let entry = |k: usize, l: usize| {
            if k != l {
                0.0
            } else if k == axis {
                *along
            } else {
                *beside
            }
        };
        Value::from((0..9).map(|kl| entry(kl / 3, kl % 3)).collect::<Vec<f64>>())
    };
    let test = (0..3).flat_map(|axis| STRETCHES.iter().zip(&known).map(move |pair| state(pair, axis)));
    let test: Vec<Value> = test.collect();
    let others = "families = [\"simple-shear\", \"biaxial\"]\nstretch = [0.1, 0.3]\ncount = 200\nperturbation = 0\n";
    let others: toml::Table = toml::from_str(others).unwrap();
    let tensile = toml::Table::from_iter([
        ("gradients".to_string(), Value::from(test)),
        ("perturbation".into(), Value::from(0.0)),
        ("held_out".into(), Value::from(others.clone())),
    ]);
    let mut varied: toml::Table = toml::from_str("stretch = [-0.2, 0.3]\nperturbation = 0").unwrap();
    varied.insert("held_out".into(), Value::from(others));
    let lengths = ["edge", "face diagonal", "body diagonal"].map(String::from).to_vec();
    let every: Vec<String> = lengths.iter().cloned().chain(["bulk".to_string()]).collect();
    let entry = |shapes: &toml::Table, springs: &[String], force: &str| {
        let entry = FitEntry::new("sampled").with_springs(Some(springs.to_vec()));
        entry.with("shapes", Some(shapes.clone())).with("tied", Some(true)).with("force", Some(force.to_string()))
    };
    let cubic = "k1*s + k2*s^2 + k3*s^3";
    let at_rest = FitEntry::new("modal").with_springs(Some(lengths.clone()));
    let large = LargeBody::at_rest(EnergyMap::from((energy.clone(), material.state())));
    let reference = Reference { large: Some(&large), ..Reference::default() };
    let rows = [
        ("stiffness at rest, `modal`", at_rest),
        ("tensile test, linear springs, k ≥ 0", entry(&tensile, &lengths, "linear").with("nonnegative", Some(true))),
        ("tensile test, linear springs", entry(&tensile, &lengths, "linear")),
        ("tensile test, cubic springs", entry(&tensile, &lengths, cubic)),
        ("tensile test, cubic springs and volume", entry(&tensile, &every, cubic)),
        ("four families, linear springs", entry(&varied, &lengths, "linear")),
        ("four families, cubic springs and volume", entry(&varied, &every, cubic)),
    ];
    let row = |(name, entry): (&str, FitEntry)| {
        let own = fit(entry);
        let (found, _) = fit_without_errors(&mesh, &material.into(), &reference, &own, &mut |_| {}).unwrap();
        let test: Vec<[f64; 2]> = STRETCHES.iter().map(|along| of_springs(&found.network, &mesh, *along)).collect();
        let rms = |of: &dyn Fn([f64; 2], [f64; 2]) -> f64| {
            let squares = test.iter().zip(&known).map(|(found, known)| of(*found, *known).powi(2));
            100.0 * (squares.sum::<f64>() / known.len() as f64).sqrt()
        };
        let largest = known.iter().fold(0.0f64, |most, [_, stress]| most.max(stress.abs()));
        let of_stress = rms(&|found, known| (found[1] - known[1]) / largest);
        let beside = rms(&|found, known| found[0] - known[0]);
        let unseen = |family: &str| {
            let families = found.kind.sampled().map(|sampled| &sampled.families);
            let known = families.and_then(|all| all.iter().find(|one| one.family == family));
            known.map_or("".to_string(), |one| format!("{:.1}", 100.0 * one.held_out.mean))
        };
        let numbers = [format!("{of_stress:.2}"), format!("{beside:.2}"), unseen("simple-shear"), unseen("biaxial")];
        std::iter::once(name.to_string()).chain(numbers).collect()
    };
    let rows: Vec<Vec<String>> = rows.into_iter().map(row).collect();
    markdown(&["fit", "tensile stress", "lateral stretch", "shears", "biaxial stretches"], &rows)
}
