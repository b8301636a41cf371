//! Constraints on the slip at surfaces that the liquid does not pass, solved together.
//!
#![doc = include_str!("../../../docs/formulas.html")]
//!
//! The pressure on a sealed surface is the multiplier of $\int\psi_a\,(v_w - v_s)\cdot n\,dA = 0$, with the
//! surface's particles as points of the integral and $\psi_a$ the traces of the basis: the products of its
//! functions along the other axes, one for each place of a DOF beside the face's axis and each layer of cells
//! that the surface passes. That is one equation for each value that the slip can have on a flat surface,
//! however many particles end there: one equation a particle would fix the slip at several depths of one
//! cell, and with it the flow through that cell.
//!
//! With $C$ these equations, $N$ the slip that a unit force on the liquid and its opposite on the solid make
//! at each DOF, the forces $C^T\lambda$ follow from $C N C^T\lambda = -C(v_w - v_s)$, symmetric and positive
//! semidefinite (a trace that few particles meet may follow from others): conjugate gradients, preconditioned
//! by the row sums, which are positive since all entries are.
//!
//! The same constraints hold for the accelerations and for every velocity mapped from the particles, as at a
//! held face. Kick and drift are then adjoint, $v = \Pi M^{-1}\Phi^T m_p v_p$ and $\dot v_p = \Phi\Pi
//! M^{-1}f$ with one projection $\Pi$, orthogonal in the masses and, where the drag is felt at the step's
//! end, in that of the drag times the step; the surface does no work on the slip. A constraint on the
//! accelerations alone leaves a slip in the mapped velocity; what it then does to the pressure answers other
//! forces than those that it came from, and the waves along the surface grow.

use crate::grid::{Face, Side};
use crate::scalar::Scalar;

/// A number of a DOF's component, or of a multiplier, with what it has of one point of a surface.
#[derive(Clone, Copy, Debug)]
struct Weight<T> {
    index: usize,
    value: T,
}

/// Ends of a point's part in the lists of all points.
#[derive(Clone, Copy, Debug)]
struct Ends {
    functions: usize,
    traces: usize,
}

/// Where a point of a sealed surface lies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<const D: usize> {
    pub(super) face: Face,
    /// Cell along the face's axis.
    pub(super) layer: usize,
    /// DOFs along each axis.
    pub(super) shape: [usize; D],
}

impl<const D: usize> Place<D> {
    /// The DOF on the grid's face in the row of `dof` along the face's axis.
    pub(super) fn below(&self, dof: usize) -> usize {
        let axis = self.face.axis;
        let stride: usize = self.shape[..axis].iter().product();
        let index = dof / stride % self.shape[axis];
        match self.face.side {
            Side::Min => dof - index * stride,
            Side::Max => dof + (self.shape[axis] - 1 - index) * stride,
        }
    }

    /// Number of the multiplier whose trace has the function of `dof`.
    fn trace_of(&self, dof: usize) -> usize {
        let axis = self.face.axis;
        let stride: usize = self.shape[..axis].iter().product();
        let line = stride * self.shape[axis];
        let beside = dof % stride + dof / line * stride;
        let side = match self.face.side {
            Side::Min => 0,
            Side::Max => 1,
        };
        let count: usize = self.shape.iter().product();
        ((self.layer * 2 + side) * D + axis) * count + beside
    }
}

/// What a unit force on the liquid, and its opposite on the solid, does to a component of a DOF.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer<T> {
    pub(super) solid: T,
    pub(super) liquid: T,
}

impl<T: Scalar> Answer<T> {
    pub(super) fn none() -> Self {
        Self {
            solid: T::zero(),
            liquid: T::zero(),
        }
    }
}

/// The components of the DOFs that sealed surfaces see.
#[derive(Clone, Debug)]
pub(super) struct Components<T> {
    /// Axis `a` of DOF `i` is `D i + a`, ascending.
    numbers: Vec<usize>,
    /// Whether a wall holds the solid and the liquid there.
    pub(super) held: Vec<[bool; 2]>,
    pub(super) answers: Vec<Answer<T>>,
    /// Slip that the constraints want to vanish, or the answer to a force.
    pub(super) slip: Vec<T>,
    /// Force on the liquid.
    pub(super) force: Vec<T>,
}

impl<T: Scalar> Components<T> {
    /// DOF and axis of each.
    pub(super) fn places<const D: usize>(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.numbers.iter().map(|&number| (number / D, number % D))
    }

