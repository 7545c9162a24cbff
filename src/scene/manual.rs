#![doc = "[language]: crate::scene::language\n"]
// `manual.md` links to the name `language`: as a source file it links to a file, and here, where the first definition takes precedence, to
// a module.
#![doc = include_str!("manual.md")]

/// The text of the reference.
pub(super) const MANUAL: &str = include_str!("manual.md");

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::fmt::Debug;

    use serde::de::DeserializeOwned;

    use crate::animation::Notation;
    use crate::animation::limits::{LARGEST, MOST_LIGHT, SMALLEST};
    use crate::components::{Property, Quantity};
    use crate::scene::document::{
        AmbientOcclusionDocument, AnchorDocument, AnimationDocument, AreaShapeDocument, BackgroundDocument,
        BetweenDocument, BondsDocument, CameraDocument, ChannelDocument, CloudDocument, ColorByDocument,
        ColorMapDocument, EasingDocument, EndDocument, EntityDocument, FilmDocument, FogDocument,
        FramesDocument, IncludeDocument, LensDocument, LightDocument, MaterialDocument, NoiseDocument,
        NormDocument, OverlayDocument, PatternDocument, QualityDocument, ReflectiveDocument,
        RefractiveDocument, RepeatDocument, RotationDocument, SamplingDocument, ScaleByDocument,
        SceneDocument, ScreenDocument, ScriptDocument, ShapeDocument, SpaceDocument, SpecularDocument,
        StarsDocument, StyleDocument, SunDocument, TimelineDocument, TrackDocument, TransferDocument,
        TransformDocument, Triple,
    };
    use crate::scene::parse::options;
    use crate::scene::reference::{self, FieldEntry, ManualSection, VariantEntry};
    use crate::script::Data;

    use super::MANUAL;

    /// Returns the sections by name.
    fn sections() -> BTreeMap<String, &'static ManualSection> {
        reference::sections().iter().map(|section| (section.name.to_owned(), section)).collect()
    }

    fn read<T: DeserializeOwned>(text: &str) -> T {
        options().from_str(text).unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    /// Returns the names that serde accepts, from its error for an unknown name.
    fn known<T: DeserializeOwned>(text: &str) -> Vec<String> {
        use ron::Error;
        let error = options().from_str::<T>(text).err().unwrap();
        let (Error::NoSuchStructField { expected, .. } | Error::NoSuchEnumVariant { expected, .. }) =
            error.code
        else {
            panic!("{text}: {error}");
        };
        expected.iter().map(|name| (*name).to_owned()).collect()
    }

    /// Checks the fields, their order, and every default.
    fn check_fields<T: DeserializeOwned + PartialEq + Debug>(
        name: &str,
        sections: &mut BTreeMap<String, &ManualSection>,
    ) {
        check_named::<T>(name, sections, &known::<T>("(nobody_knows: 0)"));
    }

    /// Checks the same, given the names of the fields.
    fn check_named<T: DeserializeOwned + PartialEq + Debug>(
        name: &str,
        sections: &mut BTreeMap<String, &ManualSection>,
        known: &[impl AsRef<str>],
    ) {
        let section = sections.remove(name).unwrap_or_else(|| panic!("the manual has no section {name}"));
        let named: Vec<&str> = section.fields.iter().map(|field| field.name).collect();
        let known: Vec<&str> = known.iter().map(AsRef::as_ref).collect();
        assert_eq!(named, known, "{name}");
        let required = section.fields.iter().filter(|field| field.is_required);
        let needed: String = required.map(|field| format!("{}: {}, ", field.name, field.value)).collect();
        let written_without: T = read(&format!("({needed})"));
        for FieldEntry { name: field, value: default, is_required, .. } in &section.fields {
            if *is_required {
                let rest = needed.replace(&format!("{field}: {default}, "), "");
                assert!(
                    options().from_str::<T>(&format!("({rest})")).is_err(),
                    "{name}.{field} is not required"
                );
            } else {
                let written: T = read(&format!("({field}: {default}, {needed})"));
                assert_eq!(written, written_without, "the default of {name}.{field}");
            }
        }
    }

    fn check_variants<T: DeserializeOwned>(
        name: &str,
        sections: &mut BTreeMap<String, &'static ManualSection>,
    ) -> &'static ManualSection {
        let section = sections.remove(name).unwrap_or_else(|| panic!("the manual has no section {name}"));
        let named: Vec<&str> = section.variants.iter().map(|variant| variant.name).collect();
        assert_eq!(named, known::<T>("NobodyKnows"), "{name}");
        section
    }

    #[test]
    fn manual_lists_every_field_variant_and_default() {
        let mut sections = sections();
        let all = &mut sections;
        check_fields::<SceneDocument>("Scene", all);
        check_fields::<IncludeDocument>("Include", all);
        check_fields::<AmbientOcclusionDocument>("AmbientOcclusion", all);
        check_named::<BackgroundDocument>("Gradient", all, BackgroundDocument::FIELDS);
        check_fields::<SunDocument>("Sun", all);
        check_fields::<StarsDocument>("Stars", all);
        check_fields::<FogDocument>("Fog", all);
        check_fields::<TimelineDocument>("Timeline", all);
        check_fields::<FilmDocument>("Film", all);
        check_fields::<QualityDocument>("Quality", all);
        check_fields::<SamplingDocument>("Sampling", all);
        check_fields::<CameraDocument>("Camera", all);
        check_fields::<ScreenDocument>("Screen", all);
        check_fields::<LensDocument>("Lens", all);
        check_fields::<MaterialDocument>("Material", all);
        check_fields::<SpecularDocument>("Specular", all);
        check_fields::<ReflectiveDocument>("Reflective", all);
        check_fields::<RefractiveDocument>("Refractive", all);
        check_fields::<EntityDocument>("Entity", all);
        check_fields::<CloudDocument>("Cloud", all);
        check_fields::<BondsDocument>("Bonds", all);
        check_fields::<FramesDocument>("Frames", all);
        check_fields::<TransformDocument>("Transform", all);
        check_fields::<AnimationDocument>("Animation", all);
        check_variants::<TransferDocument>("Transfer", all);
        check_variants::<SpaceDocument>("Space", all);
        check_variants::<NormDocument>("Norm", all);
        check_variants::<NoiseDocument>("Noise", all);
        check_variants::<StyleDocument>("Style", all);
        check_variants::<ScaleByDocument>("ScaleBy", all);
        check_variants::<ColorMapDocument>("ColorMap", all);
        check_variants::<BetweenDocument>("Between", all);
        check_variants::<EndDocument>("End", all);
        check_variants::<OverlayDocument>("OverlayItem", all);
        check_variants::<AnchorDocument>("Anchor", all);
        check_variants::<RotationDocument>("Rotation", all);
        check_variants::<ChannelDocument>("Channel", all);
        check_variants::<EasingDocument>("Easing", all);
        for VariantEntry { name: variant, inside, .. } in
            &check_variants::<TrackDocument<Triple>>("Track", all).variants
        {
            if !["Keys", "Along", "Script", "ScriptFile"].contains(variant) {
                let known = known::<TrackDocument<Triple>>(&format!("{variant}(nobody_knows: 0)"));
                assert_eq!(*inside, known.join(", "));
            }
        }
        check_variants::<RepeatDocument>("Repeat", all);
        check_variants::<ScriptDocument>("Script", all);
        for VariantEntry { name: variant, inside, .. } in
            &check_variants::<ShapeDocument>("Shape", all).variants
        {
            assert_eq!(*inside, known::<ShapeDocument>(&format!("{variant}(nobody_knows: 0)")).join(", "));
        }
        for VariantEntry { name: variant, inside, .. } in
            &check_variants::<PatternDocument>("Pattern", all).variants
        {
            assert_eq!(*inside, known::<PatternDocument>(&format!("{variant}(nobody_knows: 0)")).join(", "));
        }
        let color_by = check_variants::<ColorByDocument>("ColorBy", all);
        assert_eq!(color_by.variants[2].inside, known::<ColorByDocument>("Map(nobody_knows: 0)").join(", "));
        for VariantEntry { name: variant, inside, .. } in
            &check_variants::<LightDocument>("Light", all).variants
        {
            assert_eq!(*inside, known::<LightDocument>(&format!("{variant}(nobody_knows: 0)")).join(", "));
        }
        for VariantEntry { name: variant, inside, .. } in
            &check_variants::<AreaShapeDocument>("AreaShape", all).variants
        {
            assert_eq!(
                *inside,
                known::<AreaShapeDocument>(&format!("{variant}(nobody_knows: 0)")).join(", ")
            );
        }
        // It describes no type.
        assert!(sections.remove("Extended scenes").is_some());
        assert!(sections.is_empty(), "the manual describes what the format has not: {:?}", sections.keys());
    }

    /// Returns the manual's description of the keys of a channel.
    fn keys(quantity: Quantity) -> String {
        let range = quantity.range().limits();
        match quantity {
            Quantity::Point => "points".to_owned(),
            Quantity::Direction => "directions".to_owned(),
            Quantity::Rotation => "Rotations".to_owned(),
            Quantity::Turn | Quantity::Coordinate => "numbers".to_owned(),
            Quantity::Factors => "a factor or three".to_owned(),
            Quantity::Length => "numbers greater than 0".to_owned(),
            Quantity::Edges => "three edge lengths greater than 0".to_owned(),
            Quantity::Coefficient | Quantity::Softness | Quantity::StripeRatio => {
                format!("numbers from {} to {}", range.start(), range.end())
            }
            Quantity::Shininess => format!("numbers from {} to {:e}", range.start(), range.end()),
            Quantity::RefractiveIndex => format!("numbers from {} to {}", range.start(), range.end()),
            Quantity::Absorption => format!("three numbers, {} to {MOST_LIGHT:e}", range.start()),
            Quantity::Light => format!("RGB, {} or more", range.start()),
            Quantity::Color => "colours, and are blended as light".to_owned(),
            Quantity::SpotAngle | Quantity::AngularSize => {
                format!("numbers greater than 0, at most {}", range.end().to_degrees())
            }
            Quantity::FieldOfView => {
                format!("numbers between 0 and {}", range.end().next_up().to_degrees())
            }
            Quantity::Falloff => {
                let rest = format!("c0 greater than 0 and the others {} or more", range.start());
                format!("coefficients (c0, c1, c2), {rest}")
            }
            Quantity::Flag => "true or false, and each holds until the next one".to_owned(),
            Quantity::Aperture | Quantity::Density | Quantity::Mortar | Quantity::Contrast => {
                format!("numbers, {} or more", range.start())
            }
        }
    }

    #[test]
    fn manual_lists_the_keys_of_every_channel() {
        let section = MANUAL.split("\n## Channel\n").nth(1).unwrap();
        let bullets: Vec<&str> = section.split("\n\n").next().unwrap().split("\n- ").skip(1).collect();
        assert_eq!(bullets.len(), Property::ALL.len());
        let mut before = String::new();
        for (property, bullet) in Property::ALL.into_iter().zip(bullets) {
            let (name, keys) = (property.name(), keys(property.quantity()));
            assert!(bullet.starts_with(&format!("`{name}`: ")), "{name}: {bullet}");
            if bullet.contains("keys are") {
                assert!(bullet.contains(&format!("keys are {keys}.")), "{name}: {bullet}");
            } else {
                assert!(bullet.contains("likewise") && keys == before, "{name}: {bullet}");
            }
            let in_degrees = property.notation() == Notation::Degrees;
            assert_eq!(bullet.contains("in degrees"), in_degrees, "{name}: {bullet}");
            before = keys;
        }
    }

    #[test]
    fn manual_lists_path_channels() {
        let points = Property::ALL.into_iter().filter(|property| property.quantity() == Quantity::Point);
        let points: Vec<&str> = points.map(Property::name).collect();
        let [rest @ .., last] = &points[..] else { panic!() };
        let said = MANUAL.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(said.matches(&format!("For {} and {last}.", rest.join(", "))).count(), 2);
    }

    #[test]
    fn manual_lists_number_ranges() {
        let said = MANUAL.split_whitespace().collect::<Vec<_>>().join(" ");
        let coordinates = format!("coordinates at most {LARGEST:e} in magnitude");
        assert!(said.contains(&format!("{coordinates}; sizes must be at least {SMALLEST:e}.")));
        assert!(said.contains(&format!("per scene unit of length in the world, 0 to {MOST_LIGHT:e} |")));
        let huge = Data::Number(LARGEST * 10.0);
        let (_, help) = Notation::Number.mismatch(&huge);
        assert_eq!(help, Some(format!("numbers and coordinates reach to {LARGEST:e}").as_str()));
    }

    /// Checks that no type of the format is missing above.
    #[test]
    fn every_type_of_the_format_is_checked() {
        let this = include_str!("manual.rs");
        for source in [
            include_str!("document/animation.rs"),
            include_str!("document/cloud.rs"),
            include_str!("document/entity.rs"),
            include_str!("document/include.rs"),
            include_str!("document/material.rs"),
            include_str!("document/settings.rs"),
        ] {
            for line in source.lines() {
                let declared =
                    line.strip_prefix("pub(crate) struct ").or(line.strip_prefix("pub(crate) enum "));
                let Some(name) = declared.and_then(|rest| rest.split(['<', ' ', '(']).next()) else {
                    continue;
                };
                // Keys, shots, rods and the track type per channel have no section of their own.
                let checked = this.contains(&format!("::<{name}"))
                    || ["KeyDocument", "RodDocument", "ShotDocument", "TracksDocument"].contains(&name);
                assert!(checked, "{name}");
            }
        }
    }
}
