//! A chain of equal masses, of which everything is known in closed form.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::fs;

use tempfile::TempDir;

use super::Outcome;

/// Of each mass but those at free ends, which have half of it, kg.
const MASS: f64 = 0.05;
/// Of each spring, N/m.
const STIFFNESS: f64 = 4e5;

/// Masses 1 to n, joined by springs; a spring holds mass 1, or nothing.
pub struct Chain {
    pub held: bool,
    pub n: usize,
}

impl Chain {
    /// `ω_r = 2 √(k/m) sin θ_r/2`, with `θ_r = (2r − 1) π/2n` of the held and `(r − 1) π/(n − 1)` of the free one.
    fn angle(&self, mode: usize) -> f64 {
        match self.held {
            true => (2 * mode - 1) as f64 * PI / (2 * self.n) as f64,
            false => (mode - 1) as f64 * PI / (self.n - 1) as f64,
        }
    }

    fn omega(&self, mode: usize) -> f64 {
        2.0 * (STIFFNESS / MASS).sqrt() * (0.5 * self.angle(mode)).sin()
    }

    /// Frequency of a mode (from 1), Hz.
    pub fn hz(&self, mode: usize) -> f64 {
        self.omega(mode) / TAU
    }

    /// Mass-normalised displacement of a mass (from 1), 1/√kg.
    fn shape(&self, mass: usize, mode: usize) -> f64 {
        let angle = self.angle(mode);
        if self.held {
            return (2.0 / (MASS * self.n as f64)).sqrt() * (mass as f64 * angle).sin();
        }
        // The first is a translation, the last one alternates.
        let share = if mode == 1 || mode == self.n { 1.0 } else { 2.0 };
        (share / (MASS * (self.n - 1) as f64)).sqrt() * ((mass - 1) as f64 * angle).cos()
    }

    /// What the first `kept` modes leave of the flexibility: the whole one is that of springs in a row.
    fn residual(&self, (i, j): (usize, usize), kept: usize) -> f64 {
        let of = |mode: usize| self.shape(i, mode) * self.shape(j, mode) / self.omega(mode).powi(2);
        match self.held {
            true => i.min(j) as f64 / STIFFNESS - (1..=kept).map(of).sum::<f64>(),
            false => (kept + 1..=self.n).map(of).sum(),
        }
    }

    /// The structure as matrices in its first modes, before walls: node, side and gap.
    pub fn matrices(&self, folder: &TempDir, modes: usize, walls: &[(usize, f64, f64)]) -> Outcome<String> {
        let n = self.n;
        let (mut k, mut m, mut dofs) = (String::new(), String::new(), "row,node,component\n".to_owned());
        for i in 1..=n {
            let is_end = i == n || i == 1 && !self.held;
            let [springs, mass] = if is_end { [1.0, 0.5] } else { [2.0, 1.0] };
            writeln!(k, "{i} {i} {:e}", springs * STIFFNESS)?;
            writeln!(m, "{i} {i} {:e}", mass * MASS)?;
            if i > 1 {
                writeln!(k, "{i} {} {:e}", i - 1, -STIFFNESS)?;
            }
            writeln!(dofs, "{i},{i},ux")?;
        }
        let head = |entries: usize| format!("%%MatrixMarket matrix coordinate real symmetric\n{n} {n} {entries}\n");
        fs::write(folder.path().join("k.mtx"), head(2 * n - 1) + &k)?;
        fs::write(folder.path().join("m.mtx"), head(n) + &m)?;
        fs::write(folder.path().join("dofs.csv"), dofs)?;
        let contacts = walls.iter().map(|(node, side, gap)| {
            format!("[[contact]]\nnode = {node}\nnormal = [{side:?}, 0.0, 0.0]\ngap_m = {gap:?}\n")
        });
        let files = "[structure]\nkind = \"matrices\"\nstiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"\n";
        Ok(format!("{files}[reduction]\nmodes = {modes}\n{}", contacts.collect::<String>()))
    }

    /// The structure by its first modes and the displacements of these masses, in files of text: `rows.csv` with a line
    /// a row, `by_mode.csv` with a line a mode, and the flexibility under its key.
    pub fn reduced(&self, folder: &TempDir, modes: usize, rows: &[usize], flexibility: &str) -> Outcome<String> {
        let line = |values: Vec<f64>| values.iter().map(|x| format!("{x:e}")).collect::<Vec<_>>().join(",") + "\n";
        let by_row = rows.iter().map(|&i| line((1..=modes).map(|mode| self.shape(i, mode)).collect()));
        let by_mode = (1..=modes).map(|mode| line(rows.iter().map(|&i| self.shape(i, mode)).collect()));
        let is_static = flexibility == "flexibility_m_n";
        let whole = |i: usize, j: usize| self.residual((i, j), if is_static { 0 } else { modes });
        let table = rows.iter().map(|&i| line(rows.iter().map(|&j| whole(i, j)).collect()));
        fs::write(folder.path().join("rows.csv"), by_row.collect::<String>())?;
        fs::write(folder.path().join("by_mode.csv"), by_mode.collect::<String>())?;
        fs::write(folder.path().join(format!("{flexibility}.csv")), table.collect::<String>())?;
        let hz: Vec<String> = (1..=modes).map(|mode| format!("{:e}", self.hz(mode))).collect();
        Ok(format!(
            "[structure]\nkind = \"reduced\"\nfrequencies_hz = [{}]\ncontact_rows = \"rows.csv\"\n\
            {flexibility} = \"{flexibility}.csv\"\n",
            hz.join(", ")
        ))
    }

    /// Displacements of these masses in the first modes, a line each, and under unit forces on those of `rows`: whole,
    /// or what the modes leave.
    pub fn seen(&self, modes: usize, masses: &[usize], rows: &[usize], whole: bool) -> [String; 2] {
        let line = |values: Vec<f64>| values.iter().map(|x| format!("{x:e}")).collect::<Vec<_>>().join(",") + "\n";
        let kept = if whole { 0 } else { modes };
        let shapes = masses.iter().map(|&i| line((1..=modes).map(|mode| self.shape(i, mode)).collect()));
        let answers = masses.iter().map(|&i| line(rows.iter().map(|&j| self.residual((i, j), kept)).collect()));
        [shapes.collect(), answers.collect()]
    }

    /// Stiffness and mass of the held chain in the displacement of its last mass and all modes with that mass fixed:
    /// `θ_r = r π/n`, and `i/n` where the last mass is displaced by one.
    pub fn craig_bampton(&self) -> [Vec<Vec<f64>>; 2] {
        let n = self.n;
        let angle = |r: usize| r as f64 * PI / n as f64;
        let shape = |i: usize, r: usize| (2.0 / (MASS * n as f64)).sqrt() * (i as f64 * angle(r)).sin();
        let share = |i: usize| i as f64 / n as f64;
        let coupling = |r: usize| (1..n).map(|i| MASS * share(i) * shape(i, r)).sum::<f64>();
        let boundary = 0.5 * MASS + (1..n).map(|i| MASS * share(i).powi(2)).sum::<f64>();
        let omega = |r: usize| 2.0 * (STIFFNESS / MASS).sqrt() * (0.5 * angle(r)).sin();
        let entry = |i: usize, j: usize| match (i, j) {
            (0, 0) => [STIFFNESS / n as f64, boundary],
            (0, r) | (r, 0) => [0.0, coupling(r)],
            (r, s) if r == s => [omega(r).powi(2), 1.0],
            _ => [0.0, 0.0],
        };
        [0, 1].map(|which| (0..n).map(|i| (0..n).map(|j| entry(i, j)[which]).collect()).collect())
    }
}
