//! Damping from measurements, and moduli over frequency: against closed forms, integration in time, and every wrong key.

use crate::kit::{outcome, refusal};
use crate::messages::reads;
use nalgebra::Complex;
use springfit_fit::fit::{DampingKind, DampingTest, ratio_of_decay};
use springfit_report::report::Table;
use springfit_studies::study::{ComplexModulus, DynamicModuli, Outcome};
use std::f64::consts::TAU;

type C = Complex<f64>;

fn test<'a>(kind: DampingKind, values: &'a [f64], frequencies: &'a [f64], band: Option<[f64; 2]>) -> DampingTest<'a> {
    DampingTest { kind, values, frequencies, band }
}

/// `1 − Σ g/(1 + s τ)`, the modulus of a series over that against a sudden strain.
fn series(terms: &[[f64; 2]], s: C) -> C {
    terms.iter().fold(C::from(1.0), |sum, [g, tau]| sum - C::from(*g) / (s * *tau + 1.0))
}

fn even(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| from * (to / from).powf(i as f64 / (count - 1) as f64))
}

/// A series has the loss factor that was measured: a constant one over bands of several widths, and that of another series. What is reported as its
/// error is found again on ten times as many frequencies.
#[test]
fn a_series_has_the_loss_factor_that_was_measured() {
    for (eta, band, allowed) in [
        (0.02, [1.0, 10.0], 0.002),
        (0.2, [0.5, 50.0], 0.002),
        (0.2, [0.1, 1000.0], 0.002),
        (0.8, [1.0, 100.0], 0.006),
        (0.1, [9.0, 11.0], 0.004),
    ] {
        let fitted = test(DampingKind::LossFactor, &[eta], &[], Some(band)).series().unwrap();
        let off = |f: f64| {
            let modulus = series(&fitted.terms, C::new(0.0, TAU * f));
            (modulus.im / modulus.re - eta) / 2.0
        };
        let all: Vec<f64> = even(band[0], band[1], 1001).map(off).collect();
        let largest = all.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
        let rms = (all.iter().map(|x| x * x).sum::<f64>() / all.len() as f64).sqrt();
        println!("eta {eta} over {band:?}: {} terms, {largest:.2e} {rms:.2e}, {:?}", fitted.terms.len(), fitted.error);
        let sum: f64 = fitted.terms.iter().map(|[g, _]| g).sum();
        assert!(fitted.terms.iter().all(|[g, tau]| *g > 0.0 && *tau > 0.0) && sum < 1.0, "{fitted:?}");
        assert!(largest < allowed * eta / 2.0, "{eta} {band:?}: {largest}");
        // Some twenty frequencies in a decade see ripples that are a decade wide.
        assert!((fitted.error.largest / largest - 1.0).abs() < 0.15 && (fitted.error.rms / rms - 1.0).abs() < 0.15);
        assert!(fitted.error.band == band && (fitted.error.size / eta * 2.0 - 1.0).abs() < 1e-12);
    }
    let known = [[0.3, 0.02], [0.25, 0.4], [0.1, 3.0]];
    let frequencies: Vec<f64> = even(0.05, 20.0, 31).collect();
    let eta = |f: &f64| {
        let modulus = series(&known, C::new(0.0, TAU * f));
        modulus.im / modulus.re
    };
    let values: Vec<f64> = frequencies.iter().map(eta).collect();
    let fitted = test(DampingKind::LossFactor, &values, &frequencies, None).series().unwrap();
    println!("series of another: {fitted:?}");
    for f in even(0.05, 20.0, 97) {
        let modulus = series(&fitted.terms, C::new(0.0, TAU * f));
        assert!((modulus.im / modulus.re - eta(&f)).abs() < 0.01, "{f}: {} {}", modulus.im / modulus.re, eta(&f));
    }
    // Part of the band alone.
    let part = test(DampingKind::LossFactor, &values, &frequencies, Some([0.3, 3.0])).series().unwrap();
    assert!(part.error.band == [0.3, 3.0] && part.error.rms < 0.004, "{part:?}");
}

/// A free vibration at the seen frequency f of a mass on a spring of this series, s and `−m s²/k`: Newton's method on the phase of `f(s)/s²`, from light damping.
fn vibration(terms: &[[f64; 2]], frequency: f64) -> C {
    let seen = TAU * frequency;
    // Im(f(s)/s²) = 0 with s = −x + i ω.
    let phase = |x: f64| {
        let s = C::new(-x, seen);
        (series(terms, s) / (s * s)).im
    };
    let mut x = 0.01 * seen;
    for _ in 0..100 {
        let step = 1e-6 * seen;
        x -= phase(x) * 2.0 * step / (phase(x + step) - phase(x - step));
    }
    C::new(-x, seen)
}

