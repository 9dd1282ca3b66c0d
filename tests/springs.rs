//! Every kind of spring: its force and tangent against differences, and what it adds to a fit.

use crate::kit::place;
use crate::shapes::statics::assert_derivatives;
use crate::shapes::{Random, distorted, elements, geometry, loaded, materials, text_with_angles, with_angles};
use springfit_element::element::{Cell, Element, SHIPPED, SpringKind};
use springfit_element::material::{Material, Plane};
use springfit_element::springs::{Law, Measure, SpringResponse, Springs};
use springfit_fit::fit::{
    Balance, CellFits, Fit, Higher, MotionWeight, Objective, Search, Solver, Weight, element_errors, fit_cells,
};
use std::sync::Arc;

fn example(name: &str) -> Element {
    let path = place(format!("examples/elements/{name}.toml"));
    Element::load(path.to_str().unwrap()).unwrap()
}

/// The energy and its gradient, against which a spring pulls.
fn pulled(response: SpringResponse) -> (f64, Vec<f64>) {
    (response.energy, response.force.iter().map(|f| -f).collect())
}

/// Central differences of step 1e-5 of functions of size one err by 1e-10, and the forces' own rounding is as large.
fn check_derivatives(measure: &Measure, x: &[f64], rest: f64, d: usize, name: &str) {
    let k = 3.0;
    let response = measure.respond(k, rest, x, d);
    assert!((measure.value(x, d) - measure.jet(x, d).value).abs() < 1e-14 * (1.0 + rest.abs()), "{name}");
    let size = response.tangent.iter().fold(0.0f64, |a, t| a.max(t.abs()));
    let at = |x: &[f64]| pulled(measure.respond(k, rest, x, d));
    assert_derivatives(name, x, (1e-5, [1e-7 * size; 2]), at, |i, j| response.tangent[i * x.len() + j]);
}

/// At rest, and where every length has changed by up to half.
#[test]
fn forces_and_tangents_are_those_of_differences() {
    let examples = ["tri3_coupled", "tet4_coupled"].map(example);
    let mut kinds = Vec::new();
    for element in elements().into_iter().chain(examples).map(Arc::new) {
        let d = element.dimension();
        let every: Vec<String> = element.springs.iter().map(|g| g.name.clone()).collect();
        let springs = Springs::select(&element, Some(&every)).unwrap();
        let mut random = Random(21);
        let x = distorted(&element, &mut random);
        let stretched: Vec<f64> = x.iter().enumerate().map(|(i, x)| x * [1.5, 0.7, 1.2][i % d]).collect();
        let at =
            |x: &[f64], nodes: &[usize]| -> Vec<f64> { nodes.iter().flat_map(|a| x[a * d..][..d].to_vec()).collect() };
        let mut measures: Vec<(SpringKind, Vec<usize>, Measure)> = springs
            .functions()
            .iter()
            .map(|f| (f.kind, f.nodes.clone(), Measure::Function(f.function.clone())))
            .collect();
        measures.push((SpringKind::Length, springs.pairs()[0].to_vec(), Measure::Length));
        // 81 coordinates, each moved, take a while.
        if let Some(kind) = springs.content().filter(|_| element.nodes() < 20) {
            measures.push((kind, (0..element.nodes()).collect(), Measure::Content(element.clone())));
        }
        for (kind, nodes, measure) in measures {
            let rest = measure.value(&at(&x, &nodes), d);
            for x in [&x, &stretched] {
                check_derivatives(&measure, &at(x, &nodes), rest, d, &format!("{} {kind:?}", element.name));
            }
            kinds.push(kind);
        }
    }
    // Those of exact networks are tested with them.
    for kind in SpringKind::all().filter(|kind| kind.properties().in_element_files) {
        assert!(kinds.contains(&kind), "{kind:?}");
    }
}

