//! The study of a surrogate: the one that is named, or the one that lies beside the surrogate.

use super::Context;
use pcc_compile::study::{Study, StudyFileError};
use pcc_evaluate::surrogate::Surrogate;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Model runs that surrogates are compared with: as many as the paper's reference; of programs, which take their time,
/// fewer.
const RUNS: u64 = 10_000;
const PROGRAM_RUNS: u64 = 100;

/// A study and its file.
pub(super) struct StudyFile {
    pub study: Study,
    pub path: PathBuf,
}

/// Why there is no study beside a surrogate.
#[derive(Debug, Error)]
pub(super) enum SearchError {
    #[error("{surrogate}: its study is called {name:?}, which is no name of a file to look for; say --study FILE")]
    NoFileName { surrogate: String, name: String },
    #[error("{surrogate}: its study is needed; {looked_for} was looked for and is not there; say --study FILE")]
    NotThere { surrogate: String, looked_for: String },
    #[error("{surrogate}: its study is needed; {looked_for} was looked for and not taken; say --study FILE: {cause}")]
    Unreadable { surrogate: String, looked_for: String, cause: Box<StudyFileError> },
    #[error(
        "{surrogate}: its study is needed; {looked_for} was looked for and not taken, because its model, constants, \
         inputs or spectrum are others; say --study FILE"
    )]
    OtherProblem { surrogate: String, looked_for: String },
}

impl Context {
    /// The study that was named, or else the one beside the surrogate, which is said.
    pub fn study_of(&self, named: Option<&Path>, file: &Path, surrogate: &Surrogate) -> anyhow::Result<StudyFile> {
        if let Some(path) = named {
            return Ok(StudyFile { study: Study::read(path)?, path: path.to_owned() });
        }
        let found = study_beside(file, surrogate)?;
        self.say(&format!("the study is {}, of the same problem as {}", found.path.display(), file.display()));
        Ok(found)
    }
}

/// `<study name>.toml` in the folder of the surrogate, if it poses the surrogate's problem.
fn study_beside(file: &Path, surrogate: &Surrogate) -> Result<StudyFile, SearchError> {
    let (shown, name) = (file.display().to_string(), &surrogate.provenance.study_name);
    // Surrogates come from anywhere: their names lead to no other folder.
    if Path::new(name).file_name().is_none_or(|plain| plain != name.as_str()) || name.contains(['\\', ':', '\0']) {
        return Err(SearchError::NoFileName { surrogate: shown, name: name.clone() });
    }
    let path = file.with_file_name(format!("{name}.toml"));
    let looked_for = path.display().to_string();
    if !path.is_file() {
        return Err(SearchError::NotThere { surrogate: shown, looked_for });
    }
    match Study::read(&path) {
        Err(cause) => Err(SearchError::Unreadable { surrogate: shown, looked_for, cause: Box::new(cause) }),
        Ok(study) if study.problem_hash() != surrogate.provenance.problem_hash => {
            Err(SearchError::OtherProblem { surrogate: shown, looked_for })
        }
        Ok(study) => Ok(StudyFile { study, path }),
    }
}

/// The number of model runs that was asked for, or the usual one for the study's model.
pub(super) fn runs_or_default(asked: Option<u64>, study: &Study) -> u64 {
    asked.unwrap_or(if study.model.is_external() { PROGRAM_RUNS } else { RUNS })
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcc_evaluate::artifact;
    use std::fs;

    const STUDY: &str = include_str!("../../surrogates/clutch-r2-eigenvalues.toml");

    /// A folder with a surrogate, and beside it a file that is called like its study.
    fn beside(text: Option<&str>) -> (tempfile::TempDir, PathBuf, Surrogate) {
        let folder = tempfile::tempdir().unwrap();
        let shipped = concat!(env!("CARGO_MANIFEST_DIR"), "/surrogates/clutch-r2-eigenvalues.pcc");
        if let Some(text) = text {
            fs::write(folder.path().join("clutch-r2-eigenvalues.toml"), text).unwrap();
        }
        let file = folder.path().join("renamed.pcc");
        let surrogate = artifact::read(Path::new(shipped)).unwrap().surrogate;
        (folder, file, surrogate)
    }

    #[test]
    fn a_study_beside_the_surrogate_is_taken_if_it_poses_the_same_problem() {
        let (folder, file, surrogate) = beside(Some(STUDY));
        let found = study_beside(&file, &surrogate).unwrap();
        assert_eq!(found.path, folder.path().join("clutch-r2-eigenvalues.toml"));
        // Another fit is no other problem.
        let (_folder, file, surrogate) = beside(Some(&format!("{STUDY}\n[fit]\nmax_degree = 7\n")));
        assert!(study_beside(&file, &surrogate).is_ok());
    }

    #[test]
    fn what_is_no_study_of_the_surrogate_is_not_taken() {
        let found = |text: Option<&str>| {
            let (_folder, file, surrogate) = beside(text);
            study_beside(&file, &surrogate).map(|_| ()).unwrap_err()
        };
        assert!(matches!(found(None), SearchError::NotThere { .. }));
        assert!(matches!(found(Some("format = 1")), SearchError::Unreadable { .. }));
        let other = STUDY.replace("upper = 0.5", "upper = 0.4");
        assert!(matches!(found(Some(&other)), SearchError::OtherProblem { .. }));
    }

    #[test]
    fn names_of_studies_do_not_lead_to_other_folders() {
        for name in ["../study", "/etc/study", "a/b", "", "..", ".", "c:study", "a\\b", "a/"] {
            let (_folder, file, mut surrogate) = beside(None);
            name.clone_into(&mut surrogate.provenance.study_name);
            let error = study_beside(&file, &surrogate).map(|_| ()).unwrap_err();
            assert!(matches!(error, SearchError::NoFileName { .. }), "{name}: {error}");
        }
    }
}
