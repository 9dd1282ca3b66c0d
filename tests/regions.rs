//! Bodies of several materials, by region and from place to place: against bars and beams in closed form, and cell by cell against the
//! fit of that cell alone.

use crate::kit::{outcome, outcome_in, refusal};
use crate::shapes::bodies::grid;
use springfit_bodies::model::{cell_means, finite_elements};
use springfit_element::material::{BlockValues, CellMap, Hooke, Material, State};
use springfit_element::springs::{Measure, Springs};
use springfit_fit::fit::{Fit, Objective, element_errors, fit_cells, fit_element};
use springfit_report::report::Report;
use springfit_studies::study::{Outcome, Scene};
use tempfile::TempDir;

/// The largest displacement along the last axis under the first load.
fn end(outcome: &Outcome) -> f64 {
    let d = outcome.mesh.dimension;
    outcome.loads[0].fem.iter().skip(d - 1).step_by(d).copied().fold(0.0, f64::max)
}

fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found / expected - 1.0).abs() <= tolerance, "{found:e}, expected {expected:e}");
}

/// A bar of cells along z that is free across, under a traction of 10 Pa at its end.
fn bar(element: &str, cells: [usize; 3], materials: &str, fits: &str) -> String {
    format!(
        r#"
[mesh]
box = {{ element = "{element}", size = [1, 1, 3], cells = {cells:?} }}
{materials}
{fits}
[[fix]]
group = "zmin"
[[load]]
name = "pull"
group = "zmax"
traction = [0, 0, 10.0]
"#
    )
}

const EXACT: &str = "[[fit]]\nobjective = \"exact\"\n";

/// Materials without a Poisson's ratio: what chooses the cells of each, and its Young's modulus.
fn layers(parts: &[(&str, &str)]) -> String {
    let of = |(part, young): &(&str, &str)| format!("[[material]]\n{part}\nyoung = {young}\npoisson = 0\n");
    parts.iter().map(of).collect()
}

/// `u = σ Σ L_i/E_i`, for bars in series; without Poisson's ratio the state is uniaxial everywhere.
#[test]
fn layers_in_series_add_their_compliances() {
    let two = layers(&[("where = \"z <= 1.00001\"", "2e3"), ("", "7e3")]);
    let three = layers(&[("where = \"z < 1.00001\"", "2e3"), ("where = \"z > 1.99999\"", "\"1 MPa\""), ("", "5e3")]);
    let stiff = layers(&[("where = \"z < 1.00001\"", "1e3"), ("", "1e6")]);
    for element in ["hex8", "tet4", "hex20", "wedge6"] {
        for (materials, compliance) in [
            (&two, 1.0 / 2e3 + 2.0 / 7e3),
            (&three, 1.0 / 2e3 + 1.0 / 5e3 + 1.0 / 1e6),
            // 1 : 1000
            (&stiff, 1.0 / 1e3 + 2.0 / 1e6),
        ] {
            let outcome = outcome(&bar(element, [2, 1, 3], materials, EXACT));
            assert_close(end(&outcome), 10.0 * compliance, 1e-10);
            let error = outcome.fits[0].loads[0].error.unwrap();
            // In percent; the ratio of the stiffnesses of the regions costs digits.
            assert!(error.rms < 1e-7 && error.max < 1e-7, "{element}: {} {}", error.rms, error.max);
            assert!(outcome.fits[0].as_material.distance < 1e-8, "{element}: {}", outcome.fits[0].as_material.distance);
        }
    }
}

/// `F = ε Σ E_i A_i` of bars side by side under one strain.
#[test]
fn layers_in_parallel_add_their_stiffnesses() {
    let materials = layers(&[("where = \"x < 0.25001\"", "2e3"), ("", "7e3")]);
    let text =
        bar("hex8", [4, 1, 3], &materials, EXACT).replace("traction = [0, 0, 10.0]", "displacement = [0, 0, 0.3]");
    let outcome = outcome(&text);
    let (mesh, u) = (&outcome.mesh, &outcome.loads[0].fem);
    let mut force = 0.0;
    for entry in finite_elements(mesh, outcome.material.moduli()) {
        let is_end = |dof: usize| dof % 3 == 2 && mesh.point(dof / 3)[2] > 2.999;
        if is_end(entry.row) {
            force += entry.val * u[entry.col];
        }
        if entry.row != entry.col && is_end(entry.col) {
            force += entry.val * u[entry.row];
        }
    }
    assert_close(force, 0.1 * (0.25 * 2e3 + 0.75 * 7e3), 1e-10);
}

