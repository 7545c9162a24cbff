//! Axes of plots, with ticks at round numbers.

use super::{Area, PagePoint, Svg, TextAnchor};

/// A plot of two values.
#[derive(Clone, Copy, Debug)]
pub struct Plot {
    pub area: Area,
    pub x: Axis,
    pub y: Axis,
}

impl Plot {
    /// Returns the position of two values.
    pub fn at(&self, [x, y]: [f64; 2]) -> PagePoint {
        let Area { left, width, height, .. } = self.area;
        [left + self.x.share(x) * width, self.area.bottom() - self.y.share(y) * height]
    }

    /// Draws both axes, and a grid line with a label at every tick.
    pub fn draw(&self, svg: &mut Svg) {
        let (Area { left, top, width, height }, right, bottom) =
            (self.area, self.area.right(), self.area.bottom());
        for (value, label) in self.x.ticks() {
            let x = left + self.x.share(value) * width;
            svg.line("grid", [x, top], [x, bottom]);
            svg.text("", [x, bottom + 16.0], TextAnchor::Middle, &label);
        }
        for (value, label) in self.y.ticks() {
            let y = bottom - self.y.share(value) * height;
            svg.line("grid", [left, y], [right, y]);
            svg.text("", [left - 6.0, y + 4.0], TextAnchor::End, &label);
        }
        svg.lines("axis", &[vec![[left, top], [left, bottom], [right, bottom]]]);
    }
}

/// The values along a side of a plot.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// The values at the ends; on a logarithmic axis, their base-10 logarithms.
    pub from: f64,
    pub to: f64,
    /// Steps between ticks; `None` on a logarithmic axis.
    steps: Option<Steps>,
    unit: &'static str,
}

impl Axis {
    /// Returns a linear axis from one number to another, with ticks at up to `most` steps.
    pub fn linear((from, to): (f64, f64), most: f64) -> Self {
        let to = if to > from { to } else { from + 1.0 };
        Self { from, to, steps: Some(Steps::over(to - from, most)), unit: "" }
    }

    /// Returns a linear axis from 0 to the first tick that is not below `highest`, with up to `most` steps.
    pub fn from_zero(highest: f64, most: f64) -> Self {
        let size = Steps::over(highest, most).size;
        Self::linear((0.0, (highest / size - 1e-9).ceil().max(1.0) * size), most)
    }

    /// Returns a logarithmic axis that covers all finite values above 0, with a margin.
    pub fn logarithmic(values: impl Iterator<Item = f64>) -> Self {
        let positive = values.filter(|value| *value > 0.0 && value.is_finite()).map(libm::log10);
        let (from, to) = positive
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), value| (from.min(value), to.max(value)));
        let room = (0.06 * (to - from)).max(0.1);
        let (from, to) = if from > to { (0.0, 1.0) } else { (from - room, to + room) };
        Self { from, to, steps: None, unit: "" }
    }

    /// Returns the axis with a unit after the numbers of ticks.
    pub fn in_unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// Returns the position of a value along the axis, where 0 and 1 are the ends. On a logarithmic axis, it is clamped just outside of
    /// them.
    fn share(&self, value: f64) -> f64 {
        match self.steps {
            Some(_) => (value - self.from) / (self.to - self.from),
            None => ((libm::log10(value) - self.from) / (self.to - self.from)).clamp(-0.02, 1.02),
        }
    }

    /// Returns the ticks with their labels. Labels are empty where there is no room.
    fn ticks(&self) -> Vec<(f64, String)> {
        let Some(steps) = self.steps else { return self.logarithmic_ticks() };
        steps.within(self.from, self.to).map(|(value, text)| (value, text + self.unit)).collect()
    }

    /// Returns the ticks at 1, 2 and 5 times powers of ten.
    fn logarithmic_ticks(&self) -> Vec<(f64, String)> {
        /// Length of an axis, in decades, below which 2 and 5 are labelled as well.
        const SHORT: f64 = 2.2;
        let mut ticks = Vec::new();
        let mut power = self.from.floor();
        while power <= self.to {
            for digit in [1.0, 2.0, 5.0] {
                let value = digit * libm::exp10(power);
                let is_labelled = digit == 1.0 || self.to - self.from < SHORT;
                if (self.from..=self.to).contains(&libm::log10(value)) {
                    ticks.push((value, if is_labelled { short(value) } else { String::new() }));
                }
            }
            power += 1.0;
        }
        ticks
    }
}

