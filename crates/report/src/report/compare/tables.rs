//! The tables of a comparison.

use super::pairs::{MERITS, Pair};
use super::summary::{CaseSummary, MethodSummary, Object, Summary, Told};
use crate::order::distinct;
use crate::report::table::Digits::{self, Fixed, Significant};
use crate::report::table::Priority::Always;
use crate::report::table::{Cell, Column, Table};
use crate::study::statistics::Verdict;
use crate::text::printable;
use serde_json::Value;
use std::collections::BTreeMap;

/// Rows of cases and of pairs that the terminal shows at most; files have all. A terminal has 24 lines at least.
const SHOWN: usize = 24;
/// Medians that differ by less than this share are both the best.
const EQUAL: f64 = 1e-6;

/// What the medians of a kind of case are of: the quantity, its name in a heading, and the factor and unit of its figures.
struct Quantity {
    quantity: &'static str,
    heading: &'static str,
    /// Its name in a sentence.
    short: &'static str,
    unit: &'static str,
    places: usize,
}

/// The quantities that tables have, in their order.
const TOLD: [Quantity; 4] = [
    Quantity {
        quantity: "frobenius",
        heading: "|R-K|/|R| Frobenius",
        short: "error in the Frobenius norm",
        unit: "",
        places: 4,
    },
    Quantity { quantity: "spectral", heading: "2-norm", short: "error in the 2-norm", unit: "", places: 4 },
    Quantity { quantity: "e_rms", heading: "e_rms", short: "e_rms", unit: "%", places: 2 },
    Quantity { quantity: "e_max", heading: "e_max", short: "e_max", unit: "%", places: 2 },
];
/// The processor times that tables have, with the unit and how many of it are a second.
const TIMES: [(&str, &str, &str, f64); 5] = [
    ("fit", "time to fit", "µs/element", 1e6),
    ("solve", "solution", "ms", 1e3),
    ("explicit-step", "explicit step", "µs", 1e6),
    ("implicit-step", "implicit step", "ms", 1e3),
    ("simulated-second", "simulated second", "s", 1.0),
];
/// Figures of a case that tables have, with their headings, units, factors and places.
const FIGURES: [(&str, &str, &str, f64, usize); 7] = [
    ("springs", "springs", "", 1.0, 0),
    ("young_ratio", "E / material", "", 1.0, 3),
    ("poisson", "ν", "", 1.0, 3),
    ("zener", "Zener", "", 1.0, 3),
    ("error_of_c", "error of C", "%", 1.0, 1),
    ("trained", "sampled forces: fitted", "%", 100.0, 2),
    ("held_out", "sampled forces: held out", "%", 100.0, 2),
];

/// The summary as text for the terminal: of one case its table, of several what they have in common.
pub fn compare_text(summary: &Summary) -> String {
    let several = summary.cases.len() > 1;
    let mut text = format!("{}\n", printable(&summary.title));
    for mut table in compare_tables(summary) {
        let left_out = table.rows.len().saturating_sub(SHOWN);
        match table.name.as_str() {
            "comparison" if several && left_out > 0 => continue,
            "pairs" if !several => continue,
            "pairs" if left_out > 0 => {
                table.rows.truncate(SHOWN);
                table.notes.push(format!("... and {left_out} more pairs in pairs.csv."));
            }
            _ => {}
        }
        text += &format!("\n{}", table.titled_text());
    }
    text
}

/// A table of the cases, one of pairs, and for several cases one of each fit on each object, and one of ranks.
pub fn compare_tables(summary: &Summary) -> Vec<Table> {
    let several = summary.cases.len() > 1;
    let mut tables = vec![cases(summary)];
    if several {
        let has = |quantity: &&str| summary.objects.iter().any(|object| object.quantity == *quantity);
        let told = MERITS.into_iter().filter(has).enumerate();
        tables.extend(told.map(|(place, quantity)| objects(summary, quantity, place == 0)));
    }
    tables.extend((!summary.pairs.is_empty()).then(|| pairs(&summary.pairs)));
    tables.extend((several && !summary.ranks.is_empty()).then(|| ranks(summary)));
    tables
}

