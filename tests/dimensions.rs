//! Bodies of several dimensions: membranes on solids, rods in them, sheets that meet.

use crate::kit::{holding, ran};
use crate::shapes::bodies::{gmsh_text, grid, mapped};
use nalgebra::{Matrix3, Matrix3x2, Vector3};
use springfit_bodies::model::{finite_elements, lumped_masses};
use springfit_mesh::mesh::{Mesh, Selection};
use springfit_studies::study::{Outcome, Scene, run};
use std::fs;
use std::path::Path;

/// The file of a solid with groups of cells of fewer dimensions.
fn with_parts(mesh: &Mesh, parts: &[(&str, usize, Vec<Vec<usize>>)]) -> String {
    let body = mesh.blocks[0].cells().map(<[usize]>::to_vec).collect();
    let groups: Vec<_> = [("body", 3, body)].into_iter().chain(parts.iter().cloned()).collect();
    gmsh_text(3, &mesh.points, &groups)
}

/// The corners of the outer sides of a solid, with what their points satisfy.
fn sides(mesh: &Mesh, is_meant: impl Fn(&[f64]) -> bool) -> Vec<Vec<usize>> {
    let all = mesh.surface_faces();
    all.into_iter().filter(|face| face.iter().all(|&p| is_meant(mesh.point(p)))).collect()
}

fn scene(folder: &Path, mesh: &str, text: &str) -> Scene {
    fs::write(folder.join("body.msh"), mesh).unwrap();
    Scene::parse(&format!("mesh = {{ file = \"body.msh\" }}\n{text}"), &folder.join("s.toml")).unwrap()
}

fn outcome(scene: &Scene) -> Outcome {
    run(scene, &mut |_| ()).unwrap()
}

/// `½ uᵀ K u` of the finite elements under `u = ε x`.
fn energy(scene: &Scene, strain: &Matrix3<f64>) -> f64 {
    let mesh = scene.build_mesh().unwrap();
    let material = scene.material_of(&mesh).unwrap();
    let d = mesh.dimension;
    let at = |x: &[f64]| strain * Vector3::new(x[0], x[1], x.get(2).copied().unwrap_or(0.0));
    let u: Vec<f64> = mesh.points.chunks_exact(d).flat_map(|x| at(x).as_slice()[..d].to_vec()).collect();
    let entries = finite_elements(&mesh, material.moduli());
    let twice = |row: usize, column: usize| if row == column { 0.5 } else { 1.0 };
    entries.iter().map(|entry| twice(entry.row, entry.col) * entry.val * u[entry.row] * u[entry.col]).sum()
}

fn of_solid(young: f64, poisson: f64, volume: f64, strain: &Matrix3<f64>) -> f64 {
    let (lambda, mu) = (young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)));
    volume * (lambda / 2.0 * strain.trace().powi(2) + mu * strain.norm_squared())
}

/// A triangle in plane stress with these corners, of this thickness.
fn of_membrane(young: f64, poisson: f64, thickness: f64, corners: [Vector3<f64>; 3], strain: &Matrix3<f64>) -> f64 {
    let (a, b) = (corners[1] - corners[0], corners[2] - corners[0]);
    let area = a.cross(&b).norm() / 2.0;
    let s = a.normalize();
    let t = (b - s * s.dot(&b)).normalize();
    let plane = Matrix3x2::from_columns(&[s, t]);
    let own = plane.transpose() * strain * plane;
    let factor = young / (1.0 - poisson * poisson);
    thickness * area * factor / 2.0 * (poisson * own.trace().powi(2) + (1.0 - poisson) * own.norm_squared())
}

fn of_rod(young: f64, area: f64, [a, b]: [Vector3<f64>; 2], strain: &Matrix3<f64>) -> f64 {
    let (length, along) = ((b - a).norm(), (b - a).normalize());
    young * area * length / 2.0 * (along.dot(&(strain * along))).powi(2)
}

fn place(mesh: &Mesh, p: usize) -> Vector3<f64> {
    Vector3::from_column_slice(mesh.point(p))
}

const STRAIN: [f64; 6] = [1.0, -0.3, 0.6, 0.45, -0.7, 0.2];

