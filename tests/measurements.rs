//! Moduli of regions from measured displacements: with noise, on part of the points, and from a finer world than the network.

use crate::kit::holding;
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use springfit_element::material::{Material, State};
use springfit_identify::calibration::clamped_order;
use springfit_report::report;
use springfit_studies::study::{FoundModuli, FoundModulus, ModuliSearch, Outcome, Scene, run};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

/// A block of 1 × 1 × 2 m of hexahedra in the format of Abaqus, whose upper half is another region; `size` cells along its short sides.
fn block(size: usize) -> String {
    let n = size + 1;
    let at = |i: usize, j: usize, k: usize| (k * n + j) * n + i + 1;
    let mut text = String::from("*NODE\n");
    for k in 0..=2 * size {
        for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
            let x = |i: usize| i as f64 / size as f64;
            writeln!(text, "{}, {:?}, {:?}, {:?}", at(i, j, k), x(i), x(j), x(k)).unwrap();
        }
    }
    for (name, layers, first) in [("lower", 0..size, 1), ("upper", size..2 * size, 1 + size.pow(3))] {
        writeln!(text, "*ELEMENT, TYPE=C3D8, ELSET={name}").unwrap();
        let cells = layers.flat_map(|k| (0..size).flat_map(move |j| (0..size).map(move |i| (i, j, k))));
        for (number, (i, j, k)) in cells.enumerate() {
            let face =
                |k: usize| [at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k)].map(|p| p.to_string());
            writeln!(text, "{}, {}, {}", first + number, face(k).join(", "), face(k + 1).join(", ")).unwrap();
        }
    }
    text
}

/// Young's moduli of the lower and the upper half relative to that of the material of the scene.
const TRUTH: [f64; 2] = [1.0, 4.0];

const SCENE: &str = r#"
[mesh]
file = "MESH"

[material]
young   = 1e4
poisson = 0.3
REFERENCE
[[fix]]
where = "z < 1e-6"
"#;

/// Loads, with what is in place of MEASURED.
const LOADS: [(&str, &str); 3] = [
    ("pull", "where = \"z > 1.999\"\ntraction = [0, 0, 100]"),
    ("shear", "where = \"z > 1.999\"\ntraction = [30, 0, 0]"),
    ("squeeze", "where = \"x > 0.999\"\ntraction = [-100, 20, 0]"),
];

fn outcome(folder: &Path, name: &str, text: &str) -> springfit_foundation::error::Result<Outcome> {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    run(&Scene::load(&path)?, &mut |_| {})
}

/// A world of `size` cells across, and its displacements under the loads.
struct World {
    folder: tempfile::TempDir,
    points: Vec<f64>,
    displacements: Vec<Vec<f64>>,
}

impl World {
    fn new(size: usize) -> World {
        let folder = holding("world.inp", block(size));
        let mut text = SCENE.replace("MESH", "world.inp").replace("REFERENCE", "");
        text = text.replace("[material]", "[[material]]\ngroup = \"lower\"");
        let upper = format!("[[material]]\ngroup = \"upper\"\nyoung = {:?}\npoisson = 0.3\n", 1e4 * TRUTH[1]);
        text += &upper;
        text += "[[fit]]\nobjective = \"exact\"\n";
        LOADS.iter().for_each(|(name, load)| write!(text, "[[load]]\nname = \"{name}\"\n{load}\n").unwrap());
        let outcome = outcome(folder.path(), "world.toml", &text).unwrap();
        let displacements = outcome.loads.iter().map(|load| load.fem.clone()).collect();
        World { folder, points: outcome.mesh.points.clone(), displacements }
    }

