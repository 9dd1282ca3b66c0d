//! Closed forms: against the numerical fits of every element, the matrix of the paper, and published formulas.

use crate::shapes::{elements, loaded};
use num_rational::BigRational;
use num_traits::ToPrimitive;
use springfit_element::element::Element;
use springfit_element::material::{Hooke, Material, Moduli, Stiffness};
use springfit_element::springs::Springs;
use springfit_fit::fit::{ClosedForm, ExactFit, Fit, Higher, Objective, Weight, fit_element, fit_exact};
use springfit_foundation::symbolic::Scope;
use std::process::Command;

fn ratio(above: i64, below: i64) -> BigRational {
    BigRational::new(above.into(), below.into())
}

fn form(name: &str, groups: Option<&[String]>, sides: bool) -> ClosedForm {
    let element = loaded(name);
    let springs = Springs::select(&element, groups).unwrap();
    ClosedForm::new(&element, &springs, sides).unwrap()
}

/// At random lengths, with and without the spring on the content; formulas and numbers agree to the numbers' rounding.
#[test]
fn formulas_agree_with_the_numerical_fits() {
    let lengths = [ratio(7, 5), ratio(9, 4), ratio(4, 7), ratio(1, 3)];
    let (mut seen, moduli) = (0, Moduli { lambda: 0.7, mu: 1.3 });
    // Larger ones take up to a minute, and large ones one fit.
    for element in elements().into_iter().filter(|e| e.nodes() <= 6 || e.cell.corners().len() == e.nodes()) {
        let d = element.dimension();
        let every: Vec<String> = element.springs.iter().map(|g| g.name.clone()).collect();
        for groups in [None, Some(&every[..])] {
            if element.nodes() > 4 && groups.is_some() {
                continue;
            }
            let springs = Springs::select(&element, groups).unwrap();
            let Ok(form) = ClosedForm::new(&element, &springs, true) else { continue };
            let at = [&lengths[..d], &lengths[3..]].concat();
            let number = |f: &springfit_foundation::symbolic::Fraction| f.evaluate(&at).unwrap().to_f64().unwrap();
            let x: Vec<f64> = form.positions.iter().map(number).collect();
            for weight in [Weight::None, Weight::OffDiagonal, Weight::Modal(Higher::new(0.5).unwrap())] {
                if element.nodes() > 4 && weight != Weight::None {
                    continue;
                }
                let expected =
                    fit_element(&element, &springs, &x, moduli, &Fit::new(Objective::Frobenius(weight))).unwrap();
                let fit = form.fit(weight).unwrap();
                for (class, constants) in form.classes.iter().zip(&fit.constants) {
                    let k = 0.7 * number(&constants[0]) + 1.3 * number(&constants[1]);
                    for nodes in &class.springs {
                        let s = springs.pairs().iter().position(|p| p[..] == nodes[..]).unwrap_or(springs.len() - 1);
                        let error = (k - expected[s]).abs();
                        assert!(
                            error < 1e-11 * (1.0 + k.abs()),
                            "{} {weight:?} {nodes:?}: {k} {}",
                            element.name,
                            expected[s]
                        );
                    }
                }
                seen += 1;
            }
        }
    }
    assert!(seen > 25, "{seen}");
}

