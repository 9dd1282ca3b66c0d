//! Which shapes of a list a sampled fit sees.

use crate::shapes::loaded;
use springfit_element::material::{Energy, Material, Plane};
use springfit_element::springs::Springs;
use springfit_fit::fit::{SampledFit, SampledFits, Sampling, Source, fit_sampled};
use std::sync::Arc;

/// Every shape is either fitted or held out: a change of one that is fitted changes the constants, of one that is held out its
/// error alone. Of lists of five and more each fifth shape is held out.
#[test]
fn lists_are_split() {
    let element = loaded("tri3");
    let springs = Springs::select(&element, None).unwrap();
    let material = Material::for_body(2, 1.0, 0.3, Some(Plane::Strain), None).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let fitted = |gradients: &[[f64; 4]]| -> SampledFits {
        let source = Source::Gradients(Arc::new(gradients.concat()));
        let (shapes, held_out) = (2 * gradients.len(), 2 * gradients.len());
        let sampling = Sampling { source, shapes, held_out, perturbation: 0.0, ..Sampling::default() };
        let fit = SampledFit { sampling, ..SampledFit::default() };
        let (x, cells) = ([0.0, 0.0, 1.0, 0.1, 0.3, 0.9], [0, 1, 2]);
        fit_sampled(&element, &springs, &x, &cells, &energy, material.state(), &fit, &mut |_| {}).unwrap()
    };
    for count in (1..12).chain([23, 40]) {
        let list: Vec<[f64; 4]> = (0..count).map(|i| [1.1 + 0.01 * i as f64, 0.05, -0.02, 0.95]).collect();
        let before = fitted(&list);
        assert_eq!(before.held_out[0].is_nan(), count < 5);
        for changed in 0..count {
            let mut list = list.clone();
            list[changed] = [0.8, 0.1, 0.2, 1.3];
            let after = fitted(&list);
            let held_out = count >= 5 && changed % 5 == 4;
            assert_eq!(after.fits.constants == before.fits.constants, held_out, "{changed} of {count}");
            assert!(!held_out || after.held_out != before.held_out, "{changed} of {count}");
        }
    }
}

/// Each row of a list counts once, whatever the number that is asked for: the order of rows does not matter, nor does a number above
/// theirs. States are used equally often. The tolerance is rounding of sums of 160 terms.
#[test]
fn rows_count_once() {
    let element = loaded("tri3");
    let springs = Springs::select(&element, None).unwrap();
    let material = Material::for_body(2, 1.0, 0.3, Some(Plane::Strain), None).unwrap();
    let energy = Energy::load("neo-hookean", material).unwrap();
    let x = [0.0, 0.0, 1.0, 0.1, 0.3, 0.9];
    let fitted = |source: Source, shapes: usize| -> SampledFits {
        let sampling = Sampling { source, shapes, perturbation: 0.0, ..Sampling::default() };
        let fit = SampledFit { sampling, ..SampledFit::default() };
        fit_sampled(&element, &springs, &x, &[0, 1, 2], &energy, material.state(), &fit, &mut |_| {}).unwrap()
    };
    // A spread of gradients without an order: those of the golden ratio.
    let spread = |i: usize, k: usize| 0.3 * ((i * (k + 1)) as f64 * 0.618_033_988_749_894_9).fract() - 0.15;
    let list: Vec<[f64; 4]> =
        (0..200).map(|i| [1.0 + spread(i, 0), spread(i, 1), spread(i, 2), 1.0 + spread(i, 3)]).collect();
    // Rows 4, 9, 14, … are held out, and keep their places.
    let own: Vec<usize> = (0..200).filter(|i| i % 5 != 4).collect();
    let mut turned = list.clone();
    own.iter().zip(own.iter().rev()).for_each(|(&to, &from)| turned[to] = list[from]);
    let gradients = |list: &[[f64; 4]]| Source::Gradients(Arc::new(list.concat()));
    let states = |list: &[[f64; 4]]| {
        let place = |f: &[f64; 4]| -> Vec<f64> {
            x.chunks_exact(2).flat_map(|x| [f[0] * x[0] + f[1] * x[1], f[2] * x[0] + f[3] * x[1]]).collect()
        };
        Source::States(Arc::new(list.iter().map(place).collect()))
    };
    for (once, others) in
        [(gradients(&list), vec![gradients(&list), gradients(&turned)]), (states(&list), vec![states(&list)])]
    {
        let once = fitted(once, 160);
        for source in others {
            let found = fitted(source, 300);
            assert_eq!((found.shapes, once.shapes), (160, 160));
            let pairs = found.fits.constants.iter().zip(&once.fits.constants);
            pairs.for_each(|(k, once)| assert!((k - once).abs() < 1e-12 * once.abs(), "{k} {once}"));
        }
    }
}
