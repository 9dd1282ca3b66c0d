//! Which combinations of values are studies.

use super::range::Values;
use crate::bound::{self, check_count};
use crate::error::{Error, ErrorKind, Result};
use crate::random::{DIMENSIONS, Random, Sobol};
use crate::scene::Setting;
use schemars::JsonSchema;
use serde::Deserialize;

/// Which combinations of the keys' values are studies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Design {
    /// All combinations; the last key runs fastest.
    #[default]
    Grid,
    /// Independent samples of each key.
    Random,
    /// Points of Sobol's sequence, which fill the ranges evenly.
    Sobol,
}

/// The studies of a sweep, before they are worked out.
#[derive(Debug, Clone)]
pub enum Plan {
    Listed(Vec<Vec<Setting>>),
    Grid(Vec<(String, Vec<toml::Value>)>),
    Sampled { design: Design, keys: Vec<(String, Values)>, samples: usize, seed: Option<u64> },
}

impl Plan {
    /// # Errors
    /// There are too many studies, or a design lacks a number of them.
    pub fn new(design: Design, keys: Vec<(String, Values)>, samples: Option<usize>, seed: Option<u64>) -> Result<Plan> {
        if design == Design::Grid {
            let list = |(key, values): (String, Values)| match values.all() {
                Some(all) => Ok((key, all)),
                None => Err(Error::expected(
                    format!("over.{key}.count"),
                    "the number of values of a range in a grid",
                    "none",
                )),
            };
            let lists: Vec<(String, Vec<toml::Value>)> = keys.into_iter().map(list).collect::<Result<_>>()?;
            // In floating point, which is large where a product of integers would wrap.
            let count = lists.iter().fold(1.0, |count, (_, values)| count * values.len() as f64);
            if count > bound::STUDIES as f64 {
                let expected = format!("at most {} combinations", bound::STUDIES);
                return Err(Error::expected("over", expected, count).of_kind(ErrorKind::Limit));
            }
            return Ok(Plan::Grid(lists));
        }
        let samples = samples.ok_or_else(|| Error::expected("samples", "the number of studies", "none"))?;
        check_count("samples", samples as u64, 1, bound::STUDIES)?;
        if design == Design::Sobol && keys.len() > DIMENSIONS {
            let expected = format!("at most {DIMENSIONS} keys of a Sobol design");
            return Err(Error::expected("over", expected, keys.len()).of_kind(ErrorKind::Limit));
        }
        Ok(Plan::Sampled { design, keys, samples, seed })
    }

    /// The settings of each study.
    ///
    /// # Errors
    /// A key is no path of a scene.
    pub fn studies(&self) -> Result<Vec<Vec<Setting>>> {
        match self {
            Plan::Listed(studies) => Ok(studies.clone()),
            Plan::Grid(lists) => {
                let count: usize = lists.iter().map(|(_, values)| values.len()).product();
                let study = |mut number: usize| {
                    let mut study = Vec::new();
                    for (key, values) in lists.iter().rev() {
                        study.push(Setting::of(key, &values[number % values.len()])?);
                        number /= values.len();
                    }
                    study.reverse();
                    Ok(study)
                };
                (0..count).map(study).collect()
            }
            Plan::Sampled { design, keys, samples, seed } => {
                let mut sobol = Sobol::new(if *design == Design::Sobol { keys.len() } else { 0 }, *seed);
                let mut random = Random::new(seed.unwrap_or(0));
                let mut study = |_| {
                    let shares = match design {
                        Design::Sobol => sobol.point(),
                        Design::Random | Design::Grid => keys.iter().map(|_| random.unit()).collect(),
                    };
                    let setting =
                        |((key, values), share): (&(String, Values), f64)| Setting::of(key, &values.at(share));
                    keys.iter().zip(shares).map(setting).collect()
                };
                (0..*samples).map(&mut study).collect()
            }
        }
    }
}