/// A row for each fit, and columns for each element or scene: the median of all errors of a quantity with its interval, and in the first of these
/// tables that of the times.
fn objects(summary: &Summary, quantity: &str, is_first: bool) -> Table {
    let told = TOLD.iter().find(|told| told.quantity == quantity);
    let (heading, unit, places) = told.map_or(("error", "", 4), |told| (told.short, told.unit, told.places));
    let own: Vec<&Object> = summary.objects.iter().filter(|object| object.quantity == quantity).collect();
    let names = distinct(own.iter().map(|object| object.name.as_str()));
    let fits = distinct(own.iter().map(|object| object.fit.as_str()));
    let has_interval = own.iter().any(|object| object.error.is_some_and(|told| told.interval.is_some()));
    let is_timed = is_first && own.iter().any(|object| object.seconds.is_some());
    let mut columns = vec![Column::words("fit")];
    for name in &names {
        let number = |title: &str| Column::numbers(title).unit(unit).group(*name);
        columns.push(number("median"));
        if has_interval {
            columns.extend([number("from"), number("to")]);
        }
        columns.extend(is_timed.then(|| Column::numbers("time to fit").unit("µs").group(*name)));
    }
    let of = |fit: &str, name: &str| own.iter().find(|o| o.fit == fit && o.name == name);
    let least = |name: &str, value: fn(&Object) -> Option<f64>| {
        let own = own.iter().filter(|object| object.name == name);
        own.filter_map(|object| value(object)).fold(f64::INFINITY, f64::min)
    };
    let row = |fit: &&str| {
        let mut row = vec![Cell::from(*fit)];
        for name in &names {
            let object = of(fit, name);
            let number = |value: fn(&Object) -> Option<f64>, digits: Digits| {
                Cell::number(object.and_then(|object| value(object)), digits)
            };
            let cell = |value: fn(&Object) -> Option<f64>, digits: Digits| {
                let known = object.and_then(|object| value(object));
                let is_best = known.is_some_and(|known| known <= least(name, value) * (1.0 + EQUAL));
                number(value, digits).best(is_best)
            };
            row.push(cell(|object| object.error.map(|told| told.quantiles.median), Fixed(places)));
            if has_interval {
                row.push(number(|object| Some(object.error?.interval?.low), Fixed(places)));
                row.push(number(|object| Some(object.error?.interval?.high), Fixed(places)));
            }
            row.extend(is_timed.then(|| cell(|object| object.seconds.map(|seconds| 1e6 * seconds), Significant(3))));
        }
        row
    };
    let (name, times) = match is_first {
        true => ("objects".to_string(), if is_timed { ", and the median time" } else { "" }),
        false => (format!("objects-{quantity}"), ""),
    };
    let interval = if has_interval { " with its interval of 95 %" } else { "" };
    let title = format!("Each fit on each object: the median {heading} over all cases{interval}{times}");
    Table::new(&name, title, columns, fits.iter().map(row))
}

/// The keys of cases, in the order of tables.
const KEYS: [&str; 10] =
    ["scene", "element", "law", "plane", "poisson", "count", "family", "distortion", "aspect", "seed"];

/// The keys whose values differ among cases.
fn varied(cases: &[CaseSummary]) -> Vec<&str> {
    let mut keys: Vec<&str> = Vec::new();
    for key in KEYS {
        let values: Vec<Option<&Value>> = cases.iter().map(|case| case.settings.get(key)).collect();
        if values.iter().any(|value| *value != values[0]) {
            keys.push(key);
        }
    }
    keys
}

