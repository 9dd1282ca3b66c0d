//! Exact networks are the finite element: energies, forces and tangents of every element, bodies under loads, frequencies and
//! motion; and networks with volume springs on cells and patches, which do not lock.

use crate::shapes::bodies::grid;
use crate::shapes::statics::{assert_derivatives, dense};
use crate::shapes::{Random, elements, geometry, loaded, materials, single, valid};
use nalgebra::{DMatrix, DVector};
use springfit_bodies::dynamics::{Drive, Integrator, Motion, Options, Simulation, StepOutcome};
use springfit_bodies::model::{
    Body, Elastic, Lumping, Network, Support, exact_network, fibre_springs, finite_elements, lumped_masses,
    patch_springs,
};
use springfit_bodies::solve::{System, lowest_modes};
use springfit_element::material::{Energy, Material, Moduli, Plane, State};
use springfit_element::springs::Measure;
use springfit_fit::fit::{CellFits, ExactEnergy, ExactFit, ShearSprings, VolumeSprings, element_errors, fit_exact};
use springfit_mesh::mesh::Mesh;
use springfit_studies::study::{Scene, run};
use std::path::Path;
use std::sync::Arc;

const POINTS: ExactFit = ExactFit {
    energy: ExactEnergy::StableNeoHookean,
    shear: ShearSprings::Cells,
    volume: VolumeSprings::Points,
    large: false,
};

fn cells(mesh: &Mesh, material: Material, fit: ExactFit) -> CellFits {
    let block = &mesh.blocks[0];
    fit_exact(&block.element, &mesh.points, &block.connectivity, material, &fit, &mut |_| {}).unwrap()
}

fn network(mesh: &Mesh, material: Material, fit: ExactFit) -> Network {
    Network::assemble(mesh, &[cells(mesh, material, fit)])
}

/// The force at rest, relative to the largest force of one spring there.
fn force_at_rest(network: &Network, mesh: &Mesh) -> f64 {
    let mut force = vec![0.0; mesh.points.len()];
    assert!(network.forces(&mesh.points, &mut force));
    let d = mesh.dimension;
    let tension = |s: &springfit_bodies::model::LengthSpring| {
        let [a, b] = s.points.map(|p| DVector::from_column_slice(mesh.point(p)));
        s.pull((a - b).norm())[1].abs()
    };
    let largest = network.lengths.iter().map(tension).fold(0.0, f64::max);
    assert!(largest > 0.0 || d == 1);
    force.iter().fold(0.0f64, |a, f| a.max(f.abs())) / largest
}

/// `Σ_q w_q |F_q|² = −Σ_{a<b} L_ab |x_a − x_b|²` for every element and its quadrature.
#[test]
fn squares_of_edges_are_the_square_of_the_gradient() {
    for element in elements() {
        let (n, d) = (element.nodes(), element.dimension());
        let mut random = Random(31);
        for _ in 0..3 {
            let x = valid(&element, &mut random);
            let geometry = geometry(&element, &x);
            let now: Vec<f64> = x.iter().map(|x| x * 1.3 + random.next()).collect();
            let (mut gradient, mut edges) = (0.0, 0.0);
            for (g, v) in geometry.gradients.chunks_exact(n * d).zip(&geometry.volumes) {
                let g = DMatrix::from_row_slice(n, d, g);
                let f = DMatrix::from_row_slice(n, d, &now).transpose() * &g;
                gradient += v * f.norm_squared();
                for (a, b) in (0..n).flat_map(|b| (0..b).map(move |a| (a, b))) {
                    let apart: f64 = (0..d).map(|k| (now[a * d + k] - now[b * d + k]).powi(2)).sum();
                    edges -= v * g.row(a).dot(&g.row(b)) * apart;
                }
            }
            assert!((gradient - edges).abs() < 1e-12 * gradient, "{}: {gradient} {edges}", element.name);
        }
    }
}

