//! Which shapes of a list a sampled fit sees.

use springfit::element::Element;
use springfit::fit::{SampledFit, SampledFits, Sampling, Source, fit_sampled};
use springfit::material::{Energy, Material, Plane};
use springfit::springs::Springs;
use std::sync::Arc;

/// Every shape is either fitted or held out: a change of one that is fitted changes the constants, of one that is held out its
/// error alone. Of lists of five and more each fifth shape is held out.
#[test]
fn lists_are_split() {
    let element = Arc::new(Element::load("tri3").unwrap());
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
