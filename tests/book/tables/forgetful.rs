//! The errors of springs that forget, beside closed forms.

use super::markdown;
use crate::prony::{creep_error, shear_errors};

/// Each number of steps in 2 τ: the errors of shear to 600 %, and that of creep during 2.5 τ.
pub fn table() -> String {
    let row = |steps: usize| {
        let [shear, normal] = shear_errors(steps);
        let creep = creep_error(2.0 / steps as f64);
        let number = |error: f64| if error < 1e-12 { "rounding".to_string() } else { format!("{error:.1e}") };
        let numbers = [shear, normal, creep].map(number);
        [vec![steps.to_string(), format!("{}", 2.0 / steps as f64)], numbers.to_vec()].concat()
    };
    let rows: Vec<Vec<String>> = [20, 50, 100, 200, 400, 1000].map(row).to_vec();
    markdown(&["steps in 2 τ", "h/τ", "shear stress", "first normal stress difference", "creep of a bar"], &rows)
}