fn cases(summary: &Summary) -> Table {
    let keys = varied(&summary.cases);
    let methods = || summary.cases.iter().flat_map(|case| &case.methods);
    let has =
        |list: fn(&MethodSummary) -> &BTreeMap<String, Told>, name: &str| methods().any(|m| list(m).contains_key(name));
    let told: Vec<&Quantity> = TOLD.iter().filter(|told| has(|m| &m.values, told.quantity)).collect();
    let times: Vec<_> = TIMES.iter().filter(|(kind, ..)| has(|m| &m.times, kind)).collect();
    let figures: Vec<_> = FIGURES
        .iter()
        .filter(|(name, ..)| methods().any(|m| m.figures.get(*name).is_some_and(Option::is_some)))
        .collect();
    let has_interval =
        |quantity: &str| methods().any(|m| m.values.get(quantity).is_some_and(|told| told.interval.is_some()));
    let has_negative = methods().any(|m| m.values.contains_key("negative"));
    let has_gap = methods().any(|m| m.values.contains_key("gap"));
    let is_copied = methods().any(|m| m.copied > 0);
    let is_refused = methods().any(|m| m.refused.is_some()) || summary.cases.iter().any(|case| case.error.is_some());
    let mut columns: Vec<Column> = keys.iter().map(|key| Column::words(*key).priority(Always)).collect();
    columns.extend([Column::words("fit").priority(Always), Column::words("solver")]);
    for (_, heading, unit, _) in &times {
        let column = |title| Column::numbers(title).unit(unit).group(*heading);
        columns.extend([column("median").priority(Always), column("least")]);
    }
    for told in &told {
        let column = |title| Column::numbers(title).unit(told.unit).group(told.heading);
        columns.push(column("median").priority(Always));
        if has_interval(told.quantity) {
            columns.extend(["from", "to"].map(|title| column(title).priority(Always)));
        }
        columns.extend([column("mean"), column("max")]);
    }
    columns.extend(has_gap.then(|| Column::numbers("gap max")));
    columns.extend(has_negative.then(|| Column::numbers("k < 0").unit("%").priority(Always)));
    columns.extend(figures.iter().map(|(_, heading, unit, ..)| Column::numbers(*heading).unit(unit)));
    columns.extend(is_copied.then(|| Column::numbers("copied")));
    columns.extend(is_refused.then(|| Column::sentences("why not").priority(Always)));
    let mut rows = Vec::new();
    for case in &summary.cases {
        let best = Best::of(case);
        let words = |key: &&str| case.settings.get(*key).map_or(Cell::from("-"), |value| plain(value).as_str().into());
        let named: Vec<Cell> = keys.iter().map(words).collect();
        if let Some(error) = &case.error {
            let mut row = named;
            row.resize(columns.len() - 1, Cell::from("-"));
            row.push(error.as_str().into());
            rows.push(row);
            continue;
        }
        for method in &case.methods {
            let mut row = named.clone();
            let solver = method.settings.get("solver").and_then(Value::as_str).unwrap_or("-");
            row.extend([Cell::from(method.fit.as_str()), solver.into()]);
            for (kind, _, _, factor) in &times {
                let told = method.times.get(*kind);
                let cell =
                    |value: fn(&Told) -> f64| Cell::number(told.map(|told| factor * value(told)), Significant(3));
                row.push(cell(|told| told.quantiles.median).best(best.is(kind, told)));
                row.push(cell(|told| told.quantiles.least));
            }
            for Quantity { quantity, places, .. } in &told {
                let told = method.values.get(*quantity);
                let cell = |value: fn(&Told) -> f64| Cell::number(told.map(value), Fixed(*places));
                row.push(cell(|told| told.quantiles.median).best(best.is(quantity, told)));
                if has_interval(quantity) {
                    let ends = told.and_then(|told| told.interval);
                    let ends = [ends.map(|ends| ends.low), ends.map(|ends| ends.high)];
                    row.extend(ends.map(|end| Cell::number(end, Fixed(*places))));
                }
                row.extend([cell(|told| told.quantiles.mean), cell(|told| told.quantiles.largest)]);
            }
            if has_gap {
                let gap = method.values.get("gap").map(|told| told.quantiles.largest);
                row.push(gap.map_or(Cell::from("-"), |gap| format!("{gap:.1e}").into()));
            }
            if has_negative {
                let springs = method.figures.get("springs").copied().flatten();
                let share =
                    method.values.get("negative").zip(springs).map(|(told, all)| told.quantiles.mean / all.max(1.0));
                row.push(Cell::percent(share, Fixed(1)));
            }
            for (name, _, _, factor, places) in &figures {
                let figure = method.figures.get(*name).copied().flatten();
                row.push(Cell::number(figure.map(|figure| factor * figure), Fixed(*places)));
            }
            row.extend(is_copied.then(|| method.copied.into()));
            row.extend(is_refused.then(|| method.refused.as_deref().unwrap_or("").into()));
            rows.push(row);
        }
    }
    Table::new("comparison", title(summary, &keys), columns, rows).with_notes(notes(summary))
}

/// The title of the table of cases: what all of them share.
fn title(summary: &Summary, varied: &[&str]) -> String {
    let Some(case) = summary.cases.first() else { return "Cases".into() };
    let word = |key: &&str| {
        let value = case.settings.get(*key).filter(|_| !varied.contains(key)).map(plain)?;
        Some(match *key {
            "element" | "scene" | "law" => value,
            "poisson" => format!("nu = {value}"),
            "count" if value == "1" => "1 shape".into(),
            "count" => format!("{value} shapes"),
            key => format!("{key} {value}"),
        })
    };
    let shared: Vec<String> = KEYS.iter().filter_map(word).collect();
    let cases = (summary.cases.len() > 1).then(|| format!("{} cases", summary.cases.len()));
    cases.into_iter().chain(shared).collect::<Vec<_>>().join(", ")
}

