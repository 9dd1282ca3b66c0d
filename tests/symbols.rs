//! Vectorised work is compiled in packages that are optimised for it, and in no other.
//!
//! A function with parameters of type is compiled in the package that calls it. At a low level of optimisation the instructions of vectors are
//! calls of functions, three times slower.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The packages of ours that are compiled at the highest level, in which vectorised work may be.
const FAST: [&str; 9] = [
    "springfit-foundation",
    "springfit-element",
    "springfit-fit",
    "springfit-multigrid",
    "springfit-mesh",
    "springfit-bodies",
    "springfit-identify",
    "springfit-analysis",
    "springfit-networks",
];

/// Parts of the symbols of a vector kernel: the function of `pulp` that is compiled for the instructions of the machine, and the
/// instructions of the standard library, which are functions of their own where they were not inlined. Those of SSE2 are in hash tables.
const KERNEL: [&str; 5] =
    ["12imp_fastcall", "9core_arch3x863avx", "9core_arch3x864avx2", "9core_arch3x867avx512f", "9core_arch3x863fma"];

/// The libraries of ours beside this binary, by package: of each the newest, which is that of this build.
fn libraries() -> BTreeMap<String, PathBuf> {
    let folder = std::env::current_exe().unwrap().parent().unwrap().to_path_buf();
    let mut newest: BTreeMap<String, (SystemTime, PathBuf)> = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let file = entry.file_name().into_string().unwrap();
        let name = file.strip_prefix("lib").and_then(|name| name.strip_suffix(".rlib"));
        let Some((name, _hash)) = name.and_then(|name| name.rsplit_once('-')) else { continue };
        if name == "springfit" || name.starts_with("springfit_") {
            let made = (entry.metadata().unwrap().modified().unwrap(), entry.path());
            let known = newest.entry(name.replace('_', "-")).or_insert(made.clone());
            *known = made.max(known.clone());
        }
    }
    newest.into_iter().map(|(name, (_, path))| (name, path)).collect()
}

/// The compiled members of a library, which is an archive: a line of eight bytes, then for each member a header of 60 bytes with its name and
/// the number of its bytes, which is padded to an even one.
fn members(library: &Path) -> Vec<Vec<u8>> {
    let bytes = fs::read(library).unwrap();
    assert!(bytes.starts_with(b"!<arch>\n"), "{} is no archive", library.display());
    let (mut at, mut members) = (8, Vec::new());
    while at + 60 <= bytes.len() {
        let header = std::str::from_utf8(&bytes[at..at + 60]).unwrap();
        let size: usize = header[48..58].trim().parse().unwrap();
        // The description of the library for the compiler holds names of what it does not compile.
        if !header.starts_with("lib.rmeta") {
            members.push(bytes[at + 60..at + 60 + size].to_vec());
        }
        at += 60 + size.next_multiple_of(2);
    }
    members
}

/// The symbols of vector kernels in a library, each once.
fn kernels(library: &Path) -> Vec<String> {
    let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || b"_$.".contains(byte);
    let mut found = Vec::new();
    for member in members(library) {
        for name in member.split(|byte| !is_part(byte)).filter(|name| name.len() > KERNEL[1].len()) {
            let name = String::from_utf8_lossy(name);
            // The name of a section ends with that of its function, and stands for both.
            let name = name.find("_ZN").or(name.find("_R")).map_or(&*name, |at| &name[at..]);
            found.extend(KERNEL.iter().any(|part| name.contains(part)).then(|| name.to_string()));
        }
    }
    found.sort();
    found.dedup();
    found
}

/// The functions of a library with the bytes of their code, by the names of their sections: each function has a section of its own.
fn functions(library: &Path) -> Vec<(String, u64)> {
    members(library)
        .iter()
        .filter(|member| member.starts_with(b"\x7fELF"))
        .flat_map(|member| sections(member))
        .collect()
}