/// Composite beam: `y₀ = Σ E A y/Σ E A`, `κ = M/Σ E I`, deflection `κ L²/2`. Without Poisson's ratio the plane sections of the theory of
/// beams are exact, and quadratic cells have the displacements `−κ x (y − y₀)` and `κ x²/2`.
#[test]
fn a_beam_of_two_layers_bends_as_the_theory_of_beams() {
    let (e, h, length, moment) = ([2e3, 1e4], [0.4f64, 0.6], 5.0, 3.0);
    let middles = [h[0] / 2.0, h[0] + h[1] / 2.0];
    let y0: f64 = (e[0] * h[0] * middles[0] + e[1] * h[1] * middles[1]) / (e[0] * h[0] + e[1] * h[1]);
    let second = |i: usize| e[i] * (h[i].powi(3) / 12.0 + h[i] * (middles[i] - y0).powi(2));
    let curvature = moment / (second(0) + second(1));
    let load = |i: usize, part: &str| {
        format!(
            "[[load]]\nname = \"{i}\"\nwhere = \"x > 4.999 && {part}\"\ntraction = [\"{:?}*({y0:?} - y)\", 0]\n",
            e[i] * curvature
        )
    };
    for element in ["quad9", "quad8"] {
        let text = format!(
            "[mesh]\nbox = {{ element = \"{element}\", size = [5, 1], cells = [5, 5] }}\n\
             [[material]]\nwhere = \"y < 0.40001\"\nyoung = {:?}\npoisson = 0\n[[material]]\nyoung = {:?}\npoisson = 0\n\
             {EXACT}[[fix]]\nwhere = \"x < 1e-6\"\naxes = [\"x\"]\n[[fix]]\nwhere = \"x < 1e-6 && y < 1e-6\"\n{}{}",
            e[0],
            e[1],
            load(0, "y < 0.40001"),
            load(1, "y > 0.39999")
        );
        let outcome = outcome(&text);
        let (mesh, at) = (&outcome.mesh, |load: usize, dof: usize| outcome.loads[load].fem[dof]);
        for p in 0..mesh.point_count() {
            let [x, y] = [mesh.point(p)[0], mesh.point(p)[1]];
            let expected = [-curvature * x * (y - y0), curvature * x * x / 2.0];
            for k in 0..2 {
                let found = at(0, 2 * p + k) + at(1, 2 * p + k);
                let size = curvature * length * length / 2.0;
                assert!((found - expected[k]).abs() < 1e-9 * size, "{element} {x} {y}: {found} {}", expected[k]);
            }
        }
        for load in &outcome.fits[0].loads {
            assert!(load.error.unwrap().rms < 1e-7);
        }
    }
}

/// `u = σ Σ h/E(z_i)` with z_i the middles of the cells.
#[test]
fn an_expression_is_that_of_the_middle_of_each_cell() {
    let materials = "[material]\nyoung = \"5e3*(1 + 10*z)\"\npoisson = 0\ndensity = \"1000*(1 + z)\"\n";
    let outcome = outcome(&bar("hex8", [1, 1, 6], materials, EXACT));
    let compliance: f64 = (0..6).map(|i| 0.5 / (5e3 * (1.0 + 10.0 * (0.25 + 0.5 * f64::from(i))))).sum();
    assert_close(end(&outcome), 10.0 * compliance, 1e-10);
    assert!(outcome.fits[0].loads[0].error.unwrap().rms < 1e-7);
    // ∫ 1000 (1 + z) over 1 × 1 × 3, of which the rule of the middles is exact.
    assert_close(outcome.masses.unwrap().iter().sum(), 1000.0 * (3.0 + 4.5), 1e-12);
}

/// Writes the columns x, y, z, E of these places, and gives the number there.
fn table(places: impl Iterator<Item = Vec<f64>>, young: impl Fn(&[f64]) -> f64) -> String {
    let row = |x: Vec<f64>| format!("{:?},{:?},{:?},{:?}\n", x[0], x[1], x[2], young(&x));
    format!("x,y,z,E\n{}", places.map(row).collect::<String>())
}

