//! Which sides, cells or points a total force is shared over, and that sides which no cell has are no part of a load.

use crate::kit::outcome;
use crate::shapes::bodies;
use springfit_bodies::model::{Action, nodal_forces};
use springfit_foundation::symbolic::Scope;
use springfit_mesh::mesh::{Gate, Group, ListedSides, Mesh, Selection, gmsh};
use springfit_studies::study::{Scene, run};

fn grid(element: &str, cells: &[usize]) -> Mesh {
    bodies::grid(element, &cells.iter().map(|&n| n as f64).collect::<Vec<_>>(), cells)
}

fn at(condition: &str) -> Selection {
    Selection::Where(Scope::new(&["x", "y", "z"]).predicate(condition).unwrap())
}

/// The mesh with the points of a part as a set that lists nothing else.
fn with_set(mut mesh: Mesh, part: &Selection) -> Mesh {
    let points = part.points(&mesh).unwrap();
    mesh.groups.insert("set".into(), Group { points, ..Group::default() });
    mesh
}

fn named(name: &str) -> Selection {
    Selection::Group(name.into())
}

/// The shares of a force of 1 N along x.
fn shares(mesh: &Mesh, part: &Selection) -> Vec<f64> {
    let mut force = vec![0.0; mesh.dimension];
    force[0] = 1.0;
    along_x(mesh, part, &Action::Force(force))
}

fn along_x(mesh: &Mesh, part: &Selection, action: &Action) -> Vec<f64> {
    nodal_forces(mesh, part, action, 1.0).unwrap().into_iter().step_by(mesh.dimension).collect()
}

fn body(mesh: &Mesh, part: &Selection, size: f64) -> Vec<f64> {
    let load: Vec<f64> = (0..mesh.dimension).map(|k| if k == 0 { size } else { 0.0 }).collect();
    along_x(mesh, part, &Action::body(&load))
}

/// Sums of a few dozen numbers of at most 1.
fn assert_same(found: &[f64], expected: &[f64], what: &str) {
    let worst = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(found.len() == expected.len() && worst < 1e-14, "{what}: {worst:e}");
}

/// The area of `x > 0.9` is three columns of four cells, and 12 m².
#[test]
fn a_force_on_an_area_of_a_plane_mesh_is_that_of_its_cells() {
    for element in ["quad4", "tri3", "tri6", "quad9"] {
        let mesh = grid(element, &[4, 4]);
        for (part, area) in [(at("x > 0.9"), 12.0), (named("body"), 16.0), (Selection::Everything, 16.0)] {
            assert_same(&shares(&mesh, &part), &body(&mesh, &part, 1.0 / area), &format!("{element} {part:?}"));
        }
        let mesh = with_set(mesh, &at("x > 0.9"));
        assert_same(&shares(&mesh, &named("set")), &shares(&mesh, &at("x > 0.9")), element);
    }
}

/// Of four columns of triangles those at two corners of the square have all three nodes on its edges.
#[test]
fn a_force_on_the_outline_of_a_plane_mesh_is_that_of_its_sides() {
    let mut mesh = grid("tri3", &[4, 4]);
    let edge = "x < 1e-9 || x > 4 - 1e-9 || y < 1e-9 || y > 4 - 1e-9";
    let all = ["xmin", "xmax", "ymin", "ymax"].iter().flat_map(|name| mesh.groups[*name].sides.clone()).collect();
    let points = at(edge).points(&mesh).unwrap();
    mesh.groups.insert("outline".into(), Group { points, sides: all, ..Group::default() });
    assert_same(&shares(&mesh, &at(edge)), &shares(&mesh, &named("outline")), "where");
    let mesh = with_set(mesh, &at(edge));
    assert_same(&shares(&mesh, &named("set")), &shares(&mesh, &named("outline")), "set");
    assert_same(&shares(&mesh, &at("x < 1e-9")), &shares(&mesh, &named("xmin")), "one edge");
}

/// A slab of whole cells of a solid has its outer sides, an inner part its cells.
#[test]
fn a_force_on_a_part_of_a_solid_is_that_of_its_outer_sides_or_else_of_its_cells() {
    for element in ["hex8", "tet4", "tet10", "hex20"] {
        let mesh = grid(element, &[4, 4, 4]);
        let mesh = with_set(mesh, &at("z > 4 - 1e-9"));
        assert_same(&shares(&mesh, &at("z > 4 - 1e-9")), &shares(&mesh, &named("zmax")), element);
        assert_same(&shares(&mesh, &named("set")), &shares(&mesh, &named("zmax")), element);
        let slab = at("z > 2.9");
        let inside: f64 =
            shares(&mesh, &slab).iter().enumerate().filter(|(p, _)| is_inner(&mesh, *p)).map(|(_, f)| f).sum();
        assert_eq!(inside, 0.0, "{element}");
        let inner = at("x > 0.9 && x < 3.1 && y > 0.9 && y < 3.1 && z > 0.9 && z < 3.1");
        assert_same(&shares(&mesh, &inner), &body(&mesh, &inner, 1.0 / 8.0), element);
        let cells = with_set(mesh, &inner);
        assert_same(&shares(&cells, &named("set")), &shares(&cells, &inner), element);
        assert_same(&shares(&cells, &named("body")), &body(&cells, &named("body"), 1.0 / 64.0), element);
    }
}