    /// Writes the displacements at the points that `keep` chooses of those of a mesh of `size` cells across, with noise of this share of
    /// their root mean square; returns the deviations, m.
    fn measure(&self, size: usize, (noise, seed): (f64, u64), keep: impl Fn(&[f64]) -> bool) -> Vec<f64> {
        let mut random = StdRng::seed_from_u64(seed);
        let mut sigmas = Vec::new();
        for ((name, _), u) in LOADS.iter().zip(&self.displacements) {
            let on = |x: &[f64]| x.iter().all(|x| (x * size as f64 - (x * size as f64).round()).abs() < 1e-6);
            let rms = (u.iter().map(|u| u * u).sum::<f64>() / u.len() as f64).sqrt();
            let mut text = String::from("x,y,z,ux,uy,uz\n");
            for (x, u) in self.points.chunks_exact(3).zip(u.chunks_exact(3)).filter(|(x, _)| on(x) && keep(x)) {
                let noisy = u.iter().map(|u| {
                    // The sum of twelve uniform numbers is nearly normal.
                    let normal = (0..12).map(|_| random.random_range(0.0..1.0)).sum::<f64>() - 6.0;
                    format!("{:?}", if x[2] > 1e-6 { u + noise * rms * normal } else { *u })
                });
                let noisy: Vec<String> = noisy.collect();
                writeln!(text, "{:?},{:?},{:?},{}", x[0], x[1], x[2], noisy.join(",")).unwrap();
            }
            std::fs::write(self.folder.path().join(format!("{name}.csv")), text).unwrap();
            sigmas.push(noise * rms);
        }
        sigmas
    }

    /// A scene in which a network of `size` cells across finds moduli with these keys, and a finer mesh of `finer` cells across.
    fn scene(&self, size: usize, finer: Option<usize>, sigmas: Option<&[f64]>, keys: &str) -> String {
        let folder = self.folder.path();
        std::fs::write(folder.join("own.inp"), block(size)).unwrap();
        let reference = finer.map_or(String::new(), |finer| {
            std::fs::write(folder.join("finer.inp"), block(finer)).unwrap();
            "[reference]\nmesh = { file = \"finer.inp\" }".into()
        });
        let mut text = SCENE.replace("MESH", "own.inp").replace("REFERENCE", &reference);
        text += "[[fit]]\nname = \"moduli\"\nobjective = \"whole\"\nstart = \"exact\"\nloads = [\"pull\", \"shear\", \"squeeze\"]\n";
        text += keys;
        for (i, (name, load)) in LOADS.iter().enumerate() {
            let sigma = sigmas.map_or(String::new(), |sigmas| format!(", sigma = {:?}", sigmas[i]));
            write!(text, "\n[[load]]\nname = \"{name}\"\n{load}\nmeasured = {{ file = \"{name}.csv\"{sigma} }}\n")
                .unwrap();
        }
        text
    }

    fn find(
        &self,
        size: usize,
        finer: Option<usize>,
        sigmas: Option<&[f64]>,
        keys: &str,
    ) -> springfit_foundation::error::Result<Outcome> {
        outcome(self.folder.path(), "own.toml", &self.scene(size, finer, sigmas, keys))
    }
}

fn moduli(outcome: &Outcome) -> &FoundModuli {
    &outcome.fits[0].kind.whole().unwrap().moduli
}

fn on_surface(x: &[f64]) -> bool {
    x.iter().zip([1.0, 1.0, 2.0]).any(|(x, side)| *x < 1e-6 || *x > side - 1e-6)
}

/// Of how many of these seeds the 95 % intervals hold the truth, of each modulus; and the largest error of a modulus.
fn coverage(world: &World, (size, finer): (usize, Option<usize>), noise: f64, surface: bool, seeds: u64) -> (f64, f64) {
    coverage_with(world, (size, finer), (noise, surface), "", seeds)
}

fn coverage_with(
    world: &World,
    (size, finer): (usize, Option<usize>),
    (noise, surface): (f64, bool),
    keys: &str,
    seeds: u64,
) -> (f64, f64) {
    let (mut held, mut all, mut worst) = (0, 0, 0.0f64);
    for seed in 0..seeds {
        let sigmas = world.measure(size, (noise, seed), |x| !surface || on_surface(x));
        let found = world.find(
            size,
            finer,
            Some(&sigmas).filter(|_| noise > 0.0).map(|s| &s[..]),
            &format!("unknowns = \"region-young\"\n{keys}"),
        );
        let found = found.unwrap();
        for modulus in &moduli(&found).all {
            let truth = TRUTH[usize::from(modulus.name.contains("upper"))];
            let [low, high] = modulus.interval.unwrap();
            let error = (modulus.factor / truth - 1.0).abs();
            // Without noise the interval is that of rounding.
            held += usize::from((low <= truth && truth <= high) || error < 1e-6);
            all += 1;
            worst = worst.max(error);
        }
    }
    let share = held as f64 / all as f64;
    println!(
        "{size} cells, finer {finer:?}, noise {noise}, surface {surface} {keys}: {:.0} %, moduli within {:.2} %",
        100.0 * share,
        100.0 * worst
    );
    (share, worst)
}

