//! Functions that are condensed in each cell: Wilson's modes and bubbles, against hand-made matrices, bending and the patch test.

use crate::kit::{place, refused, said, springfit};
use crate::shapes::{Random, distorted, geometry, loaded};
use nalgebra::{DMatrix, DVector, Matrix2};
use springfit_element::element::Element;
use springfit_element::material::{Hooke, Material, Moduli, Stiffness};
use springfit_element::springs::Springs;
use springfit_fit::fit::{
    CellFits, ClosedForm, ExactFit, Fit, Higher, Objective, Weight, condense, element_errors, fit_cells, fit_element,
    fit_exact, reference_fit,
};
use springfit_studies::study::{StabilityRow, Verdict, stability};

const MODULI: Moduli = Moduli { lambda: 1.7, mu: 0.6 };
const NAMES: [&str; 3] = ["quad4_wilson", "quad8_bubble", "hex8_wilson"];

fn example(name: &str) -> Element {
    let path = place(format!("examples/elements/{name}.toml"));
    Element::load(path.to_str().unwrap()).unwrap()
}

fn stiffness(element: &Element, x: &[f64], hooke: impl Into<Hooke>) -> DMatrix<f64> {
    let geometry = geometry(element, x);
    geometry.stiffness(hooke)
}

/// The quadrilateral of Taylor, Beresford and Wilson (1976) in a few lines of its own: `B` of the nodes and of the two parabolas at 2 × 2
/// points, the second with J at the centre and the ratio of the determinants, and their amplitudes eliminated.
fn wilson_by_hand(x: &[f64], law: &DMatrix<f64>) -> DMatrix<f64> {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let slopes = |xi: f64, eta: f64| corners.map(|[a, b]| [a * (1.0 + b * eta) / 4.0, b * (1.0 + a * xi) / 4.0]);
    let jacobian = |dn: &[[f64; 2]; 4]| {
        Matrix2::from_fn(|k, l| dn.iter().enumerate().map(|(a, dn)| x[2 * a + k] * dn[l]).sum::<f64>())
    };
    let middle = jacobian(&slopes(0.0, 0.0));
    let mut whole = DMatrix::zeros(12, 12);
    let g = 1.0 / 3.0f64.sqrt();
    for (xi, eta) in [(-g, -g), (g, -g), (g, g), (-g, g)] {
        let dn = slopes(xi, eta);
        let here = jacobian(&dn);
        let mut b = DMatrix::zeros(3, 12);
        let modes = [[-2.0 * xi, 0.0], [0.0, -2.0 * eta]];
        for (a, dn) in dn.iter().chain(&modes).enumerate() {
            let (back, share) = match a < 4 {
                true => (here, 1.0),
                false => (middle, middle.determinant() / here.determinant()),
            };
            let grad = back.try_inverse().unwrap().transpose() * nalgebra::Vector2::new(dn[0], dn[1]) * share;
            (b[(0, 2 * a)], b[(1, 2 * a + 1)]) = (grad[0], grad[1]);
            (b[(2, 2 * a)], b[(2, 2 * a + 1)]) = (grad[1], grad[0]);
        }
        whole += here.determinant() * b.transpose() * law * b;
    }
    condense(&whole, &(0..8).collect::<Vec<_>>()).unwrap()
}

/// Both are sums of some hundred products: 1e-12 is a thousand roundings.
#[test]
fn wilsons_quadrilateral_is_the_one_that_is_made_by_hand() {
    let element = example("quad4_wilson");
    let mut random = Random(3);
    let Moduli { lambda, mu } = MODULI;
    let isotropic = [lambda + 2.0 * mu, lambda, 0.0, lambda, lambda + 2.0 * mu, 0.0, 0.0, 0.0, mu];
    let other = [3.0, 0.4, 0.2, 0.4, 1.5, -0.1, 0.2, -0.1, 0.7];
    for _ in 0..20 {
        let x = distorted(&element, &mut random);
        for (law, hooke) in
            [(isotropic, Hooke::Isotropic(MODULI)), (other, Hooke::Anisotropic(Stiffness::new(2, &other).unwrap()))]
        {
            let by_hand = wilson_by_hand(&x, &DMatrix::from_row_slice(3, 3, &law));
            let found = stiffness(&element, &x, hooke);
            assert!((&found - &by_hand).amax() < 1e-12 * by_hand.amax(), "{x:?}");
        }
    }
}

