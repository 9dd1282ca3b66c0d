//! Texts that leave their place where a writer forgets what ends it.

/// What a file that is read may have as a name: printable lines.
pub fn printable_lines() -> Vec<String> {
    let texts = [
        "plain",
        "\"quotes\"",
        "'apostrophes'",
        "\"\"\" docstring",
        "''' docstring",
        "back\\slash",
        "ends with \\",
        "ends with blanks after \\  ",
        "trigraph ??/",
        "\\n \\u000a \\x0a",
        "*/ int x; /*",
        "// # % --",
        "#include \"/etc/hostname\"",
        "coding: utf-7 +AAo-import os",
        "vim: set fenc=latin1: coding=latin1",
        "=cmd|' /C calc'!A0",
        "+1+cmd",
        "-2+3",
        "@SUM(A1)",
        " =1+1",
        "'=1",
        "-0.5",
        "1e3",
        "$x$",
        "$$",
        "\\input{/etc/passwd}",
        "\\end{align*}\\input|ls",
        "[2pt]",
        "*",
        "a -- b --- c ''d'' ``e``",
        "^^M ~ ^ _ # % & { }",
        "${x} `y` {0} {{title}}",
        "--> <!-- -- ",
        "]]> <![CDATA[",
        "</script><script>alert(1)</script>",
        "<b>&amp;&lt;</b>",
        "a,b;c\"d",
        "| a | b |",
        "*bold* _it_ snake_case 1*2*3 [l](http://x) ~~s~~ `c`",
        "]\n".trim_end(),
        "[table]",
        "key = 1",
        "ünïcödé 漢字 😀",
        "",
    ];
    texts.map(String::from).into()
}

/// What no name may have, and long texts.
pub fn others() -> Vec<String> {
    let ends = ["\n", "\r\n", "\r", "\u{85}", "\u{2028}", "\u{2029}", "\u{b}", "\u{c}"];
    let codes = ["import os; os.system('echo')", "#error left", "\\input{x}", "int left;"];
    let mut texts: Vec<String> =
        ends.iter().flat_map(|end| codes.map(|code| format!("title{end}{code}{end}"))).collect();
    let marks = ["nul\0", "\u{1b}[31mred\u{7}", "\u{9b}2J", "\u{202e}txt.exe", "del\u{7f}", "tab\tx", "\\\n", "??/\n"];
    texts.extend(marks.map(String::from));
    texts
}

/// A megabyte with something to escape at its end.
pub fn long() -> String {
    "long \\ ".repeat(150_000) + "</x>\"'*/\\"
}

/// All of them.
pub fn every() -> Vec<String> {
    [printable_lines(), others(), vec![long()]].concat()
}
