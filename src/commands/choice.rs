//! Choices as values of options.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use springfit_report::report::Choice;

/// The parser of an option whose values are choices, which help lists with their sentences.
pub fn choice<C: Choice>() -> impl TypedValueParser<Value = C> {
    let value = |(_, names, sentence): &(C, &'static [&'static str], &'static str)| {
        PossibleValue::new(names[0]).aliases(names[1..].iter().copied()).help(sentence.trim().trim_end_matches('.'))
    };
    let of_name = |name: String| {
        let row = C::ALL.iter().find(|(_, names, _)| names.contains(&name.as_str()));
        row.expect("the parser knows the names").0
    };
    PossibleValuesParser::new(C::ALL.iter().map(value)).map(of_name)
}
