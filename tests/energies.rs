//! Every shipped energy: stress and tangent against differences, linear elasticity at rest, closed forms.

use crate::messages::reads;

use crate::shapes::Random;
use nalgebra::{Matrix3, SMatrix, Vector3};
use springfit_element::material::{Energy, Material, Moduli, SHIPPED, State};

fn solid(young: f64, poisson: f64) -> Material {
    Material::new(young, poisson, State::Solid).unwrap()
}

fn energies(poisson: f64) -> Vec<Energy> {
    SHIPPED.iter().map(|(name, _)| Energy::load(name, solid(1.0, poisson)).unwrap()).collect()
}

/// At rest, near it, at equal stretches, in shear and at random deformations of half the size.
fn deformations() -> Vec<Matrix3<f64>> {
    let mut random = Random(3);
    let shear = Matrix3::new(1.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    let turn = *nalgebra::Rotation3::from_euler_angles(0.3, -1.2, 2.0).matrix();
    let mut all = vec![
        Matrix3::identity(),
        Matrix3::identity() * 1.2,
        Matrix3::from_diagonal(&Vector3::new(1.5, 0.8, 0.8)),
        shear,
        turn * shear,
        turn,
        Matrix3::from_diagonal(&Vector3::new(1.1, 1.1 * (1.0 + 3e-7), 0.9)),
    ];
    while all.len() < 30 {
        let size = if all.len() < 15 { 0.01 } else { 0.5 };
        let f = Matrix3::identity() + size * Matrix3::from_fn(|_, _| random.next());
        if f.determinant() > 0.2 {
            all.push(f);
        }
    }
    all
}

/// Central differences of step 1e-5 err by 1e-10 of the third derivative; where two stretches are nearly equal the tangent
/// has an error of 1e-10 of its own.
#[test]
fn stresses_and_tangents_are_those_of_differences() {
    for energy in energies(0.3) {
        for f in deformations() {
            let (_, stress, tangent) = energy.respond(&f);
            let size = tangent.norm();
            assert!((energy.stress(&f) - stress).norm() < 1e-12 * size, "{} {f}", energy.name());
            for k in 0..9 {
                let moved = |h: f64| {
                    let mut f = f;
                    f[(k / 3, k % 3)] += h;
                    energy.respond(&f)
                };
                let (ahead, behind) = (moved(1e-5), moved(-1e-5));
                let slope = (ahead.0 - behind.0) / 2e-5;
                assert!((slope - stress[(k / 3, k % 3)]).abs() < 1e-7 * size, "{} {f}", energy.name());
                for l in 0..9 {
                    let slope = (ahead.1[(l / 3, l % 3)] - behind.1[(l / 3, l % 3)]) / 2e-5;
                    assert!((slope - tangent[(l, k)]).abs() < 1e-7 * size, "{} {f} {l} {k}", energy.name());
                }
            }
            assert!((tangent - tangent.transpose()).norm() < 1e-12 * size, "{}", energy.name());
        }
    }
}

/// `∂P/∂F = λ δ_ij δ_kl + μ (δ_ik δ_jl + δ_il δ_jk)` with the λ and μ asked for. Fibres add their own stiffness along them:
/// there across them only.
#[test]
fn energies_are_linear_elasticity_at_rest() {
    for poisson in [-0.4, 0.0, 0.3, 0.45] {
        let (lambda, mu) = (poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), 0.5 / (1.0 + poisson));
        let same = |a: usize, b: usize| f64::from(u8::from(a == b));
        let expected = SMatrix::<f64, 9, 9>::from_fn(|r, s| {
            let (i, j, k, l) = (r / 3, r % 3, s / 3, s % 3);
            lambda * same(i, j) * same(k, l) + mu * (same(i, k) * same(j, l) + same(i, l) * same(j, k))
        });
        for energy in energies(poisson) {
            let (value, stress, mut tangent) = energy.respond(&Matrix3::identity());
            assert!(value.abs() < 1e-14 && stress.norm() < 1e-14, "{}", energy.name());
            if energy.name() == "fibre" {
                let along = tangent[(0, 0)] - expected[(0, 0)];
                // ½·stiffness·mu·(4·2) with stiffness = 1/2: 4 stiffness mu
                assert!((along - 2.0 * mu).abs() < 1e-12, "{along}");
                tangent[(0, 0)] = expected[(0, 0)];
            }
            assert!((tangent - expected).norm() < 1e-9, "{} {poisson}: {}", energy.name(), (tangent - expected).norm());
        }
    }
}

