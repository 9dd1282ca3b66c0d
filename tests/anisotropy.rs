//! Anisotropic linear materials: blocks against their compliance in turned axes, and the isotropic law as one of them.

use crate::kit::{outcome, outcome_in, refusal};
use crate::messages::reads;
use crate::shapes::{elements, geometry, loaded};
use nalgebra::{DVector, Matrix3, Matrix6, Vector3};
use springfit_element::element::Element;
use springfit_element::material::{Anisotropy, Hooke, Material, Plane, State, Stiffness};
use springfit_element::springs::Springs;
use springfit_fit::fit::{Fit, Objective, Weight, element_errors, fit_cells, fit_element};
use springfit_studies::study::{Scene, run};
use tempfile::TempDir;

/// Numbers from 0 to 1 without pattern.
fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}

fn rotation(seed: &mut u64) -> Matrix3<f64> {
    let axis = Vector3::from_fn(|_, _| random(seed) - 0.5);
    nalgebra::Rotation3::new(axis.normalize() * (6.0 * random(seed))).into_inner()
}

const YOUNG: [f64; 3] = [9e3, 4e3, 2e3];
/// ν12, ν23, ν13.
const POISSON: [f64; 3] = [0.35, 0.25, 0.4];
/// G12, G23, G13.
const SHEAR: [f64; 3] = [1.5e3, 1e3, 2.5e3];

/// The strain of the orthotropic material under a stress, both as tensors, with its axes as columns: from the definition of the
/// constants, without a matrix of stiffness.
fn strain(axes: &Matrix3<f64>, stress: &Matrix3<f64>) -> Matrix3<f64> {
    let s = axes.transpose() * stress * axes;
    let mut e = Matrix3::zeros();
    let nu = |i: usize, j: usize| match (i.min(j), i.max(j)) {
        (0, 1) => POISSON[0] / YOUNG[0],
        (1, 2) => POISSON[1] / YOUNG[1],
        _ => POISSON[2] / YOUNG[0],
    };
    for i in 0..3 {
        e[(i, i)] = s[(i, i)] / YOUNG[i] - (0..3).filter(|j| *j != i).map(|j| nu(i, j) * s[(j, j)]).sum::<f64>();
    }
    for ((i, j), g) in [(0, 1), (1, 2), (0, 2)].into_iter().zip(SHEAR) {
        (e[(i, j)], e[(j, i)]) = (s[(i, j)] / (2.0 * g), s[(i, j)] / (2.0 * g));
    }
    axes * e * axes.transpose()
}

/// A block that is held so that every constant strain is free, pulled along z by 10 Pa at both ends.
fn block(element: &str, material: &str) -> String {
    format!(
        r#"
[mesh]
box = {{ element = "{element}", size = [1, 1, 1], cells = [2, 2, 2] }}
[material]
{material}
[[fit]]
objective = "frobenius"
[[fix]]
where = "x < 1e-9 && y < 1e-9 && z < 1e-9"
[[fix]]
where = "x > 0.999 && y < 1e-9 && z < 1e-9"
axes = ["y", "z"]
[[fix]]
where = "x < 1e-9 && y > 0.999 && z < 1e-9"
axes = ["z"]
[[load]]
name = "top"
group = "zmax"
traction = [0, 0, 10]
[[load]]
name = "bottom"
group = "zmin"
traction = [0, 0, -10]
"#
    )
}

const ORTHOTROPIC: &str =
    "orthotropic = { young = [9e3, \"4 kPa\", 2e3], poisson = [0.35, 0.25, 0.4], shear = [1.5e3, 1e3, 2.5e3] }\n";