/// A field that is linear in space is that of the expression, whatever file it comes from: nodes and cells of the mesh, or other places.
#[test]
fn data_of_files_are_those_of_an_expression() {
    let folder = TempDir::new().unwrap();
    let young = |x: &[f64]| 5e3 * (2.5 + 0.1 * x[0] - 0.2 * x[1] + 10.0 * x[2]);
    let text = "\"5e3*(2.5 + 0.1*x - 0.2*y + 10*z)\"";
    for element in ["tet4", "hex8", "tet10"] {
        let mesh = grid(element, &[1.0, 1.0, 3.0], &[2, 2, 3]);
        let points = || (0..mesh.point_count()).map(|p| mesh.point(p).to_vec());
        let middles = cell_means(&mesh, &mesh.points).concat();
        std::fs::write(folder.path().join("nodes.csv"), table(points(), young)).unwrap();
        std::fs::write(folder.path().join("cells.csv"), table(middles.chunks(3).map(<[f64]>::to_vec), young)).unwrap();
        let steps = |i: usize| (i as f64 - 0.5) / 4.0;
        let others = (0..7 * 7 * 14).map(|i| vec![steps(i % 7), steps(i / 7 % 7), steps(i / 49)]);
        std::fs::write(folder.path().join("others.csv"), table(others, young)).unwrap();
        let scene = |young: &str| {
            let materials = format!("[material]\nyoung = {young}\npoisson = 0.3\n");
            let text = bar(element, [2, 2, 3], &materials, EXACT);
            let scene = Scene::parse(&text, &folder.path().join("scene.toml")).unwrap();
            let mesh = scene.build_mesh().unwrap();
            let moduli = scene.material_of(&mesh).unwrap().moduli();
            moduli.values().map(|hooke| hooke.moduli().unwrap().mu).collect::<Vec<f64>>()
        };
        let expected = scene(text);
        for file in [
            "{ file = \"nodes.csv\" }",
            "{ file = \"cells.csv\", interpolation = \"nearest\" }",
            "{ file = \"others.csv\", array = \"E\", interpolation = \"linear\" }",
        ] {
            for (found, expected) in scene(file).iter().zip(&expected) {
                assert_close(*found, *expected, 1e-9);
            }
        }
        let mega: Vec<f64> = scene("{ file = \"cells.csv\", interpolation = \"nearest\", unit = \"kPa\" }");
        assert_close(mega[0], 1e3 * expected[0], 1e-9);
    }
}

/// The arrays of a grid: one number for each cell, or for each point.
#[test]
fn arrays_of_a_grid_are_read() {
    let folder = TempDir::new().unwrap();
    let grid = "# vtk DataFile Version 3.0\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n\
        0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1 0 0 3 1 0 3 1 1 3 0 1 3\n\
        CELLS 2 18\n8 0 1 2 3 4 5 6 7\n8 4 5 6 7 8 9 10 11\nCELL_TYPES 2\n12\n12\n\
        CELL_DATA 2\nSCALARS E double 1\nLOOKUP_TABLE default\n2000 7000\nSCALARS part int 1\nLOOKUP_TABLE default\n4 9\n\
        POINT_DATA 12\nSCALARS T double 1\nLOOKUP_TABLE default\n1 1 1 1 3 3 3 3 5 5 5 5\n";
    std::fs::write(folder.path().join("two.vtk"), grid).unwrap();
    let solve = |materials: &str| {
        let text = bar("hex8", [1, 1, 1], materials, EXACT);
        let mesh = "box = { element = \"hex8\", size = [1, 1, 3], cells = [1, 1, 1] }";
        assert!(text.contains(mesh));
        let text = text.replace(mesh, "file = \"two.vtk\"").replace("group = \"zmin\"", "where = \"z < 1e-9\"");
        let text = text.replace("group = \"zmax\"", "where = \"z > 2.999\"");
        outcome_in(folder.path(), &text).unwrap()
    };
    let cells = solve("[material]\nyoung = { file = \"two.vtk\", array = \"E\" }\npoisson = 0\n");
    assert_close(end(&cells), 10.0 * (1.0 / 2e3 + 2.0 / 7e3), 1e-10);
    // Numbers of points: means over the cells, here 2 kPa and 4 kPa.
    let points = solve("[material]\nyoung = { file = \"two.vtk\", array = \"T\", unit = \"kPa\" }\npoisson = 0\n");
    assert_close(end(&points), 10.0 * (1.0 / 2e3 + 2.0 / 4e3), 1e-10);
    let sets = solve(&layers(&[("group = \"part=4\"", "2e3"), ("group = \"part=9\"", "7e3")]));
    assert_close(end(&sets), 10.0 * (1.0 / 2e3 + 2.0 / 7e3), 1e-10);
    assert_eq!(sets.material.regions(), ["part=4", "part=9"]);
}