fn strain() -> Matrix3<f64> {
    let [xx, yy, zz, yz, xz, xy] = STRAIN;
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// The lines along the longest diagonal of a cube through the cells of a mesh of tetrahedra, as far as they are edges.
fn diagonal(mesh: &Mesh, cells: usize) -> Vec<Vec<usize>> {
    let at = |i: usize| {
        let x = i as f64 / cells as f64;
        (0..mesh.point_count()).find(|&p| mesh.point(p).iter().all(|y| (x - y).abs() < 1e-9)).unwrap()
    };
    (0..cells).map(|i| vec![at(i), at(i + 1)]).collect()
}

const PARTS: &str = "[[material]]\nyoung = 1e4\npoisson = 0.3\ndensity = 1000\n\
                     [[material]]\ngroup = \"capsule\"\nyoung = 3e6\npoisson = 0.4\nthickness = \"2 mm\"\ndensity = 1200\n\
                     [[material]]\ngroup = \"tendon\"\nyoung = 1e9\npoisson = 0.3\narea = \"3 mm^2\"\ndensity = 1500\n";

/// A cube of tetrahedra with a capsule on two of its sides and a tendon along its diagonal, under an affine displacement: the energy and the mass
/// are the sums of those of solid, membrane and rod in closed form, on the mesh and with its cells halved and quadratic.
#[test]
fn parts_of_several_dimensions_add_their_energies() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = grid("tet4", &[1.0, 1.0, 1.0], &[3, 3, 3]);
    let capsule =
        sides(&mesh, |x| x[2] > 1.0 - 1e-9).into_iter().chain(sides(&mesh, |x| x[0] < 1e-9)).collect::<Vec<_>>();
    let tendon = diagonal(&mesh, 3);
    let text = with_parts(&mesh, &[("capsule", 2, capsule.clone()), ("tendon", 1, tendon.clone())]);
    let fit = "fit = [{ objective = \"exact\" }]\n";
    let scene = scene(folder.path(), &text, &format!("{fit}{PARTS}"));
    let strain = strain();
    let corners = |face: &Vec<usize>| [0, 1, 2].map(|i| place(&mesh, face[i]));
    let ends = |line: &Vec<usize>| [0, 1].map(|i| place(&mesh, line[i]));
    let expected = of_solid(1e4, 0.3, 1.0, &strain)
        + capsule.iter().map(|face| of_membrane(3e6, 0.4, 2e-3, corners(face), &strain)).sum::<f64>()
        + tendon.iter().map(|line| of_rod(1e9, 3e-6, ends(line), &strain)).sum::<f64>();
    let found = energy(&scene, &strain);
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    assert!((found / of_solid(1e4, 0.3, 1.0, &strain) - 1.0).abs() > 0.2);

    let read = scene.build_mesh().unwrap();
    assert!(read.is_mixed() && read.cell_dimension() == 3 && read.blocks.len() == 3);
    assert!(read.annotations.left_out.is_empty(), "{:?}", read.annotations);
    assert_eq!(Selection::Everything.sides(&read).unwrap().len(), 6 * 3 * 3 * 2);
    assert_eq!(read.groups["capsule"].sides.len(), capsule.len());
    let material = scene.material_of(&read).unwrap();
    let masses = lumped_masses(&read, material.densities(), material.thicknesses(), Default::default());
    let mass = 1000.0 + 1200.0 * 2e-3 * 2.0 + 1500.0 * 3e-6 * 3f64.sqrt();
    assert!((masses.iter().sum::<f64>() / mass - 1.0).abs() < 1e-12);

    for finer in [read.refined().unwrap(), read.elevated().unwrap()] {
        let material = scene.material_of(&finer).unwrap();
        let u: Vec<f64> = finer
            .points
            .chunks_exact(3)
            .flat_map(|x| (strain * Vector3::from_column_slice(x)).as_slice().to_vec())
            .collect();
        let entries = finite_elements(&finer, material.moduli());
        let twice = |row: usize, column: usize| if row == column { 0.5 } else { 1.0 };
        let found: f64 =
            entries.iter().map(|entry| twice(entry.row, entry.col) * entry.val * u[entry.row] * u[entry.col]).sum();
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}

/// The exact network of such a body is its finite elements, also where the springs of the solid are on edges and patches; fits of single cells do
/// not take from one part to give to the other.
#[test]
fn the_exact_network_has_all_parts() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = grid("tet4", &[1.0, 1.0, 1.0], &[3, 3, 3]);
    let capsule = sides(&mesh, |x| x[2] > 1.0 - 1e-9);
    let text = with_parts(&mesh, &[("capsule", 2, capsule), ("tendon", 1, diagonal(&mesh, 3))]);
    let all = format!(
        "fit = [{{ objective = \"exact\" }}, {{ objective = \"exact\", shear = \"edges\", volume = \"patches\" }}, {{ objective = \"modal\" }}]\n\
         output = {{ frequencies = 3 }}\n{PARTS}[[fix]]\nwhere = \"x < 1e-9\"\n\
         [[load]]\nname = \"pull\"\nwhere = \"x > 0.999\"\ntraction = [100, 0, 30]\n\
         [[load]]\nname = \"press\"\ngroup = \"capsule\"\npressure = \"1 kPa\"\n[[load]]\nname = \"hang\"\ngravity = [0, 0, -9.81]\n"
    );
    let outcome = outcome(&scene(folder.path(), &text, &all));
    for load in &outcome.fits[0].loads {
        let error = load.error.unwrap();
        assert!(error.max < 1e-8, "{}: {error:?}", load.name);
        assert!(load.work_error.unwrap().abs() < 1e-8);
    }
    let errors = outcome.fits[0].errors.get().unwrap();
    assert!(errors.frobenius.unwrap().max < 1e-12);
    // Each part has its weight.
    let weight: f64 = outcome.loads[2].forces.iter().skip(2).step_by(3).sum();
    let mass = 1000.0 + 1200.0 * 2e-3 + 1500.0 * 3e-6 * 3f64.sqrt();
    assert!((weight / (-9.81 * mass) - 1.0).abs() < 1e-12, "{weight}");
    assert!(outcome.fits.iter().all(|fit| fit.stability.is_some()));
    let frequencies = &outcome.frequencies;
    assert_eq!(frequencies.len(), 4);
    // What attaches stiffens: without it the body moves further.
    let alone = all
        .replace(
            "[[material]]\ngroup = \"capsule\"\nyoung = 3e6\npoisson = 0.4\nthickness = \"2 mm\"\ndensity = 1200\n",
            "",
        )
        .replace(
            "[[material]]\ngroup = \"tendon\"\nyoung = 1e9\npoisson = 0.3\narea = \"3 mm^2\"\ndensity = 1500\n",
            "",
        );
    let bare = self::outcome(&scene(folder.path(), &text, &alone));
    assert!(!bare.mesh.is_mixed());
    for (own, other) in outcome.loads.iter().zip(&bare.loads) {
        assert!(
            own.largest_displacement(&outcome.mesh) < 0.97 * other.largest_displacement(&bare.mesh),
            "{}",
            own.name
        );
    }
    // Smoothed springs are softer than linear cells by some percent, and fits to single tetrahedra miss much: with exact membranes and rods no more.
    for (fit, other) in outcome.fits.iter().zip(&bare.fits) {
        for (own, other) in fit.loads.iter().zip(&other.loads) {
            let [own, other] = [own, other].map(|load| load.error.unwrap().rms);
            assert!(own < 1.3 * other + 1e-6, "{}: {own} {other}", fit.fit.name);
        }
    }
}

