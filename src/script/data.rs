//! Script values, and their conversion from and to animated values.

use glam::{DVec3, Vec3};

use crate::animation::limits::{LARGEST, MOST_LIGHT};
use crate::animation::{Notation, Rotation, Value};
use crate::color::{Transfer, hex_channels};

/// A value returned by a script or passed to it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Data {
    /// `()`, the result of a script whose last statement is not an expression.
    Nothing,
    /// A Boolean.
    Flag(bool),
    /// A finite floating-point number.
    Number(f64),
    /// An integer.
    Whole(i64),
    /// A string.
    Text(String),
    /// `[a, b, c]`.
    List(Vec<Data>),
    /// `#{ name: value }`, ordered by name.
    Map(Vec<(String, Data)>),
    /// A value of any other type, with the name of the type.
    Other(&'static str),
}

impl Data {
    /// Describes the value, for example as `a list of 2 values`.
    #[must_use]
    pub(crate) fn description(&self) -> String {
        match self {
            Self::Nothing => "nothing".to_owned(),
            Self::Flag(flag) => flag.to_string(),
            Self::Number(number) => format!("the number {number}"),
            Self::Whole(whole) => format!("the number {whole}"),
            Self::Text(text) if text.chars().count() <= 40 => format!("the text \"{text}\""),
            Self::Text(_) => "a long text".to_owned(),
            Self::List(list) if list.len() == 1 => "a list of 1 value".to_owned(),
            Self::List(list) => format!("a list of {} values", list.len()),
            Self::Map(_) => "a map".to_owned(),
            Self::Other(what) => (*what).to_owned(),
        }
    }

    #[expect(clippy::cast_precision_loss, reason = "whole numbers beyond 2^53 round, as in a file")]
    fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Whole(whole) => Some(*whole as f64),
            _ => None,
        }
    }

    /// Returns the first element of a list that is not a number.
    fn odd_part(&self) -> Option<&Self> {
        let Self::List(list) = self else { return None };
        list.iter().find(|part| part.number().is_none())
    }

    /// Returns the elements of a list of exactly `COUNT` numbers.
    fn numbers<const COUNT: usize>(&self) -> Option<[f64; COUNT]> {
        let Self::List(list) = self else { return None };
        let numbers: Vec<f64> = list.iter().map(Self::number).collect::<Option<_>>()?;
        numbers.try_into().ok()
    }
}

impl From<[f64; 3]> for Data {
    fn from(numbers: [f64; 3]) -> Self {
        Self::List(numbers.map(Self::Number).into())
    }
}

impl Notation {
    /// Describes the expected data, with an example.
    #[must_use]
    pub(crate) fn expected(self) -> &'static str {
        match self {
            Self::Number => "a number, as 0.5",
            Self::Degrees => "a number of degrees, as 90",
            Self::Vector => "three numbers, as [0, 1, 0]",
            Self::Scale => "a factor, as 2, or three, as [1, 2, 1]",
            Self::Rotation => {
                "three angles in degrees, as [0, 90, 0], or a quaternion of four numbers, not all 0"
            }
            Self::Light => "three numbers of 0 or more, as [1, 1, 1]",
            Self::Color => "a colour, as [255, 120, 60] or \"#ff783c\"",
            Self::Flag => "true or false, as t < 2",
        }
    }

    /// Converts the result of a script to an animated value, or returns `None` if the result does not have the expected form.
    ///
    /// Colours are clamped to 0..=255, light to 0..=1e30.
    #[must_use]
    pub(crate) fn value(self, data: &Data, transfer: Transfer) -> Option<Value> {
        let within = |number: &f64| number.abs() <= LARGEST;
        let vector = || data.numbers::<3>().filter(|numbers| numbers.iter().all(within)).map(DVec3::from);
        Some(match self {
            Self::Number => Value::Number(data.number().filter(within)?),
            Self::Degrees => Value::Number(data.number().filter(within)?.to_radians()),
            Self::Vector => Value::Vector(vector()?),
            Self::Scale => match data.number() {
                Some(factor) => Value::Vector(DVec3::splat(Some(factor).filter(within)?)),
                None => Value::Vector(vector()?),
            },
            Self::Rotation => Value::Rotation(rotation(data)?.quaternion()),
            Self::Light => Value::Color(light(vector()?)),
            Self::Color => {
                let channels = match data {
                    Data::Text(text) => hex_channels(text)?,
                    _ => data.numbers()?,
                };
                Value::Color(transfer.decode(channels.map(|channel| channel.clamp(0.0, 255.0))))
            }
            Self::Flag => match data {
                Data::Flag(flag) => Value::Flag(*flag),
                _ => return None,
            },
        })
    }

    /// Returns the error message for data that does not have the expected form, and the remedy if there is one.
    #[must_use]
    pub(crate) fn mismatch(self, data: &Data) -> (String, Option<&'static str>) {
        let message = match data
            .odd_part()
            .filter(|_| !matches!(self, Self::Number | Self::Degrees | Self::Flag))
        {
            Some(part) => format!("expected {}, found {} in the list", self.expected(), part.description()),
            None => format!("expected {}, found {}", self.expected(), data.description()),
        };
        let parts = match data {
            Data::List(list) => list.as_slice(),
            other => std::slice::from_ref(other),
        };
        let huge = parts.iter().filter_map(Data::number).any(|number| number.abs() > LARGEST);
        let help = match data {
            _ if huge => Some("numbers and coordinates reach to 1e60"),
            Data::Nothing => Some("end the script with the value, without a semicolon after it"),
            _ => None,
        };
        (message, help)
    }

    /// Converts an animated value to data. Rotations become quaternions.
    #[must_use]
    pub(crate) fn data(self, value: Value, transfer: Transfer) -> Data {
        match (self, value) {
            (Self::Degrees, Value::Number(radians)) => Data::Number(radians.to_degrees()),
            (_, Value::Number(number)) => Data::Number(number),
            (_, Value::Flag(flag)) => Data::Flag(flag),
            (_, Value::Vector(vector)) => vector.to_array().into(),
            (_, Value::Rotation(rotation)) => Data::List(rotation.to_array().map(Data::Number).into()),
            (Self::Color, Value::Color(color)) => transfer.channels(color).into(),
            (_, Value::Color(light)) => light.as_dvec3().to_array().into(),
        }
    }
}

fn rotation(data: &Data) -> Option<Rotation> {
    if let Some(degrees) = data.numbers::<3>() {
        return Some(Rotation::Euler(DVec3::from(degrees)));
    }
    let [x, y, z, w] = data.numbers::<4>()?;
    [x, y, z, w].iter().any(|part| *part != 0.0).then_some(Rotation::Quat(x, y, z, w))
}

fn light(numbers: DVec3) -> Vec3 {
    numbers.clamp(DVec3::ZERO, DVec3::splat(MOST_LIGHT)).as_vec3()
}
