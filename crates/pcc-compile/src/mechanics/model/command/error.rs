//! What can go wrong with a run, in the order in which it happens.

use super::printable;
use super::table_error::TableError;
use std::fmt;
use std::path::PathBuf;
use std::time::Duration;
use thiserror::Error;

/// Why a point has no eigenvalues.
#[derive(Debug, Clone, PartialEq, Error)]
pub struct CommandError {
    /// What went wrong in the last attempt.
    pub failure: CommandFailure,
    /// Attempts that were made.
    pub attempts: u32,
    /// The end of what the program wrote to its standard error, or to its standard output if that is empty. Control
    /// characters are escaped.
    pub output: String,
    /// The folder of the last attempt, if it was kept.
    pub folder: Option<PathBuf>,
}

impl fmt::Display for CommandError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", self.failure)?;
        if self.attempts > 1 {
            write!(formatter, "; {} attempts were made", self.attempts)?;
        }
        if let Some(folder) = &self.folder {
            write!(formatter, "; its files are in {}", printable::path(folder))?;
        }
        self.output.lines().try_for_each(|line| write!(formatter, "\n    {line}"))
    }
}

impl From<CommandFailure> for CommandError {
    /// The first attempt failed, and left nothing.
    fn from(failure: CommandFailure) -> Self {
        Self { failure, attempts: 1, output: String::new(), folder: None }
    }
}

