//! The key `engine` of a `[[fit]]`: the settings of the engine that the constants are for.

use crate::choice::choice;
use crate::engine::{Engine, Order, Precision, Setting, Sweep};
use crate::error::{Error, Result};
use crate::file::Forms;
use crate::scene::value;
use schemars::JsonSchema;
use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer, Serialize};

/// The settings of an engine. A key that is absent has the default of the engine.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table such as { method = \"xpbd\", substeps = 10 }")]
pub struct EngineEntry {
    /// The method is extended position-based dynamics (`xpbd`) or vertex block descent (`vbd`), or that of an engine by its name.
    #[schemars(with = "String", extend("enum" = Engine::NAMES))]
    method: Option<String>,
    /// The engine is asked for steps of this length in s, above 0 and at most 1000, such as one frame.
    #[serde(deserialize_with = "value::optional_time")]
    #[schemars(schema_with = "value::time_schema", extend("default" = "1/60 s"))]
    step: Option<f64>,
    /// A step is divided into this number of substeps, 1 or more. Jolt calls them iterations.
    #[schemars(extend("x-default" = "10; 1 of `vbd`, 5 of `jolt`"))]
    substeps: Option<usize>,
    /// A substep has this number of sweeps, 1 or more.
    #[schemars(extend("x-default" = "1; 10 of `vbd` and `newton-vbd`, 2 of `newton-xpbd`"))]
    iterations: Option<usize>,
    /// A sweep of `xpbd` takes the springs one after the other (`gauss-seidel`) or all at once (`jacobi`).
    #[schemars(extend("enum" = Sweep::NAMES, "x-default" = "`\"gauss-seidel\"`; `\"jacobi\"` of `newton-xpbd`"))]
    sweep: Option<String>,
    /// A correction is multiplied by this factor, at least 0.001 and below 2.
    #[schemars(extend("x-default" = "1; 0.9 of `newton-xpbd`"))]
    relaxation: Option<f64>,
    /// A sweep takes the springs, or the points of `vbd`, colour after colour (`colours`), as they are in the network (`given`), or as Jolt
    /// takes them (`jolt`): those on contents before those on lengths, and each from the held points outwards.
    #[schemars(extend("enum" = Order::NAMES, "x-default" = "`\"colours\"`; `\"jolt\"` of `jolt`"))]
    order: Option<String>,
    /// The engine stores positions in these numbers. They decide nothing but a note, where substeps move points by less than their last digit.
    #[schemars(extend("enum" = Precision::NAMES, "default" = Precision::Single.name()))]
    precision: Option<String>,
}

/// The settings of an engine, or its name for those that it has by default.
#[derive(Debug, Clone)]
pub(in crate::fits) struct EngineOrName(pub EngineEntry);

impl<'de> Deserialize<'de> for EngineOrName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<EngineOrName, D::Error> {
        deserializer.deserialize_any(Forms::<_, IgnoredAny, _> {
            text: Some(&|name| Ok(EngineOrName(EngineEntry { method: Some(name.into()), ..EngineEntry::default() }))),
            table: Some(EngineOrName),
            ..Forms::expecting("a name such as \"jolt\", or a table such as { method = \"xpbd\", substeps = 10 }")
        })
    }
}

impl EngineEntry {
    /// The settings.
    ///
    /// # Errors
    /// A name is unknown, or a value is out of range or not that of the engine; the error has its key.
    pub fn setting(&self) -> Result<Setting> {
        let missing = || Error::expected("method", format!("one of {}", Engine::NAMES.join(", ")), "none");
        let name = self.method.as_deref().ok_or_else(missing)?;
        let usual = Setting::usual(Engine::named(name).map_err(|e| e.at_key("method"))?);
        let setting = Setting {
            step: self.step.unwrap_or(usual.step),
            substeps: self.substeps.unwrap_or(usual.substeps),
            iterations: self.iterations.unwrap_or(usual.iterations),
            sweep: choice("sweep", self.sweep.as_deref(), usual.sweep, Sweep::named)?,
            relaxation: self.relaxation.unwrap_or(usual.relaxation),
            order: choice("order", self.order.as_deref(), usual.order, Order::named)?,
            precision: choice("precision", self.precision.as_deref(), usual.precision, Precision::named)?,
            ..usual
        };
        setting.check()?;
        Ok(setting)
    }

    /// What is set, as `engine = {…}`: what tells one fit from another on disk.
    pub fn identity(&self) -> String {
        format!("engine = {}", serde_json::to_string(self).expect("keys are text"))
    }
}
