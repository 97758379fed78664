use std::sync::Arc;

use resvg::usvg::{FontResolver, Options, Tree};

use super::PrintError;

/// Letters, digits and signs of all figures; see `fonts/OFL.txt`.
const FONT: &[u8] = include_bytes!("../../fonts/Arimo-Regular.ttf");

/// The document with its texts in the font of this crate, and signs that it lacks in those of the machine.
pub fn parsed(svg: &str) -> Result<Tree, PrintError> {
    let mut options = Options { font_resolver: resolver(), ..Options::default() };
    options.fontdb_mut().load_font_data(FONT.to_vec());
    Tree::from_str(svg, &options).map_err(PrintError::Svg)
}

/// Whatever family a text asks for: the machine's own fonts must not make another figure.
fn resolver() -> FontResolver<'static> {
    let among_all = FontResolver::default_fallback_selector();
    FontResolver {
        select_font: Box::new(|_, fonts| fonts.faces().next().map(|face| face.id)),
        select_fallback: Box::new(move |sign, tried, fonts| {
            if fonts.len() == 1 {
                Arc::make_mut(fonts).load_system_fonts();
            }
            among_all(sign, tried, fonts)
        }),
    }
}