/// Free vibrations die away as was measured, although their damping is that at a complex frequency: a vibration of the series is followed in time
/// by the method of Runge and Kutta, and its peaks are compared. The loss factor 2 ζ would be off by 2 ζ/π of itself.
#[test]
fn a_series_has_the_decay_that_was_measured() {
    for (decrement, band) in [(0.05, [2.0, 200.0]), (0.6, [2.0, 200.0]), (1.5, [5.0, 50.0])] {
        let ratio = decrement / f64::hypot(TAU, decrement);
        let fitted = test(DampingKind::Decrement, &[decrement], &[], Some(band)).series().unwrap();
        println!("decrement {decrement}: {} terms, {:?}", fitted.terms.len(), fitted.error);
        assert!(fitted.error.largest < 0.004 * ratio, "{fitted:?}");
        for frequency in even(band[0], band[1], 9) {
            let s = vibration(&fitted.terms, frequency);
            let found = -s.re / s.norm();
            assert!((found - ratio).abs() < 1.5 * fitted.error.largest + 1e-9, "{frequency}: {found} {ratio}");
        }
        // In time: x″ = −c (x − Σ g w), w′ = (x − w)/τ, from the shape of the vibration.
        let s = vibration(&fitted.terms, 20.0);
        let stiffness = -(s * s / series(&fitted.terms, s)).re;
        let slope = |y: &[f64]| -> Vec<f64> {
            let held: f64 = fitted.terms.iter().zip(&y[2..]).map(|([g, _], w)| g * w).sum();
            let memory = fitted.terms.iter().zip(&y[2..]).map(|([_, tau], w)| (y[0] - w) / tau);
            [y[1], -stiffness * (y[0] - held)].into_iter().chain(memory).collect()
        };
        let mut y: Vec<f64> = [C::from(1.0), s].iter().map(|z| z.re).collect();
        y.extend(fitted.terms.iter().map(|[_, tau]| (C::from(1.0) / (s * *tau + 1.0)).re));
        let shortest = fitted.terms.iter().fold(1.0 / 20.0, |least: f64, [_, tau]| least.min(*tau));
        let steps = (3.0 / 20.0 / (0.2 * shortest)).ceil().max(6000.0);
        let h = 3.0 / 20.0 / steps;
        let (mut peaks, mut before) = (Vec::new(), y[1]);
        for _ in 0..steps as usize {
            let moved = |k: &[f64], by: f64| -> Vec<f64> { y.iter().zip(k).map(|(y, k)| y + by * h * k).collect() };
            let a = slope(&y);
            let b = slope(&moved(&a, 0.5));
            let c = slope(&moved(&b, 0.5));
            let d = slope(&moved(&c, 1.0));
            for i in 0..y.len() {
                y[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
            }
            if before > 0.0 && y[1] <= 0.0 {
                peaks.push(y[0]);
            }
            before = y[1];
        }
        assert!(peaks.len() >= 2, "{peaks:?}");
        let found = (peaks[0] / peaks[1]).ln();
        println!("decrement {decrement}: {found} in time");
        assert!((found / decrement - 1.0).abs() < 0.004, "{found} {decrement}");
    }
}

/// Two loss factors give `α = ω₁ω₂(η₁ω₂ − η₂ω₁)/(ω₂² − ω₁²)`, `β = (η₂ω₂ − η₁ω₁)/(ω₂² − ω₁²)`; where they are equal, damping between them is least at
/// `√(ω₁ω₂)`, of which the difference is reported (Clough, Penzien, Dynamics of Structures). Decays count ω₀, not what is seen.
#[test]
fn rayleighs_numbers_are_those_of_two_frequencies() {
    let closed = |[w1, w2]: [f64; 2], [z1, z2]: [f64; 2]| {
        let across = w2 * w2 - w1 * w1;
        [2.0 * w1 * w2 * (z1 * w2 - z2 * w1) / across, 2.0 * (z2 * w2 - z1 * w1) / across]
    };
    let near =
        |found: [f64; 2], expected: [f64; 2]| found.into_iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-10);
    for eta in [[0.1, 0.1], [0.08, 0.3]] {
        let f = [2.0, 30.0];
        let fitted = test(DampingKind::LossFactor, &eta, &f, None).rayleigh().unwrap();
        assert!(near(fitted.numbers, closed(f.map(|f| TAU * f), eta.map(|eta| eta / 2.0))), "{fitted:?}");
        if eta[0] == eta[1] {
            let least = 0.05 * (1.0 - 2.0 * f64::sqrt(60.0) / 32.0);
            // The least is between two of 24 frequencies.
            assert!((fitted.error.largest / least - 1.0).abs() < 2e-3, "{fitted:?} {least}");
        }
    }
    for (kind, values) in [(DampingKind::Ratio, [0.3, 0.6]), (DampingKind::Decrement, [1.9760, 4.7124])] {
        let ratios = values.map(|x| if kind == DampingKind::Ratio { x } else { x / f64::hypot(TAU, x) });
        let seen = [5.0, 12.0];
        let free: Vec<f64> = seen.iter().zip(&ratios).map(|(f, z)| TAU * f / (1.0 - z * z).sqrt()).collect();
        let fitted = test(kind, &values, &seen, None).rayleigh().unwrap();
        assert!(near(fitted.numbers, closed([free[0], free[1]], ratios)), "{fitted:?}");
    }
    // One number over a band: no other pair has less error, and what falls or rises too fast has one number alone.
    let fitted = test(DampingKind::Ratio, &[0.05], &[], Some([1.0, 40.0])).rayleigh().unwrap();
    let rms = |[alpha, beta]: [f64; 2]| {
        let free = 1.0 / (1.0f64 - 0.05 * 0.05).sqrt();
        let off = |f: f64| (alpha / (TAU * f * free) + beta * TAU * f * free) / 2.0 - 0.05;
        // As many frequencies as the fit has: twenty in a decade.
        let count = (40f64.log10() * 20.0).ceil() as usize + 1;
        (even(1.0, 40.0, count).map(|f| off(f).powi(2)).sum::<f64>() / count as f64).sqrt()
    };
    let least = rms(fitted.numbers);
    assert!((least / fitted.error.rms - 1.0).abs() < 1e-9, "{least} {fitted:?}");
    for by in [[1.001, 1.0], [0.999, 1.0], [1.0, 1.001], [1.0, 0.999]] {
        assert!(rms([fitted.numbers[0] * by[0], fitted.numbers[1] * by[1]]) > least);
    }
    let steep = test(DampingKind::LossFactor, &[0.01, 0.5], &[1.0, 10.0], None).rayleigh().unwrap();
    assert!(steep.numbers[0] == 0.0 && steep.numbers[1] > 0.0, "{steep:?}");
}

