use nlmodes::report::FigureStyle;
use nlmodes_scene::scene::OutputFiles;

/// How the figures of a scene are drawn.
pub(crate) fn style_of(files: &OutputFiles) -> FigureStyle {
    FigureStyle { width_mm: files.figure_width_mm, has_title: files.figure_titles }
}