/// On straight edges with nodes at their middles the quadrilateral of nine nodes has the functions of that of eight and the bubble.
#[test]
fn a_condensed_bubble_is_the_inner_node_of_quad9_taken_out() {
    let (bubble, nine) = (example("quad8_bubble"), Element::load("quad9").unwrap());
    let corners = loaded("quad4");
    let mut random = Random(4);
    for _ in 0..20 {
        let x = distorted(&corners, &mut random);
        let at = |element: &Element| -> Vec<f64> {
            let places = element.positions.chunks_exact(2);
            places
                .flat_map(|xi| {
                    let n: Vec<f64> = corners.functions.values.iter().map(|n| n.evaluate(xi)).collect();
                    [0, 1].map(|k| n.iter().enumerate().map(|(a, n)| n * x[2 * a + k]).sum::<f64>())
                })
                .collect()
        };
        let whole = stiffness(&nine, &at(&nine), MODULI);
        assert!((0..16).all(|i| nine.positions[i] == bubble.positions[i]));
        let expected = condense(&whole, &(0..16).collect::<Vec<_>>()).unwrap();
        let found = stiffness(&bubble, &at(&bubble), MODULI);
        assert!((&found - &expected).amax() < 1e-12 * expected.amax());
    }
}

/// Under a linear displacement each cell has the forces of the uniform stress and no others, and its energy: then nodes inside any patch of
/// cells are in equilibrium.
#[test]
fn every_shape_passes_the_patch_test() {
    for name in NAMES {
        let element = example(name);
        let (n, d) = (element.nodes(), element.dimension());
        let mut random = Random(5);
        for _ in 0..20 {
            let x = match name {
                // The rule of nine points integrates the bubble where edges are straight.
                "quad8_bubble" => {
                    let affine = [[1.0, 0.3], [-0.2, 0.8]];
                    element
                        .positions
                        .chunks_exact(2)
                        .flat_map(|at| affine.map(|row| row[0] * at[0] + row[1] * at[1] + 0.1 * at[0] * at[1]))
                        .collect()
                }
                _ => distorted(&element, &mut random),
            };
            let geometry = geometry(&element, &x);
            let h = DMatrix::from_fn(d, d, |_, _| random.next());
            let strain = (&h + h.transpose()) * 0.5;
            let stress = DMatrix::identity(d, d) * (MODULI.lambda * strain.trace()) + &strain * (2.0 * MODULI.mu);
            let u = DVector::from_fn(n * d, |i, _| (0..d).map(|l| h[(i % d, l)] * x[i / d * d + l]).sum());
            let force = geometry.stiffness(MODULI) * &u;
            let content = geometry.content_gradient();
            for i in 0..n * d {
                let expected: f64 = (0..d).map(|l| stress[(i % d, l)] * content[i / d * d + l]).sum();
                assert!((force[i] - expected).abs() < 1e-12 * force.amax(), "{name}");
            }
            let energy = stress.dot(&strain) * geometry.content();
            assert!((u.dot(&force) - energy).abs() < 1e-12 * energy.abs(), "{name}");
        }
    }
}

/// Pure bending of a rectangle 2a × 2b in plane stress: `u = x y`, `v = −x²/2 − ν y²/2`, with the energy `E (2a) (2b)³/12/2`. The bilinear
/// quadrilateral has `1/(1+ν) (1/(1−ν) + (a/b)²/2)` times that (Cook, Malkus, Plesha, Witt 2002).
#[test]
fn wilsons_quadrilateral_bends_as_a_beam_does() {
    let (a, b, young, nu) = (5.0, 0.5, 3.0, 0.25);
    let moduli = Material::for_body(2, young, nu, None, None).unwrap().moduli();
    let exact = young * 2.0 * a * (2.0f64 * b).powi(3) / 12.0;
    for (element, expected) in [
        (example("quad4_wilson"), 1.0),
        (Element::load("quad4").unwrap(), (1.0 / (1.0 - nu) + (a / b).powi(2) / 2.0) / (1.0 + nu)),
    ] {
        let x: Vec<f64> = element.positions.chunks_exact(2).flat_map(|at| [a * at[0], b * at[1]]).collect();
        let u = DVector::from_fn(8, |i, _| if i % 2 == 0 { x[i] * x[i + 1] } else { 0.0 });
        let energy = u.dot(&(stiffness(&element, &x, moduli) * &u));
        assert!((energy / exact - expected).abs() < 1e-12 * expected, "{}: {}", element.name, energy / exact);
    }
}