#[test]
fn a_block_answers_with_its_compliance_in_any_axes() {
    let mut seed = 3;
    let turns = |k: usize| Matrix3::from_fn(|i, j| f64::from(u8::from((j + k) % 3 == i)));
    let axes: Vec<Matrix3<f64>> = (0..3).map(turns).chain((0..20).map(|_| rotation(&mut seed))).collect();
    let stress = Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, 10.0));
    for (i, axes) in axes.iter().enumerate() {
        let vector = |k: usize| format!("[{:?}, {:?}, {:?}]", axes[(0, k)], axes[(1, k)], axes[(2, k)]);
        let element = ["hex8", "tet4", "wedge6", "hex20"][i % 4];
        let outcome = outcome(&block(element, &format!("{ORTHOTROPIC}axes = [{}, {}]\n", vector(0), vector(1))));
        let expected = strain(axes, &stress);
        let u = |p: usize| Vector3::from_fn(|k, _| outcome.loads.iter().map(|load| load.fem[3 * p + k]).sum());
        let mesh = &outcome.mesh;
        // The displacements are linear; what they turn by does not matter.
        let at = |x: [f64; 3]| (0..mesh.point_count()).find(|p| mesh.point(*p) == x).unwrap();
        let origin = u(at([0.0; 3]));
        let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|x| u(at(x)) - origin);
        let gradient = Matrix3::from_columns(&columns);
        let found = (gradient + gradient.transpose()) / 2.0;
        assert!((found - expected).norm() < 1e-10 * expected.norm(), "{element} {i}: {found} {expected}");
    }
}

/// `1/E(θ) = c⁴/E1 + s⁴/E2 + (1/G12 − 2 ν12/E1) s² c²` in plane stress; in plane strain with `S_ij − S_i3 S_j3/S_33`.
#[test]
fn a_plane_answers_with_its_compliance() {
    for (plane, condense) in [("stress", 0.0), ("strain", 1.0)] {
        for angle in [0.0, 0.3, 1.1, 2.5f64] {
            let (c, s) = (angle.cos(), angle.sin());
            let across = |i: usize, j: usize| {
                let third = [-POISSON[2] / YOUNG[0], -POISSON[1] / YOUNG[1]];
                condense * third[i] * third[j] * YOUNG[2]
            };
            let s11 = 1.0 / YOUNG[0] - across(0, 0);
            let s22 = 1.0 / YOUNG[1] - across(1, 1);
            let s12 = -POISSON[0] / YOUNG[0] - across(0, 1);
            let expected = c.powi(4) * s11 + s.powi(4) * s22 + (1.0 / SHEAR[0] + 2.0 * s12) * (s * c).powi(2);
            let text = format!(
                "[mesh]\nbox = {{ element = \"quad4\", size = [1, 1], cells = [2, 2] }}\n[material]\n{ORTHOTROPIC}\
                 plane = \"{plane}\"\nthickness = 0.5\naxes = [[{c:?}, {s:?}], [{:?}, {c:?}]]\n[[fit]]\nobjective = \"offdiag\"\n\
                 [[fix]]\nwhere = \"x < 1e-9 && y < 1e-9\"\n[[fix]]\nwhere = \"x > 0.999 && y < 1e-9\"\naxes = [\"y\"]\n\
                 [[load]]\nname = \"right\"\ngroup = \"xmax\"\ntraction = [10, 0]\n\
                 [[load]]\nname = \"left\"\ngroup = \"xmin\"\ntraction = [-10, 0]\n",
                -s
            );
            let outcome = outcome(&text);
            let mesh = &outcome.mesh;
            let p = (0..mesh.point_count()).find(|p| mesh.point(*p) == [1.0, 0.0]).unwrap();
            let found: f64 = outcome.loads.iter().map(|load| load.fem[2 * p]).sum();
            assert!((found / (10.0 * expected) - 1.0).abs() < 1e-10, "{plane} {angle}: {found} {}", 10.0 * expected);
        }
    }
}

/// The nodes of the reference cell, moved a little.
fn distorted(element: &Element, seed: &mut u64) -> Vec<f64> {
    element.positions.iter().map(|x| x + 0.04 * (random(seed) - 0.5)).collect()
}

