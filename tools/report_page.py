"""Style, tables, figures and writing, common to the pages of `report.py`."""
import base64
import html
import os
import re
from urllib.parse import quote

from report_files import folder_within, remove, write

STYLE = """
:root { --ink: #22303c; --soft: #5c6b76; --line: #dde3e7; --accent: #c8402f; }
body { font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; color: var(--ink); margin: 0 auto; max-width: 1180px;
  padding: 1.5rem 1.2rem 4rem; background: #fff; }
h1 { font-size: 1.7rem; margin: 0 0 .2rem; } h2 { font-size: 1.15rem; margin: 2.2rem 0 .6rem; }
.soft, figcaption { color: var(--soft); font-size: .9rem; }
.warning { border-left: 4px solid var(--accent); padding: .4rem .9rem; background: #fdf1ef; margin: 1rem 0; }
.cards { display: flex; flex-wrap: wrap; gap: .8rem; margin: 1.2rem 0; }
.card { border: 1px solid var(--line); border-radius: 8px; padding: .6rem 1rem; min-width: 9.5rem; }
.card b { display: block; font-size: 1.35rem; } .card span { color: var(--soft); font-size: .85rem; }
.card small { display: block; color: var(--soft); max-width: 15rem; line-height: 1.3; }
table { border-collapse: collapse; margin: .4rem 0; max-width: 100%; } td { overflow-wrap: anywhere; } td, th { padding: .22rem .9rem .22rem 0; text-align: left;
  border-bottom: 1px solid var(--line); vertical-align: top; } td.number { font-variant-numeric: tabular-nums;
  white-space: nowrap; overflow-wrap: normal; } td.si { color: var(--soft); font-variant-numeric: tabular-nums; }
.grid { display: grid; grid-template-columns: repeat(auto-fit, minmax(440px, 1fr)); gap: 1.2rem; }
.tables { display: flex; flex-wrap: wrap; gap: 0 3rem; }
figure { margin: 0; } figure img { max-width: 100%; height: auto; } figure.wide { margin: 1rem 0; }
pre { background: #f6f8f9; padding: 1rem; overflow-x: auto; font-size: .85rem; } code { font-size: .9em; }
"""


def escape(text):
    """Control characters have no meaning in a page, and a terminal that prints its text would execute them."""
    return html.escape("".join(c if c.isprintable() or c in "\n\t" else "?" for c in str(text)))


def is_inside(path):
    """True if a path is inside the folder to which it is relative."""
    return not re.match(r"/|\w+:", path) and ".." not in path.split("/")


def linked(text, to):
    """Allows links only to files below the folder of the page, whatever a file contains."""
    return f'<a href="{escape(quote(to))}">{escape(text)}</a>' if to and is_inside(to) else escape(text)


def table(rows, head=None):
    """HTML table of rows of (cell, class), (cell, class, link) or plain cells, escaped here."""
    out = ["<table>"]
    if head:
        out.append("<tr>" + "".join(f"<th>{escape(h)}</th>" for h in head) + "</tr>")
    for row in rows:
        cells = [(*c, "", "")[:3] if isinstance(c, tuple) and len(c) < 3 else c if isinstance(c, tuple) else (c, "", "") for c in row]
        out.append("<tr>" + "".join(f'<td class="{k}">{linked(t, to)}</td>' for t, k, to in cells) + "</tr>")
    return "\n".join(out + ["</table>"])


def figure(name, captions, kind=""):
    if name not in captions:
        return ""
    return (f'<figure class="{kind}"><img src="report/{name}.png" alt="{escape(name.replace("_", " "))}">'
            f"<figcaption>{escape(captions[name])}</figcaption></figure>")


def draw(jobs, folder):
    """Runs the jobs {name: function of a path}, which draw into folder/report, and returns {name: caption}; a job
    without a picture returns None. Old pictures of these names are removed."""
    pictures = folder_within(folder, "report")
    paths = {name: os.path.join(pictures, name + ".png") for name in jobs}
    for path in paths.values():
        remove(path)
    captions = {name: job(paths[name]) for name, job in jobs.items()}
    return {name: caption for name, caption in captions.items() if caption}


def embed(folder, text):
    """Embeds the pictures in the page, so that it can be sent as one file; `data-file` names the file of each."""
    def data(match):
        with open(os.path.join(folder, match[1]), "rb") as file:
            coded = base64.b64encode(file.read()).decode("ascii")
        return f'data-file="{match[1]}" src="data:image/png;base64,{coded}"'
    return re.sub(r'src="(report/[^"]+\.png)"', data, text)


def write_page(folder, text):
    target = os.path.join(folder, "report.html")
    write(target, embed(folder, text))
    return target
