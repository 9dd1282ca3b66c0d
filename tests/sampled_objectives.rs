//! Functions of the residual forces in place of norms, and where the starts of a search end.

use crate::messages::reads;
use crate::sampled::{law, sampled};
use crate::shapes::{Random, distorted, loaded};
use springfit_element::material::{Energy, Material};
use springfit_element::springs::{Force, Springs};
use springfit_fit::fit::{
    Norm, ResidualFunction, ResidualObjective, SampledFit, SampledFits, Sampling, Weights, fit_sampled,
};
use springfit_foundation::error::{Error, Result};
use std::fmt;
use std::sync::Arc;

/// The sum of a function of every residual, with its derivative.
struct Each<F>(F);

impl<F> fmt::Debug for Each<F> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "Each")
    }
}

impl<F: Fn(f64) -> Result<(f64, f64)> + Send + Sync> ResidualFunction for Each<F> {
    fn value(&self, residuals: &[f64], shape: [usize; 3], gradient: &mut [f64]) -> Result<f64> {
        assert_eq!(shape.iter().product::<usize>(), residuals.len());
        let mut sum = 0.0;
        for (r, g) in residuals.iter().zip(gradient) {
            let (value, slope) = (self.0)(*r)?;
            sum += value;
            *g = slope;
        }
        Ok(sum)
    }
}

fn fitted(name: &str, fit: &SampledFit) -> Result<SampledFits> {
    let element = loaded(name);
    let springs = Springs::select(&element, None).unwrap();
    let material = Material::for_body(element.dimension(), 1.0, 0.3, None, None).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let x = distorted(&element, &mut Random(5));
    let cells: Vec<usize> = (0..element.nodes()).collect();
    fit_sampled(&element, &springs, &x, &cells, &energy, material.state(), fit, &mut |_| {})
}

fn settings() -> SampledFit {
    let sampling = Sampling { shapes: 60, held_out: 20, stretch: [-0.2, 0.2], ..Sampling::default() };
    SampledFit { sampling, weights: Weights::Relative, ..SampledFit::default() }
}

fn by(fit: SampledFit, of: impl Fn(f64) -> Result<(f64, f64)> + Send + Sync + 'static) -> SampledFit {
    SampledFit { objective: Some(ResidualObjective::new("own", Arc::new(Each(of)))), ..fit }
}

fn apart(found: &SampledFits, known: &SampledFits) -> f64 {
    let size = known.fits.constants.iter().fold(0.0f64, |most, k| most.max(k.abs()));
    let pairs = found.fits.constants.iter().zip(&known.fits.constants);
    pairs.map(|(a, b)| (a - b).abs() / size).fold(0.0, f64::max)
}

/// The sum of squares as a function has the springs of normal equations, whatever its scale, with rest lengths of their own and constants that
/// may not be negative as well.
#[test]
fn a_sum_of_squares_is_the_two_norm() {
    for name in ["tri3", "quad4", "tet4"] {
        for (force, nonnegative, higher) in
            [(Force::Linear, false, 1.0), (Force::Linear, true, 0.3), (Force::FreeRest, false, 1.0)]
        {
            let fit = SampledFit { force, nonnegative, higher, ..settings() };
            let known = fitted(name, &fit).unwrap();
            for scale in [1.0, 1e6, 1e-6] {
                let found = fitted(name, &by(fit.clone(), move |r| Ok((scale * r * r, 2.0 * scale * r)))).unwrap();
                assert!(apart(&found, &known) < 1e-7 && found.fits.unreached == 0, "{name} {scale}");
            }
        }
    }
}

