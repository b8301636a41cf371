//! What a basis asks about the particles that it is evaluated at.

/// The domain over which a basis averages its functions at a particle ([`BasisFamily::DOMAIN`]).
///
/// Domains are kept with the particles ([`Particles::domains`]): taken as the setup gives them, else found
/// from the layout at the start. Whatever is no particle (Gauss points, points of surfaces, interpolation
/// points) is a point, for every basis.
///
/// [`BasisFamily::DOMAIN`]: super::BasisFamily::DOMAIN
/// [`Particles::domains`]: crate::particles::Particles::domains
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Domain {
    /// None: particles are points.
    Point,
    /// Half its length along each axis, which never changes: the undeformed box of uniform GIMP (Bardenhagen
    /// & Kober 2004). Neither the deformation nor the volume enters after the start.
    Size {
        /// Greatest half length in cell sizes. A particle that is larger is refused.
        most: f64,
    },
    /// Half its edge vectors, those of a box at the start, carried by the deformation gradient: after each
    /// step `e = (1 + dt grad v) e`. They know no limit: a basis that sees so many cells about a particle and
    /// no more shrinks what reaches further.
    Edges,
}

impl Domain {
    /// Whether particles have one.
    pub const fn is_asked_for(self) -> bool {
        !matches!(self, Self::Point)
    }
}
