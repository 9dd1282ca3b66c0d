//! Loads and masses are integrals by rules of their own, whatever the rule of the stiffness.

use crate::shapes::{Random, elements, geometry, loaded, single};
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};
use springfit_bodies::model::{Action, Component, Lumping, lumped_masses, masses, nodal_forces};
use springfit_element::element::{Element, Integrand, Quadrature, Tabulation};
use springfit_element::stiffness::Geometry;
use springfit_foundation::symbolic::Scope;
use springfit_mesh::mesh::{BoxMesh, Selection};
use springfit_studies::study::random_shapes;

/// Reference positions under an affine map.
fn affine(element: &Element, random: &mut Random) -> Vec<f64> {
    let d = element.dimension();
    let map: Vec<f64> = (0..d * d).map(|i| if i % (d + 1) == 0 { 1.0 } else { 0.0 } + 0.2 * random.next()).collect();
    let place = |at: &[f64]| -> Vec<f64> {
        (0..d).map(|k| 0.7 + (0..d).map(|l| map[k * d + l] * at[l]).sum::<f64>()).collect()
    };
    element.positions.chunks_exact(d).flat_map(place).collect()
}

fn component(text: &str) -> Component {
    Component::Varying(Scope::new(&["x", "y", "z"]).expression(text).unwrap())
}

/// Of the second degree in space, in the plane and on a line.
const LOADS: [&str; 3] = ["2*x^2 - x + 3", "100*(y - 0.4) + x*y - 3*x^2", "z^2 + x*y - 2*y*z + 5*x - 1"];

/// Of shapes with straight and with bent edges, against a rule whose degree, 24, is above that of all polynomials here: 15 for tet20.
/// The functions of the pentagon are no polynomials.
#[test]
fn varying_loads_are_exact() {
    for element in elements() {
        let d = element.dimension();
        let load = LOADS[d - 1];
        let bent = random_shapes(&element, 2, 5).unwrap();
        let mut shapes: Vec<Vec<f64>> = bent.chunks_exact(element.nodes() * d).map(<[f64]>::to_vec).collect();
        shapes.extend((0..2).map(|seed| affine(&element, &mut Random(seed))));
        let fine = Quadrature::of_degree(element.cell, if element.name == "pentagon5" { 60 } else { 24 });
        let fine = Tabulation::new(&element.functions, &fine, None);
        for x in shapes {
            let expression = Scope::new(&["x", "y", "z"]).expression(load).unwrap();
            let mut geometry = Geometry::new(&fine);
            // Far out a bent cell may be tangled: its integral counts that as negative.
            geometry.update(&fine, &x);
            let mut expected = vec![0.0; x.len()];
            for (values, v) in fine.values.chunks_exact(fine.nodes).zip(&geometry.volumes) {
                let at = |k: usize| values.iter().zip(x.chunks_exact(d)).map(|(n, x)| n * x[k]).sum();
                let at: Vec<f64> = (0..d).map(at).chain(std::iter::repeat_n(0.0, 3 - d)).collect();
                let value = v * expression.evaluate(&at);
                expected.chunks_exact_mut(d).zip(values).for_each(|(f, n)| f[0] += n * value);
            }
            let mut body = vec![Component::Constant(0.0); d];
            body[0] = component(load);
            let mesh = single(&element, &x);
            let found = nodal_forces(&mesh, &Selection::Everything, &Action::Body(body), 1.0).unwrap();
            let size = expected.iter().fold(0.0f64, |m, f| m.max(f.abs()));
            let error = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size;
            assert!(error < 1e-10, "{}: {error:e}", element.name);
        }
    }
}

/// The resultant and the moment of a load on a unit box, whose points reproduce linear functions: `∫ b dV` and `∫ b y dV`, with
/// `b = 100 (y − 0.4)`: 10 and `100 (1/3 − 0.2)`; of a traction `y²` on one side, `1/3` and `1/4`.
#[test]
fn resultants_and_moments_are_those_of_the_load() {
    for name in ["tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "tri3", "tri6", "quad4", "quad9"] {
        let element = loaded(name);
        let d = element.dimension();
        let mesh = BoxMesh { element, size: vec![1.0; d], cells: vec![2; d], origin: vec![0.0; d] }.build();
        let Ok(mesh) = mesh else { continue };
        let sums = |forces: &[f64]| -> [f64; 2] {
            let along = |p: usize| forces[p * d];
            [
                (0..mesh.point_count()).map(along).sum(),
                (0..mesh.point_count()).map(|p| along(p) * mesh.point(p)[1]).sum(),
            ]
        };
        let of = |text: &str| {
            let mut components = vec![Component::Constant(0.0); d];
            components[0] = component(text);
            components
        };
        let body = Action::Body(of("100*(y - 0.4)"));
        let [force, moment] = sums(&nodal_forces(&mesh, &Selection::Everything, &body, 1.0).unwrap());
        assert!((force - 10.0).abs() < 1e-11 && (moment - 100.0 * (1.0 / 3.0 - 0.2)).abs() < 1e-11, "{name}: {moment}");
        let side = Action::Traction(of("y^2"));
        let [force, moment] = sums(&nodal_forces(&mesh, &Selection::Group("xmax".into()), &side, 1.0).unwrap());
        assert!((force - 1.0 / 3.0).abs() < 1e-12 && (moment - 0.25).abs() < 1e-12, "{name}: {force} {moment}");
    }
}

