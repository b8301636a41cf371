//! Commands and flags.

mod bar;
mod check;
mod failure;
mod list;
mod pace;
mod print;
mod run;
mod study;
mod study_table;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use failure::Failure;

/// The material point method, with basis, reconstruction and law of your choice.
///
/// Without a command: the default study, a vibrating bar at large deformation with all methods side by side.
#[derive(Debug, Parser)]
#[command(name = "materialpoint", version, about)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    shared: Shared,
    #[command(flatten)]
    study: StudyFlags,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run one scene with its method.
    Run {
        /// Scene file (TOML), or the name of a compiled-in scene (see `list`).
        scene: String,
        /// Go on from a checkpoint, which a run with output.checkpoint_every leaves in its folder.
        #[arg(long, value_name = "FILE")]
        resume: Option<PathBuf>,
    },
    /// Compare methods and resolutions on one scene: speed against error.
    Study {
        /// Scene file (TOML), or the name of a compiled-in scene (see `list`).
        scene: String,
        #[command(flatten)]
        flags: StudyFlags,
    },
    /// Validate a scene; print what will be modelled and the largest stable time step.
    Check {
        /// Scene file (TOML), or the name of a compiled-in scene (see `list`).
        scene: String,
        /// Find the largest stable step of the start by power iteration on all particles instead of a bound:
        /// up to twice as large, but some hundred steps' work.
        #[arg(long)]
        sharp: bool,
    },
    /// List basis families, reconstructions, laws, phases, references and scenes.
    List,
}

/// Flags of every command that takes a scene.
#[derive(Args, Debug)]
struct Shared {
    /// Override a scene key, repeatable: --set time.end=0.2
    #[arg(long = "set", value_name = "KEY=VALUE", global = true)]
    set: Vec<String>,
    /// Folder for the files written.
    #[arg(long, value_name = "DIR", default_value = "out", global = true)]
    out: PathBuf,
    /// Print the summary as JSON on standard output, and nothing else there.
    #[arg(long, global = true)]
    json: bool,
    /// Threads to use, at least 1; all processors unless told otherwise. Results are the same to the bit.
    #[arg(long, value_name = "N", global = true, value_parser = clap::value_parser!(u32).range(1..))]
    threads: Option<u32>,
    /// No progress bar.
    #[arg(long, global = true)]
    quiet: bool,
}

/// Flags of a study.
#[derive(Args, Clone, Debug, Default)]
struct StudyFlags {
    /// Methods: all (also without the flag), or a list of basis+reconstruction
    /// (linear+taylor,bspline3+spline); dual-domain+shepard4 has 4 sub-points in each particle.
    #[arg(long)]
    methods: Option<String>,
    /// Numbers of cells.
    #[arg(long, value_delimiter = ',', value_name = "N,N,...")]
    cells: Vec<usize>,
    /// Time each run at least this often (once unless told), in turns; the median counts. Short runs are
    /// timed until that takes 0.1 s.
    #[arg(long, value_name = "N")]
    repeat: Option<usize>,
}

impl StudyFlags {
    /// Name of the first one that was given.
    fn given(&self) -> Option<&'static str> {
        [
            ("--methods", self.methods.is_some()),
            ("--cells", !self.cells.is_empty()),
            ("--repeat", self.repeat.is_some()),
        ]
        .into_iter()
        .find_map(|(name, given)| given.then_some(name))
    }

    /// These, and the `others` where these are silent.
    fn or(&self, others: &Self) -> Self {
        Self {
            methods: self.methods.clone().or_else(|| others.methods.clone()),
            cells: match self.cells.is_empty() {
                true => others.cells.clone(),
                false => self.cells.clone(),
            },
            repeat: self.repeat.or(others.repeat),
        }
    }
}

/// Does what the arguments say.
pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments {
        command,
        shared,
        study,
    } = arguments;
    if let (Some(name), false) = (
        study.given(),
        matches!(command, None | Some(Command::Study { .. })),
    ) {
        return Err(Failure::Input(format!(
            "{name} is a flag of `study` only; leave it out, or give the scene to `materialpoint study`"
        )));
    }
    use_threads(shared.threads)?;
    match command {
        None => study::default_study(shared, study),
        Some(Command::Study { scene, flags }) => study::study_scene(scene, shared, &flags.or(study)),
        Some(Command::Run { scene, resume }) => run::run_scene(scene, resume.as_deref(), shared),
        Some(Command::Check { scene, sharp }) => check::check_scene(scene, *sharp, shared),
        Some(Command::List) if shared.json => print::print_json(&list::json()),
        Some(Command::List) => print::print(&list::list()),
    }
}

/// Sets the number of threads that share the work of a step; zero is rayon's word for all processors. This
/// thread is one of them: else it would have to send all that is to be shared to the others, and sleep
/// meanwhile.
fn use_threads(threads: Option<u32>) -> Result<(), Failure> {
    let count = threads.unwrap_or(0) as usize;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .use_current_thread();
    pool.build_global()
        .map_err(|error| Failure::Input(format!("--threads {count}: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Else each pass of a step would be sent to other threads, while this one sleeps.
    #[test]
    fn the_thread_of_the_command_is_one_of_those_that_share_a_step() {
        use_threads(Some(2)).unwrap();
        assert_eq!(rayon::current_thread_index(), Some(0));
        assert_eq!(rayon::current_num_threads(), 2);
    }
}
