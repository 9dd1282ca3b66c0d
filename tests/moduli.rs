//! Moduli that networks have as materials, against published and derived figures.

use crate::shapes::{elements, loaded, materials};
use springfit_element::element::Element;
use springfit_element::material::{Material, Plane};
use springfit_element::springs::Springs;
use springfit_fit::fit::{Fit, Objective, Weight};
use springfit_studies::study::{EffectiveModuli, Lattice};
use std::sync::Arc;

const FROBENIUS: Fit = Fit {
    objective: Objective::Frobenius(Weight::None),
    tied: false,
    nonnegative: false,
    solver: springfit_fit::fit::Solver::Native,
    rest: springfit_fit::fit::Rest::Mesh,
    gap: 0.0,
};

fn lattice(name: &str, material: Material) -> Lattice {
    let element = loaded(name);
    let springs = Springs::select(&element, None).unwrap();
    Lattice::fit(&element, &springs, &vec![1.0; element.dimension()], material, &FROBENIUS).unwrap()
}

fn close(moduli: &EffectiveModuli, young: f64, poisson: f64, zener: f64, digits: f64) {
    let found = [moduli.young, moduli.poisson, moduli.zener];
    for (a, b) in found.iter().zip([young, poisson, zener]) {
        assert!((a - b).abs() < digits, "{found:?}, expected {:?}", [young, poisson, zener]);
    }
}

/// The finite elements of every file that fills boxes are the material asked for; the condition of a box near
/// incompressibility costs three digits.
#[test]
fn finite_elements_have_the_moduli_of_the_material() {
    let mut seen = 0;
    for element in elements().into_iter().map(Arc::new) {
        let springs = Springs::select(&element, None).unwrap();
        let d = element.dimension();
        for material in materials(d) {
            let size = [1.0, 1.3, 0.7];
            let Ok(lattice) = Lattice::fit(&element, &springs, &size[..d], material, &FROBENIUS) else { continue };
            let moduli = lattice.of_elements(material).unwrap();
            let (e, nu) = (material.young(), material.poisson());
            // Plane strain is the plane stress of E/(1 − ν²), ν/(1 − ν).
            let plane_strain = matches!(material.state(), springfit_element::material::State::PlaneStrain { .. });
            let (e, nu) = if plane_strain { (e / (1.0 - nu * nu), nu / (1.0 - nu)) } else { (e, nu) };
            close(&moduli, e, nu, 1.0, 1e-8 * e);
            assert!((moduli.poisson - nu).abs() < 1e-11 && (moduli.zener - 1.0).abs() < 1e-11, "{}", element.name);
            seen += 1;
        }
    }
    assert!(seen > 80, "{seen}");
}

/// A square in plane stress at ν = 1/3: the Frobenius fit, Lloyd's 5/16 and 7/16, and Baudet's constants, which hold both
/// moduli; their diagonals 1/(2(1 + ν)), sides (1 + 3ν)/(4(1 + ν)) at l = h.
#[test]
fn squares_have_the_published_moduli() {
    let third = 1.0 / 3.0;
    let material = Material::for_body(2, 1.0, third, Some(Plane::Stress), None).unwrap();
    let springs = Springs::select(&Element::load("quad4").unwrap(), None).unwrap();
    let found = lattice("quad4", material).of_springs().unwrap();
    assert!((found.young - 0.852).abs() < 5e-4 && (found.poisson - 0.404).abs() < 5e-4, "{found:?}");
    let with = |edge: f64, diagonal: f64| {
        let side = |&[a, b]: &[usize; 2]| (a + b) % 2 == 1;
        let constants = springs.pairs().iter().map(|pair| if side(pair) { edge } else { diagonal }).collect();
        lattice("quad4", material).with_constants(constants).of_springs().unwrap()
    };
    let lloyd = with(5.0 / 16.0, 7.0 / 16.0);
    assert!((lloyd.young - 0.882).abs() < 5e-4 && (lloyd.poisson - 0.412).abs() < 5e-4, "{lloyd:?}");
    let baudet = with((1.0 + 3.0 * third) / (4.0 * (1.0 + third)), 1.0 / (2.0 * (1.0 + third)));
    close(&baudet, 1.0, third, 1.0, 1e-12);
}