/// Amplitudes of a mass on a spring with a damper, whose motion is known, give its damping ratio; noise is reported.
#[test]
fn amplitudes_give_the_ratio_of_a_decay() {
    for ratio in [0.01, 0.2, 0.7] {
        let (free, seen) = (31.0, 31.0 * f64::sqrt(1.0 - ratio * ratio));
        let times: Vec<f64> = (0..6).map(|n| n as f64 * TAU / seen).collect();
        let amplitudes: Vec<f64> = times.iter().map(|t| 0.3 * f64::exp(-ratio * free * t)).collect();
        let decay = ratio_of_decay(&times, &amplitudes, seen / TAU).unwrap();
        assert!((decay.ratio / ratio - 1.0).abs() < 1e-12 && decay.error < 1e-14, "{decay:?}");
        let noisy: Vec<f64> =
            amplitudes.iter().enumerate().map(|(i, a)| a * if i % 2 == 0 { 1.1 } else { 0.9 }).collect();
        let decay = ratio_of_decay(&times, &noisy, seen / TAU).unwrap();
        assert!(decay.error > 0.09 && decay.error < 0.11, "{decay:?}");
    }
}

/// A block of a mesh with a material and keys beside.
fn block(mesh: &str, material: &str, rest: &str) -> String {
    format!("[mesh]\n{mesh}\n[material]\nyoung = 10e3\npoisson = 0.3\n{material}\n{rest}\n")
}

const BOX: &str = "box = { element = \"tet4\", size = [0.04, 0.02, 0.02], cells = [4, 2, 2] }";
const EXACT: &str = "[[fit]]\nobjective = \"exact\"\n[[fit]]\nname = \"smooth\"\nobjective = \"exact\"\nshear = \"edges\"\nvolume = \"patches\"\n";
const SWEPT: &str = "[output]\ndynamic_moduli = { band = [0.01, 100], count = 9 }\n";