/// The isotropic law as a stiffness takes another path and has the same constants, of every element by every objective.
#[test]
fn an_isotropic_stiffness_is_the_isotropic_law() {
    let mut seed = 23;
    for element in elements() {
        let d = element.dimension();
        let springs = Springs::select(&element, None).unwrap();
        if springs.is_empty() || d < 2 || element.space() != d {
            continue;
        }
        let x = distorted(&element, &mut seed);
        let moduli = Material::for_body(d, 3e3, 0.3, None, None).unwrap().moduli();
        let plain = Hooke::Isotropic(moduli);
        let general = Hooke::Anisotropic(Stiffness::new(d, &plain.entries(d).0).unwrap());
        let geometry = geometry(&element, &x);
        let [a, b] = [geometry.stiffness(&plain), geometry.stiffness(&general)];
        assert!((&a - &b).norm() < 1e-12 * a.norm(), "{}", element.name);
        let large = element.nodes() * d > 30;
        for objective in Objective::all(element.has_higher_modes()) {
            if large && !matches!(objective, Objective::Frobenius(_)) {
                continue;
            }
            let fit = Fit::new(objective);
            let connectivity: Vec<usize> = (0..element.nodes()).collect();
            let all = |hooke: &Hooke| {
                let found = fit_cells(&element, &springs, &x, &connectivity, hooke.clone(), &fit, &mut |_| {}).unwrap();
                let errors = element_errors(&element, &x, &connectivity, hooke.clone(), &found).unwrap();
                (found.constants, errors.frobenius[0], found.deficient)
            };
            let ((plain, own, deficient), (general, other, _)) = (all(&plain), all(&general));
            // Iterations end where their value is known to their own accuracy.
            let tolerance = if matches!(objective, Objective::Frobenius(_)) { 1e-6 } else { 1e-4 };
            assert!((own - other).abs() < tolerance, "{} {objective:?}: {own} {other}", element.name);
            if deficient == 0 && matches!(objective, Objective::Frobenius(_)) {
                let size = plain.iter().fold(0.0f64, |a, k| a.max(k.abs()));
                for (a, b) in plain.iter().zip(&general) {
                    assert!((a - b).abs() < 1e-6 * size, "{} {objective:?}: {a} {b}", element.name);
                }
            }
        }
    }
}

/// Cells and material turned together have the same constants; cells turned alone have others.
#[test]
fn constants_turn_with_cell_and_material() {
    let mut seed = 31;
    let law = Anisotropy::orthotropic(YOUNG, POISSON, SHEAR).unwrap();
    for name in ["tet4", "hex8"] {
        let element = loaded(name);
        let springs = Springs::select(&element, None).unwrap();
        let x = distorted(&element, &mut seed);
        let q = rotation(&mut seed);
        let turned: Vec<f64> =
            x.chunks(3).flat_map(|x| (q * Vector3::from_column_slice(x)).as_slice().to_vec()).collect();
        let column = |k: usize| [q[(0, k)], q[(1, k)], q[(2, k)]];
        let own = law.turned([column(0), column(1)]).unwrap();
        let constants = |x: &[f64], law: &Anisotropy, objective: Objective| {
            let hooke = Hooke::Anisotropic(law.in_state(State::Solid).unwrap());
            DVector::from_vec(fit_element(&element, &springs, x, hooke, &Fit::new(objective)).unwrap())
        };
        for objective in Objective::all(element.has_higher_modes()) {
            let [plain, both, alone] =
                [(&x, &law), (&turned, &own), (&turned, &law)].map(|(x, law)| constants(x, law, objective));
            let tolerance = if matches!(objective, Objective::Frobenius(_)) { 1e-8 } else { 1e-3 };
            assert!((&plain - &both).norm() < tolerance * plain.norm(), "{name} {objective:?}");
            assert!((&plain - &alone).norm() > 1e-3 * plain.norm(), "{name} {objective:?}");
        }
    }
}

/// The closed forms of the families of laws.
#[test]
fn laws_are_those_of_their_constants() {
    let cubic = Anisotropy::cubic(5.0, 2.0, 3.0).unwrap();
    // 1/E along n: S11 − 2 (S11 − S12 − S44/2) (n1² n2² + n2² n3² + n3² n1²); x is n = (1/√3, 1/√2, 1/√6) in these axes.
    let s = cubic.stiffness().try_inverse().unwrap();
    let along = s[(0, 0)] - 2.0 * (s[(0, 0)] - s[(0, 1)] - s[(3, 3)] / 2.0) * 11.0 / 36.0;
    let turned = cubic.turned([[1.0, 1.0, 1.0], [1.0, -1.0, 0.0]]).unwrap();
    assert!((turned.stiffness().try_inverse().unwrap()[(0, 0)] / along - 1.0).abs() < 1e-12);
    let wood = Anisotropy::transversely_isotropic([9e3, 3e3], [0.3, 0.4], 1e3).unwrap();
    // Turned about its axis it stays as it is.
    let about = wood.turned([[1.0, 0.0, 0.0], [0.0, 0.6, 0.8]]).unwrap();
    assert!((about.stiffness() - wood.stiffness()).norm() < 1e-10 * wood.stiffness().norm());
    let steel = Material::for_body(2, 2e11, 0.3, Some(Plane::Stress), Some(0.1)).unwrap();
    let g = 2e11 / 2.6;
    let same = Anisotropy::orthotropic([2e11; 3], [0.3; 3], [g; 3]).unwrap().in_state(steel.state()).unwrap();
    let expected = Hooke::Isotropic(steel.moduli()).entries(2).0;
    same.entries().iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-9 * 2e10, "{a} {b}"));
}

