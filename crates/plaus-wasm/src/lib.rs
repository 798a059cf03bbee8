//! The sampler of a gallery's page, as a module of WebAssembly: plain functions over linear memory, without imports.
//!
//! A caller writes its message to the place that `input` gives, and calls a function. Each answers with a number: below
//! 0 if it failed. What it has to say, or why it failed, is then at `output`, `output_length` bytes long. An instance
//! is either a sampler, from `open_sampler` on, or a keeper of solutions, from `open_keeper` on. See
//! [`plaus_gallery::live`] for what they do.
//!
//! A fault in the program traps; the instance must not be used any more.

use plaus_gallery::live::{Edit, File, Keeper, Live, Sampler, begun, problems};
use plaus_scenes::AnyDraw;
use plaus_scenes::scenario::ScenarioError;
use serde_json::Value;
use std::cell::RefCell;

/// What an instance holds.
#[derive(Default)]
struct Instance {
    input: Vec<u8>,
    output: Vec<u8>,
    sampler: Option<Sampler>,
    keeper: Option<Keeper>,
}

thread_local! {
    /// WebAssembly has one thread here.
    static INSTANCE: RefCell<Instance> = RefCell::default();
}

impl Instance {
    fn live(&self) -> Result<Live, String> {
        Live::read(&self.input)
    }

    fn tree(&self) -> Result<Value, String> {
        serde_json::from_slice(&self.input).map_err(|error| error.to_string())
    }

    fn draw(&self) -> Result<AnyDraw, String> {
        serde_json::from_value(self.tree()?).map_err(|error| error.to_string())
    }

    fn sampler(&mut self) -> Result<&mut Sampler, String> {
        self.sampler.as_mut().ok_or_else(|| "no sampler was opened".to_owned())
    }
}

/// Does something, and answers.
fn answer(job: impl FnOnce(&mut Instance) -> Result<(i32, Vec<u8>), String>) -> i32 {
    INSTANCE.with_borrow_mut(|instance| {
        let (number, output) = job(instance).unwrap_or_else(|error| (-1, error.into_bytes()));
        instance.output = output;
        number
    })
}

/// A scenario that someone wrote.
#[derive(serde::Deserialize)]
struct Message {
    name: String,
    text: String,
    files: Vec<File>,
}

/// What a page is told of a scenario that was read.
fn told(read: Result<Live, ScenarioError>) -> (i32, Vec<u8>) {
    match read {
        Ok(live) => (1, text(&live)),
        Err(error) => (0, text(&problems(&error))),
    }
}

/// By way of a tree, so that the module has one writer of each type.
fn text(value: &impl serde::Serialize) -> Vec<u8> {
    serde_json::to_value(value).and_then(|tree| serde_json::to_vec(&tree)).unwrap_or_default()
}

/// Makes room for a message of so many bytes, and says where.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    INSTANCE.with_borrow_mut(|instance| {
        instance.input = vec![0; length];
        instance.input.as_mut_ptr()
    })
}

/// Where the last answer's text is.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    INSTANCE.with_borrow(|instance| instance.output.as_ptr())
}

/// How long it is, in bytes.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn output_length() -> usize {
    INSTANCE.with_borrow(|instance| instance.output.len())
}

/// What scenarios are checked against, as text; comes before all that reads one.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn give_schema() -> i32 {
    answer(|instance| {
        plaus_scenes::scenario::give_schema(instance.tree()?);
        Ok((0, Vec::new()))
    })
}

/// Answers 1, and what samplers and keepers need to sample the scenario that the message holds as `text`; or else 0,
/// and what is wrong with it. Its `name` is that of the text, its `files` are those that it may name.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn read_text() -> i32 {
    answer(|instance| {
        let Message { name, text, files } =
            serde_json::from_value(instance.tree()?).map_err(|error| error.to_string())?;
        Ok(told(begun(&name, &text, files)))
    })
}

/// The same for the keeper's scenario with the other values that the message lists.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn edit() -> i32 {
    answer(|instance| {
        let edits = Edit::read(&instance.input)?;
        let keeper = instance.keeper.as_ref().ok_or_else(|| "no keeper was opened".to_owned())?;
        Ok(told(keeper.edited(edits)))
    })
}

/// The text is what a page says of the keeper's scenario.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn about() -> i32 {
    answer(|instance| {
        let keeper = instance.keeper.as_ref().ok_or_else(|| "no keeper was opened".to_owned())?;
        Ok((0, text(&keeper.about())))
    })
}

/// Makes a sampler, the chain of this number, of a run that the message tells.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn open_sampler(chain: u32) -> i32 {
    answer(|instance| {
        instance.sampler = Some(Sampler::new(instance.live()?, chain)?);
        instance.input = Vec::new();
        Ok((0, Vec::new()))
    })
}

/// Goes on from the draw that the message tells, as the chain of another number.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn begin_at(chain: u32) -> i32 {
    answer(|instance| {
        let draw = instance.draw()?;
        instance.sampler()?.begin_at(draw, chain)?;
        Ok((0, Vec::new()))
    })
}

/// Makes about so many iterations. Answers how many solutions it found; they are the text, a list.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn advance(iterations: u32) -> i32 {
    answer(|instance| {
        let found = instance.sampler()?.advance(u64::from(iterations))?;
        Ok((found.len() as i32, if found.is_empty() { Vec::new() } else { text(&found) }))
    })
}

/// How many iterations the chain has behind it.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn iterations() -> f64 {
    INSTANCE.with_borrow(|instance| instance.sampler.as_ref().map_or(0.0, |sampler| sampler.iterations() as f64))
}

/// The text is where the chain is.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn state() -> i32 {
    answer(|instance| Ok((0, text(&instance.sampler()?.state()))))
}

/// Makes a keeper of the solutions of a page, of which the message tells.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn open_keeper() -> i32 {
    answer(|instance| {
        instance.keeper = Some(Keeper::new(instance.live()?)?);
        instance.input = Vec::new();
        Ok((0, Vec::new()))
    })
}

/// Adds the solution that the message tells, if it looks clearly different from all others. Answers 1 and what the page
/// needs to show it, or else 0.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn add() -> i32 {
    answer(|instance| {
        let found = serde_json::from_value(instance.tree()?).map_err(|error| error.to_string())?;
        let Some(keeper) = &mut instance.keeper else { return Err("no keeper was opened".to_owned()) };
        let added = keeper.add(found)?;
        Ok((i32::from(added.is_some()), added.unwrap_or_default()))
    })
}

/// The text is the draw of the solution of this number on the page.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn draw(number: usize) -> i32 {
    answer(|instance| {
        let draw = instance.keeper.as_ref().and_then(|keeper| keeper.draw(number));
        draw.map(|draw| (0, text(&draw))).ok_or_else(|| format!("there is no solution {number}"))
    })
}

/// What is said is a GLB of the solution of this number on the page; the message is its name and facts.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn glb(number: usize) -> i32 {
    answer(|instance| {
        let keeper = instance.keeper.as_ref().ok_or_else(|| "no keeper was opened".to_owned())?;
        Ok((0, keeper.glb(number, &instance.input)?))
    })
}

/// The text is a file with all solutions that were added.
#[allow(unsafe_code, reason = "no other function has this name")]
#[unsafe(no_mangle)]
pub extern "C" fn saved() -> i32 {
    answer(|instance| {
        let keeper = instance.keeper.as_ref().ok_or_else(|| "no keeper was opened".to_owned())?;
        Ok((0, keeper.saved().into_bytes()))
    })
}
