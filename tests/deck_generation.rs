//! Nodes and elements that the keywords of Abaqus make of others: `*NGEN`, `*NFILL`, `*NCOPY`, `*ELGEN` and `*ELCOPY`, beside bodies in closed form.

use springfit_bodies::model::content;
use springfit_mesh::mesh::{Mesh, MeshSource};
use std::f64::consts::PI;

fn source(text: &str) -> MeshSource {
    MeshSource::parse(text.as_bytes(), "inp").unwrap()
}

fn read(text: &str) -> Mesh {
    Mesh::resolve(&source(text), &[], 1.0).unwrap()
}

fn error(text: &str) -> String {
    MeshSource::parse(text.as_bytes(), "inp").unwrap_err().to_string()
}

/// The place of the node with this number.
fn place(mesh: &Mesh, number: u64) -> &[f64] {
    let index = (0..mesh.point_count()).find(|&p| mesh.point_number(p) == number).unwrap();
    mesh.point(index)
}

fn assert_at(mesh: &Mesh, number: u64, expected: &[f64]) {
    let found = place(mesh, number);
    // Places of order one are sums of a few products.
    assert!(found.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-14), "{number}: {found:?}, {expected:?}");
}

/// A box of 4 × 3 × 2 cells: an edge, a face between edges, layers as copies, and elements of one.
const BOX: &str = "*NODE\n1, 0,0,0\n5, 2,0,0\n31, 0,3,0\n35, 2,3,0\n\
    *NGEN, NSET=FRONT\n1, 5\n*NGEN, NSET=BACK\n31, 35, 1\n*NFILL, NSET=BOTTOM\nFRONT, BACK, 3, 10\n\
    *NCOPY, CHANGE NUMBER=100, OLD SET=BOTTOM, SHIFT, MULTIPLE=2,\nNEW SET=ABOVE\n0, 0, 0.5\n\
    *ELEMENT, TYPE=C3D8\n1, 1,2,12,11,101,102,112,111\n\
    *ELGEN, ELSET=BODY\n1, 4, 1, 1, 3, 10, 10, 2, 100, 100\n\
    *NSET, NSET=LINE, GEN\n1, 5\n";

#[test]
fn a_box_of_one_element_and_four_corners_is_whole() {
    let mesh = read(BOX);
    assert_eq!((mesh.cell_count(), mesh.point_count()), (24, 60));
    assert!((content(&mesh) - 6.0).abs() < 1e-12);
    assert_at(&mesh, 23, &[1.0, 2.0, 0.0]);
    assert_at(&mesh, 214, &[1.5, 1.0, 1.0]);
    let count = |name: &str| mesh.groups[name].points.len();
    assert_eq!(["FRONT", "BACK", "BOTTOM", "ABOVE", "LINE"].map(count), [5, 5, 20, 40, 5]);
    assert_eq!(mesh.groups["BODY"].cells.len(), 24);
    assert!(
        source(BOX)
            .annotations
            .remarks
            .iter()
            .any(|said| said.contains("\"BOTTOM\" of *NFILL holds the nodes of both"))
    );
}

/// `A = (R² − r²)/2 · n sin(θ/n)` of a ring of θ by n chords; the middle by its node or by its coordinates.
#[test]
fn arcs_are_those_of_circles() {
    for middle in ["9", ", 1, 2, 0"] {
        let deck = format!(
            "*NODE\n9, 1,2,0\n1, 2,2,0\n7, 1,3,0\n21, 4,2,0\n27, 1,5,0\n*NGEN, LINE=C, NSET=IN\n1, 7, 1, {middle}\n\
             *NGEN, LINE=C, NSET=OUT\n21, 27, 1, {middle}\n*NFILL\nIN, OUT, 2, 10\n\
             *ELEMENT, TYPE=CPS4\n1, 1,11,12,2\n*ELGEN\n1, 6, 1, 1, 2, 10, 10\n"
        );
        let mesh = read(&deck);
        let (n, angle) = (6.0, PI / 2.0);
        let expected = (9.0 - 1.0) / 2.0 * n * (angle / n).sin();
        assert!((content(&mesh) - expected).abs() < 1e-12, "{}, {expected}", content(&mesh));
        let (sine, cosine) = (PI / 6.0).sin_cos();
        assert_at(&mesh, 13, &[1.0 + 2.0 * cosine, 2.0 + 2.0 * sine]);
    }
}

