"""The JSON Schemas of the messages, generated from the models and committed beside this file."""

import json
from importlib.resources import files

from actum.codec import schema_name
from actum.messages import MESSAGES, Message


def file_name(message: type[Message]) -> str:
    """Name a message's schema file, e.g. `actum.skeleton.1.json`."""
    return f"{schema_name(message).replace('/', '.')}.json"


def generated() -> dict[str, str]:
    """Generate the text of every schema file, by the file's name."""
    schemas = {
        file_name(message): {"$id": schema_name(message), **message.model_json_schema(mode="validation")}
        for message in MESSAGES
    }
    return {name: json.dumps(schema, indent=2, sort_keys=True) + "\n" for name, schema in schemas.items()}


def committed(name: str) -> str:
    """Return the text of a schema file in the package."""
    return files(__name__).joinpath(name).read_text()
