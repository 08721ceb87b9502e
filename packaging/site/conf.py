"""Sphinx: pages of docs/, staged by build.py beside this file."""
import os
import re

project = "gneiss"
author = "The gneiss authors"
copyright = "the gneiss authors, BSD-3-Clause"
with open(os.path.join(os.environ["GNEISS_ROOT"], "meson.build"), encoding="utf-8") as _file:
    version = release = re.search(r"^  version: '(.*)'", _file.read(), re.M).group(1)

extensions = ["myst_parser", "breathe", "sphinx.ext.autodoc"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # pages may leave out a level of headings
highlight_language = "none"
breathe_projects = {"gneiss": os.path.join(os.environ["GNEISS_STAGED"], "doxygen", "xml")}
breathe_default_project = "gneiss"
breathe_domain_by_extension = {"h": "c"}
breathe_show_include = False
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_class_signature = "separated"
exclude_patterns = ["doxygen", "_static"]


def tables_as_fields(app, what, name, obj, options, lines):
    """Lists of docstrings, `name   text` a line with indented further lines, as fields of reStructuredText."""
    row = re.compile(r"^([*\w][\w*, ]*?)  +(\S.*)$")
    inside, out = False, []
    for line in lines:
        found = row.match(line.strip()) if not inside or not line.startswith("     ") else None
        if found:
            out += ([] if inside else [""]) + [f":{found[1]}: {found[2]}".replace("*", "\\*")]
            inside = True
        elif inside and line.strip() and line.startswith("  "):
            out[-1] += " " + line.strip().replace("*", "\\*")
        else:
            out += [""] if inside and line.strip() else []
            out.append(line)
            inside = False
    lines[:] = out


def setup(app):
    app.connect("autodoc-process-docstring", tables_as_fields)


html_theme = "furo"
html_title = f"gneiss {release}"
html_static_path = [os.path.join(os.environ["GNEISS_STAGED"], "_static")]
html_css_files = ["style.css"]
html_show_sphinx = False
html_copy_source = False
html_theme_options = {"light_css_variables": {"color-brand-primary": "#8c4a1f", "color-brand-content": "#8c4a1f"},
                      "dark_css_variables": {"color-brand-primary": "#e0a070", "color-brand-content": "#e0a070"}}
pygments_style = "friendly"
