//! The names of the files that a run writes.

/// The table of the points, if all networks of a run have the same masses.
pub(super) const POINTS: &str = "points.csv";
/// The report.
pub(super) const REPORT: &str = "report.json";
/// The report as a page.
pub(super) const PAGE: &str = "report.html";

/// The files' names without their endings.
pub(super) struct Stems {
    /// Files of the networks.
    pub fits: Vec<String>,
    /// Files of the motions.
    pub motions: Vec<String>,
    /// Files of the points of each network, where they are not the same.
    pub points: Vec<String>,
    /// Files of the errors of each fit at sampled shapes, and of its starts.
    pub sampled: Vec<[String; 2]>,
}

impl Stems {
    /// The stems of these fits, and of these models that move.
    pub fn of<'a>(fits: impl Iterator<Item = &'a str>, moved: impl Iterator<Item = &'a str>) -> Stems {
        let fits: Vec<&str> = fits.collect();
        let moved: Vec<String> = moved.map(|name| format!("motion {name}")).collect();
        let points: Vec<String> = fits.iter().map(|name| format!("points {name}")).collect();
        let sampled: Vec<String> =
            fits.iter().flat_map(|name| [format!("shapes {name}"), format!("starts {name}")]).collect();
        let own = moved.iter().chain(&points).chain(&sampled).map(String::as_str);
        let mut stems = file_stems(fits.iter().copied().chain(own));
        let sampled = stems.split_off(fits.len() + moved.len() + points.len());
        let sampled = sampled.as_chunks::<2>().0.to_vec();
        let points = stems.split_off(fits.len() + moved.len());
        let motions = stems.split_off(fits.len());
        Stems { fits: stems, motions, points, sampled }
    }

    /// The names of all files that a run can write, but for the pictures of motions.
    pub fn names(&self) -> impl Iterator<Item = String> {
        let with = |stems: &[String], endings: &'static [&'static str]| {
            let stems = stems.to_vec();
            stems.into_iter().flat_map(|stem| endings.iter().map(move |ending| format!("{stem}.{ending}")))
        };
        with(&self.fits, &["csv", "json", "vtu"])
            .chain(with(&self.motions, &["csv", "pvd"]))
            .chain(with(&self.points, &["csv"]))
            .chain(with(self.sampled.as_flattened(), &["csv"]))
            .chain(["mesh.vtu", POINTS, REPORT, PAGE].map(String::from))
    }
}

/// Characters of a stem, without the number that tells equal ones apart.
const LONGEST_STEM: usize = 40;

/// The stem of a name without letters or digits of ASCII.
const UNNAMED: &str = "fit";

/// Each name as the stem of a file of its own, also where files do not tell capitals from small letters: `modal 0.1 +bulk` is
/// `modal-0.1-bulk`.
pub(super) fn file_stems<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let reserved = ["mesh", "points", "report"];
    let mut stems: Vec<String> = reserved.map(String::from).into();
    for name in names {
        let kept = |c: char| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' };
        let dashed: String = name.chars().map(kept).collect();
        let mut stem = String::new();
        for part in dashed.split('-').filter(|part| !part.is_empty()) {
            if !stem.is_empty() && stem.len() + part.len() >= LONGEST_STEM {
                break;
            }
            stem += if stem.is_empty() { "" } else { "-" };
            stem += part;
        }
        stem.truncate(LONGEST_STEM);
        if stem.chars().all(|c| c == '.') {
            stem = UNNAMED.into();
        }
        let numbered = (2..).map(|i| format!("{stem}-{i}"));
        // Some file systems do not tell capital letters from small ones: two fits would write one file.
        let is_free = |stem: &String| !stems.iter().any(|other| other.eq_ignore_ascii_case(stem));
        let free = std::iter::once(stem.clone()).chain(numbered).find(is_free);
        stems.extend(free);
    }
    stems.split_off(reserved.len())
}
