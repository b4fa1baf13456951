//! Plans over generated ground and writes the page: `cargo run -p bekker-planning --example plan_page`.

use bekker_planning::answer::PlanAnswer;
use bekker_planning::page::plan_page;
use bekker_planning::plan::Request;
use bekker_planning::site::{Site, SiteError, Source};

fn main() -> Result<(), SiteError> {
    let ground = std::env::args().nth(1).unwrap_or_else(|| "benign:3".to_owned());
    let site = Site::open(&Source::new(&ground, "fsrl"))?;
    let request = Request { start: [1.0, 1.0], heading: None, goal: [6.5, 6.0], most_evaluations: 60_000 };
    let plan = site.plan(&request)?;
    let alternatives = site.alternatives(&request, &plan)?;
    let answer = PlanAnswer::new(&site, &plan).with_alternatives(&alternatives);
    println!(
        "{:.2} m, {} places evaluated, {} of them unsafe",
        answer.length,
        answer.evaluations,
        answer.failures.len()
    );
    if let Err(error) = std::fs::write("plan.html", plan_page(&site, &plan, &answer, Some(&alternatives))) {
        eprintln!("plan.html: {error}");
    }
    Ok(())
}