    /// Calls `f(dof, axis, held, answer, slip)` for each.
    pub(super) fn for_each<const D: usize>(
        &mut self,
        mut f: impl FnMut(usize, usize, [bool; 2], &mut Answer<T>, &mut T),
    ) {
        let lists = self.held.iter().zip(&mut self.answers).zip(&mut self.slip);
        for (&number, ((&held, answer), slip)) in self.numbers.iter().zip(lists) {
            f(number / D, number % D, held, answer, slip);
        }
    }

    /// Place in the lists of an axis of a DOF.
    pub(super) fn find<const D: usize>(&self, dof: usize, axis: usize) -> Option<usize> {
        self.numbers.binary_search(&(dof * D + axis)).ok()
    }

    fn bytes(&self) -> usize {
        size_of::<usize>() * self.numbers.capacity()
            + size_of::<[bool; 2]>() * self.held.capacity()
            + size_of::<Answer<T>>() * self.answers.capacity()
            + size_of::<T>() * (self.slip.capacity() + self.force.capacity())
    }
}

/// Calls what it is given for DOFs with values, and whether their traces ask anything.
type Visit<'a, T> = dyn FnMut(&mut dyn FnMut(usize, T, bool)) + 'a;

/// The points of the sealed surfaces.
#[derive(Clone, Debug)]
struct Points<T> {
    ends: Vec<Ends>,
    functions: Vec<Weight<T>>,
    traces: Vec<Weight<T>>,
}

impl<T: Scalar> Points<T> {
    fn for_each(&self, mut f: impl FnMut(&[Weight<T>], &[Weight<T>])) {
        let (mut function, mut trace) = (0, 0);
        for end in &self.ends {
            f(
                &self.functions[function..end.functions],
                &self.traces[trace..end.traces],
            );
            (function, trace) = (end.functions, end.traces);
        }
    }

    /// `C^T multipliers`.
    fn spread(&self, multipliers: &[T], force: &mut [T]) {
        force.fill(T::zero());
        self.for_each(|functions, traces| {
            let pressure = sum(traces, multipliers);
            for function in functions {
                force[function.index] += function.value * pressure;
            }
        });
    }

    /// `C slip`.
    fn gather(&self, slip: &[T], equations: &mut [T]) {
        equations.fill(T::zero());
        self.for_each(|functions, traces| {
            let here = sum(functions, slip);
            for trace in traces {
                equations[trace.index] += trace.value * here;
            }
        });
    }

    fn bytes(&self) -> usize {
        size_of::<Ends>() * self.ends.capacity()
            + size_of::<Weight<T>>() * (self.functions.capacity() + self.traces.capacity())
    }
}

fn sum<T: Scalar>(weights: &[Weight<T>], values: &[T]) -> T {
    weights
        .iter()
        .fold(T::zero(), |sum, weight| sum + weight.value * values[weight.index])
}

/// Adds to the weight of `index` among those from `first` on.
fn add<T: Scalar>(weights: &mut Vec<Weight<T>>, first: usize, index: usize, value: T) {
    match weights[first..].iter_mut().find(|weight| weight.index == index) {
        Some(weight) => weight.value += value,
        None => weights.push(Weight { index, value }),
    }
}

/// Replaces indices by their places in the ascending list of those that there are, which it makes.
fn number<T>(weights: &mut [Weight<T>], numbers: &mut Vec<usize>) {
    numbers.clear();
    numbers.extend(weights.iter().map(|weight| weight.index));
    numbers.sort_unstable();
    numbers.dedup();
    for weight in weights {
        weight.index = numbers.partition_point(|&number| number < weight.index);
    }
}

/// Makes room for so many more than there is room for.
fn enlarge<A>(list: &mut Vec<A>, by: usize) {
    list.reserve_exact(list.capacity() - list.len() + by);
}

/// Vectors of the conjugate gradients, an entry each multiplier.
#[derive(Clone, Debug)]
struct Gradients<T> {
    numbers: Vec<usize>,
    multipliers: Vec<T>,
    residual: Vec<T>,
    direction: Vec<T>,
    image: Vec<T>,
    inverse_row_sum: Vec<T>,
}

impl<T: Scalar> Gradients<T> {
    /// An entry of zero each.
    fn clear(&mut self) {
        let count = self.numbers.len();
        for vector in self.vectors() {
            vector.clear();
            vector.resize(count, T::zero());
        }
    }