/// A bar without contraction, held across, with a skin all around and a tendon along it: its pull and its lowest axial frequency are those of the
/// sum of the stiffnesses and of the masses, `f = √(Σ E A/Σ ρ A)/(4 L)`. Sound is as fast in each part, so that sections stay plane.
#[test]
fn a_bar_with_a_skin_and_a_tendon_is_a_composite_bar() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["hex8", "tet4"] {
        let n = 16;
        let mesh = grid(name, &[4.0, 1.0, 1.0], &[n, 2, 2]);
        let skin = sides(&mesh, |x| {
            let on = |v: f64| v.abs() < 1e-9 || (v - 1.0).abs() < 1e-9;
            on(x[1]) || on(x[2])
        });
        // A side at an end of the bar may have all its points on edges of it.
        let is_along = |face: &Vec<usize>| face.iter().any(|&p| mesh.point(p)[0] != mesh.point(face[0])[0]);
        let skin: Vec<Vec<usize>> = skin.into_iter().filter(is_along).collect();
        let middle = |i: usize| {
            let x = [4.0 * i as f64 / n as f64, 0.5, 0.5];
            (0..mesh.point_count()).find(|&p| mesh.point(p).iter().zip(x).all(|(a, b)| (a - b).abs() < 1e-9)).unwrap()
        };
        let tendon: Vec<Vec<usize>> = (0..n).map(|i| vec![middle(i), middle(i + 1)]).collect();
        let text = with_parts(&mesh, &[("skin", 2, skin), ("tendon", 1, tendon)]);
        let scene = scene(
            folder.path(),
            &text,
            "fit = [{ objective = \"exact\" }]\noutput = { frequencies = 1 }\n\
             [[material]]\nyoung = 1e4\npoisson = 0\ndensity = 1000\n\
             [[material]]\ngroup = \"skin\"\nyoung = 1e6\npoisson = 0\nthickness = 0.002\ndensity = 1e5\n\
             [[material]]\ngroup = \"tendon\"\nyoung = 1e9\npoisson = 0.3\narea = 4e-6\ndensity = 1e8\n\
             [[fix]]\nwhere = \"x < 1e-9\"\naxes = [\"x\"]\n[[fix]]\nwhere = \"x > -1\"\naxes = [\"y\", \"z\"]\n\
             [[load]]\nname = \"pull\"\nwhere = \"x > 3.999\"\ndisplacement = [0.01, \"free\", \"free\"]\n",
        );
        let outcome = outcome(&scene);
        let stiffness: f64 = 1e4 + 1e6 * 0.002 * 4.0 + 1e9 * 4e-6;
        let mass = 1000.0 + 1e5 * 0.002 * 4.0 + 1e8 * 4e-6;
        let worst = outcome.loads[0].fem.chunks_exact(3).zip(outcome.mesh.points.chunks_exact(3));
        let worst = worst.map(|(u, x)| (u[0] - 0.01 * x[0] / 4.0).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-12, "{name}: {worst:e}");
        assert!(outcome.fits[0].loads[0].error.unwrap().max < 1e-9);
        let expected = (stiffness / mass).sqrt() / 16.0;
        for model in &outcome.frequencies {
            let found = model.frequencies.as_ref().unwrap()[0];
            // Masses are lumped on 16 cells along, which errs by (π/32)²/24 of the frequency.
            assert!((found / expected - 1.0).abs() < 5e-4, "{name}: {found} {expected}");
        }
    }
}