/// Every objective that is not exact runs, and the network is compared with the material that was asked for.
#[test]
fn networks_are_compared_with_the_anisotropic_material() {
    let objectives = ["frobenius", "offdiag", "modal", "spectral", "divergence"];
    let fits: String = objectives.iter().map(|o| format!("[[fit]]\nobjective = \"{o}\"\n")).collect();
    let whole =
        "[[fit]]\nobjective = \"whole\"\nloads = [\"top\", \"bottom\"]\niterations = 3\nregularization = 0.01\n";
    let scene = |material: &str| {
        block("tet4", material).replace("[[fit]]\nobjective = \"frobenius\"\n", &(fits.clone() + whole))
    };
    let isotropic = "young = 3e3\npoisson = 0.25\n";
    // λ = μ = 1200
    let same = "stiffness = [[3600, 1200, 1200, 0, 0, 0], [1200, 3600, 1200, 0, 0, 0], [1200, 1200, 3600, 0, 0, 0], \
                [0, 0, 0, 1200, 0, 0], [0, 0, 0, 0, 1200, 0], [0, 0, 0, 0, 0, 1200]]\n";
    let [plain, general] = [isotropic, same].map(|material| outcome(&scene(material)));
    for (a, b) in plain.fits.iter().zip(&general.fits) {
        let difference = (a.as_material.distance - b.as_material.distance).abs();
        // Iterations end where their value is known to their own accuracy.
        let is_direct = ["frobenius", "offdiag", "modal"].iter().any(|name| a.fit.name.starts_with(name));
        let tolerance = if is_direct { 1e-6 } else { 1e-3 };
        assert!(difference < tolerance, "{}: {} {}", a.fit.name, a.as_material.distance, b.as_material.distance);
    }
    let turned = outcome(&scene(&format!("{ORTHOTROPIC}axes = [[1, 1, 0], [0, 1, 1]]\n")));
    for fit in &turned.fits {
        assert!(fit.as_material.distance.is_finite() && fit.as_material.distance > 0.01, "{}", fit.fit.name);
    }
}