/// Each cell has the constants that it has alone, whatever the materials of its neighbours are: every objective.
#[test]
fn every_cell_is_fitted_to_its_own_moduli() {
    for name in ["hex8", "tet4"] {
        let mut mesh = grid(name, &[1.0, 1.0, 3.0], &[2, 2, 3]);
        mesh.points.iter_mut().enumerate().for_each(|(i, x)| *x += 0.02 * ((i * 7919 % 97) as f64 / 97.0 - 0.5));
        let block = &mesh.blocks[0];
        let (element, n) = (&block.element, block.element.nodes());
        let springs = Springs::select(element, None).unwrap();
        let moduli: Vec<Hooke> = (0..block.cells().len())
            .map(|cell| {
                let young = 1e3 * 10f64.powi((cell % 3) as i32);
                Material::new(young, 0.05 * (cell % 8) as f64, State::Solid).unwrap().moduli().into()
            })
            .collect();
        for objective in Objective::all(element.has_higher_modes()) {
            for nonnegative in [false, true] {
                let fit = Fit { nonnegative, ..Fit::new(objective) };
                let found =
                    fit_cells(element, &springs, &mesh.points, &block.connectivity, &moduli[..], &fit, &mut |_| {})
                        .unwrap();
                for (cell, nodes) in block.connectivity.chunks(n).enumerate() {
                    let x: Vec<f64> = nodes.iter().flat_map(|&p| mesh.point(p)).copied().collect();
                    let alone = fit_element(element, &springs, &x, &moduli[cell], &fit).unwrap();
                    let own = &found.constants[cell * springs.len()..(cell + 1) * springs.len()];
                    let size = alone.iter().fold(0.0f64, |a, k| a.max(k.abs()));
                    for (a, b) in own.iter().zip(&alone) {
                        assert!((a - b).abs() <= 1e-7 * size, "{name} {objective:?} cell {cell}: {a} {b}");
                    }
                }
                let errors = element_errors(element, &mesh.points, &block.connectivity, &moduli[..], &found).unwrap();
                assert_eq!(errors.frobenius.len(), moduli.len());
            }
        }
        let few = BlockValues::Each(&moduli[1..]);
        let fit = Fit::new(Objective::all(false)[0]);
        let error = fit_cells(element, &springs, &mesh.points, &block.connectivity, few, &fit, &mut |_| {});
        assert!(error.unwrap_err().to_string().contains("one of each cell"));
    }
}

/// Congruent cells of other moduli are other cells.
#[test]
fn congruent_cells_share_constants_only_within_a_region() {
    let materials =
        "[[material]]\nwhere = \"z < 1.00001\"\nyoung = 1e3\npoisson = 0.3\n[[material]]\nyoung = 3e3\npoisson = 0.1\n";
    let outcome = outcome(&bar("hex8", [2, 2, 3], materials, "[[fit]]\nobjective = \"spectral\"\n"));
    assert_eq!(outcome.fits[0].reused, 12 - 2);
}