/// A ball with a curved capsule under a pressure: halved cells, quadratic elements and both come nearer to one answer.
#[test]
fn a_curved_capsule_converges() {
    let folder = tempfile::tempdir().unwrap();
    let n = 4;
    // A ball, from a cube whose shells become spheres.
    let mesh = mapped(grid("tet4", &[2.0, 2.0, 2.0], &[n, n, n]), |x| {
        let from = [x[0] - 1.0, x[1] - 1.0, x[2] - 1.0];
        let largest = from.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let length = from.iter().map(|x| x * x).sum::<f64>().sqrt();
        from.iter().map(|x| if length > 0.0 { x * largest / length } else { 0.0 }).collect()
    });
    let capsule = sides(&mesh, |_| true);
    assert_eq!(capsule.len(), 12 * n * n);
    let text = with_parts(&mesh, &[("capsule", 2, capsule)]);
    let error = |reference: &str| {
        let scene = scene(
            folder.path(),
            &text,
            &format!(
                "fit = [{{ objective = \"exact\" }}]\nreference = {{ {reference} }}\n[[material]]\nyoung = 1e4\npoisson = 0.3\n\
                 [[material]]\ngroup = \"capsule\"\nyoung = 1e6\npoisson = 0.4\nthickness = 0.01\n[[fix]]\nwhere = \"x < -0.6\"\n\
                 [[load]]\nname = \"press\"\nwhere = \"x > -0.1 && x^2 + y^2 + z^2 > 0.9\"\npressure = 100\n"
            ),
        );
        let outcome = outcome(&scene);
        assert!(outcome.mesh.is_mixed());
        outcome.fits[0].loads[0].error.unwrap().rms
    };
    let [cells, halved, quadratic, best] =
        ["from = \"cells\"", "refine = 1", "from = \"quadratic\"", "from = \"quadratic\"\nrefine = 1"]
            .map(|reference| error(&reference.replace('\n', ", ")));
    assert!(cells < 1e-8, "{cells}");
    // Each is softer than the one before it, whose displacements it can have, and the last two differ least.
    assert!(halved > 1.0 && quadratic > halved && best > quadratic, "{halved} {quadratic} {best}");
    assert!(best - quadratic < 0.3 * quadratic, "{quadratic} {best}");
}

