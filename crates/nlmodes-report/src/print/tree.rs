use std::sync::Arc;

use resvg::usvg::{FontResolver, Options, Tree};

use super::PrintError;

/// Letters, digits and signs of all figures; see `fonts/OFL.txt`.
const FONT: &[u8] = include_bytes!("../../fonts/Arimo-Regular.ttf");

/// The document with its text in the font of this crate, and missing characters in system fonts.
pub fn parsed(svg: &str) -> Result<Tree, PrintError> {
    let mut options = Options { font_resolver: resolver(), ..Options::default() };
    options.fontdb_mut().load_font_data(FONT.to_vec());
    Tree::from_str(svg, &options).map_err(PrintError::Svg)
}

/// For any font family: system fonts must not change the figure.
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
