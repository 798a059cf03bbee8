//! Tables of scenario files, with each key written once.

/// Defines structs that are tables of a scenario file. Each field is a key:
///
/// ```text
/// /// What it means.
/// name: Type = default, least..=most, "unit";
/// ```
///
/// The range, its unit and the default may be left out; the default is then that of the type. Reading, writing,
/// `Default` and the schema follow from this, and from the schema all that `check`, `explain` and templates say. Other
/// attributes of a field go to `serde` and `schemars`. Fields are public. Keys that a file leaves out have their
/// defaults; keys that a table does not have are refused.
macro_rules! settings {
    (@default) => { Default::default() };
    (@default $value:expr) => { $value };
    ($(
        $(#[$of_table:meta])*
        pub struct $table:ident {
            $(
                $(#[$of_key:meta])*
                $key:ident: $kind:ty $(= $default:expr)? $(, $least:literal..=$most:literal $(, $unit:literal)?)?;
            )+
        }
    )+) => { $(
        $(#[$of_table])*
        #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        #[serde(default, deny_unknown_fields)]
        pub struct $table {
            $(
                $(#[$of_key])*
                $(#[schemars(extend("minimum" = $least, "maximum" = $most $(, "x-unit" = $unit)?))])?
                pub $key: $kind,
            )+
        }

        impl Default for $table {
            fn default() -> Self {
                Self { $($key: $crate::settings::settings!(@default $($default)?),)+ }
            }
        }
    )+ };
}
pub(crate) use settings;
