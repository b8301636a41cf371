//! The methods by name: one table behind scenes, studies, tests and benches.

use std::fmt;

use crate::basis::{BSpline, BasisFamily, DualDomain, Linear};
use crate::reconstruction::{CubicSpline, Reconstruction, RelaxedTaylor, Shepard, SubPoints, Taylor};
use crate::scalar::Scalar;

/// A basis family by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Basis {
    /// [`Linear`].
    Linear,
    /// [`DualDomain`].
    DualDomain,
    /// [`BSpline`] of degree 1, 2 or 3.
    BSpline {
        /// Polynomial degree.
        degree: usize,
    },
}

impl Basis {
    /// Name in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::DualDomain => "dual-domain",
            Self::BSpline { .. } => "bspline",
        }
    }

    /// Polynomial degree of the values.
    pub fn degree(self) -> usize {
        match self {
            Self::Linear | Self::DualDomain => 1,
            Self::BSpline { degree } => degree,
        }
    }
}

impl fmt::Display for Basis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BSpline { degree } if *degree != 2 => write!(f, "bspline{degree}"),
            _ => f.write_str(self.name()),
        }
    }
}

/// A reconstruction by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ReconstructionKind {
    /// [`Shepard`].
    Shepard,
    /// [`Taylor`].
    Taylor,
    /// [`RelaxedTaylor`].
    RelaxedTaylor,
    /// [`CubicSpline`].
    Spline,
}

impl ReconstructionKind {
    /// Name in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shepard => "shepard",
            Self::Taylor => "taylor",
            Self::RelaxedTaylor => "relaxed-taylor",
            Self::Spline => "spline",
        }
    }
}

impl ReconstructionKind {
    /// Whether it exists for so many axes and phases: the spline along one axis, relaxed Taylor in one phase
    /// or along one axis.
    pub fn is_known(self, dimension: usize, phases: usize) -> bool {
        match self {
            Self::Shepard | Self::Taylor => true,
            Self::RelaxedTaylor => phases == 1 || dimension == 1,
            Self::Spline => dimension == 1,
        }
    }
}

/// A basis family with a reconstruction, written `basis+reconstruction`, with sub-points
/// `dual-domain+shepard4`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Method {
    /// The basis family.
    pub basis: Basis,
    /// The reconstruction.
    pub reconstruction: ReconstructionKind,
    /// Sub-points of each particle's domain, 1 to [`SubPoints::MOST`]; one is the particle itself. More with
    /// dual domain and Shepard only.
    pub subpoints: u8,
}

/// What is done with a method's types in `D` dimensions. Written once, it compiles for every method.
pub trait MethodVisitor<T: Scalar, const D: usize = 1> {
    /// What comes out of it.
    type Output;

    /// Whether [`Taylor`] lends virtual points ([`Taylor::with_virtual_points`]) along one axis.
    fn lends_virtual_points(&self) -> bool {
        false
    }

    /// Called with an instance of either type.
    fn visit<B, R>(self, basis: B, reconstruction: R) -> Self::Output
    where
        B: BasisFamily<T, D> + Send + 'static,
        R: Reconstruction<T, D> + Clone + Send + 'static;
}

/// The reconstructions that exist in `D` dimensions, by name: the number of Taylor functions is a type of
/// each.
pub trait KnownIn<const D: usize> {
    /// Calls `visitor` with `basis` and the reconstruction's type; `None` if there is none in `D` dimensions.
    fn with_basis<T, B, V>(self, basis: B, visitor: V) -> Option<V::Output>
    where
        T: Scalar,
        B: BasisFamily<T, D> + Send + 'static,
        V: MethodVisitor<T, D>;
}

impl KnownIn<1> for ReconstructionKind {
    fn with_basis<T, B, V>(self, basis: B, visitor: V) -> Option<V::Output>
    where
        T: Scalar,
        B: BasisFamily<T, 1> + Send + 'static,
        V: MethodVisitor<T, 1>,
    {
        let degree = basis.degree();
        Some(match self {
            Self::Shepard => visitor.visit(basis, Shepard),
            Self::Taylor => {
                let taylor = Taylor::<T, 1, 3>::for_degree(degree);
                let taylor = taylor.with_virtual_points(visitor.lends_virtual_points());
                visitor.visit(basis, taylor)
            }
            Self::RelaxedTaylor => {
                let taylor = RelaxedTaylor::<T, 1, 3>::for_basis(&basis);
                visitor.visit(basis, taylor)
            }
            Self::Spline => visitor.visit(basis, CubicSpline::for_degree(degree)),
        })
    }
}

/// The global spline exists along one axis only.
macro_rules! known_beyond_one_axis {
    ($dimension:literal, $functions:literal) => {
        impl KnownIn<$dimension> for ReconstructionKind {
            fn with_basis<T, B, V>(self, basis: B, visitor: V) -> Option<V::Output>
            where
                T: Scalar,
                B: BasisFamily<T, $dimension> + Send + 'static,
                V: MethodVisitor<T, $dimension>,
            {
                let degree = basis.degree();
                match self {
                    Self::Shepard => Some(visitor.visit(basis, Shepard)),
                    Self::Taylor => {
                        let taylor = Taylor::<T, $dimension, $functions>::for_degree(degree);
                        Some(visitor.visit(basis, taylor))
                    }
                    Self::RelaxedTaylor => {
                        let taylor = RelaxedTaylor::<T, $dimension, $functions>::for_basis(&basis);
                        Some(visitor.visit(basis, taylor))
                    }
                    Self::Spline => None,
                }
            }
        }
    };
}

