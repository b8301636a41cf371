//! What a run leaves on disk: tables as CSV, particles as VTK files with their index, pictures as SVG.
//!
//! [`Folder`] is checked before anything is computed, and a file in it is complete or absent. Pictures are
//! returned as text, drawn from a few primitives; a plotting crate would place them on whole pixels and bring
//! neither dashes nor haloes. Colours are those of Okabe and Ito, and every distinction that a colour makes
//! is made again by a marker, its filling or a dash, so that a grey print tells the same. Maps take viridis,
//! which brightens evenly.

mod error;
mod fields;
mod folder;
mod frame;
mod grid_of_fields;
mod labels;
mod left_over;
mod legend;
mod lines;
mod map;
mod page;
mod panel;
mod pvd;
mod replace;
mod scale;
mod study;
mod style;
mod svg;
mod table;
mod text;
mod ticks;
mod vtu;

pub use error::OutputError;
pub use fields::draw_fields;
pub use folder::Folder;
pub use grid_of_fields::draw_grid_of_fields;
pub(crate) use left_over::is_frame;
pub use lines::{Line, LineAxis, LineCaptions, LinePanel, draw_lines};
pub use map::{MapPanel, StripFrame, draw_maps, draw_strip};
pub use page::{PageError, fill_in};
pub use panel::FieldPanel;
pub use pvd::{Series, SeriesFrame};
pub use study::{Curve, CurvePoint, draw_study};
pub use table::{Records, Table, number};
pub use vtu::{Components, PointCloud, PointField};

#[cfg(test)]
pub(crate) mod tests;