/// The tangent at rest is R in every state, and no force is left.
#[test]
fn tangents_at_rest_are_the_stiffness() {
    for element in elements().into_iter().map(Arc::new) {
        let d = element.dimension();
        let mut random = Random(32);
        for material in materials(d) {
            let mesh = single(&element, &valid(&element, &mut random));
            let r = dense(mesh.points.len(), &finite_elements(&mesh, material.moduli()));
            for energy in
                [ExactEnergy::StableNeoHookean, ExactEnergy::NeoHookean, ExactEnergy::StableMooneyRivlin { share: 0.3 }]
            {
                let fit = ExactFit { energy, ..POINTS };
                let network = network(&mesh, material, fit);
                let error = (dense(mesh.points.len(), &network.stiffness(&mesh.points)) - &r).norm() / r.norm();
                let name = format!("{} {energy:?} nu = {}", element.name, material.poisson());
                assert!(error < 1e-12, "{name}: {error:e}");
                let left = force_at_rest(&network, &mesh);
                assert!(left < 1e-12, "{name}: {left:e}");
                let fits = cells(&mesh, material, fit);
                let block = &mesh.blocks[0];
                let errors = element_errors(&element, &mesh.points, &block.connectivity, material.moduli(), &fits);
                let errors = errors.unwrap();
                assert!(errors.frobenius[0] < 1e-12 && errors.spectral[0] < 1e-12, "{name}: {errors:?}");
            }
        }
    }
}

/// Rules of their own for the term λ (div u)² are kept, in elements of users too.
#[test]
fn volumetric_rules_are_kept() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/elements/hex8_selective.toml");
    let element = loaded(path);
    let material = Material::new(1e4, 0.4999, State::Solid).unwrap();
    let mesh = single(&element, &valid(&element, &mut Random(33)));
    let r = dense(mesh.points.len(), &finite_elements(&mesh, material.moduli()));
    let network = network(&mesh, material, POINTS);
    let error = (dense(mesh.points.len(), &network.stiffness(&mesh.points)) - &r).norm() / r.norm();
    assert!(error < 1e-12, "{error:e}");
    assert!(force_at_rest(&network, &mesh) < 1e-9);
}

/// The energy is the body's at any deformation: of solids, in plane strain, in plane stress and in rods.
#[test]
fn energies_are_those_of_the_body() {
    for element in elements().into_iter().map(Arc::new) {
        let d = element.dimension();
        let mut random = Random(34);
        for material in materials(d).into_iter().filter(|m| m.poisson() > -0.5) {
            let condensed = matches!(material.state(), State::PlaneStress { .. } | State::Rod { .. });
            for (energy, law) in [
                (ExactEnergy::StableNeoHookean, "stable-neo-hookean"),
                (ExactEnergy::NeoHookean, "neo-hookean"),
                (ExactEnergy::StableMooneyRivlin { share: 0.25 }, "stable-mooney-rivlin"),
            ] {
                let law = Energy::load(law, material).unwrap();
                let mesh = single(&element, &valid(&element, &mut random));
                let fit = ExactFit { energy, large: true, ..POINTS };
                let block = &mesh.blocks[0];
                let found = fit_exact(&element, &mesh.points, &block.connectivity, material, &fit, &mut |_| {});
                if condensed && energy != ExactEnergy::StableNeoHookean {
                    let error = found.unwrap_err().to_string();
                    assert!(error.starts_with("energy: expected \"stable-neo-hookean\""), "{error}");
                    continue;
                }
                let network = Network::assemble(&mesh, &[found.unwrap()]);
                let laws = (law.clone(), material.state()).into();
                let body = Body::new(&mesh, &laws);
                let rest = Elastic::energy(&network, &mesh.points).unwrap();
                let mut tried = 0;
                while tried < 3 {
                    let x: Vec<f64> = mesh.points.iter().map(|x| 1.1 * x + 0.25 * random.next()).collect();
                    let Some(expected) = body.respond(&x) else { continue };
                    if body.inverted(&x) > 0 {
                        continue;
                    }
                    tried += 1;
                    let found = network.respond(&x).unwrap();
                    let name =
                        format!("{} {energy:?} {:?} nu = {}", element.name, material.state(), material.poisson());
                    let change = found.energy - rest;
                    // Energies of laws are integrals by quadrature; of linear springs they are large and cancel.
                    let (size, known) = if fit_is_linear(&network) {
                        (rest.abs() + expected.energy, 1e-12)
                    } else {
                        (expected.energy, 1e-12)
                    };
                    assert!((change - expected.energy).abs() < known * size, "{name}: {change} {}", expected.energy);
                    let norm = expected.force.iter().map(|f| f * f).sum::<f64>().sqrt();
                    for (a, b) in found.force.iter().zip(&expected.force) {
                        assert!((a - b).abs() < 1e-11 * norm, "{name}: {a} {b}");
                    }
                    let (k, t) = (dense(x.len(), &found.tangent), dense(x.len(), &expected.tangent));
                    assert!((&k - &t).norm() < 1e-11 * t.norm(), "{name}: {:e}", (&k - &t).norm() / t.norm());
                }
            }
        }
    }
}

