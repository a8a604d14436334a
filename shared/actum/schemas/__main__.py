"""`python -m actum.schemas`: write the schema files."""

from pathlib import Path

from actum.schemas import write

write(Path(__file__).parent)
