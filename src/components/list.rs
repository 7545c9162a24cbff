//! The list of all component types, one row each.

/// Calls a macro with a row `Component: word,` for every component. The word selects the action taken if the value differs in an edited
/// scene:
///
/// | word | action |
/// |---|---|
/// | `kept` | none: names stay the same, and derived values are never written by hand |
/// | `transform` | writes the value and derives world transforms again |
/// | `shape`, `material` | writes the value and prepares the entity's shape or material again |
/// | `rewritten` | writes the value only: it is read at every moment |
macro_rules! with_components {
    ($rows:ident) => {
        $rows! {
            Name: kept,
            Order: rewritten,
            Transform: transform,
            Parent: transform,
            WorldTransform: kept,
            Shape: shape,
            Cloud: kept,
            CloudSource: rewritten,
            AtParticle: rewritten,
            Visibility: shape,
            Material: material,
            Specular: material,
            Reflective: material,
            Refractive: material,
            Pattern: material,
            Emission: material,
            Light: rewritten,
            Camera: rewritten,
            Follow: rewritten,
            LookAt: transform,
            FocusOn: rewritten,
            Target: transform,
            Shots: rewritten,
            FilmSettings: rewritten,
            Ambient: rewritten,
            AmbientOcclusion: rewritten,
            Background: rewritten,
            Fog: rewritten,
            Sun: rewritten,
            Stars: rewritten,
            Quality: rewritten,
            Sampling: rewritten,
            Space: rewritten,
            Overlay: rewritten,
            Animated: rewritten,
        }
    };
}

pub(crate) use with_components;

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    #[test]
    fn component_list_matches_the_module_table() {
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