fn is_inner(mesh: &Mesh, point: usize) -> bool {
    mesh.point(point).iter().all(|x| *x > 1e-9 && *x < 4.0 - 1e-9)
}

/// A point beside a face would have no part of a force on the face alone.
#[test]
fn a_set_with_points_beside_its_sides_shares_a_force_equally() {
    let mesh = with_set(grid("hex8", &[2, 2, 2]), &at("z > 2 - 1e-9 || x^2 + y^2 + z^2 < 1e-9"));
    let expected: Vec<f64> =
        (0..mesh.point_count()).map(|p| if mesh.groups["set"].points.contains(&p) { 0.1 } else { 0.0 }).collect();
    assert_same(&shares(&mesh, &named("set")), &expected, "set");
}

/// The thickness weighs the sides of both alike: a tapered strip.
#[test]
fn a_force_of_a_motion_is_shared_as_that_of_a_load() {
    let outcome = outcome(
        r#"
[mesh]
box = { element = "quad4", size = [4, 1], cells = [4, 1] }
scale = "cm"
[material]
young = "10 kPa"
poisson = 0.3
density = "1 g/cm^3"
thickness = "1e-3*(1 + 100*x)"
[[fit]]
objective = "exact"
[[fix]]
group = "xmin"
[[load]]
group = "ymax"
force = [0, 1]
[motion]
duration = "1 ms"
step = "1 ms"
finite_elements = false
[[motion.force]]
group = "ymax"
force = [0, "1"]
"#,
    );
    let force = &outcome.motion.as_ref().unwrap().forces[0];
    let mut found = vec![0.0; outcome.mesh.point_count()];
    force.shares.iter().for_each(|&(point, share)| found[point] = share);
    let expected: Vec<f64> = outcome.loads[0].forces.iter().skip(1).step_by(2).copied().collect();
    assert_same(&found, &expected, "motion");
    // The middles of the sides are at 0.5, 1.5, 2.5 and 3.5 cm, the thicknesses there as 1.5 : 2.5 : 3.5 : 4.5 of 12 in all.
    let mut listed: Vec<f64> = found.into_iter().filter(|share| *share != 0.0).collect();
    listed.sort_by(f64::total_cmp);
    assert_same(&listed, &[1.5, 4.0, 4.5, 6.0, 8.0].map(|share| share / 24.0), "shares");
}

/// A skin of two triangles on the one hexahedron and of a quadrangle on the other.
#[test]
fn a_load_on_sides_that_no_cell_has_is_an_error() {
    let mut mesh = grid("hex8", &[2, 1, 1]);
    let corner = |x: f64, y: f64| (0..mesh.point_count()).find(|&p| mesh.point(p) == [x, y, 1.0]).unwrap();
    let [a, b, c, d] = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
    let [e, f] = [corner(2.0, 0.0), corner(2.0, 1.0)];
    let mut sides = vec![vec![a, b, c], vec![a, c, d], vec![b, e, f, c]];
    sides.iter_mut().for_each(|side| side.sort_unstable());
    let first = sides.iter().min().unwrap().iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
    let points = at("z > 1 - 1e-9").points(&mesh).unwrap();
    mesh.groups.insert("skin".into(), Group { points, sides, ..Group::default() });
    assert_eq!(ListedSides::of(&mesh, &mesh.groups["skin"]).sides.len(), 1);
    for action in [Action::traction(&[0.0, 0.0, 1.0]), Action::Force(vec![0.0, 0.0, 1.0])] {
        let found = nodal_forces(&mesh, &named("skin"), &action, 1.0).unwrap_err().to_string();
        let expected = format!("in group \"skin\", found 2 of 3 that no cell has, the first with the points {first}");
        assert!(found.ends_with(&expected), "{found}");
    }
    let expected = 2.0;
    let found: f64 = along_x(&mesh, &named("zmax"), &Action::traction(&[1.0, 0.0, 0.0])).iter().sum();
    assert!((found - expected).abs() < 1e-14, "{found}");
}

/// The second tetrahedron is flat, and its face the second of the group.
#[test]
fn sides_of_cells_that_are_left_out_go_with_them() {
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 0\n$EndNodes\n\
                $Elements\n4\n1 4 2 1 1 1 2 3 4\n2 4 2 1 1 1 2 5 3\n3 2 2 9 1 1 2 3\n4 2 2 9 1 2 5 3\n$EndElements\n";
    let gate = Gate::named(Some("skip"), None).unwrap();
    let mesh = Mesh::resolve_within(&gmsh::parse(text.as_bytes()).unwrap(), &[], 1.0, Some(gate)).unwrap();
    assert_eq!(mesh.quality.skipped, 1);
    let (name, _) = mesh.groups.iter().find(|(_, group)| !group.sides.is_empty()).unwrap();
    let found: f64 = along_x(&mesh, &named(name), &Action::traction(&[1.0, 0.0, 0.0])).iter().sum();
    assert!((found - 0.5).abs() < 1e-15, "{found}");
}