/// A turned body has the same energy and turned stresses; a reference that is turned too, for those without fibres.
#[test]
fn energies_do_not_see_rotations() {
    let turn = *nalgebra::Rotation3::from_euler_angles(0.7, 0.2, -1.1).matrix();
    for energy in energies(0.3) {
        for f in deformations() {
            let (value, stress, _) = energy.respond(&f);
            let (turned, turned_stress, _) = energy.respond(&(turn * f));
            assert!((value - turned).abs() < 1e-12 * (1.0 + value.abs()), "{}", energy.name());
            assert!((turn * stress - turned_stress).norm() < 1e-10 * (1.0 + stress.norm()), "{}", energy.name());
            if energy.name() != "fibre" {
                let (isotropic, _, _) = energy.respond(&(f * turn));
                assert!((value - isotropic).abs() < 1e-12 * (1.0 + value.abs()), "{}", energy.name());
            }
        }
    }
}

/// Principal stresses `P_i = ∂W/∂λ_i` written down by hand for each law, under uniaxial, equibiaxial and general stretch.
#[test]
fn principal_stresses_are_the_closed_forms() {
    let poisson: f64 = 0.3;
    let (lambda, mu) = (poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), 0.5 / (1.0 + poisson));
    let kappa = lambda + 2.0 / 3.0 * mu;
    for stretch in [[1.3, 0.9, 0.9], [1.2, 1.2, 0.75], [0.6, 1.1, 1.7]] {
        let l = Vector3::from(stretch);
        let j: f64 = l.product();
        let i1: f64 = l.norm_squared();
        let i2 = (i1 * i1 - l.map(|l| l.powi(4)).sum()) / 2.0;
        let volumetric = |i: usize| kappa * (j - 1.0) * j / l[i];
        // ∂(J^(−2/3) I1)/∂λ_i and ∂(J^(−4/3) I2)/∂λ_i
        let d1 = |i: usize| j.powf(-2.0 / 3.0) * (2.0 * l[i] - 2.0 / 3.0 * i1 / l[i]);
        let d2 = |i: usize| j.powf(-4.0 / 3.0) * (2.0 * l[i] * (i1 - l[i] * l[i]) - 4.0 / 3.0 * i2 / l[i]);
        let s = j.powf(-2.0 / 3.0) * i1 - 3.0;
        let ogden = |power: f64, share: f64, i: usize| {
            let bar = |i: usize| (j.powf(-1.0 / 3.0) * l[i]).powf(power);
            2.0 * mu * share / (power * l[i]) * (bar(i) - (bar(0) + bar(1) + bar(2)) / 3.0)
        };
        for energy in energies(poisson) {
            let (_, stress, _) = energy.respond(&Matrix3::from_diagonal(&l));
            for i in 0..3 {
                let strain = |i: usize| (l[i] * l[i] - 1.0) / 2.0;
                let logarithmic = mu * (l[i] - 1.0 / l[i]) + lambda * j.ln() / l[i];
                let expected = match energy.name() {
                    "st-venant-kirchhoff" => {
                        l[i] * (lambda * (strain(0) + strain(1) + strain(2)) + 2.0 * mu * strain(i))
                    }
                    "neo-hookean" => logarithmic,
                    "neo-hookean-isochoric" => mu / 2.0 * d1(i) + volumetric(i),
                    "mooney-rivlin" => mu / 2.0 * (0.75 * d1(i) + 0.25 * d2(i)) + volumetric(i),
                    "yeoh" => mu / 2.0 * (1.0 + 0.1 * s + 0.03 * s * s) * d1(i) + volumetric(i),
                    "ogden" => ogden(1.3, 0.9, i) + ogden(-2.0, 0.1, i) + volumetric(i),
                    "fung" => mu / 2.0 * (1.5 * s).exp() * d1(i) + volumetric(i),
                    "corotational" => 2.0 * mu * (l[i] - 1.0) + lambda * (l.sum() - 3.0),
                    "fibre" => {
                        let x = l[0] * l[0] - 1.0;
                        let along = 0.5 * mu * (x * x).exp() * x * 2.0 * l[0];
                        logarithmic + if i == 0 { along } else { 0.0 }
                    }
                    "stable-neo-hookean" => mu * l[i] + ((lambda + mu) * (j - 1.0) - mu) * j / l[i],
                    "stable-mooney-rivlin" => {
                        let pull = (lambda + 0.75 * mu) * (j - 1.0) - 1.25 * mu;
                        mu * l[i] * (0.75 + 0.25 * (i1 - l[i] * l[i])) + pull * j / l[i]
                    }
                    other => panic!("no closed form of {other} is written down"),
                };
                assert!(
                    (stress[(i, i)] - expected).abs() < 1e-12,
                    "{} {i}: {} {expected}",
                    energy.name(),
                    stress[(i, i)]
                );
            }
        }
    }
}