fn notes(summary: &Summary) -> Vec<String> {
    let methods = || summary.cases.iter().flat_map(|case| &case.methods);
    let interval = "From and to are the ends of the bootstrap interval of the median, 95 %.";
    let times = "Times are processor times of one thread for each element that is fitted, in passes that take turns.";
    let second = "A simulated second is one of explicit steps half as long as the longest stable one, and of a fit with an engine one of the steps of that \
                  engine, made by this program on one thread.";
    let has_second = methods().any(|method| method.times.contains_key("simulated-second"));
    let notes = [
        (
            methods().any(|m| TOLD.iter().any(|t| m.values.get(t.quantity).is_some_and(|t| t.interval.is_some()))),
            interval,
        ),
        (methods().any(|method| !method.times.is_empty()), times),
        (has_second, second),
    ];
    notes.into_iter().filter(|(is_told, _)| *is_told).map(|(_, words)| words.to_string()).collect()
}

/// The least medians of a case.
struct Best(BTreeMap<String, f64>);

impl Best {
    fn of(case: &CaseSummary) -> Best {
        let mut least: BTreeMap<String, f64> = BTreeMap::new();
        for (name, told) in case.methods.iter().flat_map(|method| method.values.iter().chain(&method.times)) {
            let known = least.entry(name.clone()).or_insert(f64::INFINITY);
            *known = known.min(told.quantiles.median);
        }
        Best(least)
    }

    fn is(&self, name: &str, told: Option<&Told>) -> bool {
        told.is_some_and(|told| self.0.get(name).is_some_and(|least| told.quantiles.median <= *least * (1.0 + EQUAL)))
    }
}

/// A value without the quotes of a text.
pub(super) fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), String::from)
}

fn pairs(pairs: &[Pair]) -> Table {
    let number = |value: f64| Cell::number(Some(value), Significant(4));
    let ratio = |title| Column::numbers(title).group("first / second");
    let better = |pair: &Pair| match pair.verdict {
        Verdict::First => pair.first.clone(),
        Verdict::Second => pair.second.clone(),
        Verdict::Tie => "tie".into(),
        Verdict::TooFew => "too few pairs".into(),
    };
    let notes = [
        "Errors: the median ratio of the first to the second on the same shapes or loads, its bootstrap interval of 95 %, and the probability \
         of Wilcoxon's signed-rank test after Holm's correction for all pairs of the quantity; a tie where the interval has 1 or that is above 0.05. \
         Errors below 1e-12 count as 1e-12.",
        "Times: a tie where medians differ by less than 10 % or the interval of their ratio has 1 on some case, or cases disagree.",
    ];
    let table = Table::of(
        "pairs",
        "Methods in pairs",
        pairs,
        &[
            (Column::words("quantity"), &|pair| pair.quantity.as_str().into()),
            (Column::words("first").priority(Always), &|pair| pair.first.as_str().into()),
            (Column::words("second").priority(Always), &|pair| pair.second.as_str().into()),
            (Column::numbers("pairs"), &|pair| pair.paired.count.into()),
            (Column::numbers("first wins"), &|pair| pair.paired.wins.into()),
            (Column::numbers("second wins"), &|pair| pair.paired.losses.into()),
            (ratio("median").priority(Always), &|pair| number(pair.paired.ratio)),
            (ratio("from"), &|pair| number(pair.paired.interval.low)),
            (ratio("to"), &|pair| number(pair.paired.interval.high)),
            (Column::numbers("p").priority(Always), &|pair| Cell::number(pair.adjusted, Significant(2))),
            (Column::words("better").priority(Always), &|pair| better(pair).into()),
        ],
    );
    table.with_notes(notes.map(String::from))
}

fn ranks(summary: &Summary) -> Table {
    let columns =
        vec![Column::words("quantity"), Column::words("fit"), Column::numbers("mean rank"), Column::numbers("cases")];
    let mut sorted: Vec<_> = summary.ranks.iter().filter(|rank| rank.rank.is_some()).collect();
    sorted.sort_by(|a, b| {
        (&a.quantity, a.rank.unwrap_or(0.0))
            .partial_cmp(&(&b.quantity, b.rank.unwrap_or(0.0)))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let row = |rank: &&super::pairs::Rank| {
        vec![
            Cell::from(rank.quantity.as_str()),
            rank.fit.as_str().into(),
            Cell::number(rank.rank, Fixed(2)),
            format!("{} of {}", rank.cases, rank.of).as_str().into(),
        ]
    };
    let title = "Mean ranks over the cases in which all have figures, by the median; 1 is the least error";
    Table::new("ranks", title, columns, sorted.iter().map(row))
}