/// Every route of a fit sees the condensed stiffness: against the formula, and the errors against both matrices.
#[test]
fn fits_are_those_of_the_condensed_matrix() {
    let mut random = Random(6);
    for name in NAMES {
        let element = example(name);
        let springs = Springs::select(&element, None).unwrap();
        let x = distorted(&element, &mut random);
        let cell: Vec<usize> = (0..element.nodes()).collect();
        let r = reference_fit::stiffness(&element, &x, &MODULI.into()).unwrap();
        assert!((&r - stiffness(&element, &x, MODULI)).amax() < 1e-12 * r.amax(), "{name}");
        for weight in [Weight::None, Weight::OffDiagonal, Weight::Modal(Higher::DEFAULT), Weight::Relative] {
            let fit = Fit::new(Objective::Frobenius(weight));
            let formula = reference_fit::constants(&element, &springs, &x, &MODULI.into(), weight).unwrap();
            let found = fit_element(&element, &springs, &x, MODULI, &fit).unwrap();
            let size = formula.iter().fold(0.0f64, |size, k| size.max(k.abs()));
            let error = formula.iter().zip(&found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // The relative weight loses the digits of the softest motion.
            assert!(
                error < if weight == Weight::Relative { 1e-9 } else { 1e-11 } * size,
                "{name} {weight:?}: {error:e}"
            );
            let fits: CellFits = fit_cells(&element, &springs, &x, &cell, MODULI, &fit, &mut |_| {}).unwrap();
            let errors = element_errors(&element, &x, &cell, MODULI, &fits).unwrap();
            let left = &r - reference_fit::network(&reference_fit::gradients(&element, &springs, &x).unwrap(), &found);
            assert!((errors.frobenius[0] - left.norm() / r.norm()).abs() < 1e-12, "{name} {weight:?}");
        }
    }
}

/// The sweep of ill-conditioned cases, with twice the digits as its reference, knows the condensed matrix too.
#[test]
fn no_case_of_a_condensed_element_is_lost() {
    let rows = stability(Some(example("quad4_wilson")), &mut |_| {}).unwrap().rows;
    let lost: Vec<&StabilityRow> = rows.iter().filter(|row| row.verdict == Verdict::Lost).collect();
    assert!(lost.is_empty(), "{lost:?}");
    let accurate = rows.iter().filter(|row| row.verdict == Verdict::Accurate && row.method == "frobenius").count();
    assert!(accurate > 50, "{accurate}");
}

#[test]
fn what_needs_nodes_alone_is_refused() {
    let element = example("quad4_wilson");
    let springs = Springs::select(&element, None).unwrap();
    let x = element.positions.clone();
    let material = Material::for_body(2, 1.0, 0.3, None, None).unwrap();
    let exact = fit_exact(&element, &x, &[0, 1, 2, 3], material, &ExactFit::default(), &mut |_| {}).unwrap_err();
    let expected =
        "element: expected an element without condensed functions for exact networks, found quad4_wilson with 2";
    assert_eq!(exact.to_string(), expected);
    let derived = ClosedForm::new(&element, &springs, false).unwrap_err().to_string();
    assert!(derived.contains("closed forms, which are linear in the moduli"), "{derived}");
    // Springs of an element with the same nodes know nothing of the condensed functions.
    let plain = Springs::select(&Element::load("quad4").unwrap(), None).unwrap();
    let fit = Fit::new(Objective::Frobenius(Weight::None));
    let error = fit_element(&element, &plain, &x, material.moduli(), &fit).unwrap_err().to_string();
    let expected =
        "springs: expected those of quad4_wilson: with condensed functions, found without condensed functions";
    assert_eq!(error, expected);

    let folder = tempfile::tempdir().unwrap();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/elements/quad4_wilson.toml");
    let scene = |law: &str| {
        format!(
            "[mesh]\nbox = {{ element = {path:?}, size = [4, 1], cells = [4, 1] }}\n[material]\n\
             young = 1e4\npoisson = 0.3\n{law}[[fit]]\nobjective = \"frobenius\"\n[[fix]]\ngroup = \"xmin\"\n[[load]]\n\
             group = \"xmax\"\ntraction = [0, 1]\n"
        )
    };
    let run = |text: String| {
        std::fs::write(folder.path().join("scene.toml"), text).unwrap();
        let output = springfit(folder.path(), &["run", "scene.toml"]);
        (output.status.code(), said(&output))
    };
    let (code, said) = run(scene("law = \"neo-hookean\"\n"));
    assert!(code == Some(2) && said.contains("without condensed functions for large deformation"), "{said}");
    let (code, said) = run(scene(""));
    assert_eq!(code, Some(0), "{said}");
    for (arguments, what) in [(["generate", path], "generated code"), (["derive", path], "closed forms")] {
        let said = refused(folder.path(), &arguments);
        assert!(said.contains(what), "{said}");
    }
}

#[test]
fn wrong_functions_name_what_is_wrong() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/elements/quad4_wilson.toml");
    let text = std::fs::read_to_string(path).unwrap();
    for (from, to, key, what) in [
        ("\"1 - xi^2\"", "\"2 - xi^2\"", "nodes[4].shape", "zero at nodes[0]"),
        ("\"1 - xi^2\"", "\"(1 - xi^2)*xi^2*(1 + xi)\"", "nodes[4].shape", "the mean zero by the quadrature"),
        ("\"1 - eta^2\"", "\"2 - 2*xi^2\"", "nodes", "linearly independent"),
        ("{ shape = \"1 - xi^2\",", "{ at = [0, 0], shape = \"1 - xi^2\",", "nodes[4].at", "no place"),
        (",  condense = true", "", "nodes[4].at", "2 coordinates"),
        (
            "\"1 - xi^2\",  condense = true",
            "\"1 - xi^2\", condense = true }, { at = [0, 0], shape = \"0\"",
            "nodes[5]",
            "come before",
        ),
    ] {
        let error = Element::parse(&text.replace(from, to)).unwrap_err();
        let said = error.to_string();
        assert!(said.contains(&format!("{key}: ")) && said.contains(what), "{said}");
    }
}