/// What went wrong in an attempt.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CommandFailure {
    /// The command is empty.
    #[error("there is no command; give the program and its arguments, such as \"python3\", \"{{study}}/model.py\"")]
    NoCommand,
    /// A shell takes one text.
    #[error("a shell runs one text, but the command has {found} elements; write one, or run the program without shell")]
    ShellCommand {
        /// Elements of the command.
        found: usize,
    },
    /// A point of another space.
    #[error("a point has {found} values, but there are {expected} inputs; give one value for each")]
    PointLength {
        /// Values of the point.
        found: usize,
        /// Number of inputs.
        expected: usize,
    },
    /// A value that cannot be written into a file of numbers.
    #[error("{name} is {value}, but programs are given finite numbers only; correct the input or the constant")]
    ValueNotFinite {
        /// Name of the input or constant.
        name: String,
        /// Its value, as text.
        value: String,
    },
    /// A folder or a file cannot be made or read.
    #[error("{path}: {cause}; the folders of runs need space and the right to write")]
    Folder {
        /// Folder or file.
        path: String,
        /// What the operating system said.
        cause: String,
    },
    /// [`CommandModel::interrupt`](super::CommandModel::interrupt) was called.
    #[error("the run was interrupted")]
    Interrupted,
    /// There is no such program.
    #[error(
        "program {program} is not found; the first element of the command must be a program on the path or a full \
         path, and {{study}}/… for a program beside the study"
    )]
    NotFound {
        /// First element of the command, with its placeholders replaced.
        program: String,
    },
    /// The operating system does not start the program.
    #[error(
        "program {program} cannot be started: {cause}; a script must be executable and name its interpreter in its \
         first line, or follow its interpreter in the command"
    )]
    NotStarted {
        /// First element of the command, with its placeholders replaced.
        program: String,
        /// What the operating system said.
        cause: String,
    },
    /// The operating system does not say how the program ended.
    #[error("nothing is known about the end of the program: {cause}; run it again")]
    Lost {
        /// What the operating system said.
        cause: String,
    },
    /// The program says that it failed.
    #[error("the program ended with status {code}; 0 would mean success")]
    ExitStatus {
        /// Its status.
        code: i32,
    },
    /// The program was killed, but not by pcc.
    #[error("the program was killed by signal {signal}{}", meaning(*.signal))]
    Signal {
        /// Number of the signal.
        signal: i32,
    },
    /// The program took too long and was killed.
    #[error("the program timed out after {} s and was ended; allow more time if it needs it", .limit.as_secs_f64())]
    TimedOut {
        /// Time allowed.
        limit: Duration,
    },
    /// The file of results is missing.
    #[error("the program ended without {file}; it must write it into the folder it is started in")]
    NoResults {
        /// Name of the file.
        file: &'static str,
    },
    /// The file of results is not read.
    #[error("{file} has {length} bytes; at most {limit} are read; write only what is asked for")]
    TooLarge {
        /// Name of the file.
        file: &'static str,
        /// Bytes found.
        length: u64,
        /// Most bytes read.
        limit: u64,
    },
    /// The file of results is not JSON because it holds the words of some languages for what is not a number.
    #[error(
        "results.json holds {word}, which is not a number; a run that has no answer must end with another status than 0"
    )]
    HoldsNan {
        /// The word.
        word: String,
    },
    /// The file of results is not JSON.
    #[error("results.json is not JSON: {cause}; write {{\"eigenvalues\": [[re, im], …]}}")]
    NotJson {
        /// What and where.
        cause: String,
    },
    /// The file of results has no eigenvalues.
    #[error("results.json has no list \"eigenvalues\"; write {{\"eigenvalues\": [[re, im], …]}}")]
    NoEigenvalues,
    /// An eigenvalue is not a pair of numbers.
    #[error("results.json: eigenvalue {number} is {found}; write each as a pair of numbers, [re, im]")]
    NotAPair {
        /// Its place, from 1.
        number: usize,
        /// Its JSON.
        found: String,
    },
    /// There are more or fewer eigenvalues than asked for.
    #[error("the number of eigenvalues in results.json is {found}, but must be {expected}")]
    Count {
        /// Eigenvalues found.
        found: usize,
        /// Eigenvalues asked for.
        expected: usize,
    },
    /// A number is too large for double precision.
    #[error("results.json holds a number that is not finite: {cause}")]
    NotFinite {
        /// What and where.
        cause: String,
    },
    /// The table of a batch cannot be used.
    #[error("results.csv: {0}")]
    Table(#[from] TableError),
    /// A row of a batch's table is about a run that does not exist.
    #[error("results.csv: line {line}: there is no run {run}; they are numbered from 1 to {count}, as in points.csv")]
    UnknownRun {
        /// Line in the file.
        line: u64,
        /// Number found.
        run: u64,
        /// Runs of the batch.
        count: usize,
    },
    /// A run of a batch was not answered.
    #[error("results.csv has no answer for run {run}; write a row for each, or the reason in a column \"error\"")]
    NoRow {
        /// Number of the run in the batch.
        run: usize,
    },
    /// The program says why there is no answer.
    #[error("the program reports: {text}")]
    Reported {
        /// Its words, with control characters escaped.
        text: String,
    },
}

impl CommandFailure {
    /// Whether the program was not run at all, or its end not seen: something is wrong with the settings or the
    /// machine.
    pub fn is_of_machine(&self) -> bool {
        let may_pass = matches!(self, Self::Folder { .. } | Self::NotStarted { .. } | Self::Lost { .. });
        may_pass || self.is_never_to_run()
    }

    /// Whether another attempt must end in the same way.
    pub(super) fn is_final(&self) -> bool {
        self.is_never_to_run() || matches!(self, Self::Table(TableError::ReservedName { .. }))
    }

    /// Whether the program cannot be started as it is described, or is not to be started any more.
    fn is_never_to_run(&self) -> bool {
        matches!(
            self,
            Self::NoCommand
                | Self::ShellCommand { .. }
                | Self::PointLength { .. }
                | Self::ValueNotFinite { .. }
                | Self::Interrupted
                | Self::NotFound { .. }
        )
    }
}

/// What a signal says to those who do not know its number; these are the same on all systems.
fn meaning(signal: i32) -> &'static str {
    match signal {
        6 => " (it aborted)",
        8 => " (arithmetic error)",
        9 => "; the system does that when memory runs out: run fewer at once",
        11 => " (invalid access to memory)",
        15 => " (someone ended it)",
        _ => "",
    }
}