/// Springs on angles, on areas in space and on expressions with one root have no roots in `g gᵀ`: at random lengths, under every weight, the
/// formulas are the numbers of the fits, to 1e-11 of the largest.
#[test]
fn formulas_of_springs_on_functions_agree_with_the_numerical_fits() {
    let lengths = [ratio(7, 5), ratio(9, 4), ratio(4, 7), ratio(1, 3)];
    let shipped =
        |name: &str| std::fs::read_to_string(format!("{}/elements/{name}.toml", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let angles = |nodes: &str| format!("\n[[springs]]\ngroup = \"angle\"\nkind = \"angle\"\nnodes = {nodes}\n");
    let faces = "\n[[springs]]\ngroup = \"face\"\nkind = \"area\"\nnodes = [[0, 1, 2], [0, 1, 3]]\n";
    let height = "\n[[springs]]\ngroup = \"height\"\nkind = \"measure\"\nmeasure = \"3*sqrt(2*(x1 - x0)^2 + 2*(y1 - y0)^2)\"\n\
                  nodes = [[0, 2]]\n";
    let ring = angles("[[3, 0, 1], [0, 1, 2], [1, 2, 3], [2, 3, 0]]");
    let texts = [
        ("quad4", ring.clone(), 4),
        ("tri3", angles("[[0, 1, 2]]"), 4),
        ("tet4", angles("[[1, 0, 2]]") + faces, 5),
        ("wedge6", angles("[[0, 1, 2], [0, 3, 5], [0, 4, 1]]"), 5),
        ("quad4", ring + height, 5),
    ];
    let moduli = Moduli { lambda: 0.7, mu: 1.3 };
    let mut compared = 0;
    for (name, more, least) in texts {
        let element = Element::parse(&(shipped(name) + &more)).unwrap();
        let springs = Springs::select(&element, None).unwrap();
        let form = ClosedForm::new(&element, &springs, true).unwrap();
        assert!(form.classes.len() >= least, "{name}: {}", form.classes.len());
        let at = [&lengths[..element.dimension()], &lengths[3..]].concat();
        let number = |f: &springfit_foundation::symbolic::Fraction| f.evaluate(&at).unwrap().to_f64().unwrap();
        let x: Vec<f64> = form.positions.iter().map(number).collect();
        for weight in [Weight::None, Weight::OffDiagonal, Weight::Modal(Higher::new(0.5).unwrap())] {
            let Ok(fit) = form.fit(weight) else { continue };
            let numbers = fit_element(&element, &springs, &x, moduli, &Fit::new(Objective::Frobenius(weight))).unwrap();
            let size = numbers.iter().fold(0.0f64, |size, k| size.max(k.abs()));
            for (class, constants) in form.classes.iter().zip(&fit.constants) {
                let k = moduli.lambda * number(&constants[0]) + moduli.mu * number(&constants[1]);
                for &place in &class.places {
                    assert!((k - numbers[place]).abs() < 1e-11 * size, "{name} {weight:?} {}: {k}", class.group);
                }
            }
            compared += 1;
        }
    }
    assert!(compared >= 12, "{compared}");
    // On the square the corners share what the shear has over that of the diagonals.
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/elements/quad4_angles.toml");
    let (code, text, _) = derive(&[path]);
    assert_eq!(code, Some(0));
    for line in
        ["  angle 3-0-1 and 3 more like it", "    k = -19/39*lambda + 3/13*mu", "  |R-K|/|R| = 0.094898 at nu = 0.3"]
    {
        assert!(text.lines().any(|l| l == line), "{line}\n{text}");
    }
}

/// With numbers of any orthotropic material they are its numerical fits, and with those of an isotropic one the isotropic formulas.
#[test]
fn orthotropic_formulas_agree_with_numerical_fits_and_isotropic_formulas() {
    let lengths = [ratio(7, 5), ratio(9, 4), ratio(4, 7), ratio(1, 3)];
    for (name, with_bulk) in [
        ("bar2", false),
        ("tri3", true),
        ("quad4", false),
        ("quad4", true),
        ("tet4", true),
        ("wedge6", false),
        ("hex8", false),
    ] {
        let element = loaded(name);
        let d = element.dimension();
        let every: Vec<String> = element.springs.iter().map(|g| g.name.clone()).collect();
        let springs = Springs::select(&element, with_bulk.then_some(&every[..])).unwrap();
        let form = ClosedForm::orthotropic(&element, &springs, true).unwrap();
        let isotropic = ClosedForm::new(&element, &springs, true).unwrap();
        let names: Vec<&str> = form.moduli.iter().map(|modulus| &modulus.name[..]).collect();
        // With λ = 1, with μ = 1, and of an orthotropic material.
        let (expected, values): (&[&str], [&[i64]; 3]) = match d {
            1 => (&["C11"], [&[1], &[2], &[5]]),
            2 => (&["C11", "C12", "C22", "C66"], [&[1, 1, 1, 0], &[2, 0, 2, 1], &[7, 2, 3, 4]]),
            _ => (
                &["C11", "C12", "C13", "C22", "C23", "C33", "C44", "C55", "C66"],
                [&[1, 1, 1, 1, 1, 1, 0, 0, 0], &[2, 0, 0, 2, 0, 2, 1, 1, 1], &[9, 2, 1, 6, 3, 8, 2, 5, 4]],
            ),
        };
        assert_eq!(names, expected);
        let strains = d * (d + 1) / 2;
        let mut entries = vec![0.0; strains * strains];
        for (modulus, value) in form.moduli.iter().zip(values[2]) {
            let digit = |i: usize| modulus.name.as_bytes()[i] as usize - b'1' as usize;
            let [i, j] = [digit(1), digit(2)].map(|i| if d == 2 && i == 5 { 2 } else { i });
            (entries[i * strains + j], entries[j * strains + i]) = (*value as f64, *value as f64);
        }
        let hooke = Hooke::Anisotropic(Stiffness::new(d, &entries).unwrap());
        let at = [&lengths[..d], &lengths[3..]].concat();
        let exact = |f: &springfit_foundation::symbolic::Fraction| f.evaluate(&at).unwrap();
        let x: Vec<f64> = form.positions.iter().map(|f| exact(f).to_f64().unwrap()).collect();
        for weight in [Weight::None, Weight::OffDiagonal, Weight::Modal(Higher::new(0.5).unwrap())] {
            let numbers =
                fit_element(&element, &springs, &x, hooke.clone(), &Fit::new(Objective::Frobenius(weight))).unwrap();
            let (fit, plain) = (form.fit(weight).unwrap(), isotropic.fit(weight).unwrap());
            let combined = |coefficients: &[springfit_foundation::symbolic::Fraction], values: &[i64]| -> BigRational {
                coefficients.iter().zip(values).map(|(f, value)| exact(f) * ratio(*value, 1)).sum()
            };
            for (class, constants) in form.classes.iter().zip(&fit.constants) {
                let k = combined(constants, values[2]).to_f64().unwrap();
                for nodes in &class.springs {
                    let s = springs.pairs().iter().position(|p| p[..] == nodes[..]).unwrap_or(springs.len() - 1);
                    assert!(
                        (k - numbers[s]).abs() < 1e-12 * (1.0 + k.abs()),
                        "{name} {weight:?} {nodes:?}: {k} {}",
                        numbers[s]
                    );
                    let same = isotropic.classes.iter().position(|class| class.springs.contains(nodes)).unwrap();
                    for (part, values) in plain.constants[same].iter().zip(values) {
                        assert_eq!(combined(constants, values), exact(part), "{name} {weight:?} {nodes:?}");
                    }
                }
            }
            // ‖R − K‖² as a quadratic form, against that of the isotropic formulas at λ = μ = 1.
            let both: Vec<i64> = values[0].iter().zip(values[1]).map(|(a, b)| a + b).collect();
            let products = |values: &[i64]| -> Vec<i64> {
                let of = |i: usize| values[i..].iter().map(move |b| values[i] * b);
                (0..values.len()).flat_map(of).collect()
            };
            assert_eq!(
                combined(&fit.residual, &products(&both)),
                combined(&plain.residual, &[1, 1, 1]),
                "{name} {weight:?}"
            );
        }
    }
    let (code, text, _) = derive(&["quad4", "--orthotropic", "--objective", "offdiag"]);
    assert_eq!(code, Some(0));
    assert!(!text.contains("nu = 0.3") && text.contains("    k = 1/3*C11 - 1/6*C66\n"), "{text}");
    let (code, _, error) = derive(&["tet4", "--orthotropic", "--objective", "exact"]);
    let expected = "error: --objective: expected frobenius or offdiag: exact networks are those of isotropic materials, found exact\n";
    assert_eq!((code, error.as_str()), (Some(2), expected));
}

/// Natsupakpong and Çavuşoğlu (2010), (19), in twelfths of λ and μ, and (27); their nodes run from the upper left clockwise.
#[test]
fn the_square_is_that_of_the_paper() {
    const ROWS: [&[[i64; 2]]; 8] = [
        &[[4, 12], [-3, -3], [-4, -6], [-3, 3], [-2, -6], [3, 3], [2, 0], [3, -3]],
        &[[4, 12], [3, -3], [2, 0], [3, 3], [-2, -6], [-3, 3], [-4, -6]],
        &[[4, 12], [3, 3], [2, 0], [-3, 3], [-2, -6], [-3, -3]],
        &[[4, 12], [3, -3], [-4, -6], [-3, -3], [-2, -6]],
        &[[4, 12], [-3, -3], [-4, -6], [-3, 3]],
        &[[4, 12], [3, -3], [2, 0]],
        &[[4, 12], [3, 3]],
        &[[4, 12]],
    ];
    let form = form("quad4", None, false);
    let at = [ratio(0, 1)];
    let ours = |dof: usize| 2 * (3 - dof / 2) + dof % 2;
    for (i, row) in ROWS.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            let place = ours(i) * 8 + ours(i + j);
            for (part, twelfths) in form.stiffness.iter().zip(entry) {
                assert_eq!(part[place].evaluate(&at).unwrap(), ratio(*twelfths, 12), "R[{i}][{}]", i + j);
            }
        }
    }
    let constants = |weight| -> Vec<Vec<BigRational>> {
        let fit = form.fit(weight).unwrap();
        fit.constants.iter().map(|pair| pair.iter().map(|f| f.evaluate(&at).unwrap()).collect()).collect()
    };
    assert_eq!(constants(Weight::OffDiagonal), [[ratio(1, 3), ratio(1, 2)], [ratio(5, 12), ratio(3, 4)]]);
    // The optimum over all entries is another.
    assert_eq!(constants(Weight::None), [[ratio(5, 21), ratio(4, 7)], [ratio(8, 21), ratio(5, 7)]]);
}

