//! The DOFs on the faces that rub, and which of them feel each other.

use nalgebra::SVector;

use super::super::{FaceCondition, Forcing};
use crate::grid::{Cell, Face, Grid, Side};
use crate::scalar::Scalar;

/// Stands for a DOF that lies on no wall.
const NOWHERE: u32 = u32::MAX;

/// A face that rubs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wall<T, const D: usize> {
    pub(super) face: Face,
    /// Coefficient of friction.
    pub(super) coefficient: T,
    /// Velocity of the wall (m/s).
    pub(super) velocity: SVector<T, D>,
}

impl<T: Scalar, const D: usize> Wall<T, D> {
    /// The walls of a step, in the order of [`Face::all`].
    pub(super) fn all(forcing: &Forcing<T, D>) -> impl Iterator<Item = Self> {
        Face::all::<D>().filter_map(|face| match *forcing.face(face) {
            FaceCondition::Frictional {
                coefficient,
                velocity,
            } => Some(Self {
                face,
                coefficient,
                velocity,
            }),
            _ => None,
        })
    }

    /// Whether a step has any.
    #[inline(never)]
    pub(super) fn are_there(forcing: &Forcing<T, D>) -> bool {
        Self::all(forcing).next().is_some()
    }

    /// The component along the normal that points into the grid.
    pub(super) fn inward(&self, v: &SVector<T, D>) -> T {
        match self.face.side {
            Side::Min => v[self.face.axis],
            Side::Max => -v[self.face.axis],
        }
    }

    /// The vector of this size along the normal that points into the grid.
    pub(super) fn along_normal(&self, size: T) -> SVector<T, D> {
        let mut vector = SVector::zeros();
        vector[self.face.axis] = match self.face.side {
            Side::Min => size,
            Side::Max => -size,
        };
        vector
    }

    /// Distance (m) of a point from the wall.
    pub(super) fn distance(&self, grid: &Grid<T, D>, x: &SVector<T, D>) -> T {
        let axis = self.face.axis;
        match self.face.side {
            Side::Min => x[axis] - grid.min()[axis],
            Side::Max => grid.max()[axis] - x[axis],
        }
    }

    /// Cells between `cell` and the wall.
    pub(super) fn cells_to(&self, grid: &Grid<T, D>, cell: &Cell<D>) -> usize {
        let axis = self.face.axis;
        let (index, count) = (cell[axis] as usize, grid.cells()[axis]);
        match self.face.side {
            Side::Min => index,
            Side::Max => count - 1 - index,
        }
    }
}

/// One DOF at one wall: where two walls meet, a DOF is the place of two contacts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact<T, const D: usize> {
    /// Which of the walls' DOFs it is.
    pub(super) place: usize,
    pub(super) wall: Wall<T, D>,
    /// Least distance (m) of the surface of a particle that the DOF sees from the wall.
    pub(super) gap: T,
    /// Whether they touch.
    pub(super) closed: bool,
    /// Impulse of the wall along its inward normal (N s), never negative.
    pub(super) normal: T,
    /// Share of it that the liquid in the pores bears by its pressure, and what the liquid bears besides
    /// (N s): nothing where none flows, or where it passes the wall.
    pub(super) relief: T,
    pub(super) pressed: T,
    /// Impulse of the wall along itself (N s).
    pub(super) tangential: SVector<T, D>,
}

impl<T: Scalar, const D: usize> Contact<T, D> {
    /// Greatest impulse along the wall (N s).
    pub(super) fn bound(&self) -> T {
        self.wall.coefficient * self.effective()
    }

    /// Normal impulse (N s) less what the liquid's pressure bears: that of the grains, which do not pull.
    pub(super) fn effective(&self) -> T {
        (self.normal - (self.relief * self.normal + self.pressed)).max(T::zero())
    }

    /// The whole impulse (N s).
    pub(super) fn impulse(&self) -> SVector<T, D> {
        self.tangential + self.wall.along_normal(self.normal)
    }
}

/// The DOFs of all walls with their contacts, and for each DOF those whose velocity an impulse at it may
/// change.
#[derive(Clone, Debug)]
pub(super) struct WallDofs<T, const D: usize> {
    faces: Vec<Face>,
    /// Numbers of the DOFs, ascending.
    pub(super) dofs: Vec<u32>,
    /// The place of each DOF of the grid among them.
    places: Vec<u32>,
    /// Where the neighbours of each begin in `neighbours`; one entry more than DOFs.
    starts: Vec<usize>,
    neighbours: Vec<u32>,
    /// Where the contacts of each DOF begin; one entry more than DOFs.
    contact_starts: Vec<usize>,
    /// Contacts in the order of their places.
    pub(super) contacts: Vec<Contact<T, D>>,
}

impl<T: Scalar, const D: usize> WallDofs<T, D> {
    /// Of no wall.
    pub(super) fn none() -> Self {
        Self {
            faces: Vec::new(),
            dofs: Vec::new(),
            places: Vec::new(),
            starts: vec![0],
            neighbours: Vec::new(),
            contact_starts: vec![0],
            contacts: Vec::new(),
        }
    }

    /// Whether these are the DOFs of the walls of a step; coefficients and velocities may have changed.
    pub(super) fn fit(&self, forcing: &Forcing<T, D>, dofs: usize) -> bool {
        self.places.len() == dofs
            && Wall::all(forcing)
                .map(|wall| wall.face)
                .eq(self.faces.iter().copied())
    }

