//! The sets of shapes of a comparison.

use super::entry::{ShapesKeys, numbers, values};
use crate::analysis::shapes::{ShapeFamily, ShapeSet};
use crate::bound::{self, check_count};
use crate::error::{Error, Result};
use springfit_scenes::{choice, keys};

/// Sets of a table at most: lists of five keys multiply to more by mistake.
const MOST: f64 = 1e5;

/// The sets of shapes of `shapes`: all combinations of the values of each table.
pub fn shape_sets(shapes: Option<&toml::Value>) -> Result<Vec<ShapeSet>> {
    let tables: Vec<(String, toml::Table)> = match shapes {
        None => vec![("shapes".into(), toml::Table::new())],
        Some(toml::Value::Table(table)) => vec![("shapes".into(), table.clone())],
        Some(toml::Value::Array(list)) if !list.is_empty() => {
            let table = |(i, value): (usize, &toml::Value)| {
                let key = format!("shapes[{i}]");
                let table = value.as_table().cloned();
                table.map(|table| (key.clone(), table)).ok_or_else(|| Error::expected(key, "a table", value.type_str()))
            };
            list.iter().enumerate().map(table).collect::<Result<_>>()?
        }
        Some(toml::Value::Array(_)) => {
            return Err(Error::expected("shapes", "a table, or a list of tables", "an empty list"));
        }
        Some(other) => return Err(Error::expected("shapes", "a table, or a list of tables", other.type_str())),
    };
    let mut sets = Vec::new();
    for (key, table) in tables {
        sets.extend(sets_of(&table).map_err(|e| e.under(key))?);
    }
    Ok(sets)
}

fn sets_of(table: &toml::Table) -> Result<Vec<ShapeSet>> {
    let known = keys::<ShapesKeys>();
    if let Some(unknown) = table.keys().find(|key| !known.contains(&key.as_str())) {
        let expected = known.iter().map(|key| format!("\"{key}\"")).collect::<Vec<_>>().join(", ");
        return Err(Error::at(unknown, format!("unknown field \"{unknown}\", expected one of {expected}")));
    }
    let usual = ShapeSet::default();
    let whole = |key: &str, usual: usize, most: u64| -> Result<Vec<u64>> {
        let list = numbers(key, table.get(key), usual as f64)?;
        let is_whole = |v: &&f64| v.fract() == 0.0 && **v >= 0.0 && **v <= most as f64;
        match list.iter().find(|v| !is_whole(v)) {
            Some(wrong) => Err(Error::expected(key, format!("whole numbers from 0 to {most}"), wrong)),
            None => Ok(list.into_iter().map(|v| v as u64).collect()),
        }
    };
    let between = |key: &str, usual: f64, [least, most]: [f64; 2]| -> Result<Vec<f64>> {
        let list = numbers(key, table.get(key), usual)?;
        match list.iter().find(|v| !(least..=most).contains(*v)) {
            Some(wrong) => Err(Error::expected(key, format!("numbers from {least} to {most}"), wrong)),
            None => Ok(list),
        }
    };
    let families = values("family", table.get("family"))?;
    let family = |value: &toml::Value| {
        let name = value.as_str().ok_or_else(|| Error::expected("family", "a text", value.type_str()))?;
        choice("family", Some(name), usual.family, ShapeFamily::named)
    };
    let families = match families.is_empty() {
        true => vec![usual.family],
        false => families.iter().map(family).collect::<Result<_>>()?,
    };
    let counts = whole("count", usual.count, bound::RANDOM_SHAPES)?;
    counts.iter().try_for_each(|count| check_count("count", *count, 1, bound::RANDOM_SHAPES).map(|_| ()))?;
    // Numbers of the table are read as floating point, which holds all whole numbers up to 2⁵³.
    let seeds = whole("seed", usual.seed as usize, 1 << 53)?;
    let (distortions, aspects) =
        (between("distortion", usual.distortion, [0.0, 1.0])?, between("aspect", usual.aspect, [1e-3, 1e3])?);
    let lists = [families.len(), distortions.len(), aspects.len(), seeds.len(), counts.len()];
    // The product of five lengths may exceed an integer. In floating point it is large, and is refused before a set is
    // made.
    let all: f64 = lists.iter().map(|list| *list as f64).product();
    if all > MOST {
        return Err(Error::new(format!("expected at most {MOST} sets of shapes, found {all}")));
    }
    let mut sets = Vec::new();
    for &family in &families {
        for &distortion in &distortions {
            for &aspect in &aspects {
                for &seed in &seeds {
                    sets.extend(counts.iter().map(|count| ShapeSet {
                        family,
                        distortion,
                        aspect,
                        seed,
                        count: *count as usize,
                    }));
                }
            }
        }
    }
    Ok(sets)
}