/// Bars along the edges of a plane body in plane strain, of triangles and of quadrilaterals: the energy in closed form, and the exact network.
#[test]
fn bars_are_part_of_a_plane_body() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["tri3", "quad4"] {
        let mesh = grid(name, &[2.0, 1.0], &[4, 2]);
        let at = |x: f64, y: f64| {
            (0..mesh.point_count())
                .find(|&p| (mesh.point(p)[0] - x).abs() + (mesh.point(p)[1] - y).abs() < 1e-9)
                .unwrap()
        };
        let bars: Vec<Vec<usize>> =
            (0..4).map(|i| vec![at(0.5 * i as f64, 0.5), at(0.5 * (i + 1) as f64, 0.5)]).collect();
        let body: Vec<Vec<usize>> = mesh.blocks[0].cells().map(<[usize]>::to_vec).collect();
        let text = gmsh_text(2, &mesh.points, &[("body", 2, body), ("bars", 1, bars)]);
        let scene = scene(
            folder.path(),
            &text,
            "fit = [{ objective = \"exact\" }]\n[[material]]\nyoung = 1e4\npoisson = 0.3\nplane = \"strain\"\nthickness = 0.5\n\
             [[material]]\ngroup = \"bars\"\nyoung = 1e7\npoisson = 0.2\nplane = \"strain\"\narea = 1e-3\n[[fix]]\nwhere = \"x < 1e-9\"\n\
             [[load]]\nname = \"pull\"\nwhere = \"x > 1.999\"\ntraction = [100, 20]\n",
        );
        let strain = Matrix3::new(0.7, 0.2, 0.0, 0.2, -0.4, 0.0, 0.0, 0.0, 0.0);
        let expected = of_solid(1e4, 0.3, 2.0 * 0.5, &strain) + 1e7 * 1e-3 * 2.0 / 2.0 * 0.7 * 0.7;
        let found = energy(&scene, &strain);
        assert!((found / expected - 1.0).abs() < 1e-12, "{name}: {found} {expected}");
        let outcome = outcome(&scene);
        assert!(outcome.mesh.is_mixed() && outcome.assumed.is_none(), "{:?}", outcome.assumed);
        assert!(outcome.fits[0].loads[0].error.unwrap().max < 1e-8, "{name}");
    }
}

/// Three sheets that meet at a T, each of another material: the energy in closed form, and the exact network.
#[test]
fn sheets_meet_at_a_t_joint() {
    let folder = tempfile::tempdir().unwrap();
    let plate = grid("tri3", &[1.0, 1.0], &[3, 3]);
    // Left, right and up from the line x = 0, z = 0.
    let spots = [[-1.0, 0.0], [1.0, 0.1], [0.2, 1.0]];
    let (mut points, mut groups): (Vec<Vec<f64>>, Vec<Vec<Vec<usize>>>) = (Vec::new(), Vec::new());
    for [along, up] in spots {
        let mut cells = Vec::new();
        for nodes in plate.blocks[0].cells() {
            let place = |x: Vec<f64>, points: &mut Vec<Vec<f64>>| {
                points.iter().position(|y| x.iter().zip(y).all(|(a, b)| (a - b).abs() < 1e-9)).unwrap_or_else(|| {
                    points.push(x);
                    points.len() - 1
                })
            };
            cells.push(
                nodes
                    .iter()
                    .map(|&p| {
                        place(vec![along * plate.point(p)[0], plate.point(p)[1], up * plate.point(p)[0]], &mut points)
                    })
                    .collect(),
            );
        }
        groups.push(cells);
    }
    let whole = Mesh::of_cells(3, points.concat(), Vec::new());
    let names = ["left", "right", "up"];
    let parts: Vec<_> = names.into_iter().zip(&groups).map(|(name, cells)| (name, 2, cells.clone())).collect();
    let text = gmsh_text(3, &whole.points, &parts);
    let numbers = [("left", 1e4, 0.3, 0.01), ("right", 3e4, 0.1, 0.02), ("up", 1e5, 0.45, 0.005)];
    let materials: String = numbers
        .iter()
        .map(|(group, young, poisson, thickness)| {
            format!(
                "[[material]]\ngroup = \"{group}\"\nyoung = {young:e}\npoisson = {poisson}\nthickness = {thickness}\n"
            )
        })
        .collect();
    let scene = scene(folder.path(), &text, &format!("fit = [{{ objective = \"exact\" }}]\n{materials}"));
    let strain = strain();
    let of = |(cells, (_, young, poisson, thickness)): (&Vec<Vec<usize>>, &(&str, f64, f64, f64))| -> f64 {
        let corners = |cell: &Vec<usize>| [0, 1, 2].map(|i| place(&whole, cell[i]));
        cells.iter().map(|cell| of_membrane(*young, *poisson, *thickness, corners(cell), &strain)).sum()
    };
    let expected: f64 = groups.iter().zip(&numbers).map(of).sum();
    let found = energy(&scene, &strain);
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    let outcome = outcome(&scene);
    assert!(outcome.fits[0].errors.get().unwrap().frobenius.unwrap().max < 1e-12);
}

