//! The search of sampled fits whose laws are not linear in their parameters: it converges, and to the optimum.

use crate::sampled::{law, sampled};
use crate::shapes::{Random, distorted, loaded};
use springfit_element::material::{Energy, Material};
use springfit_element::springs::Springs;
use springfit_fit::fit::{DeformationFamily, SampledFit, Sampling, Source, Weights, fit_sampled};

/// Generic cells, each node moved at random: at least 95 of 100 searches end at an optimum that no step improves.
#[test]
fn nonlinear_laws_converge_in_generic_cells() {
    for (name, count) in [("tri3", 40), ("tet4", 40), ("hex8", 6)] {
        let element = loaded(name);
        let springs = Springs::select(&element, None).unwrap();
        for text in ["k*(exp(a*s) - 1)", "a*s/(1 + b*s^2)"] {
            let force = law(text, &springs);
            let fit = SampledFit { force, weights: Weights::Relative, ..SampledFit::default() };
            let start = std::time::Instant::now();
            let cells = (1..=count).map(|seed| {
                let x = distorted(&element, &mut Random(seed));
                sampled(&element, &springs, &x, "neo-hookean", &fit)
            });
            let unreached = cells.map(|cell| cell.fits.unreached).sum::<usize>();
            let each = start.elapsed().as_secs_f64() / count as f64;
            println!("{name} {text}: {unreached} of {count} not converged, {:.2} ms each", 1e3 * each);
            assert!(20 * unreached <= count as usize, "{name} {text}: {unreached} of {count}");
        }
    }
}

/// With one inner parameter, the least error of a fine grid of its values, each with k by linear least squares, is the
/// error of the search, and the value lies between the neighbours of the best point of the grid.
#[test]
fn the_search_finds_the_optimum_of_a_grid() {
    for name in ["tri3", "tet4", "hex8"] {
        let element = loaded(name);
        let springs = Springs::select(&element, None).unwrap();
        let x = distorted(&element, &mut Random(7));
        let source = Source::Families(vec![DeformationFamily::Uniaxial]);
        let sampling = Sampling { source, stretch: [0.05, 0.6], ..Sampling::default() };
        let force = law("k*(exp(a*s) - 1)", &springs);
        let free = SampledFit { force, sampling, tied: true, starts: 6, ..SampledFit::default() };
        let found = sampled(&element, &springs, &x, "ogden", &free);
        assert_eq!(found.fits.unreached, 0, "{name}");
        if springs.names().len() > 1 {
            continue;
        }
        let at = |a: f64| {
            let fit = SampledFit { bounds: vec![("a".into(), [a, a])], starts: 1, ..free.clone() };
            sampled(&element, &springs, &x, "ogden", &fit).trained[0]
        };
        // An even number of points leaves out a = 0, where the law vanishes.
        let grid: Vec<f64> = (0..80).map(|i| -10.0 + 20.0 * f64::from(i) / 79.0).collect();
        let best = grid.iter().copied().min_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap();
        let a = found.fits.parameters[1];
        assert!(found.trained[0] <= at(best) * (1.0 + 1e-9), "{name}: {} {}", found.trained[0], at(best));
        assert!((a - best).abs() <= 20.0 / 79.0 || a.abs() > 10.0, "{name}: {a} {best}");
    }
}

/// The energy of a rod whose force is `k (exp(a s) − 1)`: the search finds k and a again, from every start.
#[test]
fn an_exponential_law_is_found_again() {
    let element = loaded("bar2");
    let springs = Springs::select(&element, None).unwrap();
    let material = Material::for_body(1, 7.5, 0.0, None, None).unwrap();
    let part = |l: &str| format!("3*(exp(2.5*({l} - 1))/2.5 - {l})");
    let energy = ["l1", "l2", "l3"].map(part).join(" + ");
    let energy = Energy::parse(&format!("name = 'rope'\ntitle = 'Rope'\nenergy = '{energy}'"), material).unwrap();
    let fit = SampledFit { force: law("k*(exp(a*s) - 1)", &springs), starts: 6, ..SampledFit::default() };
    let x = [0.0, 0.5];
    let found = fit_sampled(&element, &springs, &x, &[0, 1], &energy, material.state(), &fit, &mut |_| {}).unwrap();
    let [k, a] = found.fits.parameters[..] else { panic!("{:?}", found.fits.parameters) };
    assert!((k - 3.0).abs() < 1e-6 && (a - 2.5).abs() < 1e-6, "{k} {a}");
    assert!((found.fits.constants[0] - 3.0 * 2.5 / 0.5).abs() < 1e-5);
    assert!(found.trained[0] < 1e-7 && found.held_out[0] < 1e-7 && found.fits.unreached == 0, "{found:?}");
    assert_eq!(found.agreeing, Some(1.0));
    // Where a is bounded below what fits, it stays at its bound.
    let bounds = vec![("a".to_string(), [0.0, 2.0])];
    let fit = SampledFit { bounds, ..fit };
    let found = fit_sampled(&element, &springs, &x, &[0, 1], &energy, material.state(), &fit, &mut |_| {}).unwrap();
    assert!((found.fits.parameters[1] - 2.0).abs() < 1e-12 && found.trained[0] > 1e-3, "{found:?}");
}
