//! The exponential Runge-Kutta method of order 4, exact in the drag.

use super::fields::{Fields, Rates};
use super::phi::phi;

/// Largest stable product of angular frequency and step, of the classical Runge-Kutta method.
pub(super) const STABILITY_LIMIT: f64 = 2.82;

/// The method's work space.
///
/// S. M. Cox and P. C. Matthews, *Exponential time differencing for stiff systems*, J. Comput. Phys. 176 (2002) 430-455,
/// equations 26-29, for $y' = L y + N(t, y)$: $L$ is the drag of each node as it is at the start of the step, a
/// relaxation of the relative velocity that leaves the momentum; $N$ is all the rest, the change of the drag included.
/// However strong the drag, it does not limit the step; without it the method is the classical Runge-Kutta method.
#[derive(Clone, Debug)]
pub(super) struct Exponential {
    stages: [Fields; 2],
    rates: [Rates; 4],
    drag: Vec<NodalDrag>,
}

/// What the drag of one node does in one step; the functions are reduced by their values without drag.
#[derive(Clone, Copy, Debug)]
struct NodalDrag {
    rate: f64,
    share: f64,
    half: [f64; 2],
    full: [f64; 4],
}

impl NodalDrag {
    fn new(rate: f64, share: f64, step: f64) -> Self {
        let [half_zero, half_one, ..] = phi(-0.5 * step * rate);
        let [zero, one, two, three] = phi(-step * rate);
        Self {
            rate,
            share,
            half: [half_zero - 1.0, half_one - 1.0],
            full: [
                zero - 1.0,
                one - 3.0 * two + 4.0 * three - 1.0 / 6.0,
                2.0 * two - 4.0 * three - 1.0 / 3.0,
                4.0 * three - two - 1.0 / 6.0,
            ],
        }
    }
}

impl Exponential {
    pub(super) fn new(nodes: usize, points: usize) -> Self {
        let fields = || Fields::zeros(nodes, points);
        let rates = || Rates::zeros(nodes, points);
        Self {
            stages: [fields(), fields()],
            rates: [rates(), rates(), rates(), rates()],
            drag: Vec::with_capacity(nodes),
        }
    }

    /// Moves `fields` on by `step`, s. `rate` takes the time and the fields; after its error `fields` is unchanged.
    pub(super) fn step<E>(
        &mut self,
        time: f64,
        fields: &mut Fields,
        step: f64,
        mut rate: impl FnMut(f64, &Fields, &mut Rates) -> Result<(), E>,
    ) -> Result<(), E> {
        let Self {
            stages: [first, second],
            rates: [start, middle, again, end],
            drag,
        } = self;
        let half = 0.5 * step;

        rate(time, fields, start)?;
        drag.clear();
        let frozen = start.drag.iter().zip(&start.share);
        drag.extend(frozen.map(|(rate, share)| NodalDrag::new(*rate, *share, step)));
        without_drag(drag, fields, start);

        half_step(drag, first, fields, half, &start.fields);
        rate(time + half, first, middle)?;
        without_drag(drag, first, middle);

        half_step(drag, second, fields, half, &middle.fields);
        rate(time + half, second, again)?;
        without_drag(drag, second, again);

        // 2 again - start, in place of the stage's rates that nobody needs any more after it.
        let slope = &mut end.fields;
        for ((slope, again), start) in arrays(slope, &again.fields, &start.fields) {
            *slope = 2.0 * again - start;
        }
        half_step(drag, second, first, half, slope);
        rate(time + step, second, end)?;
        without_drag(drag, second, end);

        let rates = [&start.fields, &middle.fields, &again.fields, &end.fields];
        whole_step(drag, fields, step, rates);
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

/// Writes $e^{h L/2} y + (h/2) \varphi_1(h L/2) r$, where $h/2$ is `half`, $y$ `fields` and $r$ `rates`.
fn half_step(drag: &[NodalDrag], out: &mut Fields, fields: &Fields, half: f64, rates: &Fields) {
    for ((out, value), rate) in arrays(out, fields, rates) {
        *out = value + half * rate;
    }
    for (
        node,
        NodalDrag {
            share,
            half: [zero, one],
            ..
        },
    ) in drag.iter().enumerate()
    {
        let change = zero * fields.relative(node) + half * one * rates.relative(node);
        out.shift(node, *share, change);
    }
}

/// The last stage.
fn whole_step(drag: &[NodalDrag], fields: &mut Fields, step: f64, rates: [&Fields; 4]) {
    let [start, middle, again, end] = rates;
    let changes = |drag: &NodalDrag, node: usize, fields: &Fields| {
        let [zero, first, inner, last] = drag.full;
        let slope = first * start.relative(node)
            + inner * (middle.relative(node) + again.relative(node))
            + last * end.relative(node);
        zero * fields.relative(node) + step * slope
    };
    for (node, drag) in drag.iter().enumerate() {
        let change = changes(drag, node, fields);
        fields.shift(node, drag.share, change);
    }
    let sixth = step / 6.0;
    let slopes = start
        .arrays()
        .into_iter()
        .zip(middle.arrays())
        .zip(again.arrays())
        .zip(end.arrays());
    for (values, (((start, middle), again), end)) in fields.arrays_mut().into_iter().zip(slopes) {
        let slopes = start.iter().zip(middle).zip(again).zip(end);
        for (value, (((start, middle), again), end)) in values.iter_mut().zip(slopes) {
            *value += sixth * (start + 2.0 * (middle + again) + end);
        }
    }
}

/// Goes through all values of three fields together.
fn arrays<'a>(
    out: &'a mut Fields,
    first: &'a Fields,
    second: &'a Fields,
) -> impl Iterator<Item = ((&'a mut f64, &'a f64), &'a f64)> {
    let inputs = first.arrays().into_iter().zip(second.arrays());
    out.arrays_mut()
        .into_iter()
        .zip(inputs)
        .flat_map(|(out, (first, second))| out.iter_mut().zip(first).zip(second))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// One node whose relative velocity follows w' = -d (1 + c sin t) w + d cos t, whose mean velocity turns with the
    /// pressure, and whose displacement integrates.
    fn march(drag: f64, change: f64, steps: u32) -> Fields {
        let mut fields = Fields::zeros(1, 1);
        fields.solid[0] = 1.0;
        fields.liquid[0] = 1.5;
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

    /// Steps 5e4 times longer than an explicit method could take.
    #[test]
    fn strong_drag_does_not_limit_the_step() {
        assert!(error(1e6, 20) < 1e-2, "{}", error(1e6, 20));
        assert!(error(1e6, 320) < 1e-4, "{}", error(1e6, 320));
    }

    /// The mean velocity obeys m'' = -m with the method's own error only, whatever the drag.
    #[test]
    fn drag_leaves_the_momentum() {
        let fields = march(1e9, 0.5, 200);
        let mean = 0.7 * fields.solid[0] + 0.3 * fields.liquid[0];
        assert!((mean - 1.15 * 2.0_f64.cos()).abs() < 1e-9, "{mean}");
    }
}
