//! The program as it is shipped, from file to file, beside a plain loop with the same numbers. `SPRINGFIT` names another build of it.

mod plain;

use crate::{Figures, Row};
use springfit_mesh::mesh::Mesh;
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

/// Ticks of the clock by which the system counts the processor time of children, in a second.
const TICKS: f64 = 100.0;
/// Runs of a command that takes less than a tick.
const MANY: usize = 50;

/// Seconds that the processor has spent on children that have ended.
fn children() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // What follows the name, which is in parentheses; the two are the 14th and 15th of these.
    let numbers: Vec<&str> = text.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let spent = numbers.get(13..15).unwrap_or_default().iter().filter_map(|ticks| ticks.parse::<f64>().ok());
    spent.sum::<f64>() / TICKS
}

/// Runs the program on one thread so many times, and gives what one run takes.
fn run(folder: &Path, arguments: &str, times: usize) -> Figures {
    let program = std::env::var("SPRINGFIT").unwrap_or_else(|_| env!("CARGO_BIN_EXE_springfit").into());
    let (before, start) = (children(), Instant::now());
    for _ in 0..times {
        let mut command = Command::new(&program);
        command.current_dir(folder).args(arguments.split(' ')).env("RAYON_NUM_THREADS", "1");
        let ended = command.stdout(Stdio::null()).stderr(Stdio::null()).status().expect("the program is there");
        assert!(ended.success(), "springfit {arguments}");
    }
    let seconds = [children() - before, start.elapsed().as_secs_f64()].map(|seconds| seconds / times as f64);
    Figures { processor: seconds[0], wall: seconds[1], number: f64::NAN, name: "springfit".into() }
}

/// The mesh as a binary file of Gmsh, version 4.1, in one block.
fn write_mesh(mesh: &Mesh, gmsh: i32, to: &Path) {
    let cells = mesh.blocks[0].cells();
    let mut file = b"$MeshFormat\n4.1 1 8\n".to_vec();
    let longs = |file: &mut Vec<u8>, all: &[usize]| all.iter().for_each(|n| file.extend((*n as u64).to_le_bytes()));
    let ints = |file: &mut Vec<u8>, all: &[i32]| all.iter().for_each(|n| file.extend(n.to_le_bytes()));
    ints(&mut file, &[1]);
    file.extend(b"\n$EndMeshFormat\n$Nodes\n");
    let count = mesh.point_count();
    longs(&mut file, &[1, count, 1, count]);
    ints(&mut file, &[3, 1, 0]);
    longs(&mut file, &[count]);
    (1..=count).for_each(|tag| longs(&mut file, &[tag]));
    mesh.points.iter().for_each(|x| file.extend(x.to_le_bytes()));
    file.extend(b"\n$EndNodes\n$Elements\n");
    longs(&mut file, &[1, cells.len(), 1, cells.len()]);
    ints(&mut file, &[3, 1, gmsh]);
    longs(&mut file, &[cells.len()]);
    for (cell, nodes) in cells.enumerate() {
        longs(&mut file, &[cell + 1]);
        nodes.iter().for_each(|node| longs(&mut file, &[node + 1]));
    }
    file.extend(b"\n$EndElements\n");
    std::fs::write(to, file).expect("the folder can be written");
}

/// Fits of a million tetrahedra from file to file, each beside the loop that writes a CSV file.
pub fn files(folder: &Path) -> Vec<Row> {
    let mesh = crate::body("tet4", 55);
    write_mesh(&mesh, 4, &folder.join("tets.msh"));
    let cells = mesh.cell_count();
    drop(mesh);
    let row = |ending: &str| {
        let arguments = format!("fit tets.msh --young 10kPa --poisson 0.3 -o tets.{ending}");
        run(folder, &arguments, 1);
        let own = run(folder, &arguments, 1);
        let work = || plain::exact_network(&folder.join("tets.msh"), &folder.join("plain.csv"), 1e4, 0.3);
        let peer = crate::timed("a plain loop, to CSV", work, |_| f64::NAN);
        Row { work: format!("exact network of {cells} tet4, .msh to .{ending}"), own, peer: Ok(peer) }
    };
    let rows = ["csv", "npz", "vtu", "json"].map(row).into();
    let text = |name: &str| std::fs::read_to_string(folder.join(name)).expect("it was written");
    plain::compare(&text("tets.csv"), &text("plain.csv"));
    rows
}

const BODY: &str = "fix = [{ group = \"zmin\" }]\nload = [{ group = \"zmax\", traction = [1000, 0, 0] }]\n\
                    material = { young = 1e6, poisson = 0.3 }\n";

/// What has a bound: lines of words.
pub fn bounds(folder: &Path) -> String {
    let mut text = String::new();
    for (element, gmsh, cells, most) in [("tet4", 4, 40, 3.0), ("hex8", 5, 46, 9.0)] {
        let mesh = crate::body(element, cells);
        write_mesh(&mesh, gmsh, &folder.join("errors.msh"));
        let arguments = "fit errors.msh --young 10kPa --poisson 0.3 --objective frobenius -o errors.npz";
        let all = run(folder, arguments, 3).processor;
        let none = run(folder, &format!("{arguments} --no-errors"), 3).processor;
        let each = 1e6 * (all - none) / mesh.cell_count() as f64;
        writeln!(text, "- matrix errors of {element}: {each:.2} us per cell, at most {most}")
            .expect("a text takes all");
    }
    for thickness in [0.1, 0.01] {
        let of = |fit: &str| {
            let mesh = format!("box = {{ element = \"hex8\", size = [1, 1, {thickness}], cells = [20, 20, 20] }}");
            let scene = format!("mesh = {{ {mesh} }}\nfit = [{{ objective = \"offdiag\"{fit} }}]\n{BODY}");
            std::fs::write(folder.join("scene.toml"), scene).expect("the folder can be written");
            run(folder, "run scene.toml --out out", 1).processor
        };
        let [indefinite, definite] = [of(""), of(", nonnegative = true")];
        let aspect = 1.0 / thickness;
        writeln!(
            text,
            "- run with cells of aspect {aspect:.0}: {indefinite:.2} s with an indefinite network, {definite:.2} s with a definite one, ratio {:.2}, \
             at most 1.2",
            indefinite / definite
        )
        .expect("a text takes all");
    }
    let list = 1e3 * run(folder, "elements", MANY).processor;
    writeln!(text, "- `springfit elements`: {list:.1} ms, at most 5").expect("a text takes all");
    text
}
