//! Scalars as variables: those of one name that are numbered are one, with a dimension of its own.

use plaus_scenes::{Role, Scene};

/// One or several scalars of a scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Variable {
    pub(super) name: String,
    pub(super) unit: &'static str,
    pub(super) role: Role,
    /// Whether its values are whole numbers.
    pub(super) whole: bool,
    /// Places of its values among the scene's scalars.
    columns: Vec<usize>,
    /// What is numbered, and the number of the first, where there are several.
    numbered: Option<(&'static str, i64)>,
}

impl Variable {
    /// The dimension beside chain and draw: its name, its first number, and how many there are.
    pub(super) fn coordinate(&self) -> Option<(&'static str, i64, u64)> {
        self.numbered.map(|(name, first)| (name, first, self.columns.len() as u64))
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

/// A name without its number, and the number: `theta` and 2 of `theta_2`.
fn split(name: &str) -> Option<(&str, i64)> {
    let (base, number) = name.rsplit_once('_')?;
    Some((base, number.parse().ok()?)).filter(|_| !number.starts_with(['+', '-']))
}

/// The variables of a scene in the order of their first scalars. Numbers that follow each other from the first on make
/// one variable, also where there is only one of it.
pub(super) fn of<S: Scene>(scene: &S) -> Vec<Variable> {
    let mut variables: Vec<Variable> = Vec::new();
    for (column, scalar) in scene.scalars().into_iter().enumerate() {
        let numbered = split(&scalar.name);
        let base = numbered.map_or(scalar.name.as_str(), |(base, _)| base);
        let before = variables.iter_mut().find(|known| known.name == base);
        match (before, numbered) {
            (Some(known), Some((_, number)))
                if known.numbered.is_some_and(|(_, first)| first + known.columns.len() as i64 == number) =>
            {
                known.columns.push(column);
            }
            (None, Some((base, number))) => variables.push(Variable {
                name: base.to_owned(),
                unit: scalar.unit,
                role: scalar.role,
                whole: S::WHOLE.contains(&base),
                columns: vec![column],
                numbered: Some((S::NUMBERED, number)),
            }),
            _ => variables.push(Variable {
                whole: S::WHOLE.contains(&scalar.name.as_str()),
                name: scalar.name,
                unit: scalar.unit,
                role: scalar.role,
                columns: vec![column],
                numbered: None,
            }),
        }
    }
    variables
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_ends_in_a_number_is_numbered() {
        assert_eq!(split("theta_12"), Some(("theta", 12)));
        assert_eq!(split("rest_x_1"), Some(("rest_x", 1)));
        for name in ["rest_x", "k", "x_-1", "x_"] {
            assert_eq!(split(name), None, "{name}");
        }
    }

    #[test]
    fn scalars_of_one_name_are_one_variable() {
        struct Count;
        impl plaus_scenes::Visitor for Count {
            type Output = Vec<(String, usize, bool)>;
            fn visit<S: Scene>(self, scene: S) -> Self::Output {
                let all = of(&scene).into_iter();
                all.map(|variable| (variable.name, variable.columns.len(), variable.whole)).collect()
            }
        }
        let ball = plaus_scenes::World::default_of("ball2d").unwrap().visit(Count).unwrap();
        assert_eq!(ball, [("rest_x".to_owned(), 1, false), ("theta".to_owned(), 5, false)]);
        let dice = plaus_scenes::World::default_of("dice").unwrap().visit(Count).unwrap();
        assert_eq!(dice.len(), 13, "{dice:?}");
        assert!(dice.contains(&("face".to_owned(), 1, true)));
    }
}
