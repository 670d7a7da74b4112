//! Numbers that documents quote from reports are the reports' own text.

use std::path::Path;

/// What opens a quotation, before the file that it is of, and what ends it.
const OPEN: &str = "<!-- quoted: ";
const CLOSE: &str = "<!-- end of the quotation -->";

/// The quotations of a document: the file, and the text.
fn quotations(text: &str) -> Vec<(String, String)> {
    text.split(OPEN)
        .skip(1)
        .map(|part| {
            let (file, rest) = part.split_once(" -->\n").expect("an opening comment on a line of its own");
            let (quoted, _) = rest.split_once(CLOSE).expect("a closing comment");
            (file.to_owned(), quoted.to_owned())
        })
        .collect()
}

#[test]
fn documents_quote_reports_word_for_word() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut documents = vec![root.join("README.md")];
    for entry in std::fs::read_dir(root.join("docs")).unwrap() {
        documents.push(entry.unwrap().path());
    }
    for document in documents.iter().filter(|d| d.extension().is_some_and(|e| e == "md")) {
        for (file, quoted) in quotations(&std::fs::read_to_string(document).unwrap()) {
            let original = std::fs::read_to_string(root.join(&file)).unwrap();
            assert_eq!(quoted.trim(), original.trim(), "{} quotes {file}", document.display());
        }
    }
}

#[test]
fn quotations_are_found() {
    let text = format!("a\n{OPEN}x.md -->\n| 1 |\n{CLOSE}\nb\n{OPEN}y.md -->\n{CLOSE}");
    let found = quotations(&text);
    assert_eq!(found, [("x.md".into(), "| 1 |\n".into()), ("y.md".into(), String::new())]);
}