/// E*, G* and K* of a series with shares of shear and of bulk: `E = 9 K μ/(3 K + μ)` with complex K and μ (the correspondence principle, Christensen,
/// Theory of Viscoelasticity).
fn prony(terms: &[[f64; 3]], f: f64) -> [C; 3] {
    let (mu, bulk) = (1e4 / 2.6, 1e4 / 1.2);
    let s = C::new(0.0, TAU * f);
    let of = |place: usize| series(&terms.iter().map(|term| [term[place], term[2]]).collect::<Vec<_>>(), s);
    let (mu, bulk) = (of(0) * mu, of(1) * bulk);
    [mu * bulk * 9.0 / (bulk * 3.0 + mu), mu, bulk]
}

fn at(modulus: &ComplexModulus, i: usize) -> C {
    C::new(modulus.storage[i], modulus.loss[i])
}

fn all(moduli: &DynamicModuli, i: usize) -> [C; 3] {
    let bulk = moduli.bulk.as_ref().map_or(C::from(f64::NAN), |bulk| at(bulk, i));
    [at(&moduli.young, i), at(&moduli.shear, i), bulk]
}

/// Storage and loss moduli of each are those of the series, relative to the size of the modulus; the number of models.
fn expect_prony(outcome: &Outcome, terms: &[[f64; 3]], tolerance: f64, words: &str) -> usize {
    let found = outcome.dynamic_moduli.as_ref().unwrap();
    let mut largest = 0.0f64;
    for (i, f) in found.frequency.iter().enumerate() {
        let expected = prony(terms, *f);
        let material = all(found.material.as_ref().unwrap(), i);
        for model in &found.models {
            let own = all(model.moduli.as_ref().unwrap(), i);
            for ((own, material), expected) in own.into_iter().zip(material).zip(expected) {
                assert!(
                    (material - expected).norm() < 1e-13 * expected.norm(),
                    "{words} at {f}: {material} {expected}"
                );
                largest = largest.max((own - expected).norm() / expected.norm());
            }
        }
    }
    println!("{words}: {largest:.1e}");
    assert!(largest < tolerance, "{words}: {largest:e}");
    found.models.len()
}

/// Finite elements, exact networks and smoothed ones of a bar have the moduli of the series: of shear alone, bulk alone, both, alike, at rest with a law,
/// and on a body with curved sides and a hole, whose cells nobody arranged.
#[test]
fn networks_have_the_moduli_of_their_series_over_frequency() {
    let hole = concat!("file = \"", env!("CARGO_MANIFEST_DIR"), "/scenes/meshes/cylinder_hole_tet.msh\"");
    for (words, terms, list) in [
        ("shear", "{ shear = 0.6, time = 2 }", vec![[0.6, 0.0, 2.0]]),
        ("bulk", "{ bulk = 0.6, time = 2 }", vec![[0.0, 0.6, 2.0]]),
        ("alike", "{ shear = 0.9, bulk = 0.9, time = 2 }", vec![[0.9, 0.9, 2.0]]),
        (
            "apart",
            "{ shear = 0.5, bulk = 0.1, time = 0.05 }, { shear = 0.3, time = 1 }, { bulk = 0.5, time = 20 }",
            vec![[0.5, 0.1, 0.05], [0.3, 0.0, 1.0], [0.0, 0.5, 20.0]],
        ),
    ] {
        let relaxation = format!("relaxation = {{ terms = [{terms}] }}");
        for (body, mesh) in [
            ("bar", BOX.to_string()),
            ("hexahedra", BOX.replace("tet4", "hex8")),
            ("quadratic", BOX.replace("tet4", "tet10").replace("[4, 2, 2]", "[2, 1, 1]")),
            ("hole", hole.to_string()),
        ] {
            let fits = if mesh.contains("tet4") { EXACT } else { "[[fit]]\nobjective = \"exact\"\n" };
            let found = outcome(&block(&mesh, &relaxation, &(fits.to_string() + SWEPT)));
            let count = expect_prony(&found, &list, 1e-10, &format!("{words}, {body}"));
            assert_eq!(count, if mesh.contains("tet4") { 3 } else { 2 });
        }
        if !terms.contains("bulk") {
            let law = relaxation + "\nlaw = \"stable-neo-hookean\"";
            let found = outcome(&block(BOX, &law, &(EXACT.to_string() + SWEPT)));
            expect_prony(&found, &list, 1e-10, &format!("{words}, with a law"));
            // A term that yields is elastic where the stress is small.
            let yields = law.replace("time = 2", "time = 2, yield = 100");
            let found = outcome(&block(BOX, &yields, &(EXACT.to_string() + SWEPT)));
            expect_prony(&found, &[], 1e-10, "yield");
        }
    }
}

