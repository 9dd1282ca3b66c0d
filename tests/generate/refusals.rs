//! Objectives without a direct solution, and other wrong requests.

use springfit_element::element::Element;
use springfit_fit::fit::Weight;
use springfit_foundation::error::ErrorKind;
use springfit_generate::generate::{Program, Recipe, language, language_of};

fn refused(objective: &str, volume: Option<&str>, higher: Option<f64>) -> springfit_foundation::error::Error {
    Recipe::named(objective, volume, higher).unwrap_err()
}

#[test]
fn objectives_without_a_direct_solution_are_refused_with_a_reason() {
    for objective in ["spectral", "divergence", "sampled", "whole", "nonnegative", "maciel-uniform"] {
        let error = refused(objective, None, None);
        assert_eq!(error.kind(), ErrorKind::Unsupported, "{error}");
        let text = error.to_string();
        assert!(text.contains("direct solution") && text.contains(objective), "{text}");
        assert!(
            ["\"offdiag\"", "springfit fit", "\"exact\"", "\"van-gelder\""].iter().any(|way| text.contains(way)),
            "{text}"
        );
    }
    assert_eq!(refused("exact", Some("patches"), None).kind(), ErrorKind::Unsupported);
    assert!(refused("offdig", None, None).to_string().contains("did you mean \"offdiag\"?"));
    assert!(refused("exact", None, Some(0.5)).to_string().contains("higher"));
    assert!(refused("offdiag", Some("cells"), None).to_string().contains("volume"));
    assert!(refused("modal", None, Some(2.0)).to_string().contains("higher"));
    assert!(language("rus").unwrap_err().to_string().contains("did you mean \"rust\"?"));
    assert!(language_of("h").is_ok() && language_of("txt").unwrap_err().to_string().contains("endings"));
    let relative = Recipe::Frobenius(Weight::Relative);
    let element = Element::load("tet4").unwrap();
    assert_eq!(Program::new(&element, None, relative).unwrap_err().kind(), ErrorKind::Unsupported);
}

/// Springs that are dependent, groups that are not there, and functions that need more memory than a shader has.
#[test]
fn wrong_elements_are_refused() {
    let element = Element::load("hex27").unwrap();
    let modal = Recipe::named("modal", None, None).unwrap();
    let program = Program::new(&element, None, modal).unwrap();
    for name in ["wgsl", "glsl", "cuda"] {
        let error = program.print(language(name).unwrap()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Limit, "{error}");
    }
    let groups = ["no such group".to_string()];
    assert!(Program::new(&element, Some(&groups), modal).unwrap_err().to_string().contains("no such group"));
    let exact = Recipe::named("exact", None, None).unwrap();
    assert!(Program::new(&element, Some(&groups), exact).unwrap_err().to_string().contains("springs"));
}
