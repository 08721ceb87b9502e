"""A page that is written section by section: measured sections are kept, and sections of a page made elsewhere stay if they are not measured here."""
import re

from study import prose


def mark(name):
    return f"<!-- section {name} -->"


class Page:
    """`path`: of the page; `folder`: where sections are kept; `command`: the command that measures one of them."""

    def __init__(self, path, folder, head, command):
        self.path, self.folder, self.head, self.command = path, folder, head, command

    def keep(self, name, text):
        self.folder.mkdir(parents=True, exist_ok=True)
        (self.folder / f"{name}.md").write_text(text.rstrip() + "\n")

    def kept(self, name):
        path = self.folder / f"{name}.md"
        return path.read_text() if path.exists() else None

    def there(self, name):
        """A section as the page has it, measured elsewhere: results are kept per machine, the page is not."""
        text = self.path.read_text() if self.path.exists() else ""
        found = re.search(re.escape(mark(name)) + r"\n(.*?)(?=<!-- section |\Z)", text, flags=re.DOTALL)
        return found.group(1) if found else None

    def write(self, names):
        parts = []
        for name in names:
            text = self.kept(name) or self.there(name) or f"## {name}\n\nNot measured yet: `{self.command} {name}`."
            parts.append(f"{mark(name)}\n{text.strip()}")
        self.path.write_text(prose(self.head + "\n\n".join(parts) + "\n"))
        print(f"written: {self.path}")
