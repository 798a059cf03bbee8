//! A requirement whose numbers follow from quantities of the world, so that they differ from draw to draw.

use crate::animation::Motion;
use crate::files::Files;
use crate::require::kinds::{Ask, Require};
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{FAR, Reach};
use crate::require::timed::Timed;
use crate::scene::ConfigError;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A requirement with formulas in place of some numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Varying {
    /// As the scenario says it.
    pub(crate) entry: Value,
    pub(crate) formulas: Vec<Formula>,
    /// The place of its first number among those that motions carry.
    #[serde(skip)]
    first: usize,
    /// With numbers of values in the middle of their laws.
    #[serde(skip)]
    middle: Option<Box<Require>>,
}

/// A formula in place of a number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Formula {
    /// Where the number is, as a JSON pointer.
    pub(crate) at: String,
    /// The formula.
    pub(crate) text: String,
    /// What the number may be at all: a value beyond is taken for the end.
    pub(crate) ends: [f64; 2],
}

impl Varying {
    /// Learns its numbers of values in the middle of their laws, and where motions carry its own.
    fn settle(&mut self, first: usize, middle: &[f64]) {
        self.first = first;
        self.middle = self.with(middle).and_then(read).map(Box::new);
    }

    /// Its entry with these numbers, if all of them are finite.
    fn with(&self, numbers: &[f64]) -> Option<Value> {
        let mut entry = self.entry.clone();
        for (Formula { at, ends: [low, high], .. }, number) in self.formulas.iter().zip(numbers) {
            *entry.pointer_mut(at)? = Value::from(number.clamp(*low, *high));
        }
        numbers.iter().all(|number| number.is_finite()).then_some(entry)
    }

    /// The requirement of a motion's draw; `None` if it is not known, a number is undefined, or a range is empty.
    fn of(&self, motion: &Motion) -> Option<Require> {
        let entry = self.with(motion.numbers.get(self.first..self.first + self.formulas.len())?)?;
        if is_empty(&entry) { None } else { read(entry) }
    }

    /// The requirement with values in the middle of their laws.
    pub(super) fn middle(&self) -> Option<&Require> {
        self.middle.as_deref()
    }
}

fn read(entry: Value) -> Option<Require> {
    serde_json::from_value(entry).ok()
}

/// Whether any range or window of an entry has its end before its beginning.
fn is_empty(entry: &Value) -> bool {
    let reversed = |low: &Value, high: &Value| low.as_f64().zip(high.as_f64()).is_some_and(|(low, high)| low > high);
    match entry {
        Value::Object(keys) => keys.iter().any(|(key, value)| {
            if let (true, Some([low, high])) = (key.ends_with("_mm"), value.as_array().map(Vec::as_slice)) {
                return reversed(low, high);
            }
            let end = match key.strip_prefix("at_least") {
                Some(unit) => keys.get(&format!("at_most{unit}")),
                None => keys.get("to_s").filter(|_| key == "from_s"),
            };
            end.is_some_and(|end| reversed(value, end)) || is_empty(value)
        }),
        Value::Array(items) => items.iter().any(is_empty),
        _ => false,
    }
}

/// Requirements whose formulas a scene knows: `follow` takes them, each with its key, and gives what they come to in
/// the middle of all laws.
pub(in crate::require) fn settled(
    requirements: &[Require],
    follow: impl FnOnce(&[(String, String)]) -> Result<Vec<f64>, ConfigError>,
) -> Result<Vec<Require>, ConfigError> {
    let (mut requirements, mut formulas) = (requirements.to_vec(), Vec::new());
    for (index, one) in requirements.iter().enumerate() {
        let Require::Varying(varying) = one else { continue };
        let key = |at: &str| format!("require[{index}]{}", at.replace('/', "."));
        formulas.extend(varying.formulas.iter().map(|formula| (key(&formula.at), formula.text.clone())));
    }
    let (middle, mut first) = (if formulas.is_empty() { Vec::new() } else { follow(&formulas)? }, 0);
    for one in &mut requirements {
        let Require::Varying(varying) = one else { continue };
        let next = first + varying.formulas.len();
        varying.settle(first, &middle[first..next]);
        first = next;
    }
    Ok(requirements)
}

impl Ask for Varying {
    fn load(&mut self, key: &str, _: &dyn Files) -> Result<(), ConfigError> {
        let reads = self.entry.to_string().contains("\"times_from\":");
        let message = "numbers that follow from quantities cannot stand beside `times_from`: write `times_s`";
        if reads { Err(ConfigError::new(key, message)) } else { Ok(()) }
    }

    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        let undefined = || place.wrong("with values in the middle of their laws, a number is undefined");
        self.middle().ok_or_else(undefined)?.check(place)
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn nat(&self) -> Option<Nat> {
        let is_scale = |formula: &Formula| formula.at.contains("/scale");
        self.middle().filter(|_| !self.formulas.iter().any(is_scale)).and_then(Require::nat)
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        match self.of(probe.motion()) {
            Some(require) => require.reach(probe),
            None if probe.is_whole() => Reach::NEVER,
            None => Reach::between(-FAR, FAR),
        }
    }

    /// Times differ from draw to draw, so that only impacts and the end are looked at.
    fn looks(&self) -> Looks {
        Looks { times: Vec::new(), ..self.middle().map(Require::looks).unwrap_or_default() }
    }

    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        self.of(probe.motion()).map(|require| require.times(probe)).unwrap_or_default()
    }
}