    fn vectors(&mut self) -> [&mut Vec<T>; 5] {
        [
            &mut self.multipliers,
            &mut self.residual,
            &mut self.direction,
            &mut self.image,
            &mut self.inverse_row_sum,
        ]
    }

    /// `residual . P residual` with the preconditioner `P`.
    fn size(&self) -> T {
        let residuals = self.residual.iter().zip(&self.inverse_row_sum);
        residuals.fold(T::zero(), |sum, (&r, &p)| sum + r * r * p)
    }

    /// Turns the direction to the preconditioned residual plus `share` of what it was.
    fn turn(&mut self, share: T) {
        let residuals = self.residual.iter().zip(&self.inverse_row_sum);
        for (direction, (&r, &p)) in self.direction.iter_mut().zip(residuals) {
            *direction = r * p + *direction * share;
        }
    }

    /// Goes along the direction, whose image is at hand, as far as `size` says; `false` where nothing is left
    /// to go.
    fn advance(&mut self, size: T) -> bool {
        let along = self.direction.iter().zip(&self.image);
        let curvature = along.fold(T::zero(), |sum, (&d, &i)| sum + d * i);
        if curvature <= T::zero() || !curvature.is_finite() {
            return false;
        }
        let length = size / curvature;
        for (multiplier, &direction) in self.multipliers.iter_mut().zip(&self.direction) {
            *multiplier += direction * length;
        }
        for (residual, &image) in self.residual.iter_mut().zip(&self.image) {
            *residual -= image * length;
        }
        true
    }
}

/// The constraints of one step, and room to solve them.
#[derive(Clone, Debug)]
pub(in super::super) struct Seal<T> {
    points: Points<T>,
    pub(super) components: Components<T>,
    gradients: Gradients<T>,
}

impl<T: Scalar> Seal<T> {
    /// For so many points, at each of which so many functions have a value, the products of so many along the
    /// axes beside any.
    pub(in super::super) fn new(points: usize, functions: usize, traces: usize) -> Self {
        let (functions, traces) = (points * functions, points * traces);
        let vector = || Vec::with_capacity(traces);
        Self {
            points: Points {
                ends: Vec::with_capacity(points),
                functions: Vec::with_capacity(functions),
                traces: Vec::with_capacity(traces),
            },
            components: Components {
                numbers: Vec::with_capacity(functions),
                held: Vec::with_capacity(functions),
                answers: Vec::with_capacity(functions),
                slip: Vec::with_capacity(functions),
                force: Vec::with_capacity(functions),
            },
            gradients: Gradients {
                numbers: Vec::with_capacity(traces),
                multipliers: vector(),
                residual: vector(),
                direction: vector(),
                image: vector(),
                inverse_row_sum: vector(),
            },
        }
    }

    pub(in super::super) fn bytes(&self) -> usize {
        let Gradients {
            numbers, multipliers, ..
        } = &self.gradients;
        self.points.bytes()
            + self.components.bytes()
            + size_of::<usize>() * numbers.capacity()
            + 5 * size_of::<T>() * multipliers.capacity()
    }

    /// Makes room for so many points more, each of one function and one trace.
    pub(in super::super) fn enlarge(&mut self, points: usize) {
        let Points {
            ends,
            functions,
            traces,
        } = &mut self.points;
        enlarge(ends, points);
        enlarge(functions, points);
        enlarge(traces, points);
        let Components {
            numbers,
            held,
            answers,
            slip,
            force,
        } = &mut self.components;
        enlarge(numbers, points);
        enlarge(held, points);
        enlarge(answers, points);
        enlarge(slip, points);
        enlarge(force, points);
        enlarge(&mut self.gradients.numbers, points);
        for vector in self.gradients.vectors() {
            enlarge(vector, points);
        }
    }

    /// Adds that the slip at a DOF on the grid's face vanishes, where a wall that rubs touches what it sees.
    pub(in super::super) fn add_contact<const D: usize>(
        &mut self,
        face: Face,
        dof: usize,
        shape: [usize; D],
        area: T,
    ) {
        // No surface lies beyond the last layer of cells: multipliers of their own.
        let layer = shape[face.axis];
        self.add_point(&Place { face, layer, shape }, area, &mut |add| {
            add(dof, T::one(), true);
        });
    }