/// At large deformation the exact network of the law is the finite elements, with a capsule and a tendon as well.
#[test]
fn large_deformation_has_all_parts() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = grid("tet4", &[1.0, 1.0, 1.0], &[2, 2, 2]);
    let parts = [("capsule", 2, sides(&mesh, |x| x[2] > 1.0 - 1e-9)), ("tendon", 1, diagonal(&mesh, 2))];
    let text = with_parts(&mesh, &parts);
    let law = "law = \"stable-neo-hookean\"\n";
    let all = format!(
        "fit = [{{ objective = \"exact\" }}]\n[[material]]\nyoung = 1e4\npoisson = 0.3\n{law}\
         [[material]]\ngroup = \"capsule\"\nyoung = 1e6\npoisson = 0.4\nthickness = \"2 mm\"\n{law}\
         [[material]]\ngroup = \"tendon\"\nyoung = 1e9\npoisson = 0.3\narea = \"3 mm^2\"\n{law}"
    );
    let loads = "[[fix]]\nwhere = \"x < 1e-9\"\n[[load]]\nname = \"pull\"\nwhere = \"x > 0.999\"\ntraction = [3000, 0, 500]\n\
                 [[load]]\nname = \"press\"\ngroup = \"capsule\"\npressure = \"1 kPa\"\n";
    let outcome = outcome(&scene(folder.path(), &text, &format!("newton = {{ steps = 4 }}\n{all}{loads}")));
    for (body, load) in outcome.loads.iter().zip(&outcome.fits[0].loads) {
        assert!(body.is_reached() && body.largest_displacement(&outcome.mesh) > 0.02, "{}", body.name);
        let error = load.error.unwrap();
        assert!(error.max < 1e-5, "{}: {error:?}", body.name);
    }
}

/// Sides of a generated box are membranes or rods where a material names their group, with each shipped element that fills one: the energy is that of
/// body and side in closed form.
#[test]
fn sides_of_a_box_carry_membranes() {
    let mut tested = 0;
    for element in crate::shapes::elements().iter().filter(|element| element.dimension() > 1) {
        let d = element.dimension();
        let (size, cells) = (vec!["1"; d].join(", "), vec!["2"; d].join(", "));
        let skin = if d == 3 { "thickness = 0.002" } else { "area = 0.002" };
        let text = format!(
            "mesh = {{ box = {{ element = \"{}\", size = [{size}], cells = [{cells}] }} }}\nfit = [{{ objective = \"frobenius\" }}]\n\
             [[material]]\nyoung = 1e4\npoisson = 0.3\n[[material]]\ngroup = \"ymax\"\nyoung = 1e6\npoisson = 0.2\n{skin}\n",
            element.name
        );
        let scene = Scene::parse(&text, Path::new("s.toml")).unwrap();
        let Ok(mesh) = scene.build_mesh() else { continue };
        assert!(mesh.is_mixed(), "{}", element.name);
        let strain = strain();
        let found = energy(&scene, &strain);
        let expected = match d {
            3 => {
                let corners = [[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1.0]].map(Vector3::from);
                of_solid(1e4, 0.3, 1.0, &strain) + 2.0 * of_membrane(1e6, 0.2, 0.002, corners, &strain)
            }
            _ => {
                let [xx, yy, xy] = [strain[(0, 0)], strain[(1, 1)], strain[(0, 1)]];
                let plane =
                    1e4 / (1.0 - 0.09) / 2.0 * (0.3 * (xx + yy).powi(2) + 0.7 * (xx * xx + yy * yy + 2.0 * xy * xy));
                plane + 1e6 * 0.002 / 2.0 * xx * xx
            }
        };
        assert!((found / expected - 1.0).abs() < 1e-11, "{}: {found} {expected}", element.name);
        tested += 1;
    }
    assert!(tested >= 12, "{tested}");
}