/// Two regions 1 : 4 on the mesh of the data.
fn on_the_same_mesh(seeds: u64) {
    let world = World::new(3);
    for (noise, surface) in [(0.0, false), (0.0, true), (0.01, false), (0.01, true), (0.05, false), (0.05, true)] {
        let seeds = if noise > 0.0 { seeds } else { 1 };
        let (share, _) = coverage(&world, (3, None), noise, surface, seeds);
        // Of 2 × 10 intervals of 95 %, fewer than 16 hold with a chance of 0.3 %.
        assert!(share >= if seeds >= 100 { 0.9 } else { 0.8 }, "{noise} {surface}: {share}");
    }
}

/// The same from a finer body, with a network of large cells: with the body as reference the moduli are within 3 %; with a mesh between
/// both, the intervals have what that mesh lacks.
fn on_a_coarse_network(seeds: u64) {
    let world = World::new(8);
    for (finer, noise, surface) in [(8, 0.0, false), (8, 0.01, false), (8, 0.01, true), (4, 0.01, false)] {
        let seeds = if noise > 0.0 { seeds } else { 1 };
        let (share, worst) = coverage(&world, (2, Some(finer)), noise, surface, seeds);
        assert!(share >= if seeds >= 100 { 0.9 } else { 0.8 }, "{finer} {noise} {surface}: {share}");
        assert!(worst < 0.03 || finer < 8, "{finer} {noise} {surface}: {worst}");
    }
}

#[test]
fn intervals_hold_the_truth_on_the_same_mesh() {
    on_the_same_mesh(10);
}

#[test]
fn intervals_hold_the_truth_on_a_coarse_network() {
    on_a_coarse_network(4);
}

/// A large ρ holds the moduli near the start: the intervals have how far.
#[test]
fn intervals_hold_the_truth_whatever_the_regularization_is() {
    let world = World::new(3);
    for keys in ["validate = \"discrepancy\"", "regularization = 1.0", "regularization = 0.01"] {
        let (share, worst) = coverage_with(&world, (3, None), (0.05, false), keys, 10);
        assert!(share >= 0.8 && worst > 0.01, "{keys}: {share} {worst}");
    }
}

/// A body without groups, whose halves are entries of `[[material]]`.
#[test]
fn regions_of_the_material_have_moduli_of_their_own() {
    let world = World::new(3);
    world.measure(3, (0.0, 1), |_| true);
    let parts = "[[material]]\nwhere = \"z > 0.999\"\nyoung = 1e4\npoisson = 0.3\n\n[[material]]\n";
    for keys in ["unknowns = \"region-young\"", "unknowns = \"region-moduli\""] {
        let text = world.scene(3, None, None, keys).replace("[material]\n", parts);
        let text =
            text.replace("file = \"own.inp\"", "box = { element = \"hex8\", size = [1, 1, 2], cells = [3, 3, 6] }");
        let found = outcome(world.folder.path(), "parts.toml", &text).unwrap();
        for modulus in &moduli(&found).all {
            let truth = TRUTH[usize::from(modulus.name.contains("z > 0.999"))];
            assert!((modulus.factor / truth - 1.0).abs() < 1e-3, "{keys}: {modulus:?}");
        }
        assert_eq!(moduli(&found).all.len(), if keys.contains("moduli") { 4 } else { 2 }, "{keys}");
    }
}

/// A search that ends at its largest number of steps says so, and its intervals reach to the optimum where the truth is.
#[test]
fn a_search_that_ends_before_its_optimum_says_so() {
    let world = World::new(3);
    let sigmas = world.measure(3, (0.01, 4), |_| true);
    let find = |keys: &str| {
        let found = world.find(3, None, Some(&sigmas), &format!("unknowns = \"region-young\"\n{keys}")).unwrap();
        let says = report::notes(&found).iter().any(|note| note.contains("ended at its largest number of iterations"));
        (moduli(&found).clone(), says)
    };
    let (whole, says) = find("");
    assert!(whole.search == ModuliSearch::Finished && !says);
    for keys in ["iterations = 1", "solver = \"l-bfgs\"\niterations = 2"] {
        let (found, says) = find(keys);
        assert!(found.search == ModuliSearch::Ended && says, "{keys}: {found:?}");
        for (own, best) in found.all.iter().zip(&whole.all) {
            let ([low, high], [least, most]) = (own.interval.unwrap(), best.interval.unwrap());
            assert!(low <= 1.001 * least && high >= 0.999 * most, "{keys}: {own:?} {best:?}");
        }
    }
}

