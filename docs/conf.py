"""The documentation as a site: `.ci/docs` builds it."""

import pathlib
import sys

root = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(root / "crates/python/python"))

project = "squeal"
author = "the squeal developers"
copyright = "2026, the squeal developers"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
html_theme = "furo"
html_title = "squeal"
templates_path = []
exclude_patterns = ["fig06.svg", "sweep-map.svg"]
# Links to headings, as other viewers of Markdown make them.
myst_heading_anchors = 4
# The module that Rust makes is not built for the site: the typed functions over it are Python.
autodoc_mock_imports = ["squeal._squeal", "matplotlib", "pandas", "scipy"]
autodoc_member_order = "bysource"
autodoc_typehints = "none"
# Blocks in pages are run by tests; `toml` and `text` need no colours that a lexer may refuse.
highlight_language = "none"
# Words between single backticks in docstrings are code.
default_role = "code"


def setup(app):
    """Links to files of the repository that are no pages of the site become names in code."""

    def without_outer_links(_app, _name, source):
        import re

        source[0] = re.sub(r"\[([^\]]*)\]\((?:\.\./[^)]*)\)", r"\1", source[0])

    app.connect("source-read", without_outer_links)
