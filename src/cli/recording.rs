//! Journals of model runs on the command line: which one, what is used of it, and what to say about it.

use super::Context;
use super::run_arguments::Recording;
use anyhow::bail;
use pcc_compile::campaign::Ledger;
use pcc_compile::campaign::journal::{Contents, Journal};
use pcc_compile::study::{ModelSettings, Study};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Runs of pcc's own models that took less time together are sooner run again than resumed.
const WORTH_KEEPING: Duration = Duration::from_secs(10);

/// The books of a command's model runs.
pub(super) struct Books {
    /// What is known and recorded.
    pub ledger: Ledger,
    /// The journal, if there is one.
    pub journal: Option<PathBuf>,
    /// Whether the journal is of use only until the command ends: pcc runs the model itself, nobody asked for the journal, and
    /// this command began it.
    is_disposable: bool,
}

impl Books {
    /// The journal, if it stays when the command ends.
    pub fn kept_journal(&self) -> Option<&Path> {
        self.journal.as_deref().filter(|_| !self.is_disposable)
    }

    /// Ends work that failed or was interrupted. The journal of an interrupted command is kept if it took long to fill.
    pub fn give_up(self, context: &Context, is_interruption: bool) {
        let took_long = is_interruption && self.ledger.recorded_time() >= WORTH_KEEPING;
        match took_long || !self.is_disposable {
            true => self.say_recorded(context),
            false => self.close(),
        }
    }

    /// Says what an unfinished command has recorded.
    pub fn say_recorded(&self, context: &Context) {
        if let Some(journal) = self.journal.as_ref().filter(|_| self.ledger.recorded() > 0) {
            let runs = plural(self.ledger.recorded() as usize, "model run");
            context.say(&format!("{}: {runs} recorded; --resume goes on from there", journal.display()));
        }
    }

    /// Keeps a journal that somebody may want, and removes one that nobody does.
    pub fn close(self) {
        if self.is_disposable {
            self.ledger.discard_journal();
        }
    }
}

/// Where a build records its runs unless it is told otherwise: those of programs where other commands look for them; others, which are of
/// use only while the build lasts, beside the surrogate.
pub(super) fn journal_of_build(study: &Study, surrogate: &Path) -> PathBuf {
    match study.model.is_external() {
        true => journal_here(study),
        false => surrogate.with_file_name(journal_name(study)),
    }
}

/// Where other commands look for a journal: in the current folder.
pub(super) fn journal_here(study: &Study) -> PathBuf {
    PathBuf::from(journal_name(study))
}

fn journal_name(study: &Study) -> String {
    format!("{}.journal", study.name)
}

/// Opens the books. Without a `default`, runs are recorded only if the user names a journal.
pub(super) fn open(
    context: &Context,
    study: &Study,
    options: &Recording,
    default: Option<PathBuf>,
) -> anyhow::Result<Books> {
    let is_table = matches!(study.model, ModelSettings::Table(_));
    // Without a journal there is nothing to resume from, and nothing that answers in tables.
    let wants_journal = options.resume || is_table;
    let chosen = options.journal.clone().or(default).or_else(|| wants_journal.then(|| journal_here(study)));
    let Some(path) = chosen.filter(|_| !options.no_journal) else {
        return Ok(Books { ledger: Ledger::blank(study), journal: None, is_disposable: false });
    };
    let is_unasked = options.journal.is_none() && !wants_journal && !study.model.is_external();
    let (journal, contents) = match Journal::open(&path) {
        // Builds of pcc's own models may run beside each other, as long as nobody asked for a journal.
        Err(_) if is_unasked => {
            return Ok(Books { ledger: Ledger::blank(study), journal: None, is_disposable: false });
        }
        opened => opened?,
    };
    remark(context, &path, &contents);
    let is_disposable = is_unasked && journal.is_blank();
    let mut ledger = Ledger::recording(study, journal);
    if is_unasked {
        ledger = ledger.optional();
    }
    if options.retry_failed {
        ledger = ledger.retrying_failures();
    }
    say_what_is_known(context, study, &path, &contents, wants_journal);
    if wants_journal {
        ledger = ledger.knowing(&contents);
    }
    if is_table {
        ledger = ledger.asking();
    }
    Ok(Books { ledger, journal: Some(path), is_disposable })
}

/// Says what a journal has of this model, and whether it is used.
fn say_what_is_known(context: &Context, study: &Study, path: &Path, contents: &Contents, is_used: bool) {
    let model = study.model_hash();
    let own = contents.records.iter().filter(|record| record.model == model).count();
    let others = contents.records.len() - own;
    let (shown, runs) = (path.display(), plural(own, "model run"));
    match (own, is_used) {
        (0, true) if others > 0 => context.say(&format!(
            "{shown}: has {} of other models and none of this one; model, constants or inputs have changed",
            plural(others, "run")
        )),
        (0, true) if !matches!(study.model, ModelSettings::Table(_)) => {
            context.say(&format!("{shown}: has no model runs, so there is nothing to resume from"));
        }
        (0, _) => {}
        (_, true) => {
            context.say(&format!("{shown}: {runs} recorded"));
            changed_programs(context, study, path);
        }
        (_, false) => {
            context.say(&format!("{shown}: {runs} recorded earlier are not used; stop and add --resume to use them"));
        }
    }
}

/// Says which files of the program are newer than its last recorded run: what they answer now may be something else.
fn changed_programs(context: &Context, study: &Study, journal: &Path) {
    let ModelSettings::Command(command) = &study.model else { return };
    let modified = |path: &Path| path.metadata().and_then(|metadata| metadata.modified()).ok();
    let Some(last_run) = modified(journal) else { return };
    for name in command.arguments.iter().filter_map(|argument| argument.strip_prefix("{study}/")) {
        if modified(&command.study_folder.join(name)).is_some_and(|changed| changed > last_run) {
            context.say(&format!(
                "{name} has changed since the last recorded run; if it answers otherwise now, change model.version in the study, so that \
                 earlier runs no longer count"
            ));
        }
    }
}

/// Says what is wrong with a journal that can be used all the same.
pub(super) fn remark(context: &Context, path: &Path, contents: &Contents) {
    if contents.torn_bytes > 0 {
        context.say(&format!(
            "{}: cut {} of a run whose record was not complete when an earlier build ended",
            path.display(),
            plural(contents.torn_bytes as usize, "byte")
        ));
    }
    if contents.damaged_bytes > 0 {
        context.say(&format!(
            "{}: {} between records are damaged and were passed over; the runs recorded there are lost",
            path.display(),
            plural(contents.damaged_bytes as usize, "byte")
        ));
    }
}

/// Opens the books of a command that runs the model at random points: those of programs are recorded, others only if the user
/// names a journal.
pub(super) fn open_here(context: &Context, study: &Study, options: &Recording) -> anyhow::Result<Books> {
    if let ModelSettings::Table(_) = study.model {
        bail!(
            "pcc cannot run models of kind \"table\", so it cannot sample them, compare with them or certify by them"
        );
    }
    let is_program = matches!(study.model, ModelSettings::Command(_));
    open(context, study, options, is_program.then(|| journal_here(study)))
}

/// `1 run`, `2 runs`.
pub(super) fn plural(count: usize, noun: &str) -> String {
    let digits = crate::report::count(count as u64);
    if count == 1 { format!("{digits} {noun}") } else { format!("{digits} {noun}s") }
}