/// Masses, areas and loads of a plane body are those of the thickness of each region.
#[test]
fn thickness_and_density_are_those_of_each_region() {
    let text = "[mesh]\nbox = { element = \"quad4\", size = [2, 1], cells = [4, 2] }\n\
        [[material]]\nwhere = \"x < 1.00001\"\nyoung = 1e4\npoisson = 0\nthickness = 0.1\ndensity = 1000\n\
        [[material]]\nyoung = 1e4\npoisson = 0\nthickness = 0.3\ndensity = 500\n\
        [[fit]]\nobjective = \"exact\"\n[[fix]]\ngroup = \"xmin\"\n[[load]]\nname = \"pull\"\ngroup = \"xmax\"\ntraction = [10, 0]\n";
    let outcome = outcome(text);
    assert_close(outcome.masses.as_ref().unwrap().iter().sum(), 100.0 + 150.0, 1e-12);
    // A traction of 10 Pa on 1 m × 0.3 m: the thin half carries 30 Pa.
    let end = outcome.loads[0].fem.iter().step_by(2).copied().fold(0.0, f64::max);
    assert_close(end, 30.0 / 1e4 + 10.0 / 1e4, 1e-10);
    let report = Report::of(&outcome);
    assert_eq!(report.materials.len(), 2);
    assert_eq!(report.materials[0].thickness, Some([Some(0.1), Some(0.1)]));
    assert_eq!((report.materials[1].cells, report.materials[1].density), (4, Some([Some(500.0), Some(500.0)])));
    assert_eq!((report.young, report.materials[0].region.as_deref()), (Some(1e4), Some("x < 1.00001")));
}

/// No patch has cells of two regions, and near the incompressible both answer without locking.
#[test]
fn patches_end_where_a_region_ends() {
    let materials = "[[material]]\nwhere = \"z < 1.50001\"\nyoung = 1e3\npoisson = 0.4999\n[[material]]\nyoung = 1e5\npoisson = 0.3\n";
    let outcome = outcome(&bar("tet4", [2, 2, 4], materials, "[[fit]]\nobjective = \"exact\"\nvolume = \"patches\"\n"));
    let mut patches = 0;
    for spring in &outcome.fits[0].network.others {
        let Measure::Patch(patch) = &spring.measure else { continue };
        patches += 1;
        let below = |&point: &usize| outcome.mesh.point(point)[2] < 1.50001;
        let above = |&point: &usize| outcome.mesh.point(point)[2] > 1.49999;
        let of = |nodes: &[usize]| nodes.iter().map(|&place| spring.points[place]).collect::<Vec<usize>>();
        let all = patch.cells.iter().map(|(nodes, _)| of(nodes));
        let sides: Vec<[bool; 2]> = all.map(|nodes| [nodes.iter().all(below), nodes.iter().all(above)]).collect();
        assert!(sides.iter().all(|side| side[0]) || sides.iter().all(|side| side[1]));
    }
    // The points that are free, and those of the interface twice.
    assert_eq!(patches, 36 + 9);
}

/// One table stays one material, as it was: its key, its report, its settings.
#[test]
fn one_material_is_that_of_all_cells() {
    let outcome = outcome(&bar("hex8", [1, 1, 2], "[material]\nyoung = \"2 kPa\"\npoisson = 0.3\n", EXACT));
    assert_eq!(outcome.material.uniform(), Some(Material::new(2e3, 0.3, State::Solid).unwrap()));
    let report = Report::of(&outcome);
    assert_eq!((report.young, report.poisson, report.materials.len()), (Some(2e3), Some(0.3), 1));
    assert_eq!(report.materials[0].region, None);
    let same = CellMap::of_blocks(vec![vec![1.0; 4], vec![1.0; 2]]);
    assert_eq!(same, CellMap::Uniform(1.0));
}

/// The weight of a body is its density times the acceleration, region by region and cell by cell.
#[test]
fn gravity_is_a_body_force_of_the_density() {
    let of = |materials: &str, load: &str| {
        let text = bar("hex8", [1, 1, 4], materials, EXACT);
        outcome(&(text[..text.find("[[load]]").unwrap()].to_string() + "[[load]]\nname = \"weight\"\n" + load))
    };
    let base = "young = 1e5\npoisson = 0.3\n";
    let regions = format!(
        "[[material]]\nwhere = \"z < 1.500001\"\n{base}density = 1000\n[[material]]\n{base}density = \"2 g/cm^3\"\n"
    );
    let field = format!("[material]\n{base}density = \"1000 + 1000*step(z - 1.5)\"\n");
    let uniform = format!("[material]\n{base}density = 1000\n");
    let gravity = "gravity = [1.5, 0, -9.81]\n";
    let expected = of(&uniform, "body = [\"1500 + 1500*step(z - 1.5)\", 0, \"-9810 - 9810*step(z - 1.5)\"]\n");
    for (materials, expected) in
        [(&regions, &expected), (&field, &expected), (&uniform, &of(&uniform, "body = [1500, 0, -9810]\n"))]
    {
        let found = of(materials, gravity);
        let size = expected.loads[0].fem.iter().fold(0.0, |size: f64, u| size.max(u.abs()));
        let pairs = found.loads[0].fem.iter().zip(&expected.loads[0].fem);
        let most = pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        assert!(size > 0.0 && most < 1e-10 * size, "{materials}: {most:e} of {size:e}");
    }
    let without = bar("hex8", [1, 1, 1], &format!("[material]\n{base}"), EXACT)
        .replace("group = \"zmax\"\ntraction = [0, 0, 10.0]", gravity);
    let found = refusal(&without);
    assert!(found.contains("material.density") && found.contains("load[0].gravity"), "{found}");
}

