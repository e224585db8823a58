//! Suggestions for misspelled words on the command line and in scene files, selections and scripts.

/// Maximum length of compared words in bytes: the time is the product of their lengths.
const COMPARED: usize = 64;
/// Maximum number of words in a message.
const LISTED: usize = 32;

/// Returns the known word nearest to `word`, if one differs only in case or by few letters.
pub fn nearest<'w>(word: &str, known: impl IntoIterator<Item = &'w str>) -> Option<&'w str> {
    if word.is_empty() || word.len() > COMPARED {
        return None;
    }
    let lower = word.to_lowercase();
    let near = known.into_iter().filter(|candidate| candidate.len() <= COMPARED);
    // Two edits in five letters allow a swap or two typos, but not another word. Words of one
    // letter are all near each other.
    let near = near.filter_map(|candidate| {
        let edits = strsim::damerau_levenshtein(&lower, &candidate.to_lowercase());
        let length = candidate.chars().count();
        let close = edits < length && edits * 10 <= length.max(3) * 4;
        close.then_some((edits, candidate))
    });
    near.min_by_key(|(edits, _)| *edits).map(|(_, candidate)| candidate)
}

/// Returns the known words that differ from `word` only in case; none if `word` is known itself.
pub fn other_case<'w>(word: &str, known: impl IntoIterator<Item = &'w str>) -> Vec<&'w str> {
    let mut found = Vec::new();
    for candidate in known {
        if candidate == word {
            return Vec::new();
        }
        if candidate.to_lowercase() == word.to_lowercase() && !found.contains(&candidate) {
            found.push(candidate);
        }
    }
    found
}

/// Returns the end of a sentence that asks for the nearest of the known words; empty if none is near.
pub fn question<'w>(word: &str, known: impl IntoIterator<Item = &'w str>) -> String {
    nearest(word, known).map_or(String::new(), |near| format!("; did you mean `{near}`?"))
}

/// Returns a question for the nearest of the known words, if one is near, or else a list of them with
/// the introduction `what`.
pub fn help<'w>(word: &str, known: impl Iterator<Item = &'w str> + Clone, what: &str) -> String {
    match nearest(word, known.clone()) {
        Some(candidate) => format!("did you mean `{candidate}`?"),
        None => format!("{what}: {}", list(known)),
    }
}

/// Returns the first words, separated by commas.
pub fn list<'w>(known: impl Iterator<Item = &'w str>) -> String {
    let mut words: Vec<&str> = known.take(LISTED + 1).collect();
    if words.len() > LISTED {
        words[LISTED] = "...";
    }
    words.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misspelled_words_are_found() {
        let known = ["chalk", "studio", "cloudy", "x", "Na", "residue_number"];
        for (word, expected) in [
            ("studo", Some("studio")),
            ("STUDIO", Some("studio")),
            ("chlak", Some("chalk")),
            ("na", Some("Na")),
            ("residue-number", Some("residue_number")),
            ("X", Some("x")),
            ("y", None),
            ("pretty", None),
            ("", None),
        ] {
            assert_eq!(nearest(word, known), expected, "{word}");
        }
        assert_eq!(nearest(&"a".repeat(65), ["a"]), None);
        assert_eq!(help("pretty", ["a", "b"].into_iter(), "looks are"), "looks are: a, b");
    }

    #[test]
    fn other_case_is_distinguished_from_misspelling() {
        assert_eq!(other_case("na", ["Na", "NA", "Cl", "Na"]), ["Na", "NA"]);
        assert_eq!(other_case("Na", ["NA", "Na"]), [""; 0]);
        assert_eq!(other_case("n", ["Na"]), [""; 0]);
    }

    #[test]
    fn lists_are_short() {
        let many: Vec<String> = (0..40).map(|i| i.to_string()).collect();
        assert!(list(many.iter().map(String::as_str)).ends_with("31, ..."));
        assert_eq!(list(many[..32].iter().map(String::as_str)).split(", ").count(), 32);
    }
}