/// In plane strain a tension has `E/(1 − ν²)`, also with complex numbers; in plane stress E where all relaxes alike.
#[test]
fn plane_networks_have_the_moduli_of_their_series() {
    for element in ["tri3", "quad4", "tri6"] {
        let mesh = format!("box = {{ element = \"{element}\", size = [0.04, 0.02], cells = [4, 3] }}");
        let fit = "[[fit]]\nobjective = \"exact\"\n";
        for (plane, terms, list) in [
            ("strain", "{ shear = 0.6, bulk = 0.2, time = 2 }", [[0.6, 0.2, 2.0]]),
            ("stress", "{ shear = 0.6, bulk = 0.6, time = 2 }", [[0.6, 0.6, 2.0]]),
        ] {
            let keys = format!("plane = \"{plane}\"\nthickness = 0.003\nrelaxation = {{ terms = [{terms}] }}");
            let found = outcome(&block(&mesh, &keys, &(fit.to_string() + SWEPT))).dynamic_moduli.unwrap();
            for (i, f) in found.frequency.iter().enumerate() {
                let [young, mu, bulk] = prony(&list, *f);
                let poisson = (bulk * 3.0 - mu * 2.0) / ((bulk * 3.0 + mu) * 2.0);
                let young = if plane == "strain" { young / (C::from(1.0) - poisson * poisson) } else { young };
                for model in found.models.iter().map(|model| &model.moduli).chain([&found.material]) {
                    let moduli = model.as_ref().unwrap();
                    for (own, expected) in [(at(&moduli.young, i), young), (at(&moduli.shear, i), mu)] {
                        assert!(
                            (own - expected).norm() < 1e-10 * expected.norm(),
                            "{element} {plane} {f}: {own} {expected}"
                        );
                    }
                    assert!(moduli.bulk.is_none());
                }
            }
        }
    }
}

/// Rayleigh's damping adds `iωβ` times the moduli, and α nothing; dampers beside springs lose energy in proportion to the frequency where it is low. What
/// is measured of damping gives the same as its numbers.
#[test]
fn damped_networks_have_their_loss_over_frequency() {
    let keys = |damping: &str| {
        let motion = format!("[motion]\nduration = 1e-3\nstep = 1e-3\nlinear = true\ndamping = {{ {damping} }}\n");
        block(BOX, "density = 1000", &(EXACT.to_string() + SWEPT + &motion))
    };
    let found = outcome(&keys("rayleigh = [3, 2e-3]")).dynamic_moduli.unwrap();
    let elastic = prony(&[], 1.0);
    for (i, f) in found.frequency.iter().enumerate() {
        for model in found.models.iter().map(|model| &model.moduli).chain([&found.material]) {
            for (own, elastic) in all(model.as_ref().unwrap(), i).into_iter().zip(elastic) {
                let expected = elastic * C::new(1.0, TAU * f * 2e-3);
                assert!((own - expected).norm() < 1e-10 * expected.norm(), "{f}: {own} {expected}");
            }
        }
    }
    let springs = keys("ratio = 0.1").replace("duration", "finite_elements = false\nduration");
    let found = outcome(&springs).dynamic_moduli.unwrap();
    assert!(found.material.is_none() && found.models.len() == 2);
    for model in &found.models {
        let young = &model.moduli.as_ref().unwrap().young;
        assert!((young.storage[0] / elastic[0].re - 1.0).abs() < 1e-6, "{young:?}");
        // From 0.01 Hz to 0.0316 Hz.
        assert!(young.loss[0] > 0.0 && (young.loss[1] / young.loss[0] / 10f64.sqrt() - 1.0).abs() < 1e-6, "{young:?}");
    }
    let measured = outcome(&keys("measured = { loss_factor = [0.1, 0.1], frequency = [2, 30] }"));
    let [fitted] = &measured.damping[..] else { panic!("{:?}", measured.damping) };
    let [_, beta] = fitted.rayleigh.unwrap();
    assert!((beta - 0.1 / (TAU * 32.0)).abs() < 1e-12 && fitted.key == "motion.damping.measured", "{fitted:?}");
    let moduli = measured.dynamic_moduli.as_ref().unwrap().models[1].moduli.as_ref().unwrap();
    let last = moduli.young.loss.len() - 1;
    assert!((moduli.young.loss[last] / (TAU * 100.0 * beta * 1e4) - 1.0).abs() < 1e-10);
}