#[test]
fn wrong_materials_are_named() {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("map.csv", "x,y,z,E\n0,0,0,1000\n1,1,3,nan\n");
    write("negative.csv", "x,y,z,E\n0,0,0,-1000\n1,1,3,-5\n");
    write("far.csv", "x,y,z,E\n100,100,100,1000\n");
    write("two.csv", "x,y,z,E,F\n0,0,0,1000,2\n");
    write("again.csv", "x,y,z,E\n0,0,0,1000\n1,-0.0,0,2000\n0,0,0,1000\n1,0,0,3000\n");
    write("short.csv", "x,y,z,E\n0,0,0\n");
    let region = |first: &str, second: &str| {
        format!("[[material]]\n{first}young = 1e3\npoisson = 0\n[[material]]\n{second}young = 1e4\npoisson = 0\n")
    };
    let young = |value: &str| format!("[material]\nyoung = {value}\npoisson = 0.3\n");
    let cases = [
        (region("group = \"tumour\"\n", ""), "scene.toml:5: material[0].group", "expected a group of the mesh"),
        (
            region("where = \"z < 9\"\n", "where = \"z < 1.1\"\n"),
            "material",
            "every cell in one region, found 1 in two",
        ),
        (region("where = \"z < 1.1\"\n", "where = \"z > 1.9\"\n"), "material", "found 1 cells in none"),
        (region("where = \"z < -1\"\n", ""), "material[0]", "has no cells"),
        (region("where = \"z < 9\"\n", ""), "material[1]", "has no cells"),
        (young("{ file = \"again.csv\" }"), "again.csv:5: values", "the values of line 3, which"),
        (region("", ""), "material[1]", "material[0] has what is left"),
        (region("where = \"z < 1.1\"\ngroup = \"zmin\"\n", ""), "material[0]", "found both"),
        (
            region("where = \"z < 1.1\"\ndensity = 1000\n", ""),
            "material[1].density",
            "in every [[material]] or in none",
        ),
        (
            region("where = \"z < 1.1\"\nlaw = \"neo-hookean\"\n", ""),
            "material[1].law",
            "in every [[material]] or in none",
        ),
        ("material = []\n".into(), "material", "at least one"),
        (young("\"5e3*(1 - z)\""), "material.young", "found -2500 in hex8 cell 2 at ["),
        (young("\"ln(z - 2)\""), "material.young", "found NaN in hex8 cell 1"),
        (young("\"5e3*q\""), "scene.toml:5: material.young", "\"q\""),
        (young("{ file = \"gone.csv\" }"), "gone.csv", "cannot be read"),
        (young("{ file = \"map.csv\" }"), "map.csv:3", "found \"nan\""),
        (young("{ file = \"negative.csv\" }"), "negative.csv:2: points[0]", "expected a number above 0, found -1000"),
        (young("{ file = \"far.csv\" }"), "far.csv", "values around every cell"),
        (young("{ file = \"two.csv\" }"), "two.csv:1: header", "one column besides the position"),
        (young("{ file = \"two.csv\", array = \"G\" }"), "two.csv:1: header", "a column \"g\""),
        (young("{ file = \"short.csv\" }"), "short.csv:2", "4 cells as in the header"),
        (young("{ file = \"map.csv\", interpolation = \"cubic\" }"), "material.young.interpolation", "nearest, linear"),
        (young("{ file = \"map.csv\", unit = \"lbf\" }"), "material.young", "lbf"),
        (young("{ file = \"map.txt\" }"), "map.txt", ".csv, .vtu or .vtk"),
    ];
    for (materials, place, words) in cases {
        let mut text = bar("hex8", [1, 1, 3], &materials, EXACT);
        if materials.starts_with("material =") {
            text = materials.clone() + &text.replace(&materials, "");
        }
        let found = outcome_in(folder.path(), &text).unwrap_err().to_string();
        assert!(found.contains(place) && found.contains(words), "{materials}\n{found}\nexpected {place} {words}");
    }
}