    /// Takes in which faces rub of a lattice of DOFs of this `shape`. DOFs at most `reach` apart along each
    /// axis are neighbours.
    pub(super) fn lay(
        &mut self,
        shape: [usize; D],
        face_dofs: &[Vec<u32>],
        forcing: &Forcing<T, D>,
        reach: usize,
    ) {
        self.faces = Wall::all(forcing).map(|wall| wall.face).collect();
        self.contacts.clear();
        for wall in Wall::all(forcing) {
            let list = face_dofs.get(2 * wall.face.axis + wall.face.side as usize);
            self.contacts
                .extend(list.into_iter().flatten().map(|&dof| Contact {
                    place: dof as usize,
                    wall,
                    gap: T::zero(),
                    closed: false,
                    normal: T::zero(),
                    relief: T::zero(),
                    pressed: T::zero(),
                    tangential: SVector::zeros(),
                }));
        }
        // Stable: contacts of a DOF stay in the order of the walls.
        self.contacts.sort_by_key(|contact| contact.place);
        self.dofs = self.contacts.iter().map(|contact| contact.place as u32).collect();
        self.dofs.dedup();
        self.places = vec![NOWHERE; shape.iter().product()];
        for (place, &dof) in self.dofs.iter().enumerate() {
            self.places[dof as usize] = place as u32;
        }
        for contact in &mut self.contacts {
            contact.place = self.places[contact.place] as usize;
        }
        let places = 0..=self.dofs.len();
        let contacts = &self.contacts;
        self.contact_starts = places
            .map(|place| contacts.partition_point(|contact| contact.place < place))
            .collect();
        self.join_neighbours(shape, reach);
    }

    /// Forgets which faces rub: DOFs have other numbers.
    pub(super) fn forget(&mut self) {
        self.places.clear();
    }

    /// The contacts of the DOF at `place`.
    #[inline(always)]
    pub(super) fn contacts_at(&mut self, place: usize) -> &mut [Contact<T, D>] {
        &mut self.contacts[self.contact_starts[place]..self.contact_starts[place + 1]]
    }

    /// Whether the DOF is closed at a face.
    pub(super) fn is_closed(&self, dof: usize, face: Face) -> bool {
        let Some(place) = self.place(dof) else {
            return false;
        };
        let contacts = &self.contacts[self.contact_starts[place]..self.contact_starts[place + 1]];
        let mut there = contacts.iter().filter(|contact| contact.wall.face == face);
        there.any(|contact| contact.closed)
    }

    /// Velocity (m/s) of the wall on which the DOF at `place` lies.
    pub(super) fn wall_velocity(&self, place: usize) -> SVector<T, D> {
        let first = self.contacts.get(self.contact_starts[place]);
        first.map_or(SVector::zeros(), |contact| contact.wall.velocity)
    }

    fn join_neighbours(&mut self, shape: [usize; D], reach: usize) {
        self.starts.clear();
        self.starts.push(0);
        self.neighbours.clear();
        let width = 2 * reach + 1;
        for &dof in &self.dofs {
            let here = coordinates(dof as usize, &shape);
            for step in 0..width.pow(D as u32) {
                let away = coordinates(step, &[width; D]);
                let there: [Option<usize>; D] = std::array::from_fn(|a| {
                    let index = (here[a] + away[a]).checked_sub(reach)?;
                    (index < shape[a]).then_some(index)
                });
                if let Some(dof) = number(&there, &shape)
                    && self.places[dof] != NOWHERE
                {
                    self.neighbours.push(self.places[dof]);
                }
            }
            self.starts.push(self.neighbours.len());
        }
    }

    /// Takes in coefficients and velocities of the walls, and that no impulse acts yet.
    pub(super) fn begin(&mut self, forcing: &Forcing<T, D>) {
        for contact in &mut self.contacts {
            if let Some(wall) = Wall::all(forcing).find(|wall| wall.face == contact.wall.face) {
                contact.wall = wall;
            }
            contact.gap = T::lit(f64::INFINITY);
            contact.closed = false;
            contact.normal = T::zero();
            contact.relief = T::zero();
            contact.pressed = T::zero();
            contact.tangential = SVector::zeros();
        }
    }

    /// The place of a DOF, if it lies on a wall.
    #[inline(always)]
    pub(super) fn place(&self, dof: usize) -> Option<usize> {
        match self.places.get(dof) {
            Some(&place) if place != NOWHERE => Some(place as usize),
            _ => None,
        }
    }

    /// Of the DOF at `place` the range of its neighbours in lists of all neighbours.
    pub(super) fn row(&self, place: usize) -> std::ops::Range<usize> {
        self.starts[place]..self.starts[place + 1]
    }

    /// The places of all neighbours, row after row.
    pub(super) fn neighbours(&self) -> &[u32] {
        &self.neighbours
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<u32>() * (self.dofs.capacity() + self.places.capacity() + self.neighbours.capacity())
            + size_of::<usize>() * (self.starts.capacity() + self.contact_starts.capacity())
            + size_of::<Contact<T, D>>() * self.contacts.capacity()
    }
}

/// Coordinates in a lattice of the point with this number, axis 0 fastest.
pub(super) fn coordinates<const D: usize>(mut number: usize, shape: &[usize; D]) -> [usize; D] {
    std::array::from_fn(|axis| {
        let index = number % shape[axis];
        number /= shape[axis];
        index
    })
}

fn number<const D: usize>(there: &[Option<usize>; D], shape: &[usize; D]) -> Option<usize> {
    let mut number = 0;
    for axis in (0..D).rev() {
        number = number * shape[axis] + there[axis]?;
    }
    Some(number)
}