/// A cube at ν = 1/4: the Frobenius fit, and Baudet's constants, E and G of which are the material's.
#[test]
fn cubes_have_the_published_moduli() {
    let material = Material::for_body(3, 1.0, 0.25, None, None).unwrap();
    let found = lattice("hex8", material).of_springs().unwrap();
    assert!((found.young - 0.726).abs() < 5e-4 && (found.poisson - 0.273).abs() < 5e-4, "{found:?}");
    assert!((found.zener - 1.20).abs() < 5e-3, "{found:?}");
    let element = loaded("hex8");
    let springs = Springs::select(&element, None).unwrap();
    let [edge, diagonal] = [(4.0 * 0.25 + 1.0) / (8.0 * 1.25), 3.0 / (8.0 * 1.25)];
    let constant = |&[a, b]: &[usize; 2]| {
        let differ = (0..3).filter(|k| element.positions[3 * a + k] != element.positions[3 * b + k]).count();
        [edge, 0.0, diagonal][differ - 1]
    };
    let constants = springs.pairs().iter().map(constant).collect();
    let baudet = lattice("hex8", material).with_constants(constants).of_springs().unwrap();
    close(&baudet, 1.0, 0.25, 1.0, 1e-12);
}

/// Springs that span every stiffness of their element are the material.
#[test]
fn exact_springs_have_the_moduli_of_the_material() {
    for name in ["tri3_coupled", "tet4_coupled"] {
        let path = format!("{}/examples/elements/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let material = Material::for_body(if name.starts_with("tri") { 2 } else { 3 }, 1.0, 0.3, None, None).unwrap();
        close(&lattice(&path, material).of_springs().unwrap(), 1.0, 0.3, 1.0, 1e-10);
    }
}

/// A body of finite elements is its material whatever its mesh, and one of equal cubes is the lattice of the cube. Rounding
/// of the sparse solution is below 1e-9.
#[test]
fn bodies_have_the_moduli_of_what_they_are_made_of() {
    let scene = |name: &str| {
        let path = format!("{}/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let scene = springfit_studies::study::Scene::load(path.as_ref()).unwrap();
        let first = scene.fits()[..1].to_vec();
        let output = springfit_studies::study::Output { moduli: true, ..scene.output().clone() };
        springfit_studies::study::run(&scene.without_loads().with_fits(first).with_output(output), &mut |_| {}).unwrap()
    };
    for name in ["cube_tet", "cube_hex"] {
        let outcome = scene(name);
        let entries = springfit_bodies::model::finite_elements(&outcome.mesh, outcome.material.moduli());
        let found = springfit_studies::study::moduli_of_body(&outcome.mesh, &entries).unwrap().unwrap();
        close(&found, 1e4, 0.3, 1.0, 1e-5);
        assert!((found.poisson - 0.3).abs() < 1e-9 && (found.zener - 1.0).abs() < 1e-9, "{found:?}");
    }
    let outcome = scene("cube_hex");
    let found = outcome.fits[0].moduli.as_ref().unwrap();
    let expected = lattice("hex8", outcome.material.uniform().unwrap()).of_springs().unwrap();
    close(found, expected.young, expected.poisson, expected.zener, 1e-5);
    assert!((found.zener - expected.zener).abs() < 1e-9);
}

/// In plane strain the boundary is that of the plane stress of E/(1 − ν²) and ν/(1 − ν); what is reported is the solid, as in the table
/// of the network as a material. The network of linear triangles with the energy of the finite elements is that solid.
#[test]
fn the_moduli_of_a_whole_network_in_plane_strain_are_those_of_the_solid() {
    let text = "[mesh]\nbox = { element = \"tri3\", size = [1, 1], cells = [3, 3] }\n\
                [material]\nyoung = 10e3\npoisson = 0.3\nplane = \"strain\"\nthickness = 0.5\n\
                [[fit]]\nobjective = \"exact\"\n[output]\nmoduli = true\n";
    let scene = springfit_studies::study::Scene::parse(text, std::path::Path::new("scene.toml")).unwrap();
    let outcome = springfit_studies::study::run(&scene, &mut |_| {}).unwrap();
    let record = &springfit_report::report::Report::of(&outcome).fits[0];
    let (whole, sampled) = (record.effective_young.unwrap(), record.as_material.young.unwrap());
    assert!((whole - 1e4).abs() < 1e-5 && (sampled - 1e4).abs() < 1e-5, "{whole} {sampled}");
    let (whole, sampled) = (record.effective_poisson.unwrap(), record.as_material.poisson.unwrap());
    assert!((whole - 0.3).abs() < 1e-9 && (sampled - 0.3).abs() < 1e-9, "{whole} {sampled}");
    let notes = springfit_report::report::notes(&outcome).join("\n");
    assert!(notes.contains("the whole network has E = 1.0000e4 Pa, nu = 0.300"), "{notes}");
}