/// Factors that four digits after the point would hide, or fill a line with.
#[test]
fn factors_far_from_one_are_legible() {
    let world = World::new(2);
    world.measure(2, (0.0, 1), |_| true);
    let scene = world.scene(2, None, None, "unknowns = \"region-young\"");
    for (young, lower) in [("1e9", "1.000e-5"), ("0.1", "1.000e5")] {
        let text = scene.replace("young   = 1e4", &format!("young   = {young}"));
        let found = outcome(world.folder.path(), "far.toml", &text).unwrap();
        // Beside a body of the moduli that were found, not of the guess.
        let [least, most] = found.fits[0].stability.as_ref().unwrap().energy_ratio;
        assert!(found.fits[0].status() == "stable" && least > 0.1 && most < 10.0, "{young}: {least} to {most}");
        assert!(report::notes(&found).iter().all(|note| !note.contains("is not the material")));
        let notes = report::notes(&found);
        assert!(notes.iter().any(|note| note.contains(&format!("E of lower x {lower} ("))), "{notes:?}");
    }
}

/// The finite elements of the guessed moduli are no reference for networks of the measured body.
#[test]
fn measured_bodies_are_not_compared_with_the_guess() {
    let world = World::new(4);
    world.measure(2, (0.0, 1), |_| true);
    let keys = "unknowns = \"region-young\"";
    let found = world.find(2, Some(4), None, keys).unwrap();
    assert!(found.fits[0].kind.whole().unwrap().held_out.is_empty());
    let text = world.scene(2, None, None, &format!("{keys}\nmasses = 2"));
    let text = text.replace("poisson = 0.3", "poisson = 0.3\ndensity = 1000");
    let error = outcome(world.folder.path(), "masses.toml", &text).unwrap_err().to_string();
    assert!(error.contains("fit[0].masses: expected none where displacements are measured"), "{error}");
    let error = outcome(world.folder.path(), "frequencies.toml", &text.replace("masses = 2", "frequencies = 2"));
    let error = error.unwrap_err().to_string();
    assert!(error.contains("fit[0].frequencies: expected none where displacements are measured"), "{error}");
}

/// What is measured belongs to points of the scene's mesh, of which a finer mesh has its own.
#[test]
fn measured_points_need_not_be_points_of_the_finer_mesh() {
    let world = World::new(6);
    world.measure(2, (0.0, 1), |_| true);
    let found = world.find(2, Some(3), None, "unknowns = \"region-young\"").unwrap();
    for (modulus, truth) in moduli(&found).all.iter().zip(TRUTH) {
        let [low, high] = modulus.interval.unwrap();
        assert!(low <= truth && truth <= high, "{modulus:?}");
    }
}

/// Displacements of finite elements with the moduli of the scene are no data beside measured ones, be they those of the mesh, of a finer one,
/// or under loads that are made. Springs may be fitted to both, with a note.
#[test]
fn loads_without_measured_displacements_are_refused_beside_others() {
    let world = World::new(2);
    world.measure(2, (0.0, 1), |_| true);
    let measured = "measured = { file = \"shear.csv\" }\n";
    for (finer, unknowns) in
        [(Some(4), "region-young"), (None, "region-young"), (None, "body-moduli"), (None, "moduli")]
    {
        let text = world.scene(2, finer, None, &format!("unknowns = \"{unknowns}\""));
        let error = outcome(world.folder.path(), "mixed.toml", &text.replace(measured, "")).unwrap_err().to_string();
        assert!(error.contains("fit[0].loads") && error.contains("shear, which has none"), "{error}");
        let text = text.replace("\"squeeze\"]", "\"squeeze\", \"made\"]");
        let error = outcome(world.folder.path(), "made.toml", &text).unwrap_err().to_string();
        assert!(error.contains("fit[0].loads") && error.contains("which has none"), "{unknowns}: {error}");
    }
    let springs = world.scene(2, None, None, "").replace("start = \"exact\"", "start = \"offdiag\"");
    let found = outcome(world.folder.path(), "springs.toml", &springs.replace(measured, "")).unwrap();
    let notes = report::notes(&found);
    let guess =
        "under shear, loads made from the mesh are those of finite elements with the moduli of the scene, a guess";
    assert!(notes.iter().any(|note| note.contains(guess)), "{notes:?}");
    // A load of the scene that is not fitted is compared with the guess.
    let text = world.scene(2, None, None, "unknowns = \"region-young\"").replace(measured, "");
    let text = text.replace("\"pull\", \"shear\", \"squeeze\"]", "\"pull\", \"squeeze\"]");
    let notes = report::notes(&outcome(world.folder.path(), "other.toml", &text).unwrap());
    assert!(
        notes.iter().any(|note| note.contains("errors under shear are those against finite elements")),
        "{notes:?}"
    );
}