fn fit_is_linear(network: &Network) -> bool {
    network.others.iter().all(|spring| spring.law.is_none())
}

/// Springs on content at a point, on areas and on patches: first and second derivatives against differences.
#[test]
fn measures_have_the_derivatives_of_differences() {
    let check = |measure: &Measure, x: &[f64], d: usize, name: &str| {
        let jet = measure.jet(x, d);
        assert!((jet.value - measure.value(x, d)).abs() < 1e-14 * (1.0 + jet.value.abs()), "{name}");
        let gradient = measure.gradient(x, d);
        assert!(gradient.iter().zip(&jet.gradient).all(|(a, b)| (a - b).abs() < 1e-14 * (1.0 + b.abs())), "{name}");
        let at = |x: &[f64]| (measure.value(x, d), measure.gradient(x, d));
        assert_derivatives(name, x, (1e-5, [1e-8; 2]), at, |i, j| jet.hessian[i * x.len() + j]);
    };
    let mut random = Random(35);
    for element in elements().into_iter().filter(|e| e.nodes() < 10) {
        let d = element.dimension();
        let flat = Arc::new(element.clone());
        let x = valid(&element, &mut random);
        let q = element.tabulation.points() as u32 - 1;
        check(&Measure::PointContent(flat.clone(), q), &x, d, &element.name);
        if d == 3 {
            let material = Material::new(1.0, 0.3, State::Solid).unwrap();
            let fit = ExactFit { energy: ExactEnergy::StableMooneyRivlin { share: 0.5 }, ..POINTS };
            for table in cells(&single(&flat, &x), material, fit).springs.areas() {
                check(&Measure::Span(table.clone()), &x, d, &format!("{} area", element.name));
            }
        } else {
            // A surface or curve in space.
            let bent: Vec<f64> =
                x.chunks_exact(d).flat_map(|x| [x[0], *x.get(1).unwrap_or(&0.3), 0.2 * x[0] * x[0]]).collect();
            let embedded = Arc::new(element.in_space(3));
            check(&Measure::PointContent(embedded, q), &bent, 3, &format!("{} in space", flat.name));
        }
    }
    let mesh = grid("tet4", &[1.0; 3], &[1; 3]);
    let material = Material::new(1.0, 0.4, State::Solid).unwrap();
    let fit = ExactFit { volume: VolumeSprings::Patches, ..POINTS };
    for spring in patch_springs(&mesh, material, &fit, &[]).unwrap() {
        let x: Vec<f64> = spring.points.iter().flat_map(|p| mesh.point(*p)).map(|x| x + 0.1 * random.next()).collect();
        check(&spring.measure, &x, 3, "patch");
    }
}

/// On cells, the term in λ is that of the mean dilatation: `R(0, μ) + λ/V (∫∇N)(∫∇N)ᵀ`, at rest without force.
#[test]
fn volume_springs_on_cells_are_selective_integration() {
    for element in elements().into_iter().filter(|e| e.dimension() > 1).map(Arc::new) {
        let d = element.dimension();
        let plane = (d == 2).then_some(Plane::Strain);
        let material = Material::for_body(d, 1e4, 0.4999, plane, None).unwrap();
        let mesh = single(&element, &valid(&element, &mut Random(36)));
        let Moduli { lambda, mu } = material.moduli();
        let geometry = geometry(&element, &mesh.points);
        let g = DVector::from_vec(geometry.content_gradient());
        let expected =
            geometry.stiffness(Moduli { lambda: 0.0, mu }) + &g * g.transpose() * (lambda / geometry.content());
        for energy in [ExactEnergy::StableNeoHookean, ExactEnergy::NeoHookean] {
            let fit = ExactFit { energy, volume: VolumeSprings::Cells, ..ExactFit::default() };
            let network = network(&mesh, material, fit);
            let found = dense(mesh.points.len(), &network.stiffness(&mesh.points));
            let error = (&found - &expected).norm() / expected.norm();
            assert!(error < 1e-12, "{} {energy:?}: {error:e}", element.name);
            assert!(force_at_rest(&network, &mesh) < 1e-9, "{}", element.name);
        }
    }
}

