//! Enums whose variants carry constant data, one row each.

/// Defines an enum from rows `Variant => facts,`, with the list `ALL` of its variants in the order of the rows, and a method `row` that
/// returns the name and the facts of a variant.
macro_rules! table {
    (
        $(#[$about:meta])*
        $visibility:vis enum $name:ident: $facts:ty {
            $($(#[$row_about:meta])* $row:ident => $fact:expr,)*
        }
    ) => {
        $(#[$about])*
        $visibility enum $name { $($(#[$row_about])* $row,)* }

        impl $name {
            /// All variants, in the order of the rows.
            #[allow(dead_code, reason = "some tables are gone through by tests alone")]
            $visibility const ALL: [Self; [$(Self::$row),*].len()] = [$(Self::$row),*];

            const fn row(self) -> (&'static str, $facts) {
                match self { $(Self::$row => (stringify!($row), $fact),)* }
            }
        }
    };
}

pub(crate) use table;