/// From a file and from an expression to a network of a hundred thousand cells.
#[test]
fn a_field_on_a_hundred_thousand_cells() {
    let folder = TempDir::new().unwrap();
    let n = 47;
    let middle = |i: usize| (i as f64 + 0.5) / n as f64;
    let young = |x: &[f64]| 1e4 * (1.0 + (20.0 * x[0]).sin() * (30.0 * x[1]).cos() * x[2] / 2.0);
    let places = (0..n * n * n).map(|i| vec![middle(i % n), middle(i / n % n), middle(i / n / n)]);
    std::fs::write(folder.path().join("map.csv"), table(places, young)).unwrap();
    let scene = |young: &str| {
        let text = format!(
            "[mesh]\nbox = {{ element = \"hex8\", size = [1, 1, 1], cells = [{n}, {n}, {n}] }}\n\
             [material]\nyoung = {young}\npoisson = \"0.3 + 0.1*x\"\ndensity = 1000\n\
             [[fit]]\nobjective = \"offdiag\"\n[[fit]]\nobjective = \"exact\"\n"
        );
        outcome_in(folder.path(), &text).unwrap()
    };
    let file = scene("{ file = \"map.csv\", interpolation = \"nearest\" }");
    let expression = scene("\"1e4*(1 + sin(20*x)*cos(30*y)*z/2)\"");
    assert_eq!(file.mesh.cell_count(), 103_823);
    for (a, b) in file.fits.iter().zip(&expression.fits) {
        let constants = a.network.lengths.iter().zip(&b.network.lengths);
        constants.for_each(|(a, b)| assert!((a.constant - b.constant).abs() < 1e-9 * 1e3, "{a:?} {b:?}"));
    }
    assert!(file.fits[1].frobenius().unwrap().max < 1e-10);
    assert_close(file.masses.unwrap().iter().sum(), 1000.0, 1e-10);
}

/// The stretch of a bar of two laws under a dead load: the force is the same in both, and without Poisson's ratio each answers along its
/// axis alone. Neo-Hookean: `P = μ (l − 1/l) + λ ln l/l` with λ = 0, `μ = E/2`.
#[test]
fn regions_have_laws_of_their_own() {
    let law = |region: &str, young: f64, law: &str| {
        format!("[[material]]\n{region}young = {young:?}\npoisson = 0\nlaw = \"{law}\"\n")
    };
    let stretch = |young: f64, pull: f64| {
        let (mut low, mut high) = (1.0f64, 10.0f64);
        for _ in 0..200 {
            let l = (low + high) / 2.0;
            *(if young / 2.0 * (l - 1.0 / l) < pull { &mut low } else { &mut high }) = l;
        }
        low
    };
    for element in ["hex8", "tet4"] {
        let both = law("where = \"z < 1.00001\"\n", 200.0, "neo-hookean") + &law("", 50.0, "neo-hookean");
        let outcome = outcome(&bar(element, [1, 1, 3], &both, EXACT));
        // Free sides stay straight without Poisson's ratio, as σ across is μ (1 − 1) = 0.
        let expected = stretch(200.0, 10.0) + 2.0 * stretch(50.0, 10.0) - 3.0;
        assert_close(end(&outcome), expected, 1e-6);
        let error = outcome.fits[0].loads[0].error.unwrap();
        assert!(error.rms < 1e-4 && error.max < 1e-4, "{element}: {} {}", error.rms, error.max);
    }
    // St. Venant–Kirchhoff beside neo-Hookean: the finite elements follow both, no exact network does.
    let two = law("where = \"z < 1.00001\"\n", 200.0, "st-venant-kirchhoff") + &law("", 200.0, "neo-hookean");
    let offdiag = "[[fit]]\nobjective = \"offdiag\"\n";
    let outcome = outcome(&bar("hex8", [1, 1, 3], &two, offdiag));
    // P = E/2 l (l² − 1)
    let (mut low, mut high) = (1.0f64, 10.0f64);
    for _ in 0..200 {
        let l = (low + high) / 2.0;
        *(if 100.0 * l * (l * l - 1.0) < 10.0 { &mut low } else { &mut high }) = l;
    }
    assert_close(end(&outcome), low + 2.0 * stretch(200.0, 10.0) - 3.0, 1e-6);
    assert!(outcome.law.as_ref().is_some_and(|law| law.contains("Venant") && law.contains(", ")));
    assert!(refusal(&bar("hex8", [1, 1, 3], &two, EXACT)).contains("fit[0].objective"));
}

