//! The exponential Runge-Kutta method of stiff order 4, exact in the drag.

use super::fields::{Fields, Rates};
use super::phi::phi;

/// Largest stable product of angular frequency and step, of the classical Runge-Kutta method.
pub(super) const STABILITY_LIMIT: f64 = 2.82;

const STAGES: usize = 5;

/// Where in the step the stages after the first lie.
const TIMES: [f64; STAGES - 1] = [0.5, 0.5, 1.0, 0.5];

/// Weights of the rates without drag, for the stages after the first and for the step.
const WEIGHTS: [[f64; STAGES]; STAGES] = [
    [0.5, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.5, 0.0, 0.0, 0.0],
    [0.0, 0.5, 0.5, 0.0, 0.0],
    [0.25, 0.125, 0.125, 0.0, 0.0],
    [1.0 / 6.0, 0.0, 0.0, 1.0 / 6.0, 2.0 / 3.0],
];

/// The method's work space.
///
/// M. Hochbruck and A. Ostermann, *Explicit exponential Runge-Kutta methods for semilinear parabolic
/// problems*, SIAM J. Numer. Anal. 43 (2005) 1069-1090, equation 5.19, for $y' = L y + N(t, y)$: $L$ is the
/// drag of each node as it is at the start of the step, a relaxation of the relative velocity that leaves the
/// momentum; $N$ is all the rest, the change of the drag included. However strong the drag, it does not limit
/// the step, and the order stays where a method of four stages (S. M. Cox and P. C. Matthews 2002) falls back
/// to 1. Without drag the stability is that of the classical Runge-Kutta method.
#[derive(Clone, Debug)]
pub(super) struct Exponential {
    stage: Fields,
    rates: [Rates; STAGES],
    drag: Vec<NodalDrag>,
}

/// What the drag of one node does in one step.
#[derive(Clone, Copy, Debug)]
struct NodalDrag {
    rate: f64,
    share: f64,
    /// Weights of the value and the rates of the relative velocity beyond those without drag, as `WEIGHTS`.
    excess: [(f64, [f64; STAGES]); STAGES],
}

impl NodalDrag {
    fn new(rate: f64, share: f64, step: f64) -> Self {
        let [half0, half1, half2, half3] = phi(-0.5 * step * rate);
        let [full0, full1, full2, full3] = phi(-step * rate);
        let inner = 0.5 * half2 - full3 + 0.25 * full2 - 0.5 * half3;
        let last = 0.25 * half2 - inner;
        let mut excess = [
            (half0, [0.5 * half1, 0.0, 0.0, 0.0, 0.0]),
            (half0, [0.5 * half1 - half2, half2, 0.0, 0.0, 0.0]),
            (full0, [full1 - 2.0 * full2, full2, full2, 0.0, 0.0]),
            (half0, [0.5 * half1 - 2.0 * inner - last, inner, inner, last, 0.0]),
            (
                full0,
                [
                    full1 - 3.0 * full2 + 4.0 * full3,
                    0.0,
                    0.0,
                    4.0 * full3 - full2,
                    4.0 * full2 - 8.0 * full3,
                ],
            ),
        ];
        for ((value, weights), without) in excess.iter_mut().zip(WEIGHTS) {
            *value -= 1.0;
            for (weight, without) in weights.iter_mut().zip(without) {
                *weight -= without;
            }
        }
        Self { rate, share, excess }
    }
}

impl Exponential {
    pub(super) fn new(nodes: usize, points: usize) -> Self {
        let rates = || Rates::zeros(nodes, points);
        Self {
            stage: Fields::zeros(nodes, points),
            rates: [rates(), rates(), rates(), rates(), rates()],
            drag: Vec::with_capacity(nodes),
        }
    }

    /// Moves `fields` on by `step`, s. `rate` takes the time and the fields; after its error `fields` is
    /// unchanged.
    pub(super) fn step<E>(
        &mut self,
        time: f64,
        fields: &mut Fields,
        step: f64,
        mut rate: impl FnMut(f64, &Fields, &mut Rates) -> Result<(), E>,
    ) -> Result<(), E> {
        let Self { stage, rates, drag } = self;
        let start = &mut rates[0];
        rate(time, fields, start)?;
        drag.clear();
        let frozen = start.drag.iter().zip(&start.share);
        drag.extend(frozen.map(|(rate, share)| NodalDrag::new(*rate, *share, step)));
        without_drag(drag, fields, start);

        for (index, part) in TIMES.into_iter().enumerate() {
            combine(index, drag, stage, fields, step, rates);
            let next = &mut rates[index + 1];
            rate(time + part * step, stage, next)?;
            without_drag(drag, stage, next);
        }
        combine(STAGES - 1, drag, stage, fields, step, rates);
        std::mem::swap(stage, fields);
        Ok(())
    }
}

