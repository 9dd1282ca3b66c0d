//! Published and derived figures for single elements.

use crate::shapes::loaded;
use springfit_element::material::{Material, State};
use springfit_element::springs::Springs;
use springfit_fit::fit::{Fit, Objective, Weight, element_errors, fit_cells, fit_element};

const STRESS: State = State::PlaneStress { thickness: 1.0 };

fn close(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "expected {expected}, found {found}");
}

/// The constants of each spring of the element with nodes at `x`.
fn constants(element: &str, x: &[f64], material: Material, objective: Objective) -> Vec<f64> {
    let element = loaded(element);
    let springs = Springs::select(&element, None).unwrap();
    fit_element(&element, &springs, x, material.moduli(), &Fit::new(objective)).unwrap()
}

fn regular_tetrahedron() -> Vec<f64> {
    let h = 3f64.sqrt() / 2.0;
    vec![0., 0., 0., 1., 0., 0., 0.5, h, 0., 0.5, h / 3.0, (2f64 / 3.0).sqrt()]
}

/// Regular tetrahedron of edge 1, E = 1: the printed figures have four to five digits.
#[test]
fn regular_tetrahedron_matches_published_constants() {
    let figures = [
        (0.0, 0.09428),
        (0.2, 0.10476),
        (0.25, 0.11314),
        (0.3, 0.12692),
        (0.4, 0.20203),
        (0.45, 0.35762),
        (0.49, 1.61353),
        (0.499, 15.755),
    ];
    for (poisson, expected) in figures {
        let material = Material::new(1.0, poisson, State::Solid).unwrap();
        let k = constants("tet4", &regular_tetrahedron(), material, Objective::Frobenius(Weight::None));
        k.iter().for_each(|k| close(*k, expected, 6e-5));
        // Off-diagonal: E V / l² (Van Gelder 1998) at ν = 1/4.
        if poisson == 0.25 {
            let k = constants("tet4", &regular_tetrahedron(), material, Objective::Frobenius(Weight::OffDiagonal));
            k.iter().for_each(|k| close(*k, 1.0 / 72f64.sqrt(), 1e-12));
        }
    }
}

fn unit_cube() -> Vec<f64> {
    let element = loaded("hex8");
    element.positions.iter().map(|x| (x + 1.0) / 2.0).collect()
}

fn relative_frobenius(name: &str, x: &[f64], material: Material, groups: Option<&[String]>) -> f64 {
    let element = loaded(name);
    let springs = Springs::select(&element, groups).unwrap();
    let cell: Vec<usize> = (0..element.nodes()).collect();
    let fit = Fit::new(Objective::Frobenius(Weight::None));
    let fits = fit_cells(&element, &springs, x, &cell, material.moduli(), &fit, &mut |_| {}).unwrap();
    element_errors(&element, x, &cell, material.moduli(), &fits).unwrap().frobenius[0]
}

/// Unit cube, E = 1: edge, face diagonal, body diagonal, relative Frobenius error.
#[test]
fn cube_matches_published_constants() {
    let figures = [
        (0.0, 0.07738, 0.10317, 0.05952, 0.4436),
        (0.25, 0.08286, 0.11937, 0.07810, 0.2989),
        (0.3, 0.08974, 0.13248, 0.08974, 0.3301),
        (0.45, 0.21593, 0.35687, 0.27750, 0.6123),
    ];
    for (poisson, edge, face, body, error) in figures {
        let material = Material::new(1.0, poisson, State::Solid).unwrap();
        let k = constants("hex8", &unit_cube(), material, Objective::Frobenius(Weight::None));
        k[..12].iter().for_each(|k| close(*k, edge, 7e-5));
        k[12..24].iter().for_each(|k| close(*k, face, 7e-5));
        k[24..].iter().for_each(|k| close(*k, body, 1e-4));
        close(relative_frobenius("hex8", &unit_cube(), material, None), error, 2e-4);
    }
}

/// Tetrahedron on the unit axes, ν = 1/4.
#[test]
fn corner_tetrahedron_matches_published_constants() {
    let x = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.];
    let material = Material::new(1.0, 0.25, State::Solid).unwrap();
    let k = constants("tet4", &x, material, Objective::Frobenius(Weight::None));
    for (s, expected) in [(0, 0.22353), (2, 0.22353), (3, 0.22353), (1, 0.03922), (4, 0.03922), (5, 0.03922)] {
        close(k[s], expected, 1.3e-4);
    }
    close(relative_frobenius("tet4", &x, material, None), 0.594, 1e-3);
}

/// A volume spring takes over what length springs cannot: relative error of the regular tetrahedron.
#[test]
fn volume_spring_holds_poissons_ratio() {
    let groups = ["edge".to_string(), "bulk".to_string()];
    for (poisson, alone, with) in [(0.3, 0.235, 0.166), (0.45, 0.570, 0.045), (0.49, 0.662, 0.009)] {
        let material = Material::new(1.0, poisson, State::Solid).unwrap();
        let x = regular_tetrahedron();
        assert!((relative_frobenius("tet4", &x, material, None) - alone).abs() < 6e-4);
        assert!((relative_frobenius("tet4", &x, material, Some(&groups)) - with).abs() < 6e-4);
    }
    let triangle = [0., 0., 1., 0., 0.5, 3f64.sqrt() / 2.0];
    for poisson in [0.0, 0.2, 0.3, 0.4, 0.4999] {
        let material = Material::new(1.0, poisson, STRESS).unwrap();
        assert!(relative_frobenius("tri3", &triangle, material, Some(&groups)) < 1e-12);
    }
}
