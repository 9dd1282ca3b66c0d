//! Functions of the program in place of an energy and of laws of force: what they give is what the same expressions give.

use crate::messages::reads;
use crate::shapes::{Random, distorted, loaded};
use nalgebra::Matrix3;
use springfit_element::element::Element;
use springfit_element::material::{Energy, Material};
use springfit_element::springs::{AskedForces, Force, ForceFunction, Law, Springs};
use springfit_element::stiffness::{EnergyFunction, Hyperelastic, StressFunction};
use springfit_fit::fit::{DeformationFamily, SampledFit, SampledFits, Sampling, Source, Weights, fit_sampled};
use springfit_foundation::error::{Error, Result};
use std::sync::Arc;

/// `P = μ (F − F⁻ᵀ) + λ ln J F⁻ᵀ`, as materials/neo-hookean.toml has its energy.
#[derive(Debug)]
struct NeoHookean {
    lambda: f64,
    mu: f64,
}

impl StressFunction for NeoHookean {
    fn stresses(&self, f: &[[f64; 9]], stresses: &mut [[f64; 9]]) -> Result<()> {
        for (f, stress) in f.iter().zip(stresses) {
            let f = Matrix3::from_row_slice(f);
            let inverse = f.try_inverse().ok_or_else(|| Error::new("F has no inverse"))?.transpose();
            let p = self.mu * (f - inverse) + self.lambda * f.determinant().ln() * inverse;
            *stress = std::array::from_fn(|i| p[(i / 3, i % 3)]);
        }
        Ok(())
    }
}

#[derive(Debug)]
struct Fails;

impl StressFunction for Fails {
    fn stresses(&self, _: &[[f64; 9]], _: &mut [[f64; 9]]) -> Result<()> {
        Err(Error::new("the table has no such place"))
    }
}

/// A law of the strain s and the parameters.
struct ByStrain<F>(F);

impl<F> std::fmt::Debug for ByStrain<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "ByStrain")
    }
}

impl<F: Fn(f64, &[f64]) -> f64 + Send + Sync> ForceFunction for ByStrain<F> {
    fn forces(&self, c: &[f64], rest: f64, parameters: &[f64], forces: &mut [f64]) {
        forces.iter_mut().zip(c).for_each(|(t, c)| *t = self.0((c - rest) / rest, parameters));
    }
}

fn function(names: &[&str], of: impl Fn(f64, &[f64]) -> f64 + Send + Sync + 'static) -> Law {
    Law::of_function("own", names.iter().map(|name| name.to_string()).collect(), Arc::new(ByStrain(of))).unwrap()
}

fn settings(force: Force) -> SampledFit {
    let families = vec![DeformationFamily::Uniaxial, DeformationFamily::SimpleShear];
    let sampling = Sampling { source: Source::Families(families), shapes: 60, held_out: 20, ..Sampling::default() };
    SampledFit { sampling, weights: Weights::Relative, force, ..SampledFit::default() }
}

fn fitted(
    element: &Arc<Element>,
    energy: &dyn Hyperelastic,
    material: Material,
    fit: &SampledFit,
) -> Result<SampledFits> {
    let springs = Springs::select(element, None).unwrap();
    let (x, cells) = (distorted(element, &mut Random(4)), (0..element.nodes()).collect::<Vec<_>>());
    fit_sampled(element, &springs, &x, &cells, energy, material.state(), fit, &mut |_| {})
}

fn neo_hookean(material: Material) -> EnergyFunction {
    let (young, poisson) = (material.young(), material.poisson());
    let mu = young / (2.0 * (1.0 + poisson));
    let lambda = 2.0 * mu * poisson / (1.0 - 2.0 * poisson);
    EnergyFunction::new("own", material, Arc::new(NeoHookean { lambda, mu })).unwrap()
}

fn refused<T>(result: Result<T>, words: &str) {
    let error = result.err().expect("it is refused").to_string();
    reads(&error, words).unwrap();
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().fold(0.0, |most: f64, b| most.max(b.abs()));
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / size).fold(0.0, f64::max)
}

/// The stress of the function is the closed form of the file's energy; in plane stress its own search for the thickness ends at the
/// same stretch.
#[test]
fn an_energy_that_is_a_function_gives_the_springs_of_the_same_expression() {
    for name in ["tri3", "quad4", "tet4", "hex8"] {
        let element = loaded(name);
        let material = Material::for_body(element.dimension(), 2.0, 0.3, None, None).unwrap();
        let known = Energy::load("neo-hookean", material).unwrap();
        let fit = settings(Force::Linear);
        let known = fitted(&element, &known, material, &fit).unwrap();
        let found = fitted(&element, &neo_hookean(material), material, &fit).unwrap();
        // Both solve the same normal equations; their forces differ by rounding.
        assert!(apart(&found.fits.constants, &known.fits.constants) < 1e-10, "{name}");
        assert!(
            apart(&found.trained, &known.trained) < 1e-10 && apart(&found.held_out, &known.held_out) < 1e-10,
            "{name}"
        );
    }
}