/// The sections of code of an object file in ELF of 64 bits, each with its size. A file of many sections has the counts in the first.
fn sections(object: &[u8]) -> Vec<(String, u64)> {
    let word = |at: usize| u64::from_le_bytes(object[at..at + 8].try_into().unwrap());
    let half = |at: usize| u32::from_le_bytes(object[at..at + 4].try_into().unwrap());
    let quarter = |at: usize| u16::from_le_bytes(object[at..at + 2].try_into().unwrap());
    let (table, size) = (word(0x28) as usize, quarter(0x3a) as usize);
    let count = Some(quarter(0x3c) as usize).filter(|count| *count > 0).unwrap_or(word(table + 0x20) as usize);
    let names = Some(quarter(0x3e) as usize).filter(|place| *place < 0xffff).unwrap_or(half(table + 0x28) as usize);
    let names = word(table + names * size + 0x18) as usize;
    let named = |section: usize| {
        let at = table + section * size;
        let name = object[names + half(at) as usize..].split(|byte| *byte == 0).next()?;
        let function = String::from_utf8_lossy(name).strip_prefix(".text.")?.to_string();
        Some((function, word(at + 0x20)))
    };
    (0..count).filter_map(named).collect()
}

/// A function with parameters of type is compiled where it is called. What solves and fits has a part without, which is optimised.
#[test]
fn solvers_and_fits_are_in_packages_of_the_highest_level_alone() {
    // Its own code, in bytes, of what hands its arguments on.
    const SHORT: u64 = 2200;
    let rooms = [
        "13springfit_fit",
        "16springfit_bodies",
        "17springfit_element",
        "18springfit_analysis",
        "18springfit_identify",
        "19springfit_multigrid",
    ];
    // Readers of records are derived. The others go over the springs once, where a file of them is written.
    let exempt = ["serde", "springfit_bodies6engine4jolt", "springfit_bodies5model6shares"];
    let libraries = libraries();
    let is_solver = |(name, size): &(String, u64)| {
        let is_ours = rooms.iter().any(|room| name.starts_with(&format!("_ZN{room}")));
        *size > SHORT && is_ours && !exempt.iter().any(|part| name.contains(part))
    };
    for package in ["springfit-scenes", "springfit-studies", "springfit-report", "springfit"] {
        let library = libraries.get(package).unwrap_or_else(|| panic!("{package} is not among {:?}", libraries.keys()));
        let found: Vec<String> = functions(library).into_iter().filter(is_solver).map(|(name, _)| name).collect();
        assert!(found.is_empty(), "{package} is compiled at a low level and has these:\n{}", found.join("\n"));
    }
    let known = functions(&libraries["springfit-bodies"]).into_iter().filter(is_solver).count();
    assert!(known > 100, "functions are not recognised: {known}");
}

#[test]
fn vector_kernels_are_in_packages_of_the_highest_level_alone() {
    let libraries = libraries();
    for package in FAST.iter().chain(&["springfit-scenes", "springfit-studies", "springfit-report", "springfit"]) {
        assert!(libraries.contains_key(*package), "{package} is not among {:?}", libraries.keys());
    }
    let (fast, others): (Vec<_>, Vec<_>) = libraries.iter().partition(|(package, _)| FAST.contains(&&package[..]));
    for (package, library) in others {
        let found = kernels(library);
        assert!(
            found.is_empty(),
            "{package} is compiled at a low level and has {} symbols of vector kernels: a function with parameters of type leads to them. Give \
             it a part without, in a package of {FAST:?}:\n{}",
            found.len(),
            found.join("\n")
        );
    }
    // That the parts of symbols are still those of kernels.
    let count: usize = fast.iter().map(|(_, library)| kernels(library).len()).sum();
    assert!(count > 20, "kernels are not recognised: {count}");
}

/// What the profile of the workspace says of the packages above.
#[test]
fn packages_with_vector_kernels_have_the_highest_level() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for manifest in ["Cargo.toml", "python/Cargo.toml"] {
        // A published package has no workspace of the module.
        let Ok(text) = fs::read_to_string(root.join(manifest)) else { continue };
        let table: toml::Table = text.parse().unwrap();
        let release = table.get("profile").and_then(|profile| profile.get("release"));
        let packages = release.and_then(|release| release.get("package")?.as_table()).cloned().unwrap_or_default();
        for package in FAST {
            let level = packages.get(package).and_then(|own| own.get("opt-level"));
            assert!(level.is_none_or(|level| level.as_integer() == Some(3)), "{manifest}: {package} has {level:?}");
        }
    }
}
