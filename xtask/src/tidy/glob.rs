//! Patterns for paths: `*` stands for any characters within one name, `**` for any number of folders.

/// Whether the pattern covers the whole path (both with `/` between folders).
#[must_use]
pub fn matches(pattern: &str, path: &str) -> bool {
    let pattern: Vec<&str> = pattern.split('/').collect();
    let path: Vec<&str> = path.split('/').collect();
    match_folders(&pattern, &path)
}

fn match_folders(pattern: &[&str], path: &[&str]) -> bool {
    match (pattern.split_first(), path.split_first()) {
        (None, None) => true,
        (Some((&"**", rest)), _) => {
            match_folders(rest, path)
                || path
                    .split_first()
                    .is_some_and(|(_, below)| match_folders(pattern, below))
        }
        (Some((name, rest)), Some((first, below))) => {
            match_name(name, first) && match_folders(rest, below)
        }
        _ => false,
    }
}

fn match_name(pattern: &str, name: &str) -> bool {
    let Some((before, after)) = pattern.split_once('*') else {
        return pattern == name;
    };
    let Some(rest) = name.strip_prefix(before) else {
        return false;
    };
    // The star takes as much as leaves an end that the rest of the pattern covers.
    (0..=rest.len()).any(|taken| rest.is_char_boundary(taken) && match_name(after, &rest[taken..]))
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn a_star_stays_within_a_name_and_two_stars_do_not() {
        let covered = [
            ("a/b.rs", "a/b.rs"),
            ("a/*.rs", "a/b.rs"),
            ("a/*", "a/ü.rs"),
            ("*/*/*.rs", "a/b/c.rs"),
            ("a*c*e", "abcde"),
            ("LICENSE-*", "LICENSE-MIT"),
            ("**/x.rs", "x.rs"),
            ("a/**/x.rs", "a/x.rs"),
            ("a/**/x.rs", "a/b/c/x.rs"),
            ("a/**", "a/b/c"),
            ("*", ""),
        ];
        let not_covered = [
            ("a/*.rs", "a/b/c.rs"),
            ("a/*.rs", "a/b.rsx"),
            ("a/*.rs", "b/a/c.rs"),
            ("*.rs", "a/b.rs"),
            ("a*c", "abcd"),
            ("a/b", "a"),
            ("a", "a/b"),
            ("a/**/x.rs", "b/x.rs"),
        ];
        for (pattern, path) in covered {
            assert!(matches(pattern, path), "{pattern} should cover {path}");
        }
        for (pattern, path) in not_covered {
            assert!(!matches(pattern, path), "{pattern} should not cover {path}");
        }
    }
}