/// `λ = Eν/(1 − ν²)`, `μ = E/(2(1 + ν))` at ν = 1/3 and E = 1.
fn at_one_third(pair: &[springfit_foundation::symbolic::Fraction], lengths: &[BigRational]) -> BigRational {
    let at = [lengths, &[ratio(1, 3)]].concat();
    pair[0].evaluate(&at).unwrap() * ratio(3, 8) + pair[1].evaluate(&at).unwrap() * ratio(3, 8)
}

/// Van Gelder (1998): `k = E/(1+ν) A/c² + Eν/(1−ν²) (a² + b² − c²)/(8A)` is the fit of the blocks of different nodes at
/// ν = 1/3, here for right triangles.
#[test]
fn right_triangles_have_van_gelders_constants() {
    let form = form("tri3", None, true);
    let fit = form.fit(Weight::OffDiagonal).unwrap();
    for (a, b) in [(ratio(1, 1), ratio(1, 1)), (ratio(7, 5), ratio(2, 9)), (ratio(3, 1), ratio(10, 7))] {
        let legs = [&a * &a, &b * &b];
        let area = &a * &b / ratio(2, 1);
        let all = &legs[0] + &legs[1];
        for (class, pair) in form.classes.iter().zip(&fit.constants) {
            let square = match class.springs[0][..] {
                [0, 1] => legs[0].clone(),
                [2, 0] => legs[1].clone(),
                _ => all.clone(),
            };
            let others = (&all + &legs[0] + &legs[1]) - &square;
            let first = ratio(3, 4) * &area / &square;
            let second = ratio(3, 8) * (others - &square) / (ratio(8, 1) * &area);
            assert_eq!(at_one_third(pair, &[a.clone(), b.clone()]), first + second, "{:?}", class.springs[0]);
        }
    }
}