known_beyond_one_axis!(2, 6);
known_beyond_one_axis!(3, 10);

impl Method {
    /// The nine methods of the papers: {MPM, DDMPM, BSMPM} x {Shepard, TLS, spline}.
    pub const NINE: [Self; 9] = {
        use ReconstructionKind::{Shepard, Spline, Taylor};
        const BSPLINE: Basis = Basis::BSpline { degree: 2 };
        [
            Self::new(Basis::Linear, Shepard),
            Self::new(Basis::Linear, Taylor),
            Self::new(Basis::Linear, Spline),
            Self::new(Basis::DualDomain, Shepard),
            Self::new(Basis::DualDomain, Taylor),
            Self::new(Basis::DualDomain, Spline),
            Self::new(BSPLINE, Shepard),
            Self::new(BSPLINE, Taylor),
            Self::new(BSPLINE, Spline),
        ]
    };

    /// The nine, and with each basis our own relaxed Taylor least squares.
    pub const ALL: [Self; 12] = {
        use ReconstructionKind::RelaxedTaylor;
        let [ls, lt, lc, ds, dt, dc, bs, bt, bc] = Self::NINE;
        [
            ls,
            lt,
            Self::new(Basis::Linear, RelaxedTaylor),
            lc,
            ds,
            dt,
            Self::new(Basis::DualDomain, RelaxedTaylor),
            dc,
            bs,
            bt,
            Self::new(Basis::BSpline { degree: 2 }, RelaxedTaylor),
            bc,
        ]
    };

    /// Those of [`Method::ALL`] that exist in a scene of so many axes and phases.
    pub fn all_in(dimension: usize, phases: usize) -> Vec<Self> {
        let known = |method: &Self| method.reconstruction.is_known(dimension, phases);
        Self::ALL.into_iter().filter(known).collect()
    }

    /// A pair, with the particles themselves as their only sub-points.
    pub const fn new(basis: Basis, reconstruction: ReconstructionKind) -> Self {
        Self {
            basis,
            reconstruction,
            subpoints: 1,
        }
    }

    /// Dual domain with Shepard, the stress of each particle spread over this many sub-points.
    pub const fn sub_points(subpoints: u8) -> Self {
        Self {
            subpoints,
            ..Self::new(Basis::DualDomain, ReconstructionKind::Shepard)
        }
    }

    /// Name in the literature: MPM, DDMPM or BSMPM, with TLS, cubic spline or sub-points where there are any.
    pub fn literature_name(self) -> String {
        let basis = match self.basis {
            Basis::Linear => "MPM".into(),
            Basis::DualDomain => "DDMPM".into(),
            Basis::BSpline { degree: 2 } => "BSMPM".into(),
            Basis::BSpline { degree } => format!("BSMPM degree {degree}"),
        };
        match self.reconstruction {
            ReconstructionKind::Shepard if self.subpoints != 1 => {
                format!("{basis} + {} sub-points", self.subpoints)
            }
            ReconstructionKind::Shepard => basis,
            ReconstructionKind::Taylor => format!("{basis} + TLS"),
            ReconstructionKind::RelaxedTaylor => format!("{basis} + relaxed TLS"),
            ReconstructionKind::Spline => format!("{basis} + spline"),
        }
    }

    /// Calls `visitor` with the method's types, in as many dimensions as it is for. `None` for a degree that
    /// does not exist, a number of sub-points that the pair does not have, or a reconstruction that these
    /// dimensions do not have. Beyond one dimension, where each takes seconds to compile, cubic B-splines and
    /// sub-points are left to callers that name the types.
    pub fn dispatch<T, V, const D: usize>(self, visitor: V) -> Option<V::Output>
    where
        T: Scalar,
        V: MethodVisitor<T, D>,
        ReconstructionKind: KnownIn<D>,
    {
        if self.subpoints != 1 {
            return self.with_sub_points(visitor);
        }
        let reconstruction = self.reconstruction;
        match self.basis {
            // The B-splines of degree 1 are the hats.
            Basis::Linear | Basis::BSpline { degree: 1 } => reconstruction.with_basis(Linear, visitor),
            // Known at compile time.
            Basis::BSpline { degree: 3 } if const { D > 1 } => None,
            Basis::DualDomain => reconstruction.with_basis(DualDomain::new(), visitor),
            Basis::BSpline { degree: 2 } => reconstruction.with_basis(BSpline::<2>, visitor),
            Basis::BSpline { degree: 3 } => reconstruction.with_basis(BSpline::<3>, visitor),
            Basis::BSpline { .. } => None,
        }
    }

    /// Here alone: one type for every number, and none for the pairs that are not published.
    fn with_sub_points<T: Scalar, V: MethodVisitor<T, D>, const D: usize>(
        self,
        visitor: V,
    ) -> Option<V::Output> {
        if (self.basis, self.reconstruction) != (Basis::DualDomain, ReconstructionKind::Shepard) {
            return None;
        }
        if const { D > 1 } {
            return None;
        }
        let sub_points = SubPoints::new(self.subpoints.into()).ok()?;
        Some(visitor.visit(DualDomain::new(), sub_points))
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}+{}", self.basis, self.reconstruction.name())?;
        match self.subpoints {
            1 => Ok(()),
            n => write!(f, "{n}"),
        }
    }
}
