//! A cantilever of four elements and five Poisson's ratios, against the limit of quadratic elements.

use super::{markdown, signed};
use springfit_studies::study::{Scene, converge_to};
use std::path::Path;

const RATIOS: [f64; 5] = [0.0, 0.3, 0.45, 0.49, 0.4999];

struct Kind {
    element: &'static str,
    truth: &'static str,
    /// Of the exact network that does not lock.
    volume: &'static str,
    /// Whether there are shear springs on edges.
    edges: bool,
    classical: &'static str,
    groups: &'static str,
    levels: usize,
}

const KINDS: [Kind; 4] = [
    Kind {
        element: "tet4",
        truth: "hex20",
        volume: "patches",
        edges: true,
        classical: "objective = \"divergence\"",
        groups: "\"edge\", \"bulk\"",
        levels: 3,
    },
    Kind {
        element: "tri3",
        truth: "quad9",
        volume: "patches",
        edges: true,
        classical: "objective = \"divergence\"",
        groups: "\"edge\", \"bulk\"",
        levels: 4,
    },
    Kind {
        element: "hex8",
        truth: "hex20",
        volume: "cells",
        edges: false,
        classical: "objective = \"modal\"\nnonnegative = true",
        groups: "\"edge\", \"face diagonal\", \"body diagonal\", \"bulk\"",
        levels: 3,
    },
    Kind {
        element: "quad4",
        truth: "quad9",
        volume: "cells",
        edges: false,
        classical: "objective = \"modal\"\nnonnegative = true",
        groups: "\"edge\", \"diagonal\", \"bulk\"",
        levels: 4,
    },
];

impl Kind {
    fn scene(&self, element: &str, poisson: f64, fits: &str) -> Scene {
        let (lengths, cells, traction, plane) = match self.element {
            "tet4" | "hex8" => ("[4, 1, 1]", "[4, 1, 1]", "[0, 0, 1e-3]", ""),
            _ => ("[4, 1]", "[4, 1]", "[0, 1e-3]", "plane = \"strain\"\n"),
        };
        let text = format!(
            "[mesh]\nbox = {{ element = \"{element}\", size = {lengths}, cells = {cells} }}\n[material]\nyoung = 1\npoisson = \
             {poisson}\n{plane}{fits}[[fix]]\ngroup = \"xmin\"\n[[load]]\nname = \"shear\"\ngroup = \"xmax\"\ntraction = {traction}\n"
        );
        Scene::parse(&text, Path::new("cantilever.toml")).unwrap()
    }

    fn row(&self, poisson: f64) -> Vec<String> {
        let Kind { volume, edges, classical, groups, .. } = self;
        let of_edges = match edges {
            true => "[[fit]]\nobjective = \"exact\"\nshear = \"edges\"\nvolume = \"patches\"\n",
            false => "",
        };
        let fits = format!(
            "[[fit]]\nobjective = \"exact\"\nvolume = \"{volume}\"\n{of_edges}[[fit]]\n{classical}\nsprings = [{groups}]\n[[fit]]\nobjective = \
             \"offdiag\"\nnonnegative = true\n"
        );
        let truth = self.scene(self.truth, poisson, "[[fit]]\nobjective = \"exact\"\n");
        let body = self.scene(self.element, poisson, &fits);
        let convergence = converge_to(&body, &truth, Some(self.levels), &mut |_| {}).unwrap();
        let load = &convergence.loads[0];
        let errors = load.models.iter().map(|model| load.of_truth(model)[self.levels - 1].unwrap());
        let mut errors: Vec<String> = errors.map(|error| signed(error, 1)).collect();
        if !edges {
            errors.insert(2, "–".into());
        }
        [self.element.to_string(), poisson.to_string()].into_iter().chain(errors).collect()
    }
}

pub fn table() -> String {
    let rows: Vec<Vec<String>> = KINDS.iter().flat_map(|kind| RATIOS.map(|poisson| kind.row(poisson))).collect();
    let header =
        ["element", "ν", "finite elements", "`cells` or `patches`", "`edges`", "classical", "`offdiag`, k ≥ 0"];
    markdown(&header, &rows)
}
