//! The sections of the page, each with the static figures shown without the script.

use std::collections::BTreeSet;

use super::history::thinned;
use super::motion::{is_along_an_axis, shown};
use super::number::{hertz, significant};
use super::overview::tongue_at_end;
use super::table::{DataTable, cell, point_cell};
use super::{HtmlReport, data, document};
use crate::ReportError;
use crate::figure::{
    Abscissa, BranchFigure, EventSymbols, Figure, HistoryFigure, ParticipationFigure, SHOWN_MODES, stroboscope,
};
use crate::stations;
use crate::svg::escape;
use nlmodes_modal::{Event, ModalPoint, TimeHistory, tongues};

const HINT: &str = "Wheel or drag to zoom, shift and drag to move, double click to see all again. Point at the curve \
    for its values; \
    click to see that motion beside it. With the keyboard: arrows, Enter, + − 0.";

/// A section: its anchor, its title, its content.
pub(super) struct Section {
    pub id: &'static str,
    pub title: &'static str,
    pub html: String,
}

impl HtmlReport<'_> {
    /// All sections that have something to show; the head of the page is the first, without a title.
    pub(super) fn sections(&self) -> Result<Vec<Section>, ReportError> {
        let section = |id, title, html| Section { id, title, html };
        let all = vec![
            section("overview", "", self.overview()),
            section("responses", "Responses", given(&self.leading)),
            section("branches", self.name_of_branches(), self.branch_figures()),
            section("participations", "Participation of linear modes", self.participation_figure()?),
            section("space", "Motion in space", self.wire_figure()),
            section("histories", "Time histories", self.history_figures()?),
            section("figures", "Figures", given(&self.figures)),
            section("tables", "Tables", self.all_tables()),
            section("scene", "Scene and method", self.all_documents()),
            section("certificate", "How far to trust these numbers", self.closing_tables()),
        ];
        Ok(all.into_iter().filter(|section| !section.html.is_empty()).collect())
    }

    fn branch_figures(&self) -> String {
        let main =
            self.main_figure.as_ref().map_or_else(String::new, |main| boxed(&main.title, &main.still, "id=\"main\""));
        let energy = self.branch_figure(Abscissa::Energy, "energy", "Frequency over averaged kinetic energy");
        let amplitude = match self.main_figure {
            // The axes of both can be chosen.
            Some(_) => String::new(),
            None => self.branch_figure(Abscissa::ModalAmplitude, "amplitude", "Frequency over modal amplitude"),
        };
        if main.is_empty() && energy.is_empty() && amplitude.is_empty() {
            return String::new();
        }
        let motion = self.motion_figure();
        let (class, beside) = if motion.is_empty() { ("pair", motion) } else { ("stage", motion) };
        format!(
            "<p class=\"hint needs-script control\">{HINT}</p>\n<div id=\"legend\"></div>\n<div class=\"{class}\">\
             <div class=\"curves\">{main}{energy}{amplitude}</div>{beside}</div>\n<div id=\"lay\" class=\"controls \
             needs-script control\"></div>\n"
        )
    }

    fn branch_figure(&self, abscissa: Abscissa, id: &str, title: &str) -> String {
        let mut figure = BranchFigure::new(abscissa, self.branches).scattered(&self.scattered);
        for (branch, point, name) in &self.marks {
            figure = figure.mark(*branch, *point, name);
        }
        figure.render().map_or_else(|_| String::new(), |figure| boxed(title, &figure, &format!("id=\"{id}\"")))
    }

    fn participation_figure(&self) -> Result<String, ReportError> {
        let modes = self.participating_modes();
        if modes == 0 {
            return Ok(String::new());
        }
        let pairs: Vec<_> = self.branches.iter().copied().zip(self.participation.iter().copied()).collect();
        match ParticipationFigure::new(&pairs, modes.min(SHOWN_MODES)).render() {
            Ok(figure) => {
                Ok(boxed("Shares of the linear modes in the kinetic energy", &figure, "id=\"participation\""))
            }
            Err(ReportError::NothingToDraw { .. }) => Ok(String::new()),
            Err(error) => Err(error),
        }
    }

    fn motion_figure(&self) -> String {
        let Some((branch, point)) = self.first_moving() else { return String::new() };
        let (stations, stops) = shown(self, self.branches[branch], &data::stops(self, self.branches[branch]));
        let details = "<div id=\"details\" class=\"box needs-script\"></div>";
        if !is_along_an_axis(self.branches[branch], &stations) {
            let walk = "<h3>The chosen point</h3><div id=\"walk\" class=\"controls\"></div>";
            return format!(
                "<div class=\"beside\"><div class=\"box needs-script\" id=\"moving\">{walk}</div>{details}</div>\n"
            );
        }
        let lines: Vec<(usize, f64, f64)> =
            stops.iter().map(|(number, stop, at)| (*number, stations[*at].0, stop.position)).collect();
        let name = stations::word(stations::kind(self.branches[branch]));
        let point = &self.branches[branch].points[point];
        let Some(still) = stroboscope(point, name, &stations, &lines) else { return String::new() };
        let contact = if self.contact_motion.is_some() && !stops.is_empty() {
            "<h4 class=\"needs-script\">Contacts over the period</h4><div id=\"contact\"></div>"
        } else {
            ""
        };
        format!(
            "<div class=\"beside\">{details}<div class=\"box\" id=\"moving\"><h3>Motion at the chosen point</h3><div \
                id=\"walk\" class=\"controls\"></div>\
             <div id=\"controls\" class=\"controls\"></div>\
             <div class=\"still\">{}</div><div id=\"motion\" class=\"needs-script\"></div>{contact}</div></div>\n",
            still.as_svg()
        )
    }

    fn wire_figure(&self) -> String {
        let Some(wireframe) = &self.wireframe else { return String::new() };
        let (title, still) = (escape(&wireframe.name), wireframe.still());
        format!(
            "<p class=\"hint needs-script control\">Drag or use the arrows to turn it, wheel to zoom, double click to \
                see it as at first.</p>\n\
             <figure class=\"box\"><h3>{title}</h3><div class=\"still\">{still}</div><div id=\"wire\" \
             class=\"needs-script\"></div></figure>\n"
        )
    }

    /// The point whose motion is shown initially: the last named one, or the first of all.
    fn first_moving(&self) -> Option<(usize, usize)> {
        let named = self.marks.last().map(|(branch, point, _)| (*branch, *point));
        let (branch, point) = named.unwrap_or((0, 0));
        let found = self.branches.get(branch)?;
        let complete = found.points.get(point)?.coefficients.n_coordinates() == found.coordinates.len();
        complete.then_some((branch, point))
    }

    fn history_figures(&self) -> Result<String, ReportError> {
        let mut boxes = String::new();
        for (index, (name, histories, look)) in self.histories.iter().enumerate() {
            let thin: Vec<TimeHistory> = histories.iter().map(|history| thinned(history)).collect();
            match HistoryFigure::new(&thin.iter().collect::<Vec<_>>()).look(look).with_acceleration().render() {
                Ok(figure) => boxes += &boxed(name, &figure, &format!("data-history=\"{index}\"")),
                Err(ReportError::NothingToDraw { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(if boxes.is_empty() { boxes } else { format!("<div class=\"pair\">{boxes}</div>\n") })
    }

    /// Name of the curves of frequency over energy.
    fn name_of_branches(&self) -> &'static str {
        match (&self.main_figure, self.leading.is_empty()) {
            (Some(_), true) => "Responses",
            (Some(_), false) => "Responses, point by point",
            (None, true) => "The nonlinear mode",
            (None, false) => "Frequency over energy and amplitude",
        }
    }

    fn all_tables(&self) -> String {
        let own = [self.key_points(), self.events(), self.meanings(), self.resonances(), self.ends()].concat();
        let further: String = self.tables.iter().map(DataTable::html).collect();
        if own.is_empty() && further.is_empty() {
            return String::new();
        }
        format!("<div class=\"tables\">\n{own}{further}</div>\n")
    }

    fn closing_tables(&self) -> String {
        let tables: String = self.closing.iter().map(DataTable::html).collect();
        if tables.is_empty() { tables } else { format!("<div class=\"tables\">\n{tables}</div>\n") }
    }

    /// The branch's name, if there are several.
    fn branch_cells(&self, branch: usize) -> Vec<String> {
        let label = &self.branches[branch].label;
        if self.branches.len() > 1 { vec![cell(label, &escape(label))] } else { Vec::new() }
    }

    fn own_table(&self, title: &str, head: &[&str], rows: Vec<Vec<String>>) -> String {
        let branch = (self.branches.len() > 1).then_some("branch");
        let head: Vec<&str> = branch.into_iter().chain(head.iter().copied()).collect();
        DataTable::new(title, &head).html_with(rows)
    }

    fn key_points(&self) -> String {
        let mut points = self.branches.iter().flat_map(|branch| &branch.points);
        let are_several = points.any(|point| point.contacts.len() > 1);
        let row = |(branch, point, name): &(usize, usize, String)| {
            let found = &self.branches[*branch].points[*point];
            let cells = [cell("", &escape(name)), point_cell(*branch, *point)].into_iter().chain(quantities(found));
            let more = [significant(100.0 * found.contact_fraction, 4), significant(found.peak_contact_force, 5)];
            let whose =
                are_several.then(|| strongest(found).map_or_else(|| "–".to_owned(), |stop| format!("stop {stop}")));
            let cells = cells.chain(more.into_iter().chain(whose).map(|text| cell(&text, &text)));
            self.branch_cells(*branch).into_iter().chain(cells).collect()
        };
        let first = ["name", "point", "frequency, Hz", "energy, J", "amplitude, m√kg"];
        let forces: &[&str] = match are_several {
            true => &["stop 0 closed, % of period", "largest force*, N", "at"],
            false => &["contact, % of period", "largest force*, N"],
        };
        self.own_table("Key points", &[&first, forces].concat(), self.marks.iter().map(row).collect())
    }

    fn events(&self) -> String {
        let mut rows = Vec::new();
        for (branch, found) in self.branches.iter().enumerate() {
            for (point, at) in found.points.iter().enumerate().filter(|(_, point)| !point.events.is_empty()) {
                let name = at.events.iter().map(|event| event.name().replace('-', " ")).collect::<Vec<_>>().join(", ");
                let cells = [point_cell(branch, point), cell("", &name)].into_iter().chain(quantities(at));
                rows.push(self.branch_cells(branch).into_iter().chain(cells).collect());
            }
        }
        self.own_table("Events", &["point", "event", "frequency, Hz", "energy, J", "amplitude, m√kg"], rows)
    }

    /// Meaning of the events that occur.
    fn meanings(&self) -> String {
        let points = self.branches.iter().flat_map(|branch| &branch.points);
        let met: BTreeSet<Event> = points.flat_map(|point| point.events.iter().copied()).collect();
        let known = met.into_iter().map(|event| (event.name(), EventSymbols::meaning(event)));
        let mut table = DataTable::new("What the events mean", &["event", "meaning"]);
        let known = known.filter(|(_, meaning)| !meaning.is_empty());
        table.rows = known.map(|(name, meaning)| vec![name.replace('-', " "), meaning.into()]).collect();
        table.html()
    }

    fn resonances(&self) -> String {
        let mut rows = Vec::new();
        for (branch, found) in self.branches.iter().enumerate() {
            for tongue in tongues(&found.points) {
                let name = tongue.resonance.to_string();
                let tip = if tongue.skipped { cell("", "left out") } else { point_cell(branch, tongue.tip) };
                let end = tongue.end.map_or_else(|| cell("–", "–"), |end| point_cell(branch, end));
                let energies = tongue.energy.map(|energy| significant(energy, 4)).join(" … ");
                let cells = [cell("", &name), point_cell(branch, tongue.start), tip, end, cell(&energies, &energies)];
                rows.push(self.branch_cells(branch).into_iter().chain(cells).collect());
            }
        }
        self.own_table("Internal resonances", &["harmonic : mode", "from point", "tip", "to point", "energy, J"], rows)
    }

    fn ends(&self) -> String {
        let row = |(k, branch): (usize, &&nlmodes_modal::ModalBranch)| {
            let (end, n) = (&branch.end, branch.points.len().to_string());
            let complete = match tongue_at_end(branch) {
                _ if self.scattered.contains(&k) && end.complete => "measured points".to_owned(),
                _ if !end.complete => "no, ended early".to_owned(),
                Some(tongue) => format!("yes, but on the internal-resonance branch {tongue}"),
                None => "yes".to_owned(),
            };
            let label = cell(" ", &escape(&branch.label));
            vec![label, cell(&n, &n), cell(" ", &escape(&end.message)), cell(" ", &escape(&complete))]
        };
        let rows: Vec<Vec<String>> = self.branches.iter().enumerate().map(row).collect();
        DataTable::new("Branches and why they end", &["branch", "points", "end", "complete"]).html_with(rows)
    }

    fn all_documents(&self) -> String {
        let one = |(title, value): &(String, serde_json::Value)| {
            let (title, tree) = (escape(title), document::tree(value));
            format!("<details class=\"box scene\" open=\"\"><summary>{title}</summary>{tree}</details>\n")
        };
        let all: String = self.documents.iter().map(one).collect();
        if all.is_empty() { all } else { format!("<div class=\"pair\">{all}</div>\n") }
    }
}

/// The stop with the largest force, if there is contact.
fn strongest(point: &ModalPoint) -> Option<usize> {
    let forces = point.contacts.iter().map(|contact| contact.peak_force).enumerate();
    forces.filter(|(_, force)| *force > 0.0).max_by(|a, b| a.1.total_cmp(&b.1)).map(|(stop, _)| stop)
}

/// Frequency, energy and amplitude of a point.
fn quantities(point: &ModalPoint) -> [String; 3] {
    let texts = [hertz(point.omega), significant(point.kinetic_energy, 5), significant(point.modal_amplitude, 5)];
    texts.map(|text| cell(&text, &text))
}

/// A static figure, and the container of the interactive one.
fn boxed(title: &str, figure: &Figure, attribute: &str) -> String {
    let (title, svg) = (escape(title), figure.as_svg());
    format!(
        "<figure class=\"box\"><h3>{title}</h3><div class=\"still\">{svg}</div><div class=\"plot\" \
            {attribute}></div></figure>\n"
    )
}

/// Added figures, unchanged.
fn given(figures: &[(String, Figure)]) -> String {
    let one = |(title, figure): &(String, Figure)| {
        let (title, svg) = (escape(title), figure.as_svg());
        format!("<figure class=\"box\"><h3>{title}</h3><div class=\"fixed\">{svg}</div></figure>\n")
    };
    let all: String = figures.iter().map(one).collect();
    if all.is_empty() { all } else { format!("<div class=\"pair\">{all}</div>\n") }
}
