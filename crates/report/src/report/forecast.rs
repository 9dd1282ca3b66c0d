//! What would be done, with estimates of time and memory.

use super::table::{Column, Table};
use crate::study::{EngineLimit, Forecast};
use crate::text::{memory_in_words, printable, time_in_words};

/// The sizes of the body, the stages with their estimates, and what is left out.
pub fn forecast_text(title: &str, forecast: &Forecast, stages: &[(String, Option<String>)]) -> String {
    let cells: Vec<String> = forecast.cells.iter().map(|(element, count)| format!("{count} {element}")).collect();
    let mut text = format!(
        "{}\n{} points, {}; {} unknowns\n\n",
        printable(title),
        forecast.points,
        cells.join(", "),
        forecast.unknowns
    );
    for (stage, left_out) in stages {
        text += &match left_out {
            None => format!("run       {}\n", printable(stage)),
            Some(why) => format!("left out  {}: {why}\n", printable(stage)),
        };
    }
    for limit in &forecast.engines {
        let words = limit.limit.words("the body").unwrap_or(EngineLimit::NONE.into());
        text += &format!("engine    {}: {words}\n", printable(&limit.fit));
    }
    let columns = vec![Column::words("expected"), Column::numbers("time"), Column::numbers("memory")];
    let words = |value: Option<f64>, words: fn(f64) -> String| value.map_or("unknown".into(), words);
    let mut rows: Vec<Vec<String>> = forecast
        .stages
        .iter()
        .map(|stage| vec![stage.name.clone(), words(stage.seconds, time_in_words), words(stage.bytes, memory_in_words)])
        .collect();
    let unknown = match forecast.unknown().count() {
        0 => "",
        1 => "; a stage comes on top whose time is not known before it begins",
        _ => "; stages come on top whose time is not known before they begin",
    };
    let all = if unknown.is_empty() { "all" } else { "all that is known" };
    rows.push(vec![all.into(), time_in_words(forecast.seconds()), memory_in_words(forecast.bytes())]);
    let gap = if stages.is_empty() { "" } else { "\n" };
    format!(
        "{text}{gap}{}\nTimes and memory are estimates for this machine{unknown}. Nothing was run.\n",
        Table::new("expected", "", columns, rows).text()
    )
}
