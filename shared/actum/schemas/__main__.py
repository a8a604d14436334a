"""`python -m actum.schemas`: write the schema files."""

from pathlib import Path

from actum.schemas import generated

for name, text in generated().items():
    (Path(__file__).parent / name).write_text(text)