/// Huber's function is minimised by a conic solver under its name; as a function of the residuals it has the same springs.
#[test]
fn hubers_function_is_the_norm_of_this_name() {
    for (name, nonnegative) in [("tri3", false), ("tet4", true)] {
        let fit = SampledFit { nonnegative, weights: Weights::Relative, ..settings() };
        let known = fitted(name, &SampledFit { norm: Norm::Huber { share: 0.5 }, ..fit.clone() }).unwrap();
        // With relative weights each shape has a force of one, in dimension × nodes components.
        let element = loaded(name);
        let delta = 0.5 / ((element.dimension() * element.nodes()) as f64).sqrt();
        let huber = move |r: f64| match r.abs() <= delta {
            true => Ok((0.5 * r * r, r)),
            false => Ok((delta * (r.abs() - 0.5 * delta), delta * r.signum())),
        };
        let found = fitted(name, &by(fit.clone(), huber)).unwrap();
        let squares = fitted(name, &fit).unwrap();
        // The conic solver ends at some 1e-8 of its value, which is flat in the constants.
        assert!(apart(&found, &known) < 1e-3, "{name}: {}", apart(&found, &known));
        assert!(apart(&squares, &known) > 3e-3, "{name}: {}", apart(&squares, &known));
        assert_eq!(found.fits.unreached, 0);
    }
}

/// A function that fails, that has no finite value or another gradient is told in one line; so is one beside a law that is searched.
#[test]
fn wrong_functions_are_refused() {
    let refused = |fit: SampledFit, words: &str| {
        let error = fitted("tri3", &fit).unwrap_err().to_string();
        reads(&error, words).unwrap_or_else(|fault| panic!("{fault:?}: {error}"));
        assert!(!error.contains('\n'));
    };
    refused(by(settings(), |_| Err(Error::new("the table is empty"))), "the table is empty");
    refused(by(settings(), |_| Ok((f64::NAN, 0.0))), "norm: expected finite numbers from \"own\", found the value NaN");
    refused(
        by(settings(), |r| Ok((r, f64::NAN))),
        "norm: expected finite numbers from \"own\", found a gradient with others",
    );
    refused(
        by(settings(), |r| Ok((r * r, r))),
        "norm: expected the gradient of the value of \"own\", found one with the slope …",
    );
    let element = loaded("tri3");
    let force = law("k*(exp(a*s) - 1)", &Springs::select(&element, None).unwrap());
    let fit = by(SampledFit { force, ..settings() }, |r| Ok((r * r, 2.0 * r)));
    refused(fit, "norm: expected the 2-norm for a law … found the function \"own\"");
}

/// The ends of all starts: the best has no distance from itself, the share of those with its error is the one that agrees, and starts that end
/// at other parameters have the error that the fit has with these parameters.
#[test]
fn every_start_has_its_end() {
    let element = loaded("tet4");
    let springs = Springs::select(&element, None).unwrap();
    let mut are_apart = 0;
    for seed in 1..6 {
        let x = distorted(&element, &mut Random(seed));
        let force = law("a*s/(1 + b*s^2)", &springs);
        let bounds = vec![("b".to_string(), [-2.0, 20.0])];
        let fit = SampledFit { force, bounds, starts: 8, tied: true, data: true, ..settings() };
        let found = sampled(&element, &springs, &x, "neo-hookean", &fit);
        assert_eq!(found.starts.iter().map(|start| start.start).collect::<Vec<_>>(), (0..8).collect::<Vec<_>>());
        let ends = || found.starts.iter().map(|start| start.end);
        let best = ends().map(|end| end.error).fold(f64::INFINITY, f64::min);
        assert!((best - found.trained[0]).abs() < 1e-12, "{best} {}", found.trained[0]);
        let agreeing = ends().filter(|end| end.error <= best * (1.0 + 1e-3)).count();
        assert_eq!(found.agreeing, Some(agreeing as f64 / 8.0));
        assert!(ends().any(|end| end.distance == 0.0) && ends().all(|end| end.steps > 0));
        for end in ends().filter(|end| end.error > best * (1.0 + 1e-3)) {
            assert!(end.distance > 1e-3, "{end:?}");
            are_apart += 1;
        }
        // Without data the starts of the worst cell are kept, which is this one.
        let without = sampled(&element, &springs, &x, "neo-hookean", &SampledFit { data: false, ..fit });
        assert_eq!(without.starts, found.starts);
        assert!(without.errors.is_empty());
    }
    println!("{are_apart} of 40 starts ended elsewhere");
}