/// Regions that relax unlike: the exact network has the moduli of its finite elements; at high frequency those of the material against a sudden
/// strain, which is the same in both, and at low frequency those of a body in which both have relaxed.
#[test]
fn regions_that_relax_unlike_have_the_moduli_of_their_finite_elements() {
    for law in ["law = \"stable-neo-hookean\"\n", ""] {
        expect_moduli_of_regions(law);
    }
}

fn expect_moduli_of_regions(law: &str) {
    let two = |first: &str, second: &str, band: &str| {
        let of = |keys: &str, relaxation: &str| {
            format!("[[material]]\n{keys}young = 10e3\npoisson = 0.3\n{law}{relaxation}\n")
        };
        let materials = of("where = \"x < 0.02\"\n", first) + &of("", second);
        format!("[mesh]\n{BOX}\n{materials}{EXACT}[output]\ndynamic_moduli = {{ {band} }}\n")
    };
    let relaxed = |g: f64, tau: f64| format!("relaxation = {{ terms = [{{ shear = {g:?}, time = {tau:?} }}] }}");
    let found = outcome(&two(&relaxed(0.3, 0.1), &relaxed(0.7, 5.0), "band = [1e-6, 1e6], count = 25"));
    let found = found.dynamic_moduli.unwrap();
    assert!(found.material.is_none() && found.models.len() == 3);
    let body = found.models[0].moduli.as_ref().unwrap();
    let exact = found.models[1].moduli.as_ref().unwrap();
    for i in 0..found.frequency.len() {
        for (a, b) in all(exact, i).into_iter().zip(all(body, i)) {
            assert!((a - b).norm() < 1e-10 * b.norm(), "{}: {a} {b}", found.frequency[i]);
        }
        assert!(body.young.loss[i] > 0.0);
    }
    assert!((body.young.storage[24] / 1e4 - 1.0).abs() < 1e-9, "{:?}", body.young);
    // Series of the same shares with any times end at the same body.
    let same = outcome(&two(&relaxed(0.3, 1.0), &relaxed(0.7, 1.0), "frequency = [1e-7]")).dynamic_moduli.unwrap();
    let rest = same.models[0].moduli.as_ref().unwrap().young.storage[0];
    assert!((body.young.storage[0] / rest - 1.0).abs() < 1e-7, "{} {rest}", body.young.storage[0]);
}

/// A bar that is pulled by a force that swings, in steps of time without inertia, answers with the modulus of the sweep: the steps know nothing of it.
#[test]
fn a_bar_that_is_pulled_to_and_fro_has_the_modulus_of_the_sweep() {
    let (frequency, step): (f64, f64) = (0.25, 0.01);
    let fixes =
        ["x", "y", "z"].map(|axis| format!("[[fix]]\nwhere = \"{axis} < 1e-9\"\naxes = [\"{axis}\"]\n")).concat();
    let w = TAU * frequency;
    let motion = format!(
        "[motion]\nquasi-static = true\nlinear = true\nduration = 32\nstep = {step}\nevery = {step}\nwatch = {{ group = \"xmax\" }}\n[[motion.force]]\ngroup = \"xmax\"\nforce = [\"0.02*sin({w:?}*t)\", 0, 0]\n"
    );
    let output = format!("[output]\ndynamic_moduli = {{ frequency = [{frequency}] }}\n");
    let relaxation = "relaxation = { terms = [{ shear = 0.6, bulk = 0.2, time = 0.8 }] }";
    let found = outcome(&block(BOX, relaxation, &(EXACT.to_string() + &output + &fixes + &motion)));
    let moduli = found.dynamic_moduli.unwrap();
    for (model, swept) in found.motion.unwrap().models.iter().zip(&moduli.models) {
        // The last whole period, by Fourier's sums of even steps.
        let period = (1.0 / frequency / step).round() as usize;
        let last = &model.records[model.records.len() - 1 - period..model.records.len() - 1];
        let sum: C = last.iter().map(|r| C::from_polar(r.watched[0], -TAU * frequency * r.account.time)).sum();
        // F sin ωt is the imaginary part of F e^(iωt), so that u = Im(û e^(iωt)) with û = 2 i/N Σ u e^(−iωt).
        let strain = sum * C::new(0.0, 2.0 / period as f64) / 0.04;
        let found = C::from(0.02 / 4e-4) / strain;
        let expected = at(&swept.moduli.as_ref().unwrap().young, 0);
        println!("{}: {found} {expected}", model.name);
        // Steps of 1/80 of τ err by some 1e-5, and what is left of the start by 1e-6.
        assert!((found - expected).norm() < 5e-5 * expected.norm(), "{}: {found} {expected}", model.name);
    }
}

