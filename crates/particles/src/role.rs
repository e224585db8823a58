//! Roles of columns: what a column is to a particle.

/// The role of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// x coordinate of the position.
    X,
    /// y coordinate of the position.
    Y,
    /// z coordinate of the position.
    Z,
    /// The radius.
    Radius,
    /// The diameter.
    Diameter,
    /// The type or element.
    Kind,
    /// Red channel of the color.
    Red,
    /// Green channel of the color.
    Green,
    /// Blue channel of the color.
    Blue,
    /// The name of a material.
    Material,
}

impl Role {
    /// Returns the name in `--columns`.
    pub(crate) fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, role)| *role == self).map_or("", |(name, _)| name)
    }

    /// All roles with their names on the command line.
    pub const ALL: [(&'static str, Self); 10] = [
        ("x", Self::X),
        ("y", Self::Y),
        ("z", Self::Z),
        ("radius", Self::Radius),
        ("diameter", Self::Diameter),
        ("type", Self::Kind),
        ("red", Self::Red),
        ("green", Self::Green),
        ("blue", Self::Blue),
        ("material", Self::Material),
    ];
}