fn both_with(young: &str) -> String {
    format!(
        "[[material]]\nwhere = \"z < 1.00001\"\n{young}\npoisson = 0\nlaw = \"neo-hookean\"\n\
         [[material]]\nyoung = 50\npoisson = 0\nlaw = \"neo-hookean\"\n"
    )
}

/// Forces at sampled shapes are those of the law of each region: four times the modulus is four times the constant.
#[test]
fn sampled_fits_take_the_law_of_each_region() {
    let fits = "[[fit]]\nobjective = \"sampled\"\nforce = \"free-rest\"\nshapes = { count = 12, held_out = 4, stretch = 0.2 }\n";
    let both = both_with("young = 200");
    let lawless = both.replace("law = \"neo-hookean\"\n", "");
    let own = fits.to_string() + "law = \"neo-hookean\"\n";
    for text in [bar("hex8", [1, 1, 3], &both, fits), bar("hex8", [1, 1, 3], &lawless, &own)] {
        let outcome = outcome(&text);
        let (mesh, network) = (&outcome.mesh, &outcome.fits[0].network);
        let along = |low: f64, high: f64| {
            let z = |p: usize| mesh.point(p)[2];
            let is_meant = |ends: [usize; 2]| {
                let [a, b] = ends.map(|p| mesh.point(p));
                a[..2] == b[..2] && z(ends[0]).min(z(ends[1])) == low && z(ends[0]).max(z(ends[1])) == high
            };
            let found: Vec<f64> =
                network.lengths.iter().filter(|spring| is_meant(spring.points)).map(|spring| spring.constant).collect();
            assert_eq!(found.len(), 4);
            found[0]
        };
        assert_close(along(0.0, 1.0), 4.0 * along(1.0, 2.0), 1e-9);
        assert_close(along(1.0, 2.0), along(2.0, 3.0), 1e-9);
    }
}

/// E and ν of the network of a body of two materials are those of sampled cells: the table says so, with those of the finite elements of the
/// same cells, which the exact network has. Of a body of one material it says nothing.
#[test]
fn the_material_of_samples_is_told_from_that_of_the_body() {
    let two =
        "[[material]]\nwhere = \"z < 1.00001\"\nyoung = 2e3\npoisson = 0.3\n[[material]]\nyoung = 7e3\npoisson = 0.2\n";
    let found = outcome(&bar("hex8", [1, 1, 3], two, EXACT));
    let record = &Report::of(&found).fits[0].as_material;
    let (young, poisson) = (record.asked_young.unwrap(), record.asked_poisson.unwrap());
    assert!(2e3 < young && young < 7e3);
    assert_close(record.young.unwrap(), young, 1e-9);
    assert_close(record.poisson.unwrap(), poisson, 1e-9);
    let told = format!("not of the body; finite elements have E = {young:.4e} Pa, nu = {poisson:.3} there.");
    assert!(springfit_report::report::tables(&found).contains(&told), "{}", springfit_report::report::tables(&found));
    let one = outcome(&bar("hex8", [1, 1, 3], "[material]\nyoung = 2e3\npoisson = 0.3\n", EXACT));
    assert!(!springfit_report::report::tables(&one).contains("differ from cell to cell"));
    assert_eq!(Report::of(&one).fits[0].as_material.asked_young, Some(2e3));
}
