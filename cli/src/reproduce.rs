//! `bekker reproduce`: the thesis's results beside ours, as a page and as data.

use crate::output::{say, write};
use crate::progress;
use anyhow::{Context, Result, bail};
use bekker_reproduction::{Finding, STUDIES, Study, plot_csv, reproduction_page, rows_csv};
use std::path::{Path, PathBuf};

/// Compute the thesis's results (sections 2.3, 2.4, 2.6, 3.3, 3.5 and 4.4) and write them beside the published ones.
#[derive(clap::Args)]
pub struct Reproduce {
    /// Folder to write to: reproduction.html, reproduction.csv, and one CSV a figure.
    #[arg(long, default_value = "bekker-out/reproduction")]
    out: PathBuf,
    /// Trials (seeds) of everything that is noisy or varied.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    trials: u32,
    /// Only these studies, separated by commas; all where missing.
    #[arg(long, value_delimiter = ',')]
    only: Vec<String>,
}

impl Reproduce {
    pub fn run(self) -> Result<()> {
        let studies = chosen(&self.only)?;
        let figures = self.out.join("figures");
        std::fs::create_dir_all(&figures).with_context(|| format!("cannot make `{}`", figures.display()))?;
        let bar = progress::bar(studies.len() as u64, "");
        let mut findings = Vec::new();
        for study in studies {
            bar.set_message(study.id);
            let found = (study.run)(self.trials as usize)
                .map_err(anyhow::Error::from_boxed)
                .with_context(|| format!("study `{}`", study.id))?;
            findings.extend(found);
            bar.inc(1);
        }
        bar.finish_and_clear();
        for plot in findings.iter().flat_map(|finding| &finding.plots) {
            let path = figures.join(format!("{}.csv", plot.id));
            std::fs::write(&path, plot_csv(plot)).with_context(|| format!("cannot write `{}`", path.display()))?;
        }
        print(&findings)?;
        write(&self.out.join("reproduction.csv"), &rows_csv(&findings))?;
        page(&self.out, &findings)
    }
}

fn page(out: &Path, findings: &[Finding]) -> Result<()> {
    write(&out.join("reproduction.html"), &reproduction_page(findings))
}

/// The studies asked for, in the thesis's order.
fn chosen(only: &[String]) -> Result<Vec<&'static Study>> {
    let known: Vec<&str> = STUDIES.iter().map(|study| study.id).collect();
    if let Some(unknown) = only.iter().find(|name| !known.contains(&name.as_str())) {
        bail!("unknown study `{unknown}`; expected one of {}", known.join(", "));
    }
    Ok(STUDIES.iter().filter(|study| only.is_empty() || only.iter().any(|name| name == study.id)).collect())
}

/// The numbers that the thesis gives, beside ours.
fn print(findings: &[Finding]) -> Result<()> {
    for finding in findings {
        let rows: Vec<_> = finding.rows.iter().filter(|row| row.thesis.is_some()).collect();
        if rows.is_empty() {
            continue;
        }
        say!("{} ({})", finding.title, finding.section);
        for row in rows {
            let thesis = row.thesis.unwrap_or(f64::NAN);
            let ours = row.ours;
            say!(
                "   {:64} thesis {thesis:>8.3}   ours {:>8.3}  ({:.3} .. {:.3})",
                row.quantity,
                ours.median,
                ours.low,
                ours.high
            );
        }
    }
    Ok(())
}
