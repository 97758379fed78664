"""The documentation as a site: `.ci/site` builds it with Sphinx into `target/site`.

The pages are the Markdown files of the repository, with all that they link to. `docs/README.md` is the front page, and its
lists are the contents.
"""

import re

project = "nlmodes"
author = "the authors of nlmodes"
copyright = author  # noqa: A001, the name that Sphinx asks for

extensions = ["myst_parser"]
root_doc = "docs/README"
include_patterns = [
    "docs/*.md",
    "docs/images/README.md",
    "benchmarks/verification.md",
    "benchmarks/results/*.md",
    "benchmarks/nsm/**.md",
    "crates/nlmodes-cli/matlab/README.md",
    "crates/nlmodes-cli/packaging/README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
]
myst_heading_anchors = 4
myst_enable_extensions = []
suppress_warnings = ["myst.header", "misc.highlighting_failure", "toc.not_included"]

html_theme = "furo"
html_title = "nlmodes"
html_static_path = ["site"]
html_css_files = ["site.css"]
html_extra_path = ["site/index.html"]
html_show_sphinx = False
html_copy_source = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0060a0", "color-brand-content": "#0060a0"},
    "dark_css_variables": {"color-brand-primary": "#6cb6ff", "color-brand-content": "#6cb6ff"},
}

SECTION = re.compile(r"^## (.+)$((?:\n(?!## ).*)*)", re.M)
LINK = re.compile(r"^- \[(.+?)\]\((.+?\.md)\)", re.M)


def contents(app, name, source):
    """The lists of the front page are the contents of the site, too."""
    if name != root_doc:
        return
    for title, text in SECTION.findall(source[0]):
        entries = "\n".join(f"{label} <{target}>" for label, target in LINK.findall(text))
        source[0] += f"\n```{{toctree}}\n:hidden:\n:caption: {title}\n\n{entries}\n```\n"


def setup(app):
    app.connect("source-read", contents)
    return {"parallel_read_safe": True}