/// A material whose loss factor was measured has it: in the sweep of its network, in its table and in the tables of the run.
#[test]
fn a_scene_takes_measured_damping() {
    let list = "relaxation = { measured = { loss_factor = 0.2, band = [0.1, 10], of = \"all\" } }";
    let found = outcome(&block(BOX, list, &(EXACT.to_string() + "[output]\ndynamic_moduli = { band = [0.1, 10] }\n")));
    let [measured] = &found.damping[..] else { panic!("{:?}", found.damping) };
    assert!(measured.is_constant && measured.key == "material.relaxation.measured" && measured.rayleigh.is_none());
    let moduli = found.dynamic_moduli.as_ref().unwrap();
    assert_eq!(moduli.frequency.len(), 11);
    for model in &moduli.models {
        let young = &model.moduli.as_ref().unwrap().young;
        for (storage, loss) in young.storage.iter().zip(&young.loss) {
            let off = (loss / storage - 0.2).abs() / 2.0;
            assert!(off < 1.05 * measured.largest_difference && off < 0.003, "{off} {measured:?}");
        }
    }
    let report = springfit_report::report::Report::of(&found);
    assert_eq!((report.damping, report.dynamic_moduli), (found.damping.clone(), found.dynamic_moduli.clone()));
    let tables = Table::all(&springfit_report::report::Report::of(&found));
    let table = |name: &str| tables.iter().find(|table| table.name == name).unwrap();
    assert_eq!(table("damping").rows.len(), 1);
    assert!(table("damping").notes.iter().any(|note| note.contains("constant over the band")));
    assert_eq!(table("dynamic_moduli").rows.len(), 33);
    // Decays are measured as well.
    let decay = "relaxation = { measured = { time = [0, 0.1, 0.2], amplitude = [1.0, 0.6, 0.36], frequency = 10, band = [5, 20] } }";
    let found = outcome(&block(BOX, decay, EXACT));
    let ratio = -(0.6f64.ln()) / f64::hypot(TAU, 0.6f64.ln());
    assert!((found.damping[0].ratio / ratio - 1.0).abs() < 1e-12 && found.damping[0].decay_error.unwrap() < 1e-14);
}