/// Springs that follow the measured load to less than a millionth at the least ρ: it is the loads that choose ρ, with the moduli of the scene, which
/// keep the start, and the report says so.
#[test]
fn a_fit_that_validation_holds_back_says_so() {
    let world = World::new(2);
    world.measure(2, (0.0, 1), |_| true);
    let scene = world.scene(2, None, None, "").replace("start = \"exact\"", "start = \"offdiag\"");
    let scene = scene.replace("[\"pull\", \"shear\", \"squeeze\"]", "[\"pull\"]");
    let found = outcome(world.folder.path(), "held.toml", &scene).unwrap();
    let notes = report::notes(&found);
    let says = |words: &str| notes.iter().any(|note| note.contains(words));
    assert!(says("what has chosen rho does not want it") && !says("cannot do better"), "{notes:?}");
    assert!(
        says("under loads made from the mesh are those of finite elements with the moduli of the scene"),
        "{notes:?}"
    );
    let free = scene.replace("start = \"offdiag\"", "start = \"offdiag\"\nregularization = 1e-6");
    let found = outcome(world.folder.path(), "free.toml", &free).unwrap();
    assert!(found.fits[0].kind.whole().unwrap().fitted.iter().all(|load| load.after < 1e-4));
}

/// The moduli with a finer mesh are the least squares of that mesh: its exact network alone finds the same with the same data, and its
/// intervals are those without the part of the meshes.
#[test]
fn a_finer_mesh_gives_its_own_least_squares() {
    let world = World::new(4);
    for (keys, seed) in [("region-young", 1), ("region-moduli", 2), ("region-moduli", 3)] {
        let sigmas = world.measure(2, (0.02, seed), |_| true);
        let keys = format!("unknowns = \"{keys}\"");
        let found =
            |size: usize, finer: Option<usize>| moduli(&world.find(size, finer, Some(&sigmas), &keys).unwrap()).clone();
        let (own, corrected) = (found(4, None), found(2, Some(4)));
        assert!((own.misfit.unwrap() / corrected.misfit.unwrap() - 1.0).abs() < 1e-4, "{own:?} {corrected:?}");
        for (own, corrected) in own.all.iter().zip(&corrected.all) {
            // The derivatives of the one are differences.
            assert!((corrected.factor / own.factor - 1.0).abs() < 1e-3, "{own:?} {corrected:?}");
            let half = |modulus: &FoundModulus| modulus.interval.map(|[low, high]| (high / low).ln() / 2.0).unwrap();
            let of_noise = (half(corrected).powi(2) - (1.96 * corrected.mesh.unwrap()).powi(2)).sqrt();
            assert!((of_noise / half(own) - 1.0).abs() < 0.02, "{of_noise} {own:?} {corrected:?}");
        }
    }
}

/// Where a point is held its displacement is known: what was measured there changes nothing.
#[test]
fn noise_at_held_points_is_no_data() {
    let world = World::new(2);
    let sigmas = world.measure(2, (0.02, 5), |_| true);
    let keys = "unknowns = \"region-young\"\nvalidate = \"discrepancy\"";
    let before = world.find(2, None, Some(&sigmas), keys).unwrap();
    for (name, _) in LOADS {
        let path = world.folder.path().join(format!("{name}.csv"));
        let text = std::fs::read_to_string(&path).unwrap();
        let moved = text.replace(",0.0,0.0,0.0\n", &format!(",{:?},0.0,{:?}\n", sigmas[0], -3.0 * sigmas[0]));
        assert_ne!(text, moved);
        std::fs::write(path, moved).unwrap();
    }
    assert_eq!(moduli(&before), moduli(&world.find(2, None, Some(&sigmas), keys).unwrap()));
}

