//! Numbers that documents quote from reports are the reports' own text.

use std::path::Path;

/// What opens a quotation, of a whole file or of some lines of it, before the file's name, and what ends it.
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

/// The lines of `quoted` follow each other in `original`.
fn is_part(quoted: &str, original: &str) -> bool {
    let [quoted, original] = [quoted, original].map(|text| text.trim().lines().collect::<Vec<_>>());
    !quoted.is_empty() && original.windows(quoted.len()).any(|lines| lines == quoted)
}

#[test]
fn documents_quote_reports_word_for_word() {
    let mut quoting = Vec::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut documents = vec![root.join("README.md")];
    for entry in std::fs::read_dir(root.join("docs")).unwrap() {
        documents.push(entry.unwrap().path());
    }
    for document in documents.iter().filter(|d| d.extension().is_some_and(|e| e == "md")) {
        for (file, quoted) in quotations(&std::fs::read_to_string(document).unwrap()) {
            let original = std::fs::read_to_string(root.join(&file)).unwrap();
            assert!(is_part(&quoted, &original), "{} quotes {file} otherwise than it is", document.display());
            quoting.push(document.file_name().unwrap().to_owned());
        }
    }
    for document in ["README.md", "results.md"] {
        assert!(quoting.iter().any(|d| d == document), "{document} quotes nothing");
    }
}

#[test]
fn quotations_are_found() {
    let text = format!("a\n{OPEN}x.md -->\n| 1 |\n{CLOSE}\nb\n{OPEN}y.md -->\n{CLOSE}");
    let found = quotations(&text);
    assert_eq!(found, [("x.md".into(), "| 1 |\n".into()), ("y.md".into(), String::new())]);
}

#[test]
fn parts_are_whole_lines_in_their_order() {
    let original = "a 1\nb 2\nc 3\n";
    assert!(is_part("b 2\nc 3", original) && is_part(original, original));
    for wrong in ["b", "a 1\nc 3", "b 2\na 1", "b 3", ""] {
        assert!(!is_part(wrong, original), "{wrong}");
    }
}