/// Springs with laws of force, at rest and stretched, pulling only and pushing only: with parameters as they may be fitted.
#[test]
fn laws_of_force_have_the_forces_and_tangents_of_differences() {
    let (d, rest) = (3, 1.3);
    let x = [0.1, 0.2, 0.0, 0.9, -0.4, 0.8];
    for (text, parameters) in [
        ("k1*s + k3*s^3", &[2.0, 5.0][..]),
        ("k*(exp(a*s) - 1)", &[1.5, 2.0]),
        ("k*ramp(s)^2", &[3.0]),
        ("k*c + p*(1 - c0/c)", &[1.0, -0.5]),
        ("a/(1 + s) + b*ln(1 + s)/(1 + s)", &[-0.4, 0.6]),
    ] {
        let law = Law::parse(text).unwrap();
        let respond = |x: &[f64]| {
            let pull = |c: f64| {
                [law.energy(c, rest, parameters), law.force(c, rest, parameters), law.slope(c, rest, parameters)]
            };
            Measure::Length.respond_by(pull, x, d)
        };
        for stretch in [1.0, 1.4] {
            let x = x.map(|x| x * stretch);
            let response = respond(&x);
            let tangent = |i: usize, j: usize| response.tangent[i * x.len() + j];
            assert_derivatives(text, &x, (1e-5, [1e-7; 2]), |x| pulled(respond(x)), tangent);
        }
    }
}

/// Formulas of the same thing agree: a length as a formula, the volume of a tetrahedron as its content.
#[test]
fn formulas_agree_with_closed_forms() {
    let tetrahedron = loaded("tet4");
    let mut random = Random(3);
    for _ in 0..10 {
        let x = distorted(&tetrahedron, &mut random);
        let volume = Measure::Function(Arc::new(Measure::of_kind(SpringKind::Volume, 4, 3).unwrap().into()));
        let length = Measure::Function(Arc::new(Measure::of_kind(SpringKind::Length, 2, 3).unwrap().into()));
        for (formula, closed, x) in
            [(volume, Measure::Content(tetrahedron.clone()), &x[..]), (length, Measure::Length, &x[..6])]
        {
            let (a, b) = (formula.jet(x, 3), closed.jet(x, 3));
            assert!((a.value - b.value).abs() < 1e-14);
            assert!(a.gradient.iter().zip(&b.gradient).all(|(a, b)| (a - b).abs() < 1e-13));
            assert!(a.hessian.iter().zip(&b.hessian).all(|(a, b)| (a - b).abs() < 1e-12));
        }
        let angle = Measure::Function(Arc::new(Measure::of_kind(SpringKind::Angle, 3, 3).unwrap().into()));
        let (u, v) = ([x[0] - x[3], x[1] - x[4], x[2] - x[5]], [x[6] - x[3], x[7] - x[4], x[8] - x[5]]);
        let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let cosine = dot(u, v) / (dot(u, u) * dot(v, v)).sqrt();
        assert!((angle.value(&x[..9], 3) - cosine.acos()).abs() < 1e-12);
    }
}

fn fitted(element: &Element, names: &[&str], x: &[f64], material: Material, fit: Fit) -> (CellFits, f64, f64) {
    let names: Vec<String> = names.iter().map(|n| n.to_string()).collect();
    let springs = Springs::select(element, Some(&names)).unwrap();
    let cells: Vec<usize> = (0..element.nodes()).collect();
    let fits = fit_cells(element, &springs, x, &cells, material.moduli(), &fit, &mut |_| {}).unwrap();
    let errors = element_errors(element, x, &cells, material.moduli(), &fits).unwrap();
    (fits, errors.frobenius[0], errors.spectral[0])
}

const NORMS: [Objective; 3] = [
    Objective::Frobenius(Weight::None),
    Objective::Frobenius(Weight::OffDiagonal),
    Objective::Frobenius(Weight::Modal(Higher::DEFAULT)),
];