/// `Σ_n V_n λ/2 (J_n − 1)²` beside the cells' part in μ, each cell shared among its free points.
#[test]
fn patches_have_their_energy() {
    let mesh = grid("tet4", &[1.0; 3], &[2, 2, 2]);
    let material = Material::new(1.0, 0.49, State::Solid).unwrap();
    let Moduli { lambda, mu } = material.moduli();
    let held: Vec<bool> = (0..mesh.point_count()).map(|p| mesh.point(p)[2] == 0.0).collect();
    let mut random = Random(37);
    let x: Vec<f64> = mesh.points.iter().map(|x| 1.1 * x + 0.1 * random.next()).collect();
    let block = &mesh.blocks[0];
    let volume = |x: &[f64], nodes: &[usize]| {
        let at = |a: usize| DVector::from_column_slice(&x[3 * nodes[a]..3 * nodes[a] + 3]);
        DMatrix::from_columns(&[at(1) - at(0), at(2) - at(0), at(3) - at(0)]).determinant() / 6.0
    };
    for held in [&held[..], &[]] {
        for energy in [ExactEnergy::StableNeoHookean, ExactEnergy::NeoHookean] {
            let fit = ExactFit { energy, volume: VolumeSprings::Patches, large: true, ..ExactFit::default() };
            let network = exact_network(&mesh, &material.into(), &fit, held).unwrap();
            let found = Elastic::energy(&network, &x).unwrap() - Elastic::energy(&network, &mesh.points).unwrap();
            let (mut now, mut rest) = (vec![0.0; mesh.point_count()], vec![0.0; mesh.point_count()]);
            let mut expected = 0.0;
            let solid = |lambda| Moduli { lambda, mu };
            assert_eq!(solid(lambda), material.moduli());
            for nodes in block.cells() {
                let (v, v0) = (volume(&x, nodes), volume(&mesh.points, nodes));
                let j = v / v0;
                let at = |x: &[f64], a: usize| DVector::from_column_slice(&x[3 * nodes[a]..3 * nodes[a] + 3]);
                let edges = |x: &[f64]| DMatrix::from_columns(&[1, 2, 3].map(|a| at(x, a) - at(x, 0)));
                let f = edges(&x) * edges(&mesh.points).try_inverse().unwrap();
                let own = match energy {
                    ExactEnergy::NeoHookean => -mu * j.ln(),
                    _ => -mu * (j - 1.0) + mu / 2.0 * (j - 1.0).powi(2),
                };
                expected += v0 * (mu / 2.0 * (f.norm_squared() - 3.0) + own);
                let free: Vec<usize> = nodes.iter().copied().filter(|p| held.get(*p) != Some(&true)).collect();
                for p in &free {
                    now[*p] += v / free.len() as f64;
                    rest[*p] += v0 / free.len() as f64;
                }
            }
            for (v, v0) in now.iter().zip(&rest).filter(|(_, v0)| **v0 > 0.0) {
                let j = v / v0;
                expected +=
                    v0 * lambda / 2.0 * if energy == ExactEnergy::NeoHookean { j.ln() } else { j - 1.0 }.powi(2);
            }
            let known = if energy == ExactEnergy::NeoHookean { 1e-9 } else { 1e-12 };
            assert!((found - expected).abs() < known * expected, "{energy:?}: {found} {expected}");
            assert!(force_at_rest(&network, &mesh) < 1e-10);
        }
    }
}

