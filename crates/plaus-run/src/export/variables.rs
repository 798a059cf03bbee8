//! Scalars as variables: those of several members of a kind become one, with a dimension of its own.

use plaus_scenes::{Member, Role, Scene, Stage};
use std::borrow::Cow;

/// One or several scalars of a scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Variable {
    pub(super) name: Cow<'static, str>,
    pub(super) unit: &'static str,
    pub(super) role: Role,
    /// Whether its values are whole numbers.
    pub(super) whole: bool,
    /// Indices of its values among the scene's scalars.
    columns: Vec<usize>,
    /// The member that the first belongs to, if there is one for each member of a kind.
    first: Option<Member>,
}

impl Variable {
    /// The dimension beside chain and draw: its name, its first number, and how many there are.
    pub(super) fn coordinate(&self) -> Option<(&'static str, i64, u64)> {
        self.first.map(|Member { kind, number }| (kind, i64::from(number), self.columns.len() as u64))
    }

    /// Its values of one draw, little-endian.
    pub(super) fn bytes(&self, values: &[f64]) -> Vec<u8> {
        let each = |&column: &usize| {
            let value = values[column];
            if self.whole { (value as i64).to_le_bytes() } else { value.to_le_bytes() }
        };
        self.columns.iter().flat_map(each).collect()
    }
}

/// The variables of a scene in the order of their first scalars, as declared, even if a kind has only one member.
pub(super) fn of(scene: &Stage) -> Vec<Variable> {
    let mut variables: Vec<Variable> = Vec::new();
    for (column, scalar) in scene.scalars().into_iter().enumerate() {
        let is_same = |known: &&mut Variable| known.name == scalar.base && scalar.member.is_some();
        match variables.iter_mut().find(is_same) {
            Some(known) => known.columns.push(column),
            None => variables.push(Variable {
                name: scalar.base,
                unit: scalar.unit,
                role: scalar.role,
                whole: scalar.whole,
                columns: vec![column],
                first: scalar.member,
            }),
        }
    }
    variables
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_scenes::Scenario;

    type Row = (Cow<'static, str>, usize, bool, Option<&'static str>);

    fn row(name: &'static str, count: usize, whole: bool, kind: Option<&'static str>) -> Row {
        (name.into(), count, whole, kind)
    }

    #[test]
    fn scalars_of_one_kind_are_one_variable() {
        let kind = |variable: &Variable| variable.first.map(|member| member.kind);
        let one = |variable: Variable| -> Row {
            let (count, whole, kind) = (variable.columns.len(), variable.whole, kind(&variable));
            (variable.name, count, whole, kind)
        };
        let of = |name: &str| -> Vec<Row> {
            let scene = Scenario::default_of(name).unwrap().stage().unwrap();
            super::of(&scene).into_iter().map(one).collect()
        };
        assert_eq!(of("ball2d"), [row("rest_x", 1, false, None), row("theta", 5, false, Some("bounce"))]);
        let dice = of("dice");
        assert_eq!(dice.len(), 13, "{dice:?}");
        assert!(dice.contains(&row("face", 1, true, Some("die"))) && dice.contains(&row("vx", 1, false, Some("die"))));
        let bowling = of("bowling");
        assert!(bowling.contains(&row("pinfall", 1, true, None)) && bowling.contains(&row("speed", 1, false, None)));
        assert!(of("spelling").contains(&row("bin", 10, true, Some("ball"))));
    }
}