/// `C = C₀ + 4 s μ a⊗a⊗a⊗a` with the share s: `‖C − C₀‖ = 4 s μ`.
#[test]
fn fibres_add_to_the_stiffness_at_rest() {
    let material = solid(1e4, 0.3);
    let energy = Energy::load("fibre", material).unwrap();
    let Moduli { lambda, mu } = energy.moduli();
    let size = (3.0 * (lambda + 2.0 * mu).powi(2) + 6.0 * lambda * lambda + 3.0 * (2.0 * mu).powi(2)).sqrt();
    for (share, direction) in [(0.5, [1.0, 0.0, 0.0]), (50.0, [1.0, 2.0, -3.0])] {
        let found = energy.of(material, &[("stiffness", share)], Some(direction)).unwrap().distance_at_rest();
        assert!((found / (4.0 * share * mu / size) - 1.0).abs() < 1e-12, "{found}");
    }
    assert!(Energy::load("ogden", material).unwrap().distance_at_rest() < 1e-12);
}

#[test]
fn wrong_files_are_told() {
    let file = |energy: &str, rest: &str| format!("name = \"own\"\ntitle = \"Own\"\nenergy = \"{energy}\"\n{rest}");
    for (text, error) in [
        (file("mu*(I5 - 3)", ""), "energy: … found the name \"I5\" in \"mu*(I5 - 3)\""),
        (file("mu*(I1 - 3)", ""), "energy: expected no stress at rest, found … Pa"),
        (
            file("0.5*(mu/2*(I1 - 3) - mu*ln(J)) + lambda/2*ln(J)^2", ""),
            "energy: … E = 1e0 Pa and nu = 0.3 at rest, found that of E = … Pa and nu = 0.375…",
        ),
        (file("mu/2*(I1 - 3) - mu*ln(J) + lambda*ln(J)^2", ""), "energy: … at rest, found that of E = … Pa and nu = …"),
        (
            file("-(mu/2*(I1 - 3) - mu*ln(J) + lambda/2*ln(J)^2)", ""),
            "energy: expected a positive stiffness at rest in every strain, found …",
        ),
        (
            file("mu*((l1 - 1)^2 + (l2 - 1)^2 + (l3 - 1)^2) + lambda/2*(l1 - 1)^2", ""),
            "energy: expected an energy without directions, unless it has fibres, found …",
        ),
        (file("mu*0", ""), "energy: has no finite, positive stiffness at rest"),
        (file("mu/2*(I4 - 1)^2", ""), "fibre: … found none"),
        (file("mu/2*(I4 - 1)^2", "fibre = [0, 0, 0]"), "fibre: expected a direction, found [0.0, 0.0, 0.0]"),
        (file("mu/2*(I4 - 1)^2 + (l1 - 1)^2", "fibre = [0, 0, 1]"), "energy: … found both"),
        (file("mu*a", "parameters = { I1 = 2 }"), "parameters.I1: … found \"I1\""),
        (file("mu*a", "let = { a = 3 }"), "let.a: … found integer"),
        (file("mu*a", "colour = 1"), "…colour: unknown field…"),
    ] {
        let found = Energy::parse(&text, solid(1.0, 0.3)).unwrap_err().to_string();
        // Keys that are missing have no line.
        let found =
            found.split_once(": ").filter(|(place, _)| place.starts_with("line ")).map_or(&*found, |(_, rest)| rest);
        reads(found, error).unwrap();
    }
    // Moduli of its own, which are those of the material with the numbers of the scene.
    let own = file("c/2*(I1 - 3) - c*ln(J) + d/2*ln(J)^2", "parameters = { c = 1, d = 1 }");
    let material = solid(1.0, 0.25);
    assert!(Energy::parse(&own, material).is_err());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("own.toml");
    std::fs::write(&path, own).unwrap();
    let read = Energy::read(path.to_str().unwrap()).unwrap();
    assert!(
        read.of(material, &[("c", 0.4), ("d", 0.4)], None).is_ok() && read.of(material, &[("c", 0.5)], None).is_err()
    );
    let unknown = Energy::load("rubber", solid(1.0, 0.3)).unwrap_err().to_string();
    reads(&unknown, "energy: … corotational, fibre, fung, … found \"rubber\"").unwrap();
}