/// Frequencies of the body, and 200 steps of its motion at large deformation, with every integrator.
#[test]
fn frequencies_and_motion_are_those_of_the_body() {
    let material = Material::new(1e4, 0.3, State::Solid).unwrap();
    let law = Energy::load("stable-neo-hookean", material).unwrap();
    for element in ["tet4", "hex8"] {
        let mesh = grid(element, &[0.02; 3], &[2, 2, 2]);
        let network = network(&mesh, material, ExactFit { large: true, ..POINTS });
        let laws = (law.clone(), State::Solid).into();
        let body = Body::new(&mesh, &laws);
        let masses = lumped_masses(&mesh, 1000.0, 1.0, Lumping::Hrz);
        let mut support = Support::free(&mesh);
        let held: Vec<usize> = (0..mesh.point_count()).filter(|p| mesh.point(*p)[2] == 0.0).collect();
        support.fix(&held, &[0, 1, 2], 3);
        let modes = [network.stiffness(&mesh.points), finite_elements(&mesh, material.moduli())].map(|entries| {
            let system = System::new(&entries, &support).unwrap();
            let factor = system.cholesky().unwrap().unwrap();
            lowest_modes(&system, &factor, &masses, 3, 10).unwrap().frequencies()
        });
        for (a, b) in modes[0].iter().zip(&modes[1]) {
            assert!((a - b).abs() < 1e-9 * b, "{element}: {a} {b}");
        }
        let weight = Drive::default().gravity(&[0.0, 30.0, -9.81]);
        for (integrator, step) in [
            (Integrator::SymplecticEuler, 2e-4),
            (Integrator::ImplicitEuler, 1e-3),
            (Integrator::Newmark { beta: 0.25, gamma: 0.5 }, 1e-3),
        ] {
            let models: [&dyn Elastic; 2] = [&network, &body];
            let ends = models.map(|model| {
                let motion = Motion {
                    support: support.clone(),
                    drive: weight.clone(),
                    ..Motion::free(model, &mesh.points, &masses)
                };
                let options = Options { step, integrator, tolerance: 1e-13, ..Options::default() };
                let mut simulation = Simulation::new(motion, options).unwrap();
                for _ in 0..200 {
                    assert_eq!(simulation.step().outcome, StepOutcome::Converged, "{element} {integrator:?}");
                }
                simulation.state().displacement.clone()
            });
            let size = ends[1].iter().fold(0.0f64, |a, u| a.max(u.abs()));
            let apart = ends[0].iter().zip(&ends[1]).fold(0.0f64, |a, (u, v)| a.max((u - v).abs()));
            println!("{element} {integrator:?}: largest displacement {size:e}, apart {:e}", apart / size);
            assert!(size > 1e-3 && apart < 1e-9 * size, "{element} {integrator:?}: {:e}", apart / size);
        }
    }
}

/// What no exact network can be is one line that says what is possible.
#[test]
fn what_cannot_be_exact_is_an_error() {
    let scene = |mesh: &str, material: &str, fit: &str| {
        let text = format!(
            "[mesh]\nbox = {{ {mesh} }}\n[material]\nyoung = 1\npoisson = 0.3\n{material}\n[[fit]]\nobjective = \"exact\"\n{fit}\n"
        );
        Scene::parse(&text, Path::new("scene.toml")).and_then(|scene| run(&scene, &mut |_| {})).map(|_| ()).unwrap_err()
    };
    let solid = "element = \"tet4\", size = [1, 1, 1], cells = [1, 1, 1]";
    let plane = "element = \"tri3\", size = [1, 1], cells = [1, 1]";
    for (mesh, material, fit, start) in [
        (
            solid,
            "law = \"yeoh\"",
            "",
            "scene.toml: fit[0].objective: expected a law that is \"stable-neo-hookean\", \"neo-hookean\"",
        ),
        (
            solid,
            "",
            "volume = \"nodes\"",
            "scene.toml: fit[0].volume: expected one of points, cells, patches, found \"nodes\"",
        ),
        (solid, "", "energy = \"yeoh\"", "scene.toml: fit[0].energy: expected one of stable-neo-hookean, neo-hookean"),
        (solid, "", "share = 0.5", "scene.toml: fit[0].share: belongs to the energy \"stable-mooney-rivlin\""),
        (
            solid,
            "",
            "energy = \"stable-mooney-rivlin\"\nshare = 1.5",
            "scene.toml: fit[0].share: expected a share from 0 to 1, found 1.5",
        ),
        (solid, "", "springs = [\"edge\"]", "scene.toml: fit[0].springs: expected no groups"),
        (solid, "", "weight = \"modal\"", "scene.toml: fit[0].weight: does not go with the objective \"exact\""),
        (
            "element = \"hex8\", size = [1, 1, 1], cells = [1, 1, 1]",
            "",
            "volume = \"patches\"",
            "scene.toml: fit[0].volume: expected \"points\" or \"cells\": patches are for meshes of linear triangles",
        ),
        (
            plane,
            "law = \"neo-hookean\"",
            "",
            "scene.toml: fit[0].energy: expected \"stable-neo-hookean\": the stretch across planes",
        ),
        (
            plane,
            "law = \"stable-neo-hookean\"",
            "volume = \"cells\"",
            "scene.toml: fit[0].volume: expected \"points\" at large deformation without stress",
        ),
    ] {
        let error = scene(mesh, material, fit).to_string();
        let (place, rest) = error.split_once(": ").unwrap();
        assert!(place.strip_prefix("scene.toml:").is_some_and(|line| line.parse::<usize>().is_ok()), "{fit}: {error}");
        assert!(format!("scene.toml: {rest}").starts_with(start), "{fit}: {error}");
    }
}