#[test]
fn copies_are_turned_and_reflected() {
    let corner = "*NODE, NSET=A\n1, 1,0,0\n2, 3,0,1\n3, 1,2,0\n4, 1,1,2\n*ELEMENT, TYPE=C3D4, ELSET=E\n1, 1,2,3,4\n";
    let copied = |how: &str| {
        read(&format!(
            "{corner}*NCOPY, OLD SET=A, CHANGE NUMBER=10, {how}\n*ELCOPY, OLD SET=E, ELEMENT SHIFT=5, SHIFT NODES=10, NEW SET=F\n"
        ))
    };
    for (how, second) in [
        ("SHIFT\n1, 2, 3", [4.0, 2.0, 4.0]),
        ("SHIFT\n0, 0, 0\n0,0,0, 0,0,1, 90.", [0.0, 3.0, 1.0]),
        ("SHIFT\n\n0,0,0, 0,0,1, 90.", [0.0, 3.0, 1.0]),
        ("REFLECT=LINE\n0,0,0, 0,0,2", [-3.0, 0.0, 1.0]),
        ("REFLECT=MIRROR\n0,0,5, 1,0,5\n0,1,5", [3.0, 0.0, 9.0]),
        ("REFLECT=POINT\n1, 1, 1", [-1.0, 2.0, 1.0]),
    ] {
        let mesh = copied(how);
        assert_at(&mesh, 12, &second);
        assert_eq!((mesh.cell_count(), mesh.groups["F"].cells.len()), (2, 1), "{how}");
        assert!((content(&mesh) - 2.0 * content(&read(corner))).abs() < 1e-12, "{how}");
    }
    // A twelfth of a ring, turned eleven times: its last nodes are at the place of its first.
    let ring = "*NODE, NSET=A\n1, 1,0,0\n2, 2,0,0\n*NCOPY, OLD SET=A, CHANGE NUMBER=2, SHIFT, MULTIPLE=12\n0,0,0\n0,0,0, 0,0,1, 30\n\
                *ELEMENT, TYPE=CPS4\n1, 1,2,4,3\n*ELGEN\n1, 12, 2\n";
    let mesh = read(ring);
    assert_at(&mesh, 26, &[2.0, 0.0]);
    assert!((content(&mesh) - 1.5 * 12.0 * (PI / 6.0).sin()).abs() < 1e-12);
}

/// A node that is defined twice has its last place. A note counts elements that are read as another kind, and those that are made of them as well.
#[test]
fn what_is_made_is_as_what_is_listed() {
    let deck = "*NODE\n1, 0,0,0\n3, 2,0,0\n11, 0,1,0\n13, 2,1,0\n*NGEN\n1, 3\n11, 13\n*NODE\n2, 1.5,0,0\n\
                *ELEMENT, TYPE=S4, ELSET=E\n1, 1,2,12,11\n*ELGEN, ELSET=E\n1, 2\n*ELEMENT, TYPE=MASS\n7, 1\n*ELGEN\n7, 3\n";
    let found = source(deck);
    assert_at(&read(deck), 2, &[1.5, 0.0]);
    assert_eq!(found.annotations.remarks, ["2 S4 elements are membranes, without bending stiffness here"]);
    assert_eq!(found.annotations.left_out["bodiless element"], 2);
}

#[test]
fn what_is_not_read_of_generation_is_refused_with_a_way_out() {
    let nodes = "*NODE, NSET=A\n1, 0,0,0\n5, 1,0,0\n*NODE, NSET=B\n7, 0,1,0\n";
    let element = "*ELEMENT, TYPE=T3D2, ELSET=E\n1, 1,5\n";
    let way = "let the program that wrote the file write nodes and elements one by one";
    for (more, expected) in [
        ("*NGEN, LINE=P\n1,5\n", "expected a straight line or LINE=C, found LINE=P"),
        ("*NGEN, LINE=C, SYSTEM=C\n1,5\n", "expected SYSTEM=RC, found SYSTEM=C"),
        ("*NGEN, LINE=C\n1,5,1,7\n", "expected the ends of an arc of less than 180° at one distance from its middle"),
        ("*NGEN, LINE=C\n1,5,1,7,,,,0,0,1\n", "expected an arc of less than 180°, found a normal"),
        ("*NFILL, BIAS=0.5\nA,A,2,10\n", "expected nodes at equal distances, found BIAS=0.5"),
        (
            "*NCOPY, OLD SET=A, CHANGE NUMBER=10, POLE\n7\n",
            "expected SHIFT, or REFLECT=LINE, MIRROR or POINT, found none of them",
        ),
        (
            "*NCOPY, OLD SET=A, CHANGE NUMBER=10, SHIFT\n1,0,0\n0,0,0,0,0,1,90\n",
            "expected a translation, or zeros and two points",
        ),
        (
            "*ELCOPY, OLD SET=E, ELEMENT SHIFT=1, SHIFT NODES=1, REFLECT\n",
            "expected elements that are moved, found REFLECT",
        ),
    ] {
        let said = error(&format!("{nodes}{element}{more}"));
        assert!(said.starts_with("line ") && said.contains(expected) && said.contains(way), "{said}");
    }
    for (more, expected) in [
        ("*NGEN\n1,5,3\n", "expected an increment that leads from 1 to 5, found 3"),
        ("*NGEN\n5,1,1\n", "expected an increment that leads from 5 to 1, found 1"),
        ("*NGEN\n1,6,1\n", "expected a node that is listed before, found 6"),
        ("*NFILL\nA,B,2,10\n", "expected two sets of as many nodes, found 2 and 1"),
        ("*NFILL\nA,C,2,10\n", "expected a set of nodes that is listed before, found \"C\""),
        ("*ELGEN\n9,2\n", "expected an element that is listed before, found 9"),
        ("*ELGEN\n1,2,1,1,2\n", "expected what is added to the numbers of nodes and elements, found none"),
        ("*NFILL\nA,A,1000000000000,1\n", "expected at most 2097152 nodes and elements that keywords make"),
        ("*ELGEN\n1,2\n1,2\n", "element 2 occurs twice"),
    ] {
        let nodes =
            nodes.to_string() + "*NODE\n2, 9,9,9\n6, 9,9,9\n".get(..if more.contains("1,2") { 24 } else { 0 }).unwrap();
        let said = error(&format!("{nodes}{element}{more}"));
        assert!(said.contains(expected), "{said}");
    }
    let reversed = read(&format!("{nodes}*NGEN\n5,1,-2\n*ELEMENT, TYPE=T3D2\n1, 1,3\n2, 3,5\n"));
    assert_at(&reversed, 3, &[0.5, 0.0]);
}