/// Constants as expressions and from a file: a material whose constants are those of an isotropic one in every cell answers like it, and a
/// constant that varies has its value at the centroid of each cell.
#[test]
fn constants_vary_from_place_to_place() {
    let folder = TempDir::new().unwrap();
    let middles = (0..6).map(|i| (0.25 + 0.5 * f64::from(i % 2), (f64::from(i / 2) + 0.5) / 3.0));
    let table = middles.fold("x,y,z,shear\n".to_string(), |table, (y, z)| {
        table + &format!("0.5,{y:?},{z:?},{:?}\n", 1e3 * (1.0 + z) / 2.5)
    });
    std::fs::write(folder.path().join("g.csv"), table).unwrap();
    let of = |material: &str| {
        let text = block("hex8", material).replace("cells = [2, 2, 2]", "cells = [1, 2, 3]");
        let scene = Scene::parse(&text, &folder.path().join("scene.toml")).unwrap();
        (scene.inputs(), run(&scene, &mut |_| ()).unwrap())
    };
    let e = "\"1e3*(1 + z)\"";
    let g = "{ file = \"g.csv\", unit = \"Pa\", interpolation = \"nearest\" }";
    let axes = "axes = [[0.6, 0.8, 0], [-0.8, 0.6, 0]]\n";
    let (_, isotropic) = of(&format!("young = {e}\npoisson = 0.25\n"));
    let (c11, c12) = ("\"1.2e3*(1 + z)\"", "\"0.4e3*(1 + z)\"");
    let row = |i: usize| -> String {
        let entry = |j: usize| match (i < 3, j < 3, i == j) {
            (true, true, true) => c11,
            (true, true, false) => c12,
            (false, false, true) => g,
            _ => "0",
        };
        format!("[{}]", (0..6).map(entry).collect::<Vec<_>>().join(", "))
    };
    let rows: Vec<String> = (0..6).map(row).collect();
    for (law, files) in [
        (
            format!(
                "orthotropic = {{ young = [{e}, {e}, {e}], poisson = [0.25, \"0.25 + 0*x\", 0.25], shear = [{g}, {g}, {g}] }}\n{axes}"
            ),
            3,
        ),
        (format!("transversely-isotropic = {{ young = [{e}, {e}], poisson = [0.25, 0.25], shear = {g} }}\n"), 1),
        (format!("cubic = {{ c11 = {c11}, c12 = {c12}, c44 = {g} }}\n"), 1),
        (format!("stiffness = [{}]\n{axes}", rows.join(", ")), 3),
    ] {
        let (inputs, found) = of(&law);
        let size = isotropic.loads[0].fem.iter().fold(0.0, |a: f64, u| a.max(u.abs()));
        for (a, b) in found.loads.iter().zip(&isotropic.loads) {
            assert!(a.fem.iter().zip(&b.fem).all(|(a, b)| (a - b).abs() < 1e-10 * size), "{law}");
        }
        assert_eq!(inputs.iter().filter(|path| path.ends_with("g.csv")).count(), files, "{law}");
    }
    for (law, expected) in [
        (
            "cubic = { c11 = \"1e3*(z - 0.5)\", c12 = 0, c44 = 1e3 }\n",
            "material.cubic: … eigenvalue … in hex8 cell 1 at … m",
        ),
        (
            "cubic = { c11 = \"1/(x - x)\", c12 = 0, c44 = 1e3 }\n",
            "material.cubic.c11: expected a finite number, found … in hex8 cell 1",
        ),
        (
            "cubic = { c11 = 2e3, c12 = 0, c44 = { file = \"g.csv\", array = \"other\" } }\n",
            "g.csv:1: header: … \"other\"",
        ),
        (
            "cubic = { c11 = 2e3, c12 = 0, c44 = { file = \"g.csv\", interpolation = \"cubic\" } }\n",
            "material.cubic.c44.interpolation: … \"cubic\"",
        ),
    ] {
        let found = outcome_in(folder.path(), &block("hex8", law)).unwrap_err().to_string();
        reads(&found, &format!("…{expected}…")).unwrap();
    }
}

/// Beside an isotropic region, with axes that turn from place to place.
#[test]
fn regions_may_be_isotropic_or_not() {
    let text = "[mesh]\nbox = { element = \"hex8\", size = [1, 1, 3], cells = [1, 1, 3] }\n\
        [[material]]\nwhere = \"z < 1.00001\"\nyoung = 2e3\npoisson = 0\n\
        [[material]]\northotropic = { young = [9e3, 8e3, 7e3], poisson = [0, 0, 0], shear = [1e3, 1e3, 1e3] }\n\
        axes = [[\"cos(z)\", \"sin(z)\", 0], [\"-sin(z)\", \"cos(z)\", 0]]\n\
        [[fit]]\nobjective = \"offdiag\"\n[[fix]]\ngroup = \"zmin\"\n[[load]]\nname = \"pull\"\ngroup = \"zmax\"\ntraction = [0, 0, 10]\n";
    let outcome = outcome(text);
    let end = outcome.loads[0].fem.iter().skip(2).step_by(3).copied().fold(0.0, f64::max);
    assert!((end / (10.0 / 2e3 + 20.0 / 7e3) - 1.0).abs() < 1e-10, "{end}");
    assert!(springfit_report::report::summary(&outcome).contains("anisotropic, 2 cells"));
    // Each cell has the constants that it has alone.
    let fit = Fit::new(Objective::Frobenius(Weight::OffDiagonal));
    let block = &outcome.mesh.blocks[0];
    let springs = Springs::select(&block.element, None).unwrap();
    let moduli = outcome.material.moduli();
    let connectivity = &block.connectivity;
    let all =
        fit_cells(&block.element, &springs, &outcome.mesh.points, connectivity, moduli.block(0), &fit, &mut |_| {});
    let all = all.unwrap();
    for (cell, nodes) in block.cells().enumerate() {
        let x: Vec<f64> = nodes.iter().flat_map(|&p| outcome.mesh.point(p)).copied().collect();
        let alone = fit_element(&block.element, &springs, &x, moduli.at(0, cell), &fit).unwrap();
        let own = &all.constants[cell * springs.len()..(cell + 1) * springs.len()];
        own.iter().zip(&alone).for_each(|(a, b)| assert!((a - b).abs() < 1e-8 * 1e4, "{cell}: {a} {b}"));
    }
}

