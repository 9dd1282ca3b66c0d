//! Published and derived figures for single elements.

use crate::shapes::{geometry, loaded};
use springfit_element::material::{Material, State};
use springfit_element::springs::Springs;
use springfit_fit::fit::{Fit, Objective, Weight, element_errors, fit_cells, fit_element};

const SQUARE: [f64; 8] = [-1., -1., 1., -1., 1., 1., -1., 1.];
const STRESS: State = State::PlaneStress { thickness: 1.0 };
const STRAIN: State = State::PlaneStrain { thickness: 1.0 };

fn close(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "expected {expected}, found {found}");
}

/// The constants of each spring of the element with nodes at `x`.
fn constants(element: &str, x: &[f64], material: Material, objective: Objective) -> Vec<f64> {
    let element = loaded(element);
    let springs = Springs::select(&element, None).unwrap();
    fit_element(&element, &springs, x, material.moduli(), &Fit::new(objective)).unwrap()
}

/// The square's edges and diagonals, E = 10 kPa, ν = 0.3; four decimals are given.
#[test]
fn square_constants_match_the_derived_figures() {
    let cases = [
        (STRAIN, Objective::Frobenius(Weight::OffDiagonal), 3846.1538, 5288.4615),
        (STRAIN, Objective::Frobenius(Weight::None), 3571.4286, 4945.0549),
        (STRESS, Objective::Frobenius(Weight::OffDiagonal), 3021.9780, 4258.2418),
        (STRESS, Objective::Frobenius(Weight::None), 2982.7316, 4003.1397),
    ];
    for (state, objective, edge, diagonal) in cases {
        let k = constants("quad4", &SQUARE, Material::new(1e4, 0.3, state).unwrap(), objective);
        k[..4].iter().for_each(|k| assert!((k - edge).abs() <= 5.1e-5, "{k} {edge}"));
        k[4..].iter().for_each(|k| assert!((k - diagonal).abs() <= 5.1e-5, "{k} {diagonal}"));
    }
}

/// Natsupakpong and Çavuşoğlu (2010), (19): upper triangle by rows, nodes (-1,1), (1,1), (1,-1), (-1,-1).
#[test]
fn square_stiffness_is_equation_19() {
    let material = Material::new(1e4, 0.3, STRAIN).unwrap();
    let (l, m) = (material.moduli().lambda, material.moduli().mu);
    let (d, s, c, p, q, r) = (l / 3. + m, (l + m) / 4., (m - l) / 4., -l / 3. - m / 2., -l / 6. - m / 2., l / 6.);
    let upper = [
        vec![d, -s, p, c, q, s, r, -c],
        vec![d, -c, r, s, q, c, p],
        vec![d, s, r, c, q, -s],
        vec![d, -c, p, -s, q],
        vec![d, -s, p, c],
        vec![d, -c, r],
        vec![d, s],
        vec![d],
    ];
    let element = loaded("quad4");
    let geometry = geometry(&element, &SQUARE);
    let stiffness = geometry.stiffness(material.moduli());
    let ours = [3, 2, 1, 0];
    for (i, row) in upper.iter().enumerate() {
        for (offset, expected) in row.iter().enumerate() {
            let j = i + offset;
            let found = stiffness[(2 * ours[i / 2] + i % 2, 2 * ours[j / 2] + j % 2)];
            assert!((found - expected).abs() < 1e-12 * d, "row {i} column {j}: expected {expected}, found {found}");
        }
    }
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

/// Lloyd et al. (2007): triangle √3/4 E h exactly, square 5/16 and 7/16 E h off the diagonal, all at ν = 1/3.
#[test]
fn plane_constants_of_lloyd_follow() {
    let material = Material::new(1.0, 1.0 / 3.0, STRESS).unwrap();
    let triangle = [0., 0., 1., 0., 0.5, 3f64.sqrt() / 2.0];
    let k = constants("tri3", &triangle, material, Objective::Frobenius(Weight::None));
    k.iter().for_each(|k| close(*k, 3f64.sqrt() / 4.0, 1e-14));
    assert!(relative_frobenius("tri3", &triangle, material, None) < 1e-14);
    let k = constants("quad4", &SQUARE, material, Objective::Frobenius(Weight::OffDiagonal));
    close(k[0], 5.0 / 16.0, 1e-14);
    close(k[4], 7.0 / 16.0, 1e-14);
    let k = constants("quad4", &SQUARE, material, Objective::Frobenius(Weight::None));
    close(k[0], 17.0 / 56.0, 1e-14);
    close(k[4], 23.0 / 56.0, 1e-14);
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

/// Any simplex, off the diagonal: `k_ij = V ((λ+μ)/l² − μ ∇N_i·∇N_j)`.
#[test]
fn simplex_closed_form_off_the_diagonal() {
    let x = [0.1, 0., 0.2, 1.3, -0.1, 0., 0.4, 1.1, 0.1, 0.3, 0.2, 0.9];
    let material = Material::new(7.0, 0.37, State::Solid).unwrap();
    let (l, m) = (material.moduli().lambda, material.moduli().mu);
    let element = loaded("tet4");
    let geometry = geometry(&element, &x);
    let k = constants("tet4", &x, material, Objective::Frobenius(Weight::OffDiagonal));
    for (k, nodes) in k.iter().zip(&element.springs[0].nodes) {
        let (i, j) = (nodes[0], nodes[1]);
        let dot: f64 = (0..3).map(|c| geometry.gradients[3 * i + c] * geometry.gradients[3 * j + c]).sum();
        let square: f64 = (0..3).map(|c| (x[3 * j + c] - x[3 * i + c]).powi(2)).sum();
        close(*k, geometry.content() * ((l + m) / square - m * dot), 1e-12);
    }
}