#[test]
fn laws_that_are_functions_are_those_of_the_same_expressions() {
    let element = loaded("tet4");
    let material = Material::for_body(3, 2.0, 0.3, None, None).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let groups = Springs::select(&element, None).unwrap().names().len();
    // Linear in both, in one, and in none; the last with the second derivatives of differences.
    let cases: [(&str, Law, f64); 3] = [
        ("k1*s + k3*s^3", function(&["k1", "k3"], |s, p| p[0] * s + p[1] * s.powi(3)), 1e-9),
        ("k*(exp(a*s) - 1)", function(&["k", "a"], |s, p| p[0] * ((p[1] * s).exp() - 1.0)), 1e-6),
        ("a^2*s + b^2*a*s^2", function(&["a", "b"], |s, p| p[0] * p[0] * s + p[1] * p[1] * p[0] * s * s), 1e-5),
    ];
    for (text, own, tolerance) in cases {
        let law = Law::parse(text).unwrap();
        assert_eq!(own.outer(), law.outer(), "{text}");
        for (c, p) in [(1.3, [0.7, 1.9]), (0.8, [2.0, 0.4])] {
            // Differences of the fourth order.
            assert!((own.slope(c, 1.1, &p) / law.slope(c, 1.1, &p) - 1.0).abs() < 1e-9, "{text}");
            assert!((own.energy(c, 1.1, &p) / law.energy(c, 1.1, &p) - 1.0).abs() < 1e-12, "{text}");
            // Many springs at once are each of them.
            let far = [0.4, c, 3.0];
            let asked = [
                AskedForces { c: &far, rest: 1.1, parameters: p.to_vec() },
                AskedForces { c: &far[..1], rest: 0.7, parameters: vec![0.3, 0.6] },
            ];
            for law in [&own, &law] {
                let forces = law.forces_of_all(&asked);
                let pulls = law.pulls_of_all(&asked);
                let springs =
                    asked.iter().flat_map(|one| one.c.iter().map(move |c| (*c, one.rest, &one.parameters[..])));
                for (i, (c, rest, p)) in springs.enumerate() {
                    let known = [law.energy(c, rest, p), law.force(c, rest, p), law.slope(c, rest, p)];
                    assert_eq!(forces[i], known[1], "{text}");
                    for (found, known) in pulls[i].iter().zip(known) {
                        assert!((found / known - 1.0).abs() < 1e-12, "{text}: {found} {known}");
                    }
                }
            }
        }
        let bounds: Vec<(String, [f64; 2])> = match law.is_linear() {
            true => Vec::new(),
            false => law.parameters.iter().filter(|name| *name != "k").map(|name| (name.clone(), [0.1, 5.0])).collect(),
        };
        let fit = |law: &Law| SampledFit { bounds: bounds.clone(), ..settings(Force::of_all(law.clone(), groups)) };
        let known = fitted(&element, &energy, material, &fit(&law)).unwrap();
        let found = fitted(&element, &energy, material, &fit(&own)).unwrap();
        assert!(apart(&found.fits.parameters, &known.fits.parameters) < tolerance, "{text}");
        assert!(
            apart(&found.trained, &known.trained) < 1e-9 && apart(&found.held_out, &known.held_out) < 1e-7,
            "{text}"
        );
    }
}

/// A function that is linear where it is tried and not at the optimum.
#[test]
fn a_function_that_is_not_linear_everywhere_is_refused() {
    let element = loaded("tet4");
    let material = Material::for_body(3, 2e6, 0.3, None, None).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let bent = function(&["k"], |s, p| if p[0].abs() < 3e4 { p[0] * s } else { 1.5 * p[0] * s });
    let groups = Springs::select(&element, None).unwrap().names().len();
    let found = fitted(&element, &energy, material, &settings(Force::of_all(bent, groups)));
    refused(
        found,
        "force: expected own(k) to be linear in its parameters as at values of about 1, found another force at k = …",
    );
}

#[test]
fn functions_that_fail_are_refused() {
    let material = Material::for_body(3, 2.0, 0.3, None, None).unwrap();
    let failed = EnergyFunction::new("own", material, Arc::new(Fails));
    refused(failed, "the table has no such place");
    let pressed = NeoHookean { lambda: 1.0, mu: f64::NAN };
    let failed = EnergyFunction::new("own", material, Arc::new(pressed));
    refused(
        failed,
        "energy: expected finite stresses at the sampled shapes, found others at F = [[1.0000, 0.0000, 0.0000], [0.0000, 1.0000, 0.0000], [0.0000, 0.0000, 1.0000]]",
    );
    let law = |names: &[&str]| {
        let names = names.iter().map(|name| name.to_string()).collect();
        Law::of_function("own", names, Arc::new(ByStrain(|s: f64, _: &[f64]| s))).map(drop)
    };
    refused(law(&[]), "force: expected a function with parameters to fit, such as f(s, k), found own(s)");
    refused(law(&["s"]), "force: expected parameters with names of their own, not s, c, c0, found \"s\" in own");
    refused(law(&["k", "k"]), "force: expected parameters with names of their own, not s, c, c0, found \"k\" in own");
}