#[test]
fn wrong_laws_are_named() {
    let folder = TempDir::new().unwrap();
    let fibres = "x,y,z,a_x,a_y,a_z\n0,0,0,1,0,0\n1,1,1,0,0,0\n";
    std::fs::write(folder.path().join("fibres.csv"), fibres).unwrap();
    let stiffness = |first: &str, rest: &str| {
        let rows: Vec<String> = (1..6)
            .map(|i| format!("[{}]", (0..6).map(|j| if i == j { "1" } else { "0" }).collect::<Vec<_>>().join(", ")))
            .collect();
        format!("stiffness = [{first}, {}]\n{rest}", rows.join(", "))
    };
    let cases = [
        (stiffness("[-1, 0, 0, 0, 0, 0]", ""), "scene.toml:5: material.stiffness", "found the eigenvalue -1.000000e0 Pa"),
        (stiffness("[1, 2, 0, 0, 0, 0]", ""), "material.stiffness", "a symmetric matrix"),
        (stiffness("[1, 0, 0, 0, 0]", ""), "material.stiffness", "six rows of six numbers"),
        (stiffness("[1, 0, 0, 0, 0, 0]", "axes = [[1, 0, 0], [2, 0, 0]]\n"), "axes", "two independent vectors"),
        (stiffness("[1, 0, 0, 0, 0, 0]", "axes = [[1, 0, 0]]\n"), "material.axes", "two vectors"),
        (stiffness("[1, 0, 0, 0, 0, 0]", "axes = [[1, 0, 0], [\"x\", \"q\", 0]]\n"), "material.axes[1]", "\"q\""),
        (stiffness("[1, 0, 0, 0, 0, 0]", "young = 1e3\n"), "material.young", "belongs to isotropic materials"),
        (stiffness("[1, 0, 0, 0, 0, 0]", "law = \"neo-hookean\"\n"), "material.law", "belongs to isotropic materials"),
        ("young = 1e3\npoisson = 0.3\naxes = [[1, 0, 0], [0, 1, 0]]\n".into(), "material.axes", "belongs to anisotropic"),
        ("young = 1e3\n".into(), "scene.toml:4: material", "missing field \"poisson\""),
        ("orthotropic = { young = [1, 1], poisson = [0, 0, 0], shear = [1, 1, 1] }\n".into(), "material.orthotropic.young", "three numbers"),
        (
            "orthotropic = { young = [1, 1, 1], poisson = [2, 0, 0], shear = [1, 1, 1] }\n".into(),
            "material.orthotropic.poisson",
            "eigenvalue -1",
        ),
        ("cubic = { c11 = 1, c12 = 2, c44 = 1 }\n".into(), "material.cubic", "eigenvalue -1.000000e0 Pa"),
        (
            "transversely-isotropic = { young = [1, 1], poisson = [0, 0], shear = 1 }\naxes = [{ file = \"fibres.csv\", array = \"a\" }]\n"
                .into(),
            "axes",
            "hex8 cell",
        ),
    ];
    for (material, place, words) in cases {
        let found = outcome_in(folder.path(), &block("hex8", &material)).unwrap_err().to_string();
        assert!(found.contains(place) && found.contains(words), "{material}\n{found}\nexpected {place} {words}");
    }
    // Networks that have no form are refused where they are asked for, with those that do.
    for objective in ["exact", "van-gelder"] {
        let element = if objective == "exact" { "hex8" } else { "tet4" };
        let text = block(element, ORTHOTROPIC).replace("\"frobenius\"", &format!("\"{objective}\""));
        let found = refusal(&text);
        assert!(found.contains("fit[0].objective") && found.contains("frobenius, offdiag"), "{found}");
    }
    // A solid that cannot change its volume.
    let found = refusal(&block("hex8", "young = 1e3\npoisson = 0.5\n"));
    assert!(found.contains("take 0.4999") && found.contains("volume = \"patches\""), "{found}");
    assert!(Anisotropy::of_stiffness(Matrix6::zeros()).is_err());
}
