//! Files of a study: table, statistics, page.

use std::fs;
use std::path::Path;

use serde::Serialize;

use crate::collect::{Collected, Counts};
use crate::error::StudyError;
use crate::figures::figures;
use crate::first_order::FirstOrder;
use crate::page;
use crate::statistics::Statistics;
use crate::store::replace;
use crate::study::Study;

#[derive(Serialize)]
struct Summary<'a> {
    program: &'static str,
    version: &'static str,
    title: &'a str,
    scene: &'a str,
    design: &'static str,
    #[serde(flatten)]
    counts: Counts,
    statistics: &'a [Statistics],
    #[serde(skip_serializing_if = "Option::is_none")]
    first_order: Option<&'a FirstOrder>,
}

impl Collected {
    /// Writes `study.csv`, with the feature `parquet` also `study.parquet`, `study.json` (statistics), a figure of each
    /// quantity over each variable, and `report.html` into the directory of the study. Each is replaced atomically.
    ///
    /// # Errors
    /// [`StudyError`] if one cannot be written.
    pub fn write(&self, study: &Study) -> Result<(), StudyError> {
        let directory = &study.directory;
        fs::create_dir_all(directory).map_err(StudyError::io(directory))?;
        let summary = serde_json::to_vec_pretty(&self.summary(study)).unwrap_or_default();
        let page = page::page(study, self);
        let tables = self.tables(directory)?;
        let tables = tables.iter().map(|(name, bytes)| (*name, bytes.as_slice()));
        let others: [(&str, &[u8]); 2] = [("study.json", &summary), ("report.html", page.as_bytes())];
        let figures = figures(study, self);
        let drawn = figures.iter().map(|(file, svg)| (file.as_str(), svg.as_bytes()));
        tables.chain(others).chain(drawn).try_for_each(|(name, bytes)| {
            let path = directory.join(name);
            replace(&path, bytes).map_err(StudyError::io(&path))
        })
    }

    /// The table in each of its formats, with the names of its files in `directory`.
    #[cfg(feature = "parquet")]
    fn tables(&self, directory: &Path) -> Result<Vec<(&'static str, Vec<u8>)>, StudyError> {
        let path = directory.join("study.parquet");
        let parquet = self.table.to_parquet().map_err(|source| StudyError::Parquet { path, source })?;
        Ok(vec![("study.csv", self.table.to_csv()), ("study.parquet", parquet)])
    }

    #[cfg(not(feature = "parquet"))]
    fn tables(&self, _directory: &Path) -> Result<Vec<(&'static str, Vec<u8>)>, StudyError> {
        Ok(vec![("study.csv", self.table.to_csv())])
    }

    fn summary<'a>(&'a self, study: &'a Study) -> Summary<'a> {
        Summary {
            program: "nlmodes-cli",
            version: env!("CARGO_PKG_VERSION"),
            title: &study.title,
            scene: &study.scene_name,
            design: study.design.kind.name(),
            counts: self.counts,
            statistics: &self.statistics,
            first_order: self.first_order.as_ref(),
        }
    }
}
