//! The files of a run's particles, moment by moment.

use std::path::PathBuf;

use super::error::RunError;
use super::fields::{FieldValues, for_each_field};
use super::norms::Exact;
use super::particle_table::particle_table;
use crate::output::{Components, Folder, PointCloud, PointField, Series, SeriesFrame};
use crate::particles::Particles;
use crate::phase::PoreLiquid;
use crate::scene::{ParticleOutput, Scene};

/// Writes particles in the format that the scene asks for, and remembers what was written.
pub(super) struct Frames<'a> {
    scene: &'a Scene,
    folder: Option<&'a Folder>,
    series: Series,
    /// Those of either format, with when they are of.
    written: Vec<SeriesFrame>,
    pub(super) files: Vec<PathBuf>,
}

impl<'a> Frames<'a> {
    /// `written` are the frames that there are, of an earlier part of the run.
    pub(super) fn new(scene: &'a Scene, folder: Option<&'a Folder>, written: Vec<SeriesFrame>) -> Self {
        let mut series = Series::new("particles");
        let in_series = written.iter().filter(|frame| frame.file.ends_with(".vtu"));
        series.frames.extend(in_series.cloned());
        let place = |frame: &SeriesFrame| folder.map(|folder| folder.path().join(&frame.file));
        Self {
            scene,
            folder,
            series,
            files: written.iter().filter_map(place).collect(),
            written,
        }
    }

    /// Where files go.
    pub(super) fn folder(&self) -> Option<&'a Folder> {
        self.folder
    }

    /// The frames so far.
    pub(super) fn written(&self) -> &[SeriesFrame] {
        &self.written
    }

    /// What the user should know if frames of the earlier part are not there: the run was resumed into another folder.
    pub(super) fn warning(&self) -> Option<String> {
        let missing = self.files.iter().filter(|file| !file.exists()).count();
        (missing > 0).then(|| {
            format!(
                "{missing} of the {} frames written before the checkpoint are not in the output folder; copy them there, or \
                 resume with --out naming the folder that has them",
                self.files.len()
            )
        })
    }

    /// Whether anything is written at all.
    pub(super) fn are_wanted(&self) -> bool {
        self.folder.is_some() && self.scene.output.particles != ParticleOutput::None
    }

    /// Whether there is a frame of the start: an animation wants one.
    pub(super) fn begin_at_start(&self) -> bool {
        self.are_wanted() && self.scene.output.particles == ParticleOutput::Vtu
    }

    /// Writes the particles at `time` (s), after `step` steps or, without it, at the end.
    pub(super) fn write<const D: usize>(
        &mut self,
        step: Option<usize>,
        time: f64,
        particles: &Particles<f64, D>,
        liquid: &[PoreLiquid<f64, D>],
    ) -> Result<(), RunError> {
        let Some(folder) = self.folder else {
            return Ok(());
        };
        match self.scene.output.particles {
            ParticleOutput::None => {}
            ParticleOutput::Csv => {
                let name = step.map_or("particles.csv".to_owned(), |step| {
                    format!("particles-{step:08}.csv")
                });
                let table = particle_table(self.scene, particles, liquid);
                self.files.push(table.write_csv(folder, &name)?);
                self.written.push(SeriesFrame { time, file: name });
            }
            ParticleOutput::Vtu => {
                let path = self.series.add(folder, time, &cloud(particles, liquid))?;
                self.files.push(path);
                self.written.extend(self.series.frames.last().cloned());
                if step.is_none() {
                    self.files.push(folder.path().join("particles.pvd"));
                }
            }
        }
        Ok(())
    }
}

fn cloud<const D: usize>(particles: &Particles<f64, D>, liquid: &[PoreLiquid<f64, D>]) -> PointCloud {
    let in_space = |x: &[f64]| std::array::from_fn(|a| x.get(a).copied().unwrap_or(0.0));
    let positions = particles.position.iter().map(|x| in_space(x.as_slice()));
    let mut cloud = PointCloud {
        positions: positions.collect(),
        fields: Vec::new(),
    };
    for_each_field(particles, liquid, &Exact::default(), |field| {
        cloud.fields.push(point_field::<D>(&field));
    });
    let density = (0..particles.len()).map(|p| particles.density(p)).collect();
    cloud.fields.push(PointField {
        name: "density[kg/m3]".to_owned(),
        components: Components::Scalar,
        values: density,
    });
    cloud
}

/// A field with the components that it has in three dimensions.
fn point_field<const D: usize>(field: &FieldValues) -> PointField {
    let name = format!("{}[{}]", field.name, field.unit);
    let each = field.values.chunks(field.components.max(1));
    let (components, values) = if D == 1 || field.components == 1 {
        (Components::Scalar, field.values.clone())
    } else if field.components == D {
        let padded = each.flat_map(|v| (0..3).map(|a| v.get(a).copied().unwrap_or(0.0)));
        (Components::Vector, padded.collect())
    } else {
        const ORDER: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];
        let entry = |m: &[f64], row: usize, column: usize| match row.max(column) < D {
            true => m.get(column * D + row).copied().unwrap_or(0.0),
            false => 0.0,
        };
        let padded = each.flat_map(|m| ORDER.map(|(row, column)| entry(m, row, column)));
        (Components::Symmetric, padded.collect())
    };
    PointField {
        name,
        components,
        values,
    }
}
