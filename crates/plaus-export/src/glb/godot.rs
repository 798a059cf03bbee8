//! A sidecar file for Godot. Unless told otherwise, Godot samples animations 30 times per second on import, and drops
//! keys that it considers superfluous.

/// How often Godot should sample a motion, in Hz. At 60 Hz impacts are rounded off by up to 10 mm (Godot 4.6.3); at
/// this rate, by the distance that bodies fall in an eighth of a millisecond. Its dialog offers at most 120 Hz; the
/// file may ask for more.
const RATE: u32 = 3840;

/// Text of `NAME.glb.import`, which belongs beside `NAME.glb`. Godot adds its own data when it first imports the file.
#[must_use]
pub fn godot_import(file: &str) -> String {
    let file: String = file.chars().filter(|c| !matches!(c, '"' | '\\' | '\n')).collect();
    format!(
        r#"[remap]

importer="scene"
importer_version=1
type="PackedScene"

[deps]

source_file="res://{file}"

[params]

animation/import=true
animation/fps={RATE}
animation/trimming=false
animation/remove_immutable_tracks=false
_subresources={{
"nodes": {{
"PATH:AnimationPlayer": {{
"optimizer/enabled": false
}}
}}
}}
"#
    )
}
