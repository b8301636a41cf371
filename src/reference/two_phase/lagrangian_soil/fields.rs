//! What is marched in time.

/// The unknowns, or their rates.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fields {
    /// Displacement of the solid at the nodes, m.
    pub(super) displacement: Vec<f64>,
    /// Velocity of the solid at the nodes, m/s.
    pub(super) solid: Vec<f64>,
    /// Velocity of the liquid at the nodes, m/s.
    pub(super) liquid: Vec<f64>,
    /// Pore pressure at the points, Pa.
    pub(super) pressure: Vec<f64>,
}

impl Fields {
    pub(super) fn zeros(nodes: usize, points: usize) -> Self {
        Self {
            displacement: vec![0.0; nodes],
            solid: vec![0.0; nodes],
            liquid: vec![0.0; nodes],
            pressure: vec![0.0; points],
        }
    }

    /// All arrays.
    pub(super) fn arrays(&self) -> [&[f64]; 4] {
        [&self.displacement, &self.solid, &self.liquid, &self.pressure]
    }

    /// All arrays.
    pub(super) fn arrays_mut(&mut self) -> [&mut [f64]; 4] {
        [
            &mut self.displacement,
            &mut self.solid,
            &mut self.liquid,
            &mut self.pressure,
        ]
    }

    /// Velocity of the liquid relative to the solid at a node, m/s, or its rate.
    pub(super) fn relative(&self, node: usize) -> f64 {
        self.liquid[node] - self.solid[node]
    }

    /// Adds `change`, m/s, to the relative velocity of a node and leaves its momentum; `share` is the part of
    /// its mass that is liquid.
    pub(super) fn shift(&mut self, node: usize, share: f64, change: f64) {
        self.solid[node] -= share * change;
        self.liquid[node] += (1.0 - share) * change;
    }
}

/// Rates of the fields, and what the drag is made of.
#[derive(Clone, Debug)]
pub(super) struct Rates {
    /// Rates of the fields, drag included.
    pub(super) fields: Fields,
    /// Rate at which drag alone reduces the relative velocity of each node, 1/s.
    pub(super) drag: Vec<f64>,
    /// Part of the mass of each node that is liquid.
    pub(super) share: Vec<f64>,
}

impl Rates {
    pub(super) fn zeros(nodes: usize, points: usize) -> Self {
        Self {
            fields: Fields::zeros(nodes, points),
            drag: vec![0.0; nodes],
            share: vec![0.0; nodes],
        }
    }
}
