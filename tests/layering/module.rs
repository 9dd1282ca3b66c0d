//! What one module declares, defines, imports and names.

use super::tokens::{after_block, is_word, tokens};
use std::collections::BTreeSet;

/// One name of a `use` declaration.
#[derive(Debug, PartialEq)]
pub struct Import {
    pub name: String,
    pub path: Vec<String>,
    /// Whether other modules can take the name from here.
    pub public: bool,
}

#[derive(Debug, Default)]
pub struct Module {
    /// `mod x;`
    pub declared: Vec<String>,
    /// `mod x { … }`
    pub inline: Vec<(String, Module)>,
    /// Functions, types, traits, constants and macros.
    pub defined: BTreeSet<String>,
    pub imports: Vec<Import>,
    /// The modules of `use path::*`, and whether they are passed on.
    pub globs: Vec<(Vec<String>, bool)>,
    /// Paths of two names or more outside of `use` declarations.
    pub paths: Vec<Vec<String>>,
    /// Names outside of `use` declarations that are neither methods nor fields.
    pub words: BTreeSet<String>,
}

impl Module {
    pub fn parse(text: &str) -> Module {
        Module::read(&tokens(text))
    }

    fn read(tokens: &[String]) -> Module {
        const DEFINING: [&str; 8] = ["fn", "struct", "enum", "trait", "const", "static", "type", "union"];
        let mut module = Module::default();
        let at = |i: usize| tokens.get(i).map_or("", String::as_str);
        let (mut i, mut depth) = (0, 0);
        while i < tokens.len() {
            let before = if i == 0 { "" } else { at(i - 1) };
            match at(i) {
                "{" => depth += 1,
                "}" => depth -= 1,
                // `use<'a>` is a bound of a type.
                "use" if at(i + 1) != "<" => {
                    let public = before == "pub" || before == ")";
                    i += 1;
                    module.read_use(tokens, &mut i, &[], public);
                }
                "mod" if at(i + 2) == ";" => {
                    module.declared.push(at(i + 1).to_string());
                    i += 2;
                }
                "mod" if at(i + 2) == "{" => {
                    let end = after_block(tokens, i + 2);
                    module.inline.push((at(i + 1).to_string(), Module::read(&tokens[i + 3..end - 1])));
                    i = end - 1;
                }
                "macro_rules" if at(i + 1) == "!" => _ = module.defined.insert(at(i + 2).to_string()),
                word if DEFINING.contains(&word) && depth == 0 && is_word(at(i + 1)) => {
                    module.defined.insert(at(i + 1).to_string());
                }
                word if is_word(word) && before != "." && before != "::" && before != "fn" => {
                    module.words.insert(word.to_string());
                    let mut path = vec![word.to_string()];
                    while at(i + 1) == "::" && is_word(at(i + 2)) {
                        path.push(at(i + 2).to_string());
                        i += 2;
                    }
                    if path.len() > 1 {
                        module.paths.push(path);
                    }
                }
                _ => {}
            }
            i += 1;
        }
        module
    }

    /// Reads the tree of a `use` declaration that begins at `i`, and leaves `i` at the sign that ends it.
    fn read_use(&mut self, tokens: &[String], i: &mut usize, prefix: &[String], public: bool) {
        let mut path = prefix.to_vec();
        while *i < tokens.len() {
            match tokens[*i].as_str() {
                "{" => {
                    while tokens[*i] != "}" {
                        *i += 1;
                        self.read_use(tokens, i, &path, public);
                    }
                    *i += 1;
                    return;
                }
                "*" => self.globs.push((path.clone(), public)),
                "as" => {
                    let name = tokens[*i + 1].clone();
                    let import = self.imports.last_mut().expect("a name comes before its other name");
                    import.name = name;
                    *i += 1;
                }
                "," | "}" | ";" => return,
                "::" => {}
                word => {
                    if word != "self" || path.is_empty() {
                        path.push(word.to_string());
                    }
                    if tokens[*i + 1] != "::" {
                        let name = path.last().expect("a word was read").clone();
                        self.imports.push(Import { name, path: path.clone(), public });
                    }
                }
            }
            *i += 1;
        }
    }
}