/// The first scene of a deck with a skin says what the deck states of it, and the scene with it as a material has it in its body.
#[test]
fn a_new_scene_names_what_is_beside_the_body() {
    let deck = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n*ELEMENT, TYPE=C3D8, ELSET=BODY\n1, 1,2,3,4,5,6,7,8\n\
                *ELEMENT, TYPE=M3D4, ELSET=SKIN\n2, 5,6,7,8\n*MATERIAL, NAME=A\n*ELASTIC\n2e3, 0.3\n*MATERIAL, NAME=B\n*ELASTIC\n5e5, 0.4\n\
                *SOLID SECTION, ELSET=BODY, MATERIAL=A\n*MEMBRANE SECTION, ELSET=SKIN, MATERIAL=B\n0.002\n";
    let folder = holding("d.inp", deck);
    let (code, said) = ran(folder.path(), &["new", "d.inp", "--output", "d.toml"]);
    assert_eq!(code, Some(0), "{said}");
    let scene = fs::read_to_string(folder.path().join("d.toml")).unwrap();
    let line = "# Not in the body until a [[material]] names it: group = \"SKIN\", young = 500000, poisson = 0.4, thickness = 0.002\n";
    assert!(scene.contains(line), "{scene}");
    let keys = line.trim_start_matches("# Not in the body until a [[material]] names it: ").replace(", ", "\n");
    let scene = scene.replace("[material]\n", &format!("[[material]]\n{keys}[[material]]\n"));
    fs::write(folder.path().join("d.toml"), scene).unwrap();
    let (code, said) = ran(folder.path(), &["run", "d.toml"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("1 hex8, 1 quad4"), "{said}");
    assert!(said.contains("the group \"SKIN\" is part of the body as membranes, without bending stiffness"), "{said}");
}

/// What is missing or not known is one line that says so.
#[test]
fn wrong_parts_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = grid("tet4", &[1.0, 1.0, 1.0], &[2, 2, 2]);
    let text = with_parts(&mesh, &[("capsule", 2, sides(&mesh, |x| x[2] > 0.999)), ("tendon", 1, diagonal(&mesh, 2))]);
    let fit = "fit = [{ objective = \"exact\" }]\n[[fix]]\nwhere = \"z < 1e-9\"\n[[load]]\nwhere = \"z > 0.999\"\ntraction = [0, 0, 1]\n";
    let solid = "[[material]]\nyoung = 1e4\npoisson = 0.3\n";
    let part = |group: &str, rest: &str| {
        format!("{fit}{solid}[[material]]\ngroup = \"{group}\"\nyoung = 1e6\npoisson = 0.3\n{rest}")
    };
    let fit_of = |text: String, keys: &str| text.replace("objective = \"exact\"", keys);
    for (text_of_scene, wanted) in [
        (part("capsule", ""), "material[1].thickness: expected that of the membrane"),
        (part("tendon", ""), "material[1].area: expected the cross-section of the rods"),
        (part("nothing", "thickness = 0.1\n"), "material[1].group"),
        (
            part("capsule", "thickness = 0.1\nlaw = \"fibre\"\n")
                .replace("poisson = 0.3\n[[material]]", "poisson = 0.3\nlaw = \"fibre\"\n[[material]]"),
            "a law without fibres on surfaces and curves in space",
        ),
        (
            fit_of(part("tendon", "area = 1e-4\n"), "objective = \"exact\", nonnegative = true"),
            "a body of cells of one dimension",
        ),
    ] {
        let error = run(&scene(folder.path(), &text, &text_of_scene), &mut |_| ()).unwrap_err().to_string();
        assert!(error.contains(wanted) && !error.contains('\n'), "{wanted}: {error}");
    }
}
