//! The files of a run's particles, moment by moment.

use std::path::PathBuf;

use super::error::RunError;
use super::particle_cloud::point_cloud;
use super::particle_fields::Snapshot;
use super::particle_table::particle_table;
use super::schedule::Schedule;
use crate::output::{Folder, Series, SeriesFrame, is_frame};
use crate::scene::{ParticleOutput, Scene};

/// Writes particles in the format that the scene asks for, and remembers what was written.
pub(super) struct Frames<'a> {
    scene: &'a Scene,
    folder: Option<&'a Folder>,
    series: Series,
    /// Those of either format, with when they are of.
    written: Vec<SeriesFrame>,
    pub(super) files: Vec<PathBuf>,
    /// Numbers of particles of the bodies.
    pub(super) bodies: Vec<usize>,
}

/// When particles are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moment {
    /// Steps taken, or `None` at the end.
    pub(super) step: Option<usize>,
    /// Time (s) of positions and stresses.
    pub(super) time: f64,
    /// Time (s) at which the velocities live.
    pub(super) velocity_time: f64,
}

impl Moment {
    /// After `done` steps on the way.
    pub(super) fn after(scene: &Scene, schedule: &Schedule, done: usize) -> Self {
        Self {
            step: Some(done),
            time: schedule.time(done),
            velocity_time: schedule.velocity_time(done, scene.time.half_kick),
        }
    }

    /// At the end.
    pub(super) fn end(scene: &Scene, schedule: &Schedule) -> Self {
        Self {
            step: None,
            time: schedule.end,
            velocity_time: schedule.velocity_time(schedule.steps, scene.time.half_kick),
        }
    }
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
            bodies: Vec::new(),
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

    /// What the user should know if frames of the earlier part are not there: the run was resumed into
    /// another folder.
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

    /// Removes what a former run left in the folder: temporary files of killed processes and, unless this run
    /// goes on with it, its frames. Returns their names.
    pub(super) fn clear(&self, resumed: bool) -> Vec<String> {
        let csv = self.scene.output.particles == ParticleOutput::Csv;
        // A table of the end is replaced when there is another.
        let is_old = |name: &str| !resumed && (is_frame(name) || !csv && name == "particles.csv");
        self.folder
            .map(|folder| folder.remove_left_over(is_old))
            .unwrap_or_default()
    }

    /// Whether anything is written at all.
    pub(super) fn are_wanted(&self) -> bool {
        self.folder.is_some() && self.scene.output.particles != ParticleOutput::None
    }

    /// Whether there is a frame of the start: an animation wants one.
    pub(super) fn begin_at_start(&self) -> bool {
        self.are_wanted() && self.scene.output.particles == ParticleOutput::Vtu
    }

    /// Writes the particles.
    pub(super) fn write<const D: usize>(
        &mut self,
        moment: Moment,
        snapshot: &Snapshot<'_, D>,
    ) -> Result<(), RunError> {
        let Some(folder) = self.folder else {
            return Ok(());
        };
        let Moment { step, time, .. } = moment;
        match self.scene.output.particles {
            ParticleOutput::None => {}
            ParticleOutput::Csv => {
                let name = step.map_or("particles.csv".to_owned(), |step| {
                    format!("particles-{step:08}.csv")
                });
                let table = particle_table(self.scene, snapshot, &self.bodies);
                self.files.push(table.write_csv(folder, &name)?);
                self.written.push(SeriesFrame { time, file: name });
            }
            ParticleOutput::Vtu => {
                let cloud = point_cloud(self.scene, snapshot, &self.bodies, moment);
                let path = self.series.add(folder, time, &cloud)?;
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
