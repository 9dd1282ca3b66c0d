//! Laws of force: their forces, slopes and energies, and the texts that are none.

use springfit_element::springs::Law;

/// Laws with closed forms: the cubic, the exponential, one that pulls only.
#[test]
fn forces_slopes_and_energies_are_those_of_closed_forms() {
    let cubic = Law::parse("k1*s + k3*s^3").unwrap();
    assert!(cubic.is_linear() && cubic.parameters == ["k1", "k3"]);
    let exponential = Law::parse("k*(exp(a*s) - 1)").unwrap();
    assert!(!exponential.is_linear() && exponential.parameters == ["k", "a"]);
    let rope = Law::parse("k*ramp(c - c0)").unwrap();
    assert!(rope.is_linear());
    assert!(!Law::parse("k*s + 1").unwrap().is_linear());
    for (c, rest) in [(1.5f64, 1.0f64), (0.2, 0.25), (3.0, 2.0), (2.0, 2.0)] {
        let s = c / rest - 1.0;
        for (law, p, force, slope, energy) in [
            (
                &cubic,
                [2.0, 3.0],
                2.0 * s + 3.0 * s.powi(3),
                (2.0 + 9.0 * s * s) / rest,
                rest * (s * s + 0.75 * s.powi(4)),
            ),
            (
                &exponential,
                [2.0, 1.5],
                2.0 * ((1.5 * s).exp() - 1.0),
                3.0 * (1.5 * s).exp() / rest,
                rest * 2.0 * (((1.5 * s).exp() - 1.0) / 1.5 - s),
            ),
        ] {
            assert!((law.force(c, rest, &p) - force).abs() < 1e-14 * (1.0 + force.abs()));
            assert!((law.slope(c, rest, &p) - slope).abs() < 1e-14 * slope);
            assert!((law.energy(c, rest, &p) - energy).abs() < 1e-14 * (1.0 + energy));
        }
        let stretched = (c - rest).max(0.0);
        assert!((rope.force(c, rest, &[2.0]) - 2.0 * stretched).abs() < 1e-15);
        assert!((rope.energy(c, rest, &[2.0]) - stretched * stretched).abs() < 1e-15);
    }
}

#[test]
fn texts_that_are_no_law_are_told() {
    let error = |text: &str| Law::parse(text).unwrap_err().to_string();
    assert_eq!(error("3*s"), "force: expected a law with parameters to fit, such as \"k1*s + k3*s^3\", found 3*s");
    assert!(error("k*s +").contains("column 6: expected a number, a name or '(', found the end"));
    assert!(error("k*sinh(s)").contains("found \"sinh(\""));
}