/// The sides of a surface in space are its outline.
#[test]
fn a_traction_on_a_sheet_in_space_is_said_to_act_on_its_outline() {
    let scene = |load: &str| {
        let text = format!(
            "[mesh]\ndisc = {{ element = \"tri3\", radius = 1, rings = 3, height = 0.2 }}\n[material]\nyoung = 1e4\npoisson = 0.3\n\
             thickness = 0.01\n[[fit]]\nobjective = \"exact\"\n[[fix]]\nwhere = \"x < 0.1\"\n[[fix]]\nwhere = \"x > -2\"\naxes = [\"z\"]\n\
             [[load]]\nname = \"pull\"\nwhere = \"x > 0.1\"\n{load}\n"
        );
        let scene = Scene::parse(&text, std::path::Path::new("scene.toml")).unwrap();
        springfit_report::report::notes(&springfit_studies::study::run(&scene, &mut |_| {}).unwrap())
    };
    let is_told = |notes: &[String]| notes.iter().any(|note| note.contains("traction pull acts on the outline"));
    assert!(is_told(&scene("traction = [1, 0, 0]")));
    assert!(!is_told(&scene("body = [1, 0, 0]")));
}

/// `u = A x` on the whole boundary, a rotation beside a stretch, is met by `u = A x` within (patch test). The tolerance, 1e-9 of the largest
/// displacement, is that of the solver.
#[test]
fn a_displacement_that_is_linear_in_the_position_is_linear_within() {
    let a = [[0.01, -0.1, 0.0], [0.1, 0.02, 0.03], [-0.02, 0.0, -0.01]];
    for (element, size) in [("tet4", [3.0, 2.0, 1.0]), ("hex8", [3.0, 2.0, 1.0]), ("tet10", [1.0, 1.0, 2.0])] {
        let outcome = outcome(&format!(
            r#"
[mesh]
box = {{ element = "{element}", size = {size:?}, cells = [3, 4, 3] }}
[material]
young = "10 kPa"
poisson = 0.3
[[fit]]
objective = "exact"
[[load]]
where = "x*({0} - x)*y*({1} - y)*z*({2} - z) < 1e-9"
displacement = ["0.01*x - 0.1*y", "0.1*x + 0.02*y + 0.03*z", "-0.02*x - 0.01*z"]
"#,
            size[0], size[1], size[2]
        ));
        let (mesh, load) = (&outcome.mesh, &outcome.loads[0]);
        let mut inner = 0;
        for (p, u) in load.fem.chunks_exact(3).enumerate() {
            inner += usize::from(!load.support.is_fixed(3 * p));
            for (u, row) in u.iter().zip(a) {
                let expected: f64 = row.iter().zip(mesh.point(p)).map(|(a, x)| a * x).sum();
                assert!((u - expected).abs() < 1e-9 * 0.3, "{element}, point {p}: {u} {expected}");
            }
        }
        assert!(inner >= 2 * 3 * 2, "{inner}");
    }
}

/// A note names the share of a force that acts on held points, and a measured displacement that differs from the one that the support prescribes.
#[test]
fn what_a_support_takes_from_a_load_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let notes = |load: &str| {
        let text = format!(
            "mesh = {{ box = {{ element = \"hex8\", size = [0.3, 0.1, 0.1], cells = [6, 2, 2] }} }}\nmaterial = {{ young = 1e4, poisson = 0.3 }}\n\
             fit = [{{ objective = \"exact\" }}]\nfix = [{{ where = \"x < 0.16\" }}]\nload = [{{ name = \"push\", {load} }}]\n"
        );
        let scene = Scene::parse(&text, &folder.path().join("s.toml")).unwrap();
        run(&scene, &mut |_| {}).unwrap().of_loads
    };
    // Half of the upper side, and the line of points between the halves.
    let found = notes("where = \"z > 0.0999\", traction = [0, 0, -1]");
    assert!(found.len() == 1 && found[0].contains("58 % of the force of push acts on held points"), "{found:?}");
    assert!(notes("group = \"xmax\", traction = [0, 0, -1]").is_empty());
    let table = |u: f64| {
        std::fs::write(folder.path().join("u.csv"), format!("point,ux,uy,uz\n0,{u:?},0,0\n62,0.01,0,0\n")).unwrap()
    };
    let measured = "group = \"xmax\", traction = [1, 0, 0], measured = { file = \"u.csv\" }";
    table(0.005);
    let found = notes(measured);
    assert!(
        found.len() == 1
            && found[0].contains("along x was measured as 5.000e-3 m, where the support holds it at 0.000e0 m"),
        "{found:?}"
    );
    table(1e-4);
    assert!(notes(measured).is_empty());
}