/// Lloyd et al. (2007): 5/16 and 7/16 of E h for the square at ν = 1/3; over all entries it is 17/56 and 23/56.
#[test]
fn squares_have_lloyds_constants() {
    let form = form("quad4", None, true);
    let one = [ratio(1, 1), ratio(1, 1)];
    for (weight, edge, diagonal) in
        [(Weight::OffDiagonal, ratio(5, 16), ratio(7, 16)), (Weight::None, ratio(17, 56), ratio(23, 56))]
    {
        let fit = form.fit(weight).unwrap();
        let found: Vec<BigRational> = fit.constants.iter().map(|pair| at_one_third(pair, &one)).collect();
        assert_eq!(found, [edge.clone(), edge, diagonal]);
    }
}

/// Baudet et al. on l × h: `k_l = E (h² (3ν+2) − l²)/(4lh(1+ν))`, `k_d = E (l² + h²)/(4lh(1+ν))`. They hold E and G for every
/// ν, and the whole stiffness of the strains at ν = 1/3, where the fit of the strains alone gives them.
#[test]
fn rectangles_have_baudets_constants() {
    let form = form("quad4", None, true);
    // The scale of the other motions counts by its square: far below the rounding of what is compared.
    let fit = form.fit(Weight::Modal(Higher::new(1e-12).unwrap())).unwrap();
    for (l, h) in [(ratio(1, 1), ratio(1, 1)), (ratio(7, 5), ratio(2, 3)), (ratio(1, 2), ratio(9, 7))] {
        let (ll, hh, below) = (&l * &l, &h * &h, &l * &h * ratio(16, 3));
        let expected = [(ratio(3, 1) * &hh - &ll) / &below, (ratio(3, 1) * &ll - &hh) / &below, (&ll + &hh) / &below];
        let found: Vec<BigRational> =
            fit.constants.iter().map(|pair| at_one_third(pair, &[l.clone(), h.clone()])).collect();
        let near = |a: &BigRational, b: &BigRational| (a - b).to_f64().unwrap().abs() < 1e-15;
        assert!(found.iter().zip(&expected).all(|(a, b)| near(a, b)), "{l} × {h}");
    }
}

