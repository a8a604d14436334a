"""Write the generated parts of the pages anew, in place."""

from docs.generate.pages import PAGES, renewed
from docs.generate.process_diagram import DIAGRAM, diagram

for page in PAGES:
    page.write_text(renewed(page.read_text(encoding="utf-8")), encoding="utf-8")
DIAGRAM.write_text(diagram(), encoding="utf-8")
