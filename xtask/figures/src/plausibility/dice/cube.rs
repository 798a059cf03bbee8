//! A cube is fair, and a cuboid that is nearly a cube is not.

use super::SEED;
use super::throws::Conditions;
use crate::plausibility::chance::{equal_shares, shown_p};
use crate::report::{table, thousands};
use crate::{Result, Work};

/// Edge x over edge y of the twin that must be told apart.
const NEARLY: f64 = 1.01;

pub(super) fn make(work: &mut Work) -> Result<()> {
    let throws = work.size(100_000, 300);
    work.say(format_args!("dice: {} throws of a cube", thousands(throws)));
    let row = |name: &str, ratio, seed| -> Result<Vec<String>> {
        let [none, faces @ ..] = Conditions::default().faces(ratio, throws, seed)?;
        let (sum, p) = equal_shares(&faces);
        let mut cells = vec![name.to_owned()];
        cells.extend(faces.map(thousands));
        cells.extend([thousands(none), format!("{sum:.1}"), shown_p(p)]);
        Ok(cells)
    };
    let rows = [row("cube", 1.0, SEED - 2)?, row("1 % longer from 3 to 4", NEARLY, SEED - 1)?];
    let mut text = table(&["", "1", "2", "3", "4", "5", "6", "not at rest", "χ² (5)", "p"], rows);
    text += &format!(
        "\nFaces that came up in {} throws, the scene's default throw onto a flat table. χ² of equal shares, and the probability of more by chance. The second row says what the first is worth: it is \
         the same test of a cuboid whose edge between faces 3 and 4 is 1 % longer.\n",
        thousands(throws)
    );
    work.report.section("Dice: a fair cube", &text);
    Ok(())
}