/// A search without ρ that follows a fit with a large one finds its optimum, which is that of a fit without ρ.
#[test]
fn searches_without_regularization_find_their_optimum() {
    let world = World::new(2);
    for seed in 0..10 {
        let sigmas = world.measure(2, (0.02, seed), |_| true);
        let find = |keys: &str| {
            let keys = format!("unknowns = \"region-moduli\"\n{keys}");
            moduli(&world.find(2, None, Some(&sigmas), &keys).unwrap()).clone()
        };
        let free = find("");
        for keys in ["regularization = 1e-2", "regularization = 1.0", "validate = \"discrepancy\""] {
            let held = find(keys);
            assert_eq!(held.search, ModuliSearch::Finished, "{seed} {keys}");
            for (held, free) in held.all.iter().zip(&free.all) {
                let ([low, high], [least, most]) = (held.interval.unwrap(), free.interval.unwrap());
                assert!(low < 1.01 * least && high > 0.99 * most, "{seed} {keys}: {held:?} {free:?}");
            }
        }
    }
}

#[test]
#[ignore = "takes minutes; .ci/long has it"]
fn intervals_hold_the_truth_in_a_hundred_cases() {
    on_the_same_mesh(100);
    on_a_coarse_network(100);
}

/// Without a finer mesh the discretisation makes a coarse network err by more than its interval tells, and the report says which errors are
/// in it.
#[test]
fn a_finer_mesh_removes_the_error_of_the_network() {
    let world = World::new(8);
    world.measure(2, (0.0, 1), |_| true);
    let alone = world.find(2, None, None, "unknowns = \"region-young\"").unwrap();
    let corrected = world.find(2, Some(4), None, "unknowns = \"region-young\"").unwrap();
    let worst = |outcome: &Outcome| {
        let error = |m: &FoundModulus| m.factor / TRUTH[usize::from(m.name.contains("upper"))] - 1.0;
        moduli(outcome).all.iter().map(|m| error(m).abs()).fold(0.0, f64::max)
    };
    println!("{:.4} alone, {:.4} with a finer mesh", worst(&alone), worst(&corrected));
    assert!(worst(&alone) > 0.02 && worst(&corrected) < worst(&alone) / 3.0);
    let says = |outcome: &Outcome, what: &str| report::notes(outcome).iter().any(|note| note.contains(what));
    assert!(says(&alone, "95 % intervals without errors of the mesh"));
    assert!(says(&corrected, "95 % intervals with errors of the mesh"));
}

/// One state of uniform shear does not see λ, and points of one region do not see the other's modulus well: both are named.
#[test]
fn what_displacements_do_not_see_is_named() {
    let world = World::new(3);
    let sigmas = world.measure(3, (0.05, 3), |x| x[2] > 1.999);
    let found = world.find(3, None, Some(&sigmas), "unknowns = \"region-moduli\"").unwrap();
    let weak: BTreeSet<&str> = moduli(&found).weak.iter().flat_map(|names| names.split(", ")).collect();
    println!("{:?} {:?}", moduli(&found).all, weak);
    assert!(weak.iter().any(|name| name.contains("lambda of upper")), "{weak:?}");
    assert!(report::notes(&found).iter().any(|note| note.contains("the displacements hardly see")));
    // With ν known, both are seen.
    let found = world.find(3, None, Some(&sigmas), "unknowns = \"region-young\"").unwrap();
    assert!(moduli(&found).weak.is_empty(), "{:?}", moduli(&found).weak);
}

