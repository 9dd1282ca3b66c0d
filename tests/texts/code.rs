//! Generated code and formulas: no title, name or group leaves its comment.

use super::hostile::every;
use super::readers::parsed_by_python;
use springfit_element::element::Element;
use springfit_element::material::Plane;
use springfit_element::springs::Springs;
use springfit_fit::fit::{ClosedForm, Weight};
use springfit_foundation::text::printable;
use springfit_generate::generate::{LANGUAGES, Program, Recipe};
use springfit_report::report::Derivation;
use std::fs;
use std::process::Command;
use tempfile::TempDir;

/// Characters that end a line in one of the languages.
const ENDS: [char; 7] = ['\n', '\r', '\u{b}', '\u{c}', '\u{85}', '\u{2028}', '\u{2029}'];

/// What is outside of comments, without blank lines, and the comments. A backslash or its trigraph at the end of a line takes the next line in, as in C.
fn lexed(text: &str, mark: &str) -> (String, String) {
    let (mut code, mut comments, mut goes_on) = (String::new(), String::new(), false);
    // Most characters are none of these, and a list of characters is searched slowly.
    for line in text.split(|c: char| !(' '..'\u{85}').contains(&c) && ENDS.contains(&c)) {
        let at = if goes_on { Some(0) } else { line.find(mark) };
        let (before, comment) = line.split_at(at.unwrap_or(line.len()));
        let last = comment.trim_end();
        goes_on = mark == "//" && !comment.is_empty() && (last.ends_with('\\') || last.ends_with("??/"));
        if !before.trim().is_empty() {
            code += before.trim_end();
            code.push('\n');
        }
        comments += comment;
        comments.push('\n');
    }
    (code, comments)
}

fn program(change: impl FnOnce(&mut Element)) -> Program {
    let mut element = Element::load("tri3").unwrap();
    change(&mut element);
    Program::new(&element, None, Recipe::named("offdiag", None, None).unwrap()).unwrap()
}

#[test]
fn generated_code_is_the_same_whatever_the_texts_of_the_element() {
    let mut checked = 0;
    let plain = program(|_| ());
    for text in every() {
        let titled = program(|element| {
            element.title.clone_from(&text);
            element.springs.iter_mut().for_each(|group| group.name.clone_from(&text));
        });
        let named = program(|element| element.name.clone_from(&text));
        for language in LANGUAGES {
            let mark = match language.name {
                "python" => "#",
                "latex" => "%",
                _ => "//",
            };
            // The names of functions begin with that of the element.
            let code = |program: &Program| {
                let (code, comments) = lexed(&program.print(language).unwrap(), mark);
                let short = |code: String, prefix: &str| {
                    code.replace(prefix, "NAME").replace(&prefix.replace('_', "\\_"), "NAME")
                };
                (short(short(code, &program.prefix), &program.prefix.to_uppercase()), comments)
            };
            let (expected, _) = code(&plain);
            let shown = printable(&text);
            for (found, begin) in
                [(code(&titled), format!("tri3: {shown}; objective")), (code(&named), format!("{shown}: "))]
            {
                assert_eq!(found.0, expected, "{}: {:?}", language.name, text.get(..40));
                assert!(found.1.contains(&begin), "{}: {text:?} is not in a comment", language.name);
                checked += 1;
            }
        }
    }
    println!("{checked} texts in generated code");
}

/// Compilers read what our own lexer reads. The standard of 1999 has trigraphs.
#[test]
fn compilers_take_generated_code_with_any_title() {
    let folder = TempDir::new().unwrap();
    let (c, python) = (
        springfit_generate::generate::language("c").unwrap(),
        springfit_generate::generate::language("python").unwrap(),
    );
    let mut sources = Vec::new();
    for (i, text) in every().into_iter().enumerate() {
        let program = program(|element| {
            element.title = text.clone();
            element.springs.iter_mut().for_each(|group| group.name.clone_from(&text));
        });
        let path = folder.path().join(format!("{i}.c"));
        fs::write(&path, program.print(c).unwrap()).unwrap();
        sources.push(path);
        fs::write(folder.path().join(format!("{i}.py")), program.print(python).unwrap()).unwrap();
    }
    let output = Command::new("cc").args(["-std=c99", "-fsyntax-only"]).args(&sources).output();
    let output = output.expect("the tests need a C compiler");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // What a file has at its top: an import, a class and five functions.
    parsed_by_python(
        folder.path(),
        "import ast, glob\nfound = {len(ast.parse(open(p, 'rb').read()).body) for p in glob.glob('*.py') if p[0].isdigit()}\n\
         assert len(found) == 1, found",
    );
}

#[test]
fn formulas_in_latex_name_any_group_as_a_text() {
    for text in every() {
        let mut element = Element::load("tri3").unwrap();
        element.title.clone_from(&text);
        element.springs.iter_mut().for_each(|group| group.name.clone_from(&text));
        let springs = Springs::select(&element, None).unwrap();
        let form = ClosedForm::new(&element, &springs, false).unwrap();
        let fits = [form.fit(Weight::OffDiagonal)];
        let derivation = Derivation {
            element: &element,
            form: &form,
            exact: None,
            fits: &fits,
            plane: Some(Plane::Stress),
            matrix: false,
        };
        let (code, comments) = lexed(&derivation.latex().replace("\\%", "PERCENT"), "%");
        assert!(comments.contains(&printable(&text).replace("\\%", "PERCENT")), "{:?}", text.get(..40));
        let group = super::readers::of_latex(&code.replace("PERCENT", "\\%"), "k_{\\text{", " 0-1}} &=");
        // A colon keeps a digit at the end of the name from the numbers of the nodes.
        let colon = if printable(&text).ends_with(|c: char| c.is_ascii_digit()) { ":" } else { "" };
        assert_eq!(group, Some(format!("{}{colon}", printable(&text))), "{code}");
    }
}