fn derive(arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_springfit")).arg("derive").args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[test]
fn the_command_prints_formulas_and_refuses_what_has_none() {
    let (code, text, _) = derive(&["quad4", "--plane", "strain", "--matrix"]);
    assert_eq!(code, Some(0));
    for line in [
        "  R[1][0] = 1/4*lambda + 1/4*mu",
        "    k = 5/12*lambda + 3/4*mu",
        "      = E*(9 - 8*nu)/(24*(1 + nu)*(1 - 2*nu))",
        "  |R-K|^2 = 29/18*lambda^2 - 8/3*lambda*mu + 3/2*mu^2",
        "  |R-K|/|R| = 0.173205 at nu = 0.3",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}\n{text}");
    }
    let (_, text, _) = derive(&["tri3", "--sides", "--latex"]);
    let line =
        "  k_{\\text{edge 2-0}} &= \\frac{a}{2 b} \\lambda + \\frac{a}{b} \\mu = \\frac{a E}{2 b (1+\\nu) (1-\\nu)}";
    assert!(text.lines().any(|l| l.trim_end_matches(" \\\\") == line), "{line}\n{text}");
    let (_, text, _) = derive(&["bar2", "--sides"]);
    assert!(text.contains("= E/a\n"), "{text}");
    for (arguments, error) in [
        (&["hex8", "--plane", "stress"][..], "--plane: expected a plane element, found hex8"),
        (
            &["quad4", "--springs", "edges"],
            "--springs: expected groups of quad4: \"edge\", \"diagonal\", \"bulk\", found \"edges\"; did you mean \"edge\"?",
        ),
        (
            &["pentagon5"],
            "pentagon5 has no closed form: its shape functions are not rational, or no rule integrates them exactly",
        ),
    ] {
        assert_eq!(derive(arguments), (Some(2), String::new(), format!("error: {error}\n")));
    }
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/elements/");
    for (file, why) in [
        ("tri3_coupled", "what its springs \"corner\" measure needs roots, or has no gradient on this shape"),
        (
            "hex8_selective",
            "closed forms are those of exact integration, and the quadrature of the file is another one; with more points it is exact",
        ),
    ] {
        let (code, _, error) = derive(&[&format!("{example}{file}.toml")]);
        assert_eq!((code, error), (Some(2), format!("error: {file} has no closed form: {why}\n")));
    }
}

/// What is printed in E and ν is what is printed in λ and μ: both texts are read as expressions.
/// A group whose name ends in a digit is no part of the numbers of its nodes.
#[test]
fn names_that_end_in_a_digit_are_separated_from_nodes() {
    let (_, text, _) = derive(&["quad8", "--objective", "offdiag"]);
    assert!(text.contains("  mid-mid 1: 4-5 and 3 more like it\n") && text.contains("  edge 0-1 and"), "{text}");
    let (_, text, _) = derive(&["quad8", "--objective", "offdiag", "--latex"]);
    assert!(text.contains(r"k_{\text{mid-mid 2: 4-6}} &=") && text.contains(r"k_{\text{edge 0-1}} &="), "{text}");
}