    /// Force on the liquid along an axis of a DOF that was solved for last, with its opposite on the solid;
    /// nothing where nothing is sealed.
    pub(in super::super) fn force<const D: usize>(&self, dof: usize, axis: usize) -> Option<T> {
        if self.is_empty() {
            return None;
        }
        let found = self.components.find::<D>(dof, axis)?;
        self.components.force.get(found).copied()
    }

    /// Whether nothing is sealed.
    pub(super) fn is_empty(&self) -> bool {
        self.points.ends.is_empty()
    }

    /// Forgets all points.
    pub(super) fn clear(&mut self) {
        self.points.ends.clear();
        self.points.functions.clear();
        self.points.traces.clear();
    }

    /// Adds a point at `place` that stands for `area` of the surface; `visit` calls what it is given for each
    /// DOF with its value there, and whether its trace is one that the slip is to vanish against. A point
    /// without any asks for nothing.
    pub(super) fn add_point<const D: usize>(&mut self, place: &Place<D>, area: T, visit: &mut Visit<'_, T>) {
        let Points {
            ends,
            functions,
            traces,
        } = &mut self.points;
        let first = ends.last().copied().unwrap_or(Ends {
            functions: 0,
            traces: 0,
        });
        visit(&mut |dof, value, asks| {
            if value != T::zero() {
                add(functions, first.functions, dof * D + place.face.axis, value);
                if asks {
                    add(traces, first.traces, place.trace_of(dof), value * area);
                }
            }
        });
        if traces.len() == first.traces {
            functions.truncate(first.functions);
            return;
        }
        ends.push(Ends {
            functions: functions.len(),
            traces: traces.len(),
        });
    }

    /// Numbers what the points see, once all are there.
    pub(super) fn number(&mut self) {
        number(&mut self.points.functions, &mut self.components.numbers);
        number(&mut self.points.traces, &mut self.gradients.numbers);
        let count = self.components.numbers.len();
        let Components {
            held,
            answers,
            slip,
            force,
            ..
        } = &mut self.components;
        held.clear();
        held.resize(count, [false; 2]);
        answers.clear();
        answers.resize(count, Answer::none());
        for vector in [slip, force] {
            vector.clear();
            vector.resize(count, T::zero());
        }
        self.gradients.clear();
    }

    /// Makes `components.force` what brings the slip in `components.slip` to zero at the surfaces, where
    /// every component answers by itself. The slip is used up.
    pub(super) fn solve(&mut self) {
        self.solve_with(|components| {
            let answers = components.answers.iter().zip(&components.force);
            for (slip, (answer, &force)) in components.slip.iter_mut().zip(answers) {
                *slip = (answer.liquid - answer.solid) * force;
            }
        });
    }

