//! Writes one figure of each kind into a folder, for visual inspection: `cargo run --example gallery -- FOLDER`.

#[path = "../tests/suite/report/samples.rs"]
mod samples;

use nlmodes_report::{Abscissa, BranchFigure, HistoryFigure, MotionFigure, write_branch, write_harmonics};
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("which folder?")?);
    std::fs::create_dir_all(&folder)?;
    let (exact, looped) = (samples::rod(120, 8), samples::looped(400));
    let both = [&exact, &looped];

    write_branch(folder.join("branch.csv"), &looped)?;
    write_harmonics(folder.join("harmonics.npz"), &exact)?;

    let energy = BranchFigure::new(Abscissa::Energy, &both).title("Rod with a one-sided stop");
    energy.mark(1, 140, "P1").mark(1, 168, "P2").render()?.write(folder.join("frequency_energy.svg"))?;
    BranchFigure::new(Abscissa::ModalAmplitude, &both).render()?.write(folder.join("frequency_amplitude.svg"))?;
    let narrow = samples::rod(4, 1);
    BranchFigure::new(Abscissa::Energy, &[&narrow]).render()?.write(folder.join("few_points.svg"))?;
    let single = samples::rod(1, 1);
    BranchFigure::new(Abscissa::Energy, &[&single]).render()?.write(folder.join("one_point.svg"))?;

    for point in [0, 119] {
        let motion = MotionFigure::new(&exact, point).clamped_at(&[0.0]);
        motion.render()?.write(folder.join(format!("motion_{point}.svg")))?;
    }

    let (hard, soft) = (samples::history("stiff stop", 2.3e6), samples::history("soft stop", 1e5));
    HistoryFigure::new(&[&hard]).title("Point 12").render()?.write(folder.join("history.svg"))?;
    HistoryFigure::new(&[&hard, &soft]).with_acceleration().render()?.write(folder.join("histories.svg"))?;
    Ok(())
}