#[test]
fn constants_in_engineering_moduli_are_those_in_lame_s() {
    let names = ["a", "b", "c", "E", "nu", "lambda", "mu"];
    let value = |text: &str, moduli: [f64; 2]| {
        let expression = Scope::new(&names).expression(text).unwrap();
        expression.evaluate(&[1.3, 0.7, 2.1, 2.0, 0.3, moduli[0], moduli[1]])
    };
    let [young, nu] = [2.0, 0.3];
    let mu = young / (2.0 * (1.0 + nu));
    let mut compared = 0;
    for (element, plane, moduli) in [
        ("bar2", None, [0.0, young / 2.0]),
        ("bar3", None, [0.0, young / 2.0]),
        ("tri3", Some("stress"), [young * nu / (1.0 - nu * nu), mu]),
        ("quad4", Some("stress"), [young * nu / (1.0 - nu * nu), mu]),
        ("quad4", Some("strain"), [young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), mu]),
        ("tet4", None, [young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), mu]),
    ] {
        let plane: Vec<&str> = plane.into_iter().flat_map(|plane| ["--plane", plane]).collect();
        let (_, text, _) = derive(&[&[element, "--sides"], &plane[..]].concat());
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        for pair in lines.windows(2) {
            if let (Some(lame), Some(engineering)) = (pair[0].strip_prefix("k = "), pair[1].strip_prefix("= ")) {
                let [a, b] = [value(lame, moduli), value(engineering, moduli)];
                assert!((a - b).abs() < 1e-12 * a.abs(), "{element}: {lame} is {a}, {engineering} is {b}");
                compared += 1;
            }
        }
    }
    assert!(compared > 30, "{compared}");
}

/// The closed forms of exact networks are those that the numerical network has on the stretched cell, and their sum with the
/// content is known: on a rectangle a × b, `μ (b/(3 a) − a/(6 b))` along a.
#[test]
fn formulas_of_exact_networks_agree_with_their_numbers() {
    let lengths = [ratio(7, 5), ratio(9, 4), ratio(4, 7), ratio(1, 3)];
    for name in ["bar2", "tri3", "tri6", "quad4", "tet4", "hex8", "wedge6"] {
        let element = loaded(name);
        let d = element.dimension();
        let form = form(name, None, true);
        let at = [&lengths[..d], &lengths[3..]].concat();
        let number = |f: &springfit_foundation::symbolic::Fraction| f.evaluate(&at).unwrap().to_f64().unwrap();
        let x: Vec<f64> = form.positions.iter().map(number).collect();
        let exact = form.exact();
        let material = Material::for_body(d, 2.0, 0.25, None, None).unwrap();
        let mu = material.moduli().mu;
        let cell: Vec<usize> = (0..element.nodes()).collect();
        let fits = fit_exact(&element, &x, &cell, material, &ExactFit::default(), &mut |_| {}).unwrap();
        let mut pairs = 0;
        for (class, constant) in &exact.pairs {
            for nodes in &class.springs {
                let spring = fits.springs.pairs().iter().position(|pair| pair[..] == nodes[..]).unwrap();
                let found = fits.constants[spring];
                assert!((mu * number(constant) - found).abs() < 1e-13 * mu, "{name} {nodes:?}: {found}");
                pairs += 1;
            }
        }
        assert_eq!(pairs, fits.springs.pairs().len(), "{name}");
        if name == "quad4" {
            let (a, b) = (7.0 / 5.0, 9.0 / 4.0);
            assert!((number(&exact.pairs[0].1) - (b / (3.0 * a) - a / (6.0 * b))).abs() < 1e-15);
            assert!((number(&exact.content) - a * b).abs() < 1e-14);
        }
    }
    let (code, text, _) = derive(&["quad4", "--objective", "exact"]);
    assert_eq!(code, Some(0));
    for line in [
        "    k = 1/6*mu",
        "    k = 1/3*mu",
        "  area V_q = w_q |J_q| at each of 4 quadrature points; their sum is 4",
        "    k = (lambda + mu)/V_q, rest area (1 + mu/(lambda + mu))*V_q",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}\n{text}");
    }
    assert!(!text.contains("frobenius"), "{text}");
    let (_, text, _) = derive(&["tet4", "--objective", "exact", "--latex"]);
    assert!(text.contains("k_{\\text{content}} &= \\frac{\\lambda + \\mu}{V}, \\quad V = \\frac{1}{6}"), "{text}");
    let (code, _, error) = derive(&["tet4", "--objective", "modal"]);
    let expected = "error: --objective: expected exact, frobenius or offdiag; others are solved cell by cell and have no formula here, found \"modal\"\n";
    assert_eq!((code, error.as_str()), (Some(2), expected));
}