/// With products of elongations springs are the finite element, on any triangle and tetrahedron: the residual is rounding,
/// as much as the condition of the springs of a distorted element makes of it.
#[test]
fn couplings_make_simplices_exact() {
    for (name, groups) in
        [("tri3_coupled", &["edge", "corner"][..]), ("tet4_coupled", &["edge", "coupling 1", "coupling 2"][..])]
    {
        let element = example(name);
        let mut random = Random(5);
        for _ in 0..20 {
            let x = distorted(&element, &mut random);
            for material in materials(element.dimension()) {
                for objective in NORMS {
                    let (_, frobenius, _) = fitted(&element, groups, &x, material, Fit::new(objective));
                    assert!(frobenius < 1e-10, "{name} {objective:?}: {frobenius}");
                }
                let spectral = Fit::new(Objective::Spectral(MotionWeight::None));
                let (fits, _, error) = fitted(&element, groups, &x, material, spectral);
                // The bound is zero too, and the gap relative to a millionth of R.
                assert!(error < 1e-9 && fits.certificates[0].gap() < 1e-5, "{name}: {error} {:?}", fits.certificates);
                let balance = Objective::Divergence(Balance::DEFAULT);
                let (_, frobenius, _) = fitted(&element, groups, &x, material, Fit::new(balance));
                assert!(frobenius < 1e-3, "{name}: divergence {frobenius}");
            }
        }
    }
}

/// One area spring makes the equilateral triangle exact for every ν in plane stress; method's figures for the regular
/// tetrahedron with a volume spring.
#[test]
fn area_and_volume_springs_hold_the_ratio_of_poisson() {
    let root = 3f64.sqrt();
    let triangle = loaded("tri3");
    let x = [0.0, 0.0, 1.0, 0.0, 0.5, root / 2.0];
    for nu in [0.0, 0.2, 0.3, 1.0 / 3.0, 0.45, 0.49, 0.4999] {
        let material = Material::for_body(2, 1e4, nu, Some(Plane::Stress), None).unwrap();
        for objective in NORMS {
            let (_, error, _) = fitted(&triangle, &["edge", "bulk"], &x, material, Fit::new(objective));
            assert!(error < 1e-12, "{nu} {objective:?}: {error}");
        }
    }
    let tetrahedron = loaded("tet4");
    let x = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.5, root / 2.0, 0.0, 0.5, root / 6.0, (2.0f64 / 3.0).sqrt()];
    for (nu, without, with) in [(0.3, 0.235, 0.166), (0.45, 0.570, 0.045), (0.49, 0.662, 0.009)] {
        let material = Material::for_body(3, 1e4, nu, None, None).unwrap();
        for (groups, expected) in [(&["edge"][..], without), (&["edge", "bulk"][..], with)] {
            let (_, error, _) = fitted(&tetrahedron, groups, &x, material, Fit::new(NORMS[0]));
            assert!((error - expected).abs() < 5e-4, "{nu} {groups:?}: {error}");
        }
    }
}

/// The classes of the cube's 28 pairs are its edges, face diagonals and body diagonals.
#[test]
fn the_cells_symmetry_divides_springs_into_classes() {
    let element = example("hex8_selective");
    let sizes: Vec<usize> = element.springs.iter().map(|g| g.nodes.len()).collect();
    assert_eq!(sizes, [12, 12, 4, 0]);
    assert_eq!(element.springs[1].name, "springs 2");
    let sizes: Vec<usize> = example("tet4_coupled").springs.iter().map(|g| g.nodes.len()).collect();
    assert_eq!(&sizes[..3], [6, 12, 3]);
}

/// Near incompressibility the fully integrated cube locks, the selectively integrated one does not: the energy of a
/// bending motion, u = xy, v = −x²/2 at the nodes, stays bounded.
/// The angles of a cell are those of its sides: each corner of a side has one, which other sides do not have.
#[test]
fn complete_angles_are_those_of_all_sides() {
    for name in SHIPPED.iter().map(|file| file.name).filter(|name| !name.starts_with("bar")) {
        let element = with_angles(name);
        let found = &element.springs.iter().find(|group| group.kind == SpringKind::Angle).unwrap().nodes;
        let own: Vec<usize> = (0..element.cell.corners().len()).collect();
        let sides: Vec<&[usize]> = match element.dimension() {
            // The sides of a plane cell run around it.
            2 => vec![&own],
            _ => element.cell.sides().iter().map(|side| side.corners).collect(),
        };
        let mut expected: Vec<[usize; 3]> = Vec::new();
        for side in sides {
            let corner = |i: usize| element.corner_node(side[i % side.len()]).unwrap();
            expected.extend((0..side.len()).map(|i| [corner(i), corner(i + 1), corner(i + 2)]));
        }
        let sorted = |n: &[usize]| [n[0].min(n[2]), n[1], n[0].max(n[2])];
        let mut found: Vec<[usize; 3]> = found.iter().map(|nodes| sorted(nodes)).collect();
        let mut expected: Vec<[usize; 3]> = expected.iter().map(|nodes| sorted(nodes)).collect();
        // At the apex of a pyramid edges meet that no side has both of.
        if element.cell == Cell::Pyramid {
            expected.extend([[0, 4, 2], [1, 4, 3]]);
        }
        found.sort();
        expected.sort();
        assert_eq!(found, expected, "{name}");
    }
    let again = text_with_angles("tri3") + "\n[[springs]]\ngroup = \"more\"\nkind = \"angle\"\nnodes = \"complete\"\n";
    let error = Element::parse(&again).unwrap_err().to_string();
    assert!(error.contains("springs[3].nodes: expected angles at the corners that have no spring yet"), "{error}");
}

