//! All component types: one row each.

/// Calls a macro with a row `Component: word,` for every component. The word says what follows where an edited scene has another
/// value:
///
/// | word | what follows |
/// |---|---|
/// | `kept` | nothing: a name stays the same, and what is derived is never written by hand |
/// | `transform` | it is written, and world transforms are derived again |
/// | `shape`, `material` | it is written, and what is drawn of the entity is prepared again |
/// | `anew` | it is written, and nothing more: it is read for every moment |
macro_rules! with_components {
    ($rows:ident) => {
        $rows! {
            Name: kept,
            Order: anew,
            Transform: transform,
            Parent: transform,
            WorldTransform: kept,
            Shape: shape,
            Material: material,
            Specular: material,
            Reflective: material,
            Refractive: material,
            Checker: material,
            Light: anew,
            Camera: anew,
            Follow: anew,
            LookAt: anew,
            Shots: anew,
            FilmSettings: anew,
            Ambient: anew,
            Background: anew,
            Fog: anew,
            Quality: anew,
            Sampling: anew,
            Animated: anew,
        }
    };
}

pub(crate) use with_components;

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    #[test]
    fn the_list_has_what_the_module_s_table_has() {
        macro_rules! names {
            ($($component:ident: $_:ident,)*) => {
                [$(stringify!($component)),*]
            };
        }
        let listed = BTreeSet::from(with_components!(names));
        let rows = include_str!("mod.rs").lines().filter_map(|line| line.strip_prefix("//! | [`"));
        let cells = rows.filter_map(|row| row.split(" | ").next());
        let described = cells.flat_map(|cell| cell.split("[`")).filter_map(|name| name.split('`').next());
        assert_eq!(listed, described.collect());
    }
}