/// Formats a number in a few characters.
fn short(value: f64) -> String {
    if (1e-3..1e5).contains(&value) {
        let decimals = (-libm::log10(value) - 1e-9).ceil().max(0.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 3")]
        let decimals = decimals as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.0e}")
    }
}

/// Steps of 1, 2 or 5 times a power of ten.
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    size: f64,
    /// Number of decimals that distinguish the multiples of the step.
    decimals: usize,
}

impl Steps {
    /// Creates steps that divide a length into at most `most` parts. The step is 1 if the length is not above 0.
    pub fn over(length: f64, most: f64) -> Self {
        let least = length / most;
        if !(least > 0.0 && least.is_finite()) {
            return Self { size: 1.0, decimals: 0 };
        }
        let exponent = libm::floor(libm::log10(least));
        let power = libm::exp10(exponent);
        let size =
            [1.0, 2.0, 5.0].map(|digit| digit * power).into_iter().find(|size| *size >= least * (1.0 - 1e-9));
        let (size, exponent) = size.map_or((10.0 * power, exponent + 1.0), |size| (size, exponent));
        let decimals = (-exponent).clamp(0.0, 12.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 12")]
        Self { size, decimals: decimals as usize }
    }

    pub fn size(self) -> f64 {
        self.size
    }

    /// Returns the multiples of the step from one number to another, with their labels.
    fn within(self, from: f64, to: f64) -> impl Iterator<Item = (f64, String)> {
        /// Maximum number of multiples on an axis.
        const MOST: usize = 100;
        let first = (from / self.size - 1e-9).ceil();
        let multiples = (0..MOST).map(move |index| (first + index as f64) * self.size);
        multiples
            .take_while(move |value| *value <= to + 1e-9 * self.size)
            .map(move |value| (value, self.write(value)))
    }

    fn write(self, value: f64) -> String {
        let shown = if value.abs() < 0.5 * self.size { 0.0 } else { value };
        if shown.abs() >= 1e6 || shown != 0.0 && self.size < 1e-6 {
            let digits = libm::log10(shown.abs() / self.size).ceil().clamp(0.0, 12.0);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 12")]
            let digits = digits as usize;
            format!("{shown:.digits$e}")
        } else {
            format!("{shown:.*}", self.decimals)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(from: f64, to: f64, most: f64) -> Vec<String> {
        Steps::over(to - from, most).within(from, to).map(|(_, text)| text).collect()
    }

    #[test]
    fn steps_are_round_and_few() {
        assert_eq!(written(0.0, 4.0, 5.0), ["0", "1", "2", "3", "4"]);
        assert_eq!(written(-0.3, 0.31, 4.0), ["-0.2", "0.0", "0.2"]);
        assert_eq!(written(17.0, 64.0, 5.0), ["20", "30", "40", "50", "60"]);
        assert_eq!(written(0.0, 6e7, 3.0), ["0", "2e7", "4.0e7", "6.0e7"]);
        assert_eq!(written(1.0, 1.0, 5.0), ["1"]);
    }

    #[test]
    fn ticks_of_logarithmic_axes_are_round() {
        let labels = |from: f64, to: f64| {
            let axis = Axis::logarithmic([from, to].into_iter());
            let labels = axis.ticks().into_iter().map(|(_, label)| label);
            labels.filter(|label| !label.is_empty()).collect::<Vec<_>>()
        };
        assert_eq!(labels(0.02, 0.9), ["0.02", "0.05", "0.1", "0.2", "0.5", "1"]);
        assert_eq!(labels(1.0, 1000.0), ["1", "10", "100", "1000"]);
        assert_eq!(labels(0.0, 0.0), ["1", "2", "5", "10"]);
    }
}
