//! A derive macro in place of that of schemars, for programs that only read a schema.

use proc_macro::TokenStream;

/// Implements nothing. The attribute `schemars` is allowed, and ignored.
#[proc_macro_derive(JsonSchema, attributes(schemars))]
pub fn json_schema(_: TokenStream) -> TokenStream {
    TokenStream::new()
}