/// Moduli of every cell from noisy displacements: the discrepancy principle stops where the residuals are the noise, before they fit it.
#[test]
fn the_noise_chooses_the_regularization() {
    let world = World::new(3);
    let sigmas = world.measure(3, (0.02, 9), |_| true);
    let found = world.find(3, None, Some(&sigmas), "unknowns = \"moduli\"\nvalidate = \"discrepancy\"").unwrap();
    let whole = found.fits[0].kind.whole().unwrap();
    let rho = whole.regularization.unwrap();
    // The curve has the residuals relative to the noise: above one before the stage that is chosen.
    for stage in &whole.curve {
        let ratio = stage.validated.unwrap();
        assert_eq!(ratio <= 1.0, stage.regularization <= rho, "{rho} {:?}", whole.curve);
    }
    assert!(rho < 10.0 && whole.curve.last().unwrap().regularization < rho, "{rho}");
    // A stated noise that is far too small: no rho reaches it.
    let sigmas: Vec<f64> = sigmas.iter().map(|sigma| 1e-3 * sigma).collect();
    let found = world.find(3, None, Some(&sigmas), "unknowns = \"moduli\"\nvalidate = \"discrepancy\"").unwrap();
    let notes = report::notes(&found);
    assert!(notes.iter().any(|note| note.contains("no rho that was tried reaches the noise")), "{notes:?}");
}

/// Noise that is larger than the data, noise of some loads only, and noise that is needed and not given.
#[test]
fn wrong_noise_is_named() {
    let world = World::new(2);
    world.measure(2, (0.0, 1), |_| true);
    let error = |sigmas: Option<&[f64]>, keys: &str| world.find(2, None, sigmas, keys).unwrap_err().to_string();
    let young = "unknowns = \"region-young\"";
    let large = error(Some(&[1.0, 1e-3, 1e-3]), young);
    assert!(large.contains("noise below the displacements under \"pull\"") && large.contains("1.000e0 m"), "{large}");
    assert!(large.contains("load[0].measured.sigma") && !large.contains("fit[0]"), "{large}");
    let negative = error(Some(&[-1.0, 1e-3, 1e-3]), young);
    assert!(negative.contains("load[0].measured.sigma"), "{negative}");
    let none = error(None, "unknowns = \"region-young\"\nvalidate = \"discrepancy\"");
    assert!(none.contains("validate") && none.contains("none for \"pull\""), "{none}");
}

/// A stated noise of a thousandth of what it is leaves the intervals as wide as the noise is, within a quarter: they are by the residuals then, and
/// the report says that nothing is to be trusted.
#[test]
fn intervals_are_those_of_the_residuals_where_the_stated_noise_is_too_small() {
    let world = World::new(3);
    let sigmas = world.measure(3, (0.02, 9), |_| true);
    let keys = "unknowns = \"region-young\"";
    let width = |found: &Outcome| -> Vec<f64> {
        moduli(found).all.iter().map(|modulus| modulus.interval.map(|[low, high]| (high / low).ln()).unwrap()).collect()
    };
    let right = world.find(3, None, Some(&sigmas), keys).unwrap();
    assert!(!report::notes(&right).iter().any(|note| note.contains("NOT TRUSTED")));
    let small: Vec<f64> = sigmas.iter().map(|sigma| 1e-3 * sigma).collect();
    let wrong = world.find(3, None, Some(&small), keys).unwrap();
    assert!(report::notes(&wrong).iter().any(|note| note.contains("NOT TRUSTED: residuals are")));
    for (right, wrong) in width(&right).into_iter().zip(width(&wrong)) {
        assert!((wrong / right - 1.0).abs() < 0.25, "{right} {wrong}");
    }
}

/// At the edge of a clamped face displacements grow with these powers of the distance, in plane strain (Williams 1952): 0.7112 at ν = 0.3 is known of
/// the clamped cantilever, 0.5946 is the root of `sin²(λπ/2) = 1 − λ²` of an incompressible body.
#[test]
fn clamped_edges_have_their_order() {
    for (poisson, exponent) in [(0.3, 0.7112), (0.499_999_9, 0.5946)] {
        let state = State::PlaneStrain { thickness: 2.0 };
        let order = clamped_order(&Material::new(3.0, poisson, state).unwrap().moduli());
        assert!((order - 2.0 * exponent).abs() < 2e-4, "{poisson}: {order}");
        let solid = clamped_order(&Material::new(7.0, poisson, State::Solid).unwrap().moduli());
        assert!((order - solid).abs() < 1e-9);
    }
    // A rod of no lateral strain has bounded strains.
    let plain = clamped_order(&Material::new(1.0, 0.0, State::Solid).unwrap().moduli());
    assert!(plain > 1.6 && plain <= 2.0, "{plain}");
    assert_eq!(clamped_order(&Material::new(1.0, -0.5, State::Solid).unwrap().moduli()), 2.0);
}
