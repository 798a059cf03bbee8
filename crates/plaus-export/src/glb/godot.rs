//! A sidecar for Godot, which otherwise resamples animations to 30 frames a second and drops keys it thinks superfluous.

/// Text of `NAME.glb.import`, to lie beside `NAME.glb`. Godot adds what it knows when it first imports the file.
#[must_use]
pub fn godot_import(file: &str, fps: f64) -> String {
    let file: String = file.chars().filter(|c| !matches!(c, '"' | '\\' | '\n')).collect();
    let fps = fps.round().clamp(1.0, 120.0); // what Godot accepts
    format!(
        r#"[remap]

importer="scene"
importer_version=1
type="PackedScene"

[deps]

source_file="res://{file}"

[params]

animation/import=true
animation/fps={fps}
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