#[test]
fn selective_integration_does_not_lock() {
    let full = loaded("hex8");
    let selective = example("hex8_selective");
    let bending = |element: &Element, nu: f64| {
        let x = element.positions.clone();
        let u: Vec<f64> = x.chunks_exact(3).flat_map(|x| [x[0] * x[1], -x[0] * x[0] / 2.0, 0.0]).collect();
        let moduli = Material::for_body(3, 1.0, nu, None, None).unwrap().moduli();
        let geometry = geometry(element, &x);
        let u = nalgebra::DVector::from_vec(u);
        (geometry.stiffness(moduli) * &u).dot(&u)
    };
    assert!((bending(&full, 0.0) - bending(&selective, 0.0)).abs() < 1e-13);
    assert!(bending(&full, 0.49999) > 1e4);
    assert!(bending(&selective, 0.49999) < 4.0);
    // A uniform strain has the same energy in both.
    let moduli = Material::for_body(3, 1.0, 0.49, None, None).unwrap().moduli();
    let energy = |element: &Element| {
        let geometry = geometry(element, &element.positions);
        let u = nalgebra::DVector::from_column_slice(&element.positions);
        (geometry.stiffness(moduli) * &u).dot(&u)
    };
    assert!((energy(&full) / energy(&selective) - 1.0).abs() < 1e-13);
}

/// A measure that nothing moves, or that has a kink where the body rests, is an error with the cell's name, not a number.
#[test]
fn measures_without_a_gradient_are_told() {
    let path = place("examples/elements/tri3_coupled.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let formula = "abs((x1 - x0)*(y2 - y0) - (x2 - x0)*(y1 - y0))/sqrt((x1 - x0)^2 + (y1 - y0)^2)";
    assert!(text.contains(formula));
    for measure in ["x0 - x0", "abs(x0 - x0)", "ln(x0 - x0)", "sqrt(x0 - x0)"] {
        let element = Element::parse(&text.replace(formula, measure)).unwrap();
        let names = ["edge".to_string(), "height".to_string()];
        let springs = Springs::select(&element, Some(&names)).unwrap();
        let material = Material::for_body(2, 1.0, 0.3, None, None).unwrap();
        for objective in [
            NORMS[0],
            NORMS[1],
            Objective::Spectral(MotionWeight::None),
            Objective::Divergence(Balance::new(0.0).unwrap()),
        ] {
            let x = element.positions.clone();
            let cells = [0, 1, 2, 0, 1, 2];
            let searched = Solver::General { method: Search::NelderMead, iterations: 5, topology: None };
            for solver in [Solver::Native, searched].into_iter().filter(|s| objective != NORMS[1] || *s != searched) {
                let fit = Fit { solver, ..Fit::new(objective) };
                let fits = fit_cells(&element, &springs, &x, &cells, material.moduli(), &fit, &mut |_| {});
                let error = fits.unwrap_err();
                assert_eq!(error.key(), Some("tri3_coupled cell 1"), "{measure} {objective:?}");
                assert!(error.problem().contains("no finite gradient"), "{measure} {objective:?}: {error}");
            }
        }
    }
}
