//! The page: everything about some branches in one self-contained file.

mod data;
mod document;
pub mod explore;
mod frame;
mod history;
mod knots;
mod motion;
mod number;
mod overview;
mod packed;
mod report_page;
mod sections;
mod table;
mod wire;

pub use frame::Page;
pub use table::DataTable;
pub use wire::Wireframe;

use crate::ReportError;
use crate::StopLine;
use crate::figure::{Figure, HistoryLook, LineKind, SHOWN_MODES, marked, strongest};
use crate::output::replace_file;
use crate::palette;
use nlmodes_modal::{ModalBranch, Participation, TimeHistory};
use serde::Serialize;
use serde_json::Value;
use std::io::Write;
use std::path::Path;

/// Motion and force of the contacts at all stops: branch, point; over one period from phase 0, its end included.
type ContactMotion<'a> = dyn Fn(usize, usize) -> Option<Vec<TimeHistory>> + 'a;

/// `report.html`: one page about some branches, for viewing and printing without a network.
///
/// It shows frequency over energy and over modal amplitude and the participation of linear modes, with zoom and hover;
/// the motion of the structure at the selected point; time histories; tables of events, internal resonances and ends;
/// and added contents. Without JavaScript the same figures are static. All text is escaped, and a content security
/// policy permits only the page's own script and style.
///
/// ```
/// # use nlmodes_modal::{BranchEnd, ModalBranch};
/// # let end = BranchEnd::given("it closed");
/// # let (points, coordinates) = (Vec::new(), Vec::new());
/// # let branch = ModalBranch { label: "rod".into(), coordinates, contact_coordinate: None, stop: None, points, end };
/// use nlmodes_report::HtmlReport;
///
/// let folder = tempfile::tempdir()?;
/// HtmlReport::new("Rod against a stop", &[&branch]).write(folder.path().join("report.html"))?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct HtmlReport<'a> {
    title: String,
    branches: &'a [&'a ModalBranch],
    lines: Vec<String>,
    warnings: Vec<String>,
    marks: Vec<(usize, usize, String)>,
    clamped: Vec<f64>,
    stops: Vec<StopLine>,
    contact_motion: Option<&'a ContactMotion<'a>>,
    wireframe: Option<Wireframe>,
    histories: Vec<(String, Vec<&'a TimeHistory>, HistoryLook)>,
    participation: &'a [&'a [Participation]],
    leading: Vec<(String, Figure)>,
    main_figure: Option<MainFigure>,
    quantities: Vec<(String, Vec<Vec<f64>>)>,
    scattered: Vec<usize>,
    first_points: Vec<usize>,
    kinds: Vec<LineKind>,
    figures: Vec<(String, Figure)>,
    tables: Vec<DataTable>,
    closing: Vec<DataTable>,
    documents: Vec<(String, Value)>,
}

/// The main figure of a page, if it is not frequency over energy.
struct MainFigure {
    title: String,
    still: Figure,
    axes: [String; 2],
}