/// Fibres are springs on their stretch: energy, forces and tangent of a law with fibres, recognised by its values and not by its name.
#[test]
fn fibres_are_springs() {
    let material = Material::new(1e4, 0.3, State::Solid).unwrap();
    let shipped = Energy::load("fibre", material).unwrap();
    let turned = "name = \"mine\"\ntitle = \"t\"\nfibre = [1, 2, -1]\nenergy = \"mu/2*(I1 - 3) - mu*ln(J) + lambda/2*ln(J)^2 \
                  + 0.3*mu*(I4 - 1)^2\"";
    let mine = Energy::parse(turned, material).unwrap();
    for law in [shipped, mine] {
        assert_eq!(ExactEnergy::of_law(&law), Some(ExactEnergy::NeoHookean));
        for element in ["tet4", "hex8"] {
            let element = loaded(element);
            let mut random = Random(39);
            let mesh = single(&element, &valid(&element, &mut random));
            let fit = ExactFit { energy: ExactEnergy::NeoHookean, large: true, ..POINTS };
            let mut network = network(&mesh, material, fit);
            network.others.extend(fibre_springs(&mesh, material, &law).unwrap());
            let laws = (law.clone(), State::Solid).into();
            let body = Body::new(&mesh, &laws);
            let rest = Elastic::energy(&network, &mesh.points).unwrap();
            let x: Vec<f64> = mesh.points.iter().map(|x| 1.1 * x + 0.05 * random.next()).collect();
            let (found, expected) = (network.respond(&x).unwrap(), body.respond(&x).unwrap());
            let name = format!("{} {}", law.name(), element.name);
            assert!((found.energy - rest - expected.energy).abs() < 1e-12 * (rest + expected.energy), "{name}");
            let norm = expected.force.iter().map(|f| f * f).sum::<f64>().sqrt();
            assert!(found.force.iter().zip(&expected.force).all(|(a, b)| (a - b).abs() < 1e-11 * norm), "{name}");
            let (k, t) = (dense(x.len(), &found.tangent), dense(x.len(), &expected.tangent));
            assert!((&k - &t).norm() < 1e-11 * t.norm(), "{name}: {:e}", (&k - &t).norm() / t.norm());
        }
    }
    let plane = Material::for_body(2, 1.0, 0.3, Some(Plane::Strain), None).unwrap();
    let out_of_plane = Energy::parse(&turned.replace("ln(J)^2", "ln(J)^2 "), plane).unwrap();
    let element = loaded("tri3");
    let error = fibre_springs(&single(&element, &element.positions.clone()), plane, &out_of_plane).unwrap_err();
    assert!(error.to_string().contains("in the plane of one without strain across it"), "{error}");
    for (name, known) in [("neo-hookean", true), ("stable-mooney-rivlin", true), ("yeoh", false), ("ogden", false)] {
        assert_eq!(ExactEnergy::of_law(&Energy::load(name, material).unwrap()).is_some(), known, "{name}");
    }
}
