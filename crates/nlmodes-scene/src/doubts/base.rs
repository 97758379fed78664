use nlmodes_io::{FeFiles, FeModel, Format};

use super::Subject;
use crate::scene::Scene;

/// Base motion of a structure whose affected rows are unknown.
pub fn doubt(scene: &Scene, subject: &Subject<'_>) -> Option<String> {
    let silent = unplaced_unknowns(&subject.matrices.files, subject.model).filter(|_| scene.base_motion.is_some())?;
    Some(format!(
        "the rows of {silent} of {} nodes do not answer a rigid displacement, as unknowns within elements (CalculiX's \
            C3D8I), and would be moved by the base: \
         `structure.mesh` tells which are nodes",
        subject.model.nodes().len()
    ))
}

/// Number of nodes of CalculiX's files that may be unknowns within elements, if positions do not decide; `None` without
/// such nodes.
pub fn unplaced_unknowns(files: &FeFiles, model: &FeModel) -> Option<usize> {
    let format = files.format.or_else(|| Format::of(&files.stiffness).ok());
    let silent =
        (format == Some(Format::Calculix) && !model.knows_places()).then(|| model.nodes_without_answer().len())?;
    (silent > 0).then_some(silent)
}