impl<'a> HtmlReport<'a> {
    /// A page about these branches, the first of which is the main one.
    pub fn new(title: impl Into<String>, branches: &'a [&'a ModalBranch]) -> Self {
        Self {
            title: title.into(),
            branches,
            lines: Vec::new(),
            warnings: Vec::new(),
            marks: Vec::new(),
            clamped: Vec::new(),
            stops: Vec::new(),
            contact_motion: None,
            wireframe: None,
            histories: Vec::new(),
            participation: &[],
            leading: Vec::new(),
            main_figure: None,
            quantities: Vec::new(),
            scattered: Vec::new(),
            first_points: Vec::new(),
            kinds: Vec::new(),
            figures: Vec::new(),
            tables: Vec::new(),
            closing: Vec::new(),
            documents: Vec::new(),
        }
    }

    /// With a line below the title: how it was computed, by what, when.
    pub fn line(mut self, text: impl Into<String>) -> Self {
        self.lines.push(text.into());
        self
    }

    /// With a warning above everything except how the branches ended: numbers not to use, and unmet assumptions. It
    /// begins with a capital letter.
    pub fn warning(mut self, text: impl Into<String>) -> Self {
        let text = text.into();
        let mut letters = text.chars();
        let first = letters.next().map(|letter| letter.to_uppercase().to_string());
        self.warnings.push(first.unwrap_or_default() + letters.as_str());
        self
    }

    /// With a name, for instance `P1`, for point `point` of the branch number `branch`. The last named point is
    /// animated first.
    pub fn mark(mut self, branch: usize, point: usize, name: impl Into<String>) -> Self {
        self.marks.push((branch, point, name.into()));
        self
    }

    /// With the points of each branch numbered from these on, as in a table of all of them; otherwise each from 0.
    pub fn first_points(mut self, numbers: &[usize]) -> Self {
        self.first_points = numbers.to_vec();
        self
    }

    /// With displacement zero at these positions, m, which have no coordinate because they are clamped.
    pub fn clamped_at(mut self, positions: &[f64]) -> Self {
        self.clamped.extend_from_slice(positions);
        self
    }

    /// With these stops instead of the first one of each branch.
    pub fn stops(mut self, stops: &[StopLine]) -> Self {
        self.stops = stops.to_vec();
        self
    }

    /// With the exact motion and the force of each stop's contact; otherwise contacts move by their harmonics.
    ///
    /// `motion` takes the branch and the point, returns the contacts in the order of the stops, and is called once for
    /// each animated point.
    pub fn contact_motion(mut self, motion: &'a ContactMotion<'a>) -> Self {
        self.contact_motion = Some(motion);
        self
    }

    /// With the motion of a structure in space, which can be rotated; omitted if it cannot be drawn.
    pub fn wireframe(mut self, wireframe: Wireframe) -> Self {
        self.wireframe = Some(wireframe).filter(Wireframe::is_sound);
        self
    }

    /// With a separate time history.
    pub fn history(self, name: impl Into<String>, history: &'a TimeHistory) -> Self {
        self.histories(name, &[history])
    }

    /// With overlaid time histories, named by their labels; the stop is that of the first.
    pub fn histories(self, name: impl Into<String>, histories: &[&'a TimeHistory]) -> Self {
        self.histories_at(name, histories, &[])
    }

    /// As [`HtmlReport::histories`], at the stops with these numbers, one for each history.
    pub fn histories_at(mut self, name: impl Into<String>, histories: &[&'a TimeHistory], stops: &[usize]) -> Self {
        if !histories.is_empty() {
            self.histories.push((name.into(), histories.to_vec(), HistoryLook::at(stops)));
        }
        self
    }

    /// With the shares of the lowest linear modes in the kinetic energy over the modal amplitude: for each branch, that
    /// at each of its points.
    pub fn participation(mut self, branches: &'a [&'a [Participation]]) -> Self {
        self.participation = branches;
        self
    }

    /// Number of modes with a participation at all points of all branches.
    fn participating_modes(&self) -> usize {
        let factors = self.participation.iter().flat_map(|points| points.iter()).map(|p| p.energy_shares.len());
        if self.participation.len() == self.branches.len() { factors.min().unwrap_or(0) } else { 0 }
    }

    /// The modes whose shares are drawn, from 0: those with the largest ones.
    fn strongest_modes(&self) -> Vec<usize> {
        let all = self.participation.iter().flat_map(|points| points.iter());
        let found = if self.participating_modes() == 0 { Vec::new() } else { strongest(all, SHOWN_MODES) };
        found.into_iter().filter(|mode| *mode < self.participating_modes()).collect()
    }

    /// With a static main figure, before all others.
    pub fn leading_figure(mut self, title: impl Into<String>, figure: Figure) -> Self {
        self.leading.push((title.into(), figure));
        self
    }

    /// With an additional quantity for each point of each branch, shown among its values and available as an axis; the
    /// label ends in ` in ` and its unit.
    ///
    /// Omitted if the number of values differs from the number of points.
    pub fn quantity(mut self, label: impl Into<String>, values: Vec<Vec<f64>>) -> Self {
        let lengths = self.branches.iter().map(|branch| branch.points.len());
        if values.iter().map(Vec::len).eq(lengths) {
            self.quantities.push((label.into(), values));
        }
        self
    }

    /// With the main figure, in which points can be hovered and selected. Its axes are `frequency`, `energy`,
    /// `amplitude` … of the points, or `quantity0` and so on, the quantities in their order; without the script `still`
    /// is shown.
    pub fn main_figure(mut self, title: impl Into<String>, still: Figure, axes: [&str; 2]) -> Self {
        self.main_figure = Some(MainFigure { title: title.into(), still, axes: axes.map(str::to_owned) });
        self
    }

    /// Draws the branches with these numbers as points without a line: nothing was measured between them.
    pub fn scattered(mut self, branches: &[usize]) -> Self {
        self.scattered = branches.to_vec();
        self
    }

    /// With branches that are curves of these kinds, in the colours of [`ResponseFigure`](crate::ResponseFigure).
    pub fn kinds(mut self, kinds: &[LineKind]) -> Self {
        self.kinds = kinds.to_vec();
        self
    }

    /// Colour of the branch with this number.
    fn color(&self, branch: usize) -> &'static str {
        let before = || self.kinds.iter().take(branch).filter(|kind| **kind == LineKind::Response).count();
        self.kinds.get(branch).map_or_else(|| palette::curve(branch), |kind| kind.color(before()))
    }

    /// With an additional static figure.
    pub fn figure(mut self, title: impl Into<String>, figure: Figure) -> Self {
        self.figures.push((title.into(), figure));
        self
    }

    /// With an additional table.
    pub fn table(mut self, table: DataTable) -> Self {
        self.tables.push(table);
        self
    }

    /// With a table at the end of the page: how far its numbers can be trusted.
    pub fn closing_table(mut self, table: DataTable) -> Self {
        self.closing.push(table);
        self
    }

    /// With a tree of names and values, for instance a scene.
    ///
    /// # Errors
    /// [`ReportError::Unshowable`] if it has no JSON form.
    pub fn document(mut self, title: impl Into<String>, content: &impl Serialize) -> Result<Self, ReportError> {
        let title = title.into();
        match serde_json::to_value(content) {
            Ok(value) => self.documents.push((title, value)),
            Err(source) => return Err(ReportError::Unshowable { title, source }),
        }
        Ok(self)
    }

    /// The page.
    ///
    /// Figures that cannot be drawn, because no value is finite, are omitted.
    ///
    /// # Errors
    /// [`ReportError::NoSuchPoint`] for the name of a nonexistent point, [`ReportError::SeriesLength`] if a series of a
    /// time history does not fit its time, or a branch has not as many participations as points.
    pub fn render(&self) -> Result<String, ReportError> {
        self.check_marks()?;
        let sections = self.sections()?;
        let data = data::Data::new(self);
        Ok(report_page::page(&self.title, &sections, &data))
    }

    /// Data for the script of the page, as JSON.
    ///
    /// # Errors
    /// [`ReportError::NoSuchPoint`] for the name of a nonexistent point.
    pub fn data(&self) -> Result<String, ReportError> {
        self.check_marks()?;
        Ok(data::Data::new(self).json())
    }

    /// Writes the page; an existing file is replaced atomically.
    ///
    /// # Errors
    /// Those of [`HtmlReport::render`], and [`ReportError::Io`] if the file cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), ReportError> {
        let page = self.render()?;
        replace_file(path.as_ref(), |file| file.write_all(page.as_bytes()))
    }

    fn check_marks(&self) -> Result<(), ReportError> {
        self.marks.iter().try_for_each(|(branch, point, _)| marked(self.branches, *branch, *point).map(drop))
    }
}