    /// The same with `answer`, which replaces the slip by the answer to the force.
    pub(super) fn solve_with(&mut self, mut answer: impl FnMut(&mut Components<T>)) {
        let Self {
            points,
            components,
            gradients,
        } = self;
        points.gather(&components.slip, &mut gradients.residual);
        for residual in &mut gradients.residual {
            *residual = -*residual;
        }
        let mut image_of = |multipliers: &[T], image: &mut [T]| {
            points.spread(multipliers, &mut components.force);
            answer(&mut *components);
            points.gather(&components.slip, image);
        };
        gradients.multipliers.fill(T::one());
        image_of(&gradients.multipliers, &mut gradients.image);
        for (inverse, &sum) in gradients.inverse_row_sum.iter_mut().zip(&gradients.image) {
            *inverse = if sum > T::zero() {
                T::one() / sum
            } else {
                T::zero()
            };
        }
        gradients.multipliers.fill(T::zero());
        gradients.turn(T::zero());
        let mut size = gradients.size();
        // In units of the first residual's square: three quarters of the digits.
        let root = T::default_epsilon().sqrt();
        let enough = size * root * root * root;
        for _ in 0..2 * gradients.numbers.len() {
            if size <= enough {
                break;
            }
            image_of(&gradients.direction, &mut gradients.image);
            if !gradients.advance(size) {
                break;
            }
            let next = gradients.size();
            gradients.turn(next / size);
            size = next;
        }
        points.spread(&gradients.multipliers, &mut components.force);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of `cells` bilinear cells of size 1 along x that ends above, at these places.
    fn row(cells: usize, points: &[[f64; 2]]) -> Seal<f64> {
        let mut seal = Seal::new(points.len(), 4, 2);
        for &[x, y] in points {
            let place = Place {
                face: Face {
                    axis: 1,
                    side: Side::Max,
                },
                layer: 0,
                shape: [cells + 1, 2],
            };
            let cell = x.floor();
            let (first, right) = (cell as usize, x - cell);
            seal.add_point::<2>(&place, 1.0 / points.len() as f64, &mut |add| {
                for (k, along) in [1.0 - right, right].into_iter().enumerate() {
                    add(first + k, along * (1.0 - y), true);
                    add(first + k + cells + 1, along * y, true);
                }
            });
        }
        seal.number();
        for (k, slip) in seal.components.slip.iter_mut().enumerate() {
            *slip = (1.7 * k as f64).sin();
        }
        for (k, answer) in seal.components.answers.iter_mut().enumerate() {
            let size = 1.0 + k as f64;
            (answer.solid, answer.liquid) = (-0.3 * size, size);
        }
        seal
    }

    /// Slip left at the points, and what is left of the equations, after the solution; checks that its forces
    /// take energy.
    fn solved(mut seal: Seal<f64>) -> (Vec<f64>, Vec<f64>) {
        let before = seal.components.slip.clone();
        seal.solve();
        let answers = seal.components.answers.iter().zip(&seal.components.force);
        let after: Vec<f64> = answers
            .zip(&before)
            .map(|((answer, force), slip)| slip + (answer.liquid - answer.solid) * force)
            .collect();
        let work = before.iter().zip(&after).zip(&seal.components.force);
        let work: f64 = work.map(|((a, b), force)| (a + b) / 2.0 * force).sum();
        assert!(work < 0.0, "{work}");
        let mut left = vec![0.0; seal.gradients.numbers.len()];
        seal.points.gather(&after, &mut left);
        let mut slips = Vec::new();
        seal.points
            .for_each(|functions, _| slips.push(sum(functions, &after)));
        (slips, left)
    }

    fn largest(values: &[f64]) -> f64 {
        values.iter().fold(0.0, |most, value| most.max(value.abs()))
    }

    /// Eight points a cell, nine DOFs across: the one that came last won where each was imposed in turn.
    #[test]
    fn no_liquid_passes_any_point_of_a_flat_surface() {
        for height in [0.0, 0.3, 1.0] {
            let points: Vec<_> = (0..64).map(|k| [(f64::from(k) + 0.5) / 8.0, height]).collect();
            let (slips, left) = solved(row(8, &points));
            assert_eq!(left.len(), 9);
            assert!(largest(&slips) < 1e-10, "{height}: {slips:?}");
        }
    }

    /// As many equations as a flat surface has: the flow through the cells below stays free.
    #[test]
    fn an_uneven_surface_has_the_equations_of_a_flat_one() {
        let points: Vec<_> = (0..32)
            .map(|k| [(f64::from(k) + 0.5) / 8.0, 0.5 + 0.3 * f64::from(k).sin()])
            .collect();
        let (_, left) = solved(row(4, &points));
        assert_eq!(left.len(), 5);
        assert!(largest(&left) < 1e-11, "{left:?}");
    }

    /// One point a cell: two equations follow from one; the same point twice.
    #[test]
    fn equations_that_follow_from_others_do_no_harm() {
        let one = [[0.5, 1.0]];
        let few = [[0.5, 0.7], [1.5, 0.7], [2.5, 0.7]];
        let twice = [[0.25, 0.4], [0.25, 0.4], [1.25, 0.4], [1.25, 0.4]];
        for (cells, points) in [(1, &one[..]), (3, &few), (2, &twice)] {
            let (slips, _) = solved(row(cells, points));
            assert!(largest(&slips) < 1e-10, "{slips:?}");
        }
    }

    /// DOFs that nothing moves: all of them, which leaves nothing to solve, or some.
    #[test]
    fn held_dofs_have_no_part() {
        let points: Vec<_> = (0..8).map(|k| [(f64::from(k) + 0.5) / 4.0, 0.6]).collect();
        let mut held = row(2, &points);
        held.components.answers.fill(Answer::none());
        held.solve();
        assert!(largest(&held.components.force).is_finite());
        let mut some = row(2, &points);
        some.components.answers[0] = Answer::none();
        some.components.slip[0] = 0.0;
        let (slips, _) = solved(some);
        assert!(largest(&slips) < 1e-10, "{slips:?}");
    }
}
