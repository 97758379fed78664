//! What is printed and drawn.

use std::path::Path;

use nlmodes::report::ConvergenceFigure;
use nlmodes_benchmarks::Failure;

use crate::cases::Case;
use crate::methods::{Measurement, Method};

type ErrorOf = fn(&Measurement) -> f64;

type Selects = fn(&Method) -> bool;

const ERRORS: [(&str, &str, ErrorOf); 3] = [
    ("displacement", "displacement of the contact, L2", |m| m.displacement),
    ("frequency", "frequency", |m| m.frequency),
    ("mean_force", "mean contact force", |m| m.mean_force),
];

/// Errors over harmonics with exact switching, then the least time for each digit by each method.
pub fn print(case: &Case, all: &[Measurement]) {
    println!(
        "\n| `N_h` | displacement | frequency | mean force | time | iterations |\n| ---: | ---: | ---: | ---: | ---: \
         | ---: |"
    );
    for m in all.iter().filter(|m| matches!(m.method, Method::Exact | Method::Shooting)) {
        let h = if m.method == Method::Shooting { "shooting".to_owned() } else { m.harmonics.to_string() };
        let mark = if m.is_found() { "" } else { " (not found)" };
        println!(
            "| {h}{mark} | {} | {} | {} | {} | {} |",
            figure(m.displacement),
            figure(m.frequency),
            figure(m.mean_force),
            milliseconds(m.time),
            m.iterations
        );
    }
    for (_, name, error) in ERRORS {
        println!("\nLeast time, ms, for an error of the {name} below ({})\n", case.slug);
        let digits: Vec<f64> = (1..=10).map(|d| 10_f64.powi(-d)).collect();
        println!(
            "| method |{} |",
            digits.iter().map(|d| format!(" {d:.0e} |")).collect::<String>().trim_end_matches('|')
        );
        println!("| --- |{}", " ---: |".repeat(digits.len()));
        let kinds: [(&str, Selects); 4] = [
            ("MS-HBM, exact switching", |m| *m == Method::Exact),
            ("MS-HBM, sampled", |m| matches!(m, Method::Sampled { .. })),
            ("conventional HBM", |m| matches!(m, Method::HarmonicBalance { .. })),
            ("shooting", |m| *m == Method::Shooting),
        ];
        for (kind, is) in kinds {
            let cell = |digit: &f64| {
                let good =
                    all.iter().filter(|m| is(&m.method) && m.is_found() && error(m) <= *digit && m.time.is_finite());
                let best = good.min_by(|a, b| a.time.total_cmp(&b.time));
                best.map_or_else(|| " – |".to_owned(), |m| format!(" {} ({}) |", milliseconds(m.time), setting(m)))
            };
            println!("| {kind} |{}", digits.iter().map(cell).collect::<String>());
        }
    }
}

fn setting(m: &Measurement) -> String {
    match m.method {
        Method::Shooting => "–".to_owned(),
        Method::Exact => m.harmonics.to_string(),
        Method::Sampled { samples } => format!("{}, {samples}", m.harmonics),
        Method::HarmonicBalance { stiffness } => format!("{}, 1e{:.0}", m.harmonics, stiffness.log10()),
    }
}

/// An error, or a dash where there is none.
pub fn figure(error: f64) -> String {
    if error.is_nan() { "–".to_owned() } else { format!("{error:.1e}") }
}

fn milliseconds(seconds: f64) -> String {
    let ms = 1e3 * seconds;
    if ms.is_nan() {
        return "–".to_owned();
    }
    let decimals = (1 - ms.log10().floor() as i32).clamp(0, 4) as usize;
    format!("{ms:.decimals$}")
}

pub fn print_solvers(all: &[Measurement]) {
    println!(
        "\n| contact solver | switching | `N_h` | displacement | time | iterations |\n| --- | --- | ---: | ---: | \
         ---: | ---: |"
    );
    for m in all {
        let mark = if m.is_found() { "" } else { " (not found)" };
        println!(
            "| {}{mark} | {} | {} | {} | {} | {} |",
            m.solver,
            m.method.name(),
            m.harmonics,
            figure(m.displacement),
            milliseconds(m.time),
            m.iterations
        );
    }
}

/// Error over time, a line a method and setting.
pub fn figures(case: &Case, all: &[Measurement], folder: &Path) -> Result<(), Failure> {
    let mut methods: Vec<Method> = Vec::new();
    all.iter().for_each(|m| {
        let thinned = match m.method {
            Method::Sampled { samples } => [64, 1024, 16384].contains(&samples),
            Method::HarmonicBalance { stiffness } => [2, 4].contains(&(stiffness.log10().round() as i32)),
            Method::Shooting | Method::Exact => true,
        };
        if thinned && !methods.contains(&m.method) {
            methods.push(m.method);
        }
    });
    methods.sort_by_key(|m| matches!(m, Method::Shooting));
    for (slug, name, error) in ERRORS {
        let series: Vec<(String, Vec<(f64, f64)>)> = methods
            .iter()
            .map(|method| {
                let own = all.iter().filter(|m| m.method == *method && m.is_found() && m.time.is_finite());
                // What is right to rounding is drawn at rounding.
                (
                    method.name(),
                    own.filter(|m| error(m).is_finite()).map(|m| (1e3 * m.time, error(m).max(1e-15))).collect(),
                )
            })
            .collect();
        let label = format!("error of the {name}");
        let mut figure = ConvergenceFigure::new("processor time of a point, ms", &label).title(case.title);
        for (name, points) in series.iter().filter(|(_, points)| !points.is_empty()) {
            figure = figure.series(name, points);
        }
        figure.render()?.write(folder.join(format!("work_precision_{}_{slug}.svg", case.slug)))?;
    }
    Ok(())
}