/// `∫ N_a` and `∫ N_a²` of the reference cell in exact fractions are those of the masses, which follow an affine map with its content.
#[test]
fn masses_are_exact_fractions() {
    let mut known = 0;
    for element in elements() {
        let Some(table) = element.rational_tabulation() else { continue };
        known += 1;
        let n = table.nodes;
        let (mut rows, mut squares) = (vec![BigRational::zero(); n], vec![BigRational::zero(); n]);
        for (values, w) in table.values.chunks_exact(n).zip(&table.weights) {
            for (a, value) in values.iter().enumerate() {
                rows[a] += w * value;
                squares[a] += w * value * value;
            }
        }
        let (content, square): (BigRational, BigRational) = (rows.iter().sum(), squares.iter().sum());
        let mesh = single(&element, &affine(&element, &mut Random(3)));
        let geometry = geometry(&element, &mesh.points);
        let total = 800.0 * geometry.content();
        let share = |part: &BigRational, of: &BigRational| (part / of).to_f64().unwrap();
        let rows: Vec<f64> = rows.iter().map(|row| total * share(row, &content)).collect();
        let squares: Vec<f64> = squares.iter().map(|own| total * share(own, &square)).collect();
        for (found, expected) in
            [(masses(&mesh, 800.0, 1.0), rows), (lumped_masses(&mesh, 800.0, 1.0, Lumping::Hrz), squares)]
        {
            for (m, e) in found.iter().zip(&expected) {
                assert!((m - e).abs() < 1e-12 * total, "{}: {m} {e}", element.name);
            }
        }
    }
    assert!(known >= 15, "{known}");
}

/// `∫ N_a N_b` by the rule for masses is that of fractions.
#[test]
fn consistent_masses_are_exact_fractions() {
    for element in elements() {
        let Some(exact) = element.rational_tabulation() else { continue };
        let (n, table) = (exact.nodes, element.integration_table(Integrand::Mass));
        for a in 0..n {
            for b in 0..=a {
                let own =
                    (0..table.points()).map(|q| table.weights[q] * table.values[q * n + a] * table.values[q * n + b]);
                let of = |q: usize| &exact.weights[q] * &exact.values[q * n + a] * &exact.values[q * n + b];
                let wanted: BigRational = (0..exact.points()).map(of).sum();
                let (own, wanted) = (own.sum::<f64>(), wanted.to_f64().unwrap());
                assert!((own - wanted).abs() < 1e-13 * element.cell.content(), "{}: {own} {wanted}", element.name);
            }
        }
    }
}

/// Loads and masses do not use the quadrature rule of the element file, here one of two points that does not integrate squares exactly.
#[test]
fn the_rule_of_the_stiffness_does_not_matter() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/elements/tet4.toml")).unwrap();
    let own = loaded("tet4");
    let rule = "rule   = \"simplex\"\ndegree = 1";
    assert!(text.contains(rule));
    let text = text.replace(
        rule,
        "rule = \"explicit\"\npoints = [[0.15, 0.25, 0.25], [0.35, 0.25, 0.25]]\n\
                                   weights = [\"1/12\", \"1/12\"]",
    );
    let other = Element::parse(&text).unwrap();
    let x = affine(&own, &mut Random(8));
    let body = Action::Body([LOADS[2], LOADS[1], LOADS[0]].map(component).into());
    let of = |element: &Element| {
        let mesh = single(element, &x);
        let forces = nodal_forces(&mesh, &Selection::Everything, &body, 1.0).unwrap();
        (forces, masses(&mesh, 1.0, 1.0), lumped_masses(&mesh, 1.0, 1.0, Lumping::Hrz))
    };
    assert_eq!(of(&own), of(&other));
}
