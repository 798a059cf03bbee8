//! A rope: links in a row.

use crate::scene::ConfigError;
use glam::DVec3;
use plaus_dist::math;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A rope or a chain: links in a row, each held to the next by a ball joint, straight at the start. Of a rope `rope`,
/// the links are the bodies `rope_1`, `rope_2` and so on, and the joints `rope_knot_1`, `rope_knot_2` and so on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rope {
    /// Its name.
    pub name: String,
    /// The number of its links, which are rods with round ends.
    #[schemars(range(min = 2, max = 1000))]
    pub links: u32,
    /// Half its thickness. A link must be longer than the rope is thick.
    #[schemars(extend("minimum" = 1e-3, "maximum" = 1e6, "x-unit" = "mm"))]
    pub radius_mm: f64,
    /// Where its two ends are at the start.
    #[schemars(extend("x-unit" = "mm"))]
    pub ends_mm: [[f64; 3]; 2],
    /// To what its first end is tied: the name of a body; `""`, or the name of a piece of scenery, for the fixed world.
    /// Unset: it is loose.
    #[serde(default)]
    pub first_to: Option<String>,
    /// To what its other end is tied. Unset: it is loose.
    #[serde(default)]
    pub last_to: Option<String>,
    /// The name of its material.
    #[serde(default)]
    pub material: String,
    /// Colour as on the web, `#c04030`. Unset: the material's.
    #[serde(default)]
    pub colour: String,
}

impl Rope {
    /// Its links and its joints, as tables of a scenario.
    pub(super) fn tables(&self, key: &str) -> Result<(Value, Vec<Value>), ConfigError> {
        let Self { name, links, radius_mm, .. } = self;
        let [begin, end] = self.ends_mm.map(DVec3::from_array);
        let (way, count) = (end - begin, f64::from(*links));
        let long = way.length() / count;
        if !(self.ends_mm.as_flattened().iter().all(|x| x.abs() <= 1e6) && long > 2.0 * radius_mm) {
            let message =
                format!("{links} links between these ends are {long} mm long: more than {} needed", 2.0 * radius_mm);
            return Err(ConfigError::new(format!("{key}.ends_mm"), message));
        }
        // In the arithmetic of an array.
        let along = |first: f64| {
            let one = |axis: usize| format!("{} + ({}) * (i + {first})", begin[axis], way[axis] / count);
            [0, 1, 2].map(one)
        };
        let lean = math::atan2(way.truncate().length(), way.z).to_degrees();
        let heading = math::atan2(way.y, way.x).to_degrees();
        let body = json!({
            "name": name, "count": links, "material": self.material, "colour": self.colour,
            "shape": { "capsule": { "radius_mm": radius_mm, "length_mm": long } },
            "at_mm": along(0.5), "turn_deg": [0.0, lean, heading],
        });
        let knot = |name: String, body: String, to: &str| json!({ "name": name, "body": body, "to": to, "kind": { "ball": {} } });
        let mut knots = knot(format!("{name}_knot"), format!("{name}_{{i+1}}"), &format!("{name}_{{i+2}}"));
        (knots["count"], knots["at_mm"]) = ((links - 1).into(), json!(along(1.0)));
        let tied = [("first", &self.first_to, 1, begin), ("last", &self.last_to, *links, end)];
        let ties = tied.into_iter().filter_map(|(which, to, link, at)| {
            let mut tie = knot(format!("{name}_{which}"), format!("{name}_{link}"), to.as_ref()?);
            tie["at_mm"] = json!(at.to_array());
            Some(tie)
        });
        Ok((body, std::iter::once(knots).chain(ties).collect()))
    }
}