#[test]
fn wrong_keys_of_damping_are_named() {
    let material = |keys: &str| block(BOX, &format!("relaxation = {{ measured = {{ {keys} }} }}"), EXACT);
    let motion = |keys: &str| {
        let motion = format!("[motion]\nduration = 1\nstep = 0.1\ndamping = {{ measured = {{ {keys} }} }}\n");
        block(BOX, "density = 1000", &(EXACT.to_string() + &motion))
    };
    for (keys, message) in [
        ("loss_factor = [0.1, -0.2], frequency = [1, 2]", "loss_factor: … 0 or more… found -0.2"),
        ("loss_factor = [0.1, nan], frequency = [1, 2]", "loss_factor: … found NaN"),
        ("loss_factor = [0, 0], frequency = [1, 2]", "loss_factor: … above 0, found none"),
        ("loss_factor = [], band = [1, 2]", "loss_factor: … found none"),
        ("ratio = [0.1, 1.0], frequency = [1, 2]", "ratio: … below 1… found 1.0"),
        ("decrement = -0.1, band = [1, 2]", "decrement: … 0 or more… found -0.1"),
        ("decrement = 60, band = [1, 2]", "decrement: … at most 50, found 60.0"),
        ("ratio = [0.1, 0.2], frequency = [2, 1]", "frequency: … rise, found 1 after 2"),
        ("ratio = [0.1, 0.2], frequency = [0, 1]", "frequency: … found 0.0"),
        ("ratio = [0.1, 0.2], frequency = [1, 2, 3]", "ratio: … 3 numbers… found 2"),
        ("ratio = [0.1, 0.2]", "ratio: … 0 numbers… found 2"),
        ("ratio = 0.1", "band: … found none"),
        ("ratio = 0.1, frequency = 3", "band: … found none: …"),
        ("ratio = 0.1, frequency = 3, band = [4, 5]", "band: … around 3 Hz… found 4.0 and 5.0"),
        ("ratio = 0.1, band = [5, 4]", "band: … found 5.0 and 4.0"),
        ("ratio = [0.1, 0.2], frequency = [2, 3], band = [1, 3]", "band: … from 2 to 3 Hz… found 1.0 and 3.0"),
        ("ratio = 0.1, decrement = 0.2, band = [1, 2]", "expected one of … found ratio, decrement"),
        ("band = [1, 2]", "expected one of … found none"),
        ("amplitude = [2, 1], frequency = 3, band = [1, 4]", "expected one of … found amplitude"),
        ("amplitude = [2, 1], time = [0, 1], band = [1, 4]", "frequency: … found 0 numbers"),
        (
            "amplitude = [1, 2], time = [0, 1], frequency = 3, band = [1, 4]",
            "amplitude: … fall with time, found 1 at first and 2 at last",
        ),
        ("amplitude = [1, 0], time = [0, 1], frequency = 3, band = [1, 4]", "amplitude: … found 0.0"),
        ("amplitude = [2], time = [0], frequency = 3, band = [1, 4]", "time: … found 1"),
        ("amplitude = [2, 1], time = [1, 0], frequency = 3, band = [1, 4]", "time: … found 0 after 1"),
        ("amplitude = [2], time = [0, 1], frequency = 3, band = [1, 4]", "amplitude: … 2 numbers, found 1"),
    ] {
        reads(&refusal(&material(keys)), &format!("…material.relaxation.measured…{message}…")).unwrap();
        reads(&refusal(&motion(keys)), &format!("…motion.damping.measured…{message}…")).unwrap();
    }
    for (text, message) in [
        (material("loss_factor = 0.1, band = [1, 2], modulus = [1, 2]"), "…measured.modulus: … beside damping"),
        (
            motion("ratio = 0.1, frequency = 3"),
            "…motion.damping.measured.band: expected two frequencies or more… one frequency gives one condition, and Rayleigh's damping has two numbers",
        ),
        (
            motion("ratio = 0.1, band = [1, 2]").replace("measured =", "rayleigh = [1, 1], measured ="),
            "…motion.damping: … found rayleigh and measured",
        ),
    ] {
        reads(&refusal(&text), message).unwrap();
    }
    let swept = |keys: &str| {
        let output = format!("[output]\ndynamic_moduli = {{ {keys} }}\n");
        block(BOX, "relaxation = { terms = [{ shear = 0.1, time = 1 }] }", &(EXACT.to_string() + &output))
    };
    let good = swept("band = [1, 2]");
    for (text, message) in [
        (swept(""), "…output.dynamic_moduli: … found neither"),
        (swept("band = [1, 2], frequency = [1]"), "…output.dynamic_moduli: … found both"),
        (swept("band = [2, 1]"), "…output.dynamic_moduli.band: … found 1 after 2"),
        (swept("band = [0, 1]"), "…output.dynamic_moduli.band: … found 0"),
        (swept("band = [1, 2], count = 1"), "…output.dynamic_moduli.count: … found 1"),
        (swept("frequency = []"), "…output.dynamic_moduli.frequency: … found none"),
        (swept("frequency = [1, 1]"), "…output.dynamic_moduli.frequency: … found 1 after 1"),
        (swept("frequency = [1], count = 3"), "…output.dynamic_moduli.count: … \"band\"…"),
        (good.replace("relaxation", "density = 1 #"), "…output.dynamic_moduli: … found nothing that loses energy"),
        (
            good.replace(EXACT, "[[fit]]\nobjective = \"exact\"\n")
                .replace("tet4", "tri3")
                .replace("0.02, 0.02], cells = [4, 2, 2]", "0.02], cells = [4, 2] }\nspace = 3 #")
                .replace("young", "thickness = 1e-3\nyoung")
                .replace("shear = 0.1", "shear = 0.1, bulk = 0.1"),
            "…dynamic_moduli: expected cells that fill a plane or a space, found cells of 2 dimensions in a space of 3",
        ),
    ] {
        reads(&refusal(&text), message).unwrap();
    }
}