/// Takes the drag of the start of the step out of the rates of `fields`.
fn without_drag(drag: &[NodalDrag], fields: &Fields, rates: &mut Rates) {
    for (node, drag) in drag.iter().enumerate() {
        rates
            .fields
            .shift(node, drag.share, drag.rate * fields.relative(node));
    }
}

/// Writes row `index` of the method: `fields` and the rates so far, with their weights.
fn combine(
    index: usize,
    drag: &[NodalDrag],
    out: &mut Fields,
    fields: &Fields,
    step: f64,
    rates: &[Rates; STAGES],
) {
    for (out, fields) in out.arrays_mut().into_iter().zip(fields.arrays()) {
        out.copy_from_slice(fields);
    }
    for (rates, weight) in rates
        .iter()
        .zip(WEIGHTS[index])
        .filter(|(_, weight)| *weight != 0.0)
    {
        for (out, rates) in out.arrays_mut().into_iter().zip(rates.fields.arrays()) {
            for (out, rate) in out.iter_mut().zip(rates) {
                *out += step * weight * rate;
            }
        }
    }
    for (node, drag) in drag.iter().enumerate() {
        let (value, weights) = &drag.excess[index];
        let slope: f64 = rates[..=index]
            .iter()
            .zip(weights)
            .map(|(rates, weight)| weight * rates.fields.relative(node))
            .sum();
        out.shift(node, drag.share, value * fields.relative(node) + step * slope);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// One node whose relative velocity follows w' = -d (1 + c sin t) w + d cos t from the value that strong
    /// drag allows, whose mean velocity turns with the pressure, and whose displacement integrates.
    fn march(drag: f64, change: f64, steps: u32) -> Fields {
        let mut fields = Fields::zeros(1, 1);
        fields.solid[0] = 1.0;
        fields.liquid[0] = 2.0;
        let mut method = Exponential::new(1, 1);
        let step = 2.0 / f64::from(steps);
        for i in 0..steps {
            let time = f64::from(i) * step;
            let result = method.step(time, &mut fields, step, |t, y, out| {
                let w = y.relative(0);
                let share = 0.3;
                let mean = (1.0 - share) * y.solid[0] + share * y.liquid[0];
                out.drag[0] = drag * (1.0 + change * t.sin());
                out.share[0] = share;
                out.fields.displacement[0] = y.solid[0];
                out.fields.pressure[0] = -mean;
                out.fields.solid[0] = y.pressure[0];
                out.fields.liquid[0] = y.pressure[0];
                out.fields.shift(0, share, drag * t.cos() - out.drag[0] * w);
                Ok::<(), Infallible>(())
            });
            assert!(result.is_ok());
        }
        fields
    }

    fn error(drag: f64, steps: u32) -> f64 {
        let (exact, coarse) = (march(drag, 0.5, 20_000), march(drag, 0.5, steps));
        let difference = |f: fn(&Fields) -> f64| (f(&coarse) - f(&exact)).abs();
        difference(|y| y.relative(0))
            .max(difference(|y| y.displacement[0]))
            .max(difference(|y| y.pressure[0]))
    }

    #[test]
    fn has_order_four_where_the_drag_is_resolved() {
        let order = (error(3.0, 40) / error(3.0, 80)).log2();
        assert!((3.8..4.3).contains(&order), "{order}");
    }

    /// With steps 3e4 times longer than an explicit method could take.
    #[test]
    fn has_order_four_under_strong_drag() {
        let order = (error(1e6, 20) / error(1e6, 40)).log2();
        assert!((3.7..4.3).contains(&order), "{order}");
        assert!(error(1e6, 40) < 1e-7, "{}", error(1e6, 40));
    }

    /// The mean velocity obeys m'' = -m with the method's own error only, whatever the drag.
    #[test]
    fn drag_leaves_the_momentum() {
        let fields = march(1e9, 0.5, 200);
        let mean = 0.7 * fields.solid[0] + 0.3 * fields.liquid[0];
        assert!((mean - 1.3 * 2.0_f64.cos()).abs() < 1e-9, "{mean}");
    }
}
