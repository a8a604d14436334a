"""Settings of a service that may be changed while it runs, offered as two commands."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Generic, TypeVar

from pydantic import BaseModel, Field, ValidationError

from actum.commands import Command, NoFields, Refusal, Request, problems
from actum.settings import ServiceSettings

S = TypeVar("S", bound=ServiceSettings)
UNITS = {"_per_min": "1/min", "_m": "m", "_s": "s", "_deg": "°", "_hz": "Hz"}
"""Units by the ending of a setting's name."""


class Parameter(BaseModel):
    """A setting that may be changed while the service runs."""

    name: str
    """The setting's name."""
    value: Any
    """What it is now."""
    default: Any
    """What it is where nothing is set."""
    type: str
    """Its type in JSON: `number`, `integer`, `boolean`, `string`, `array` or `object`."""
    optional: bool
    """Whether it may be null, which asks for nothing."""
    minimum: float | None
    """The smallest value; null where there is none."""
    above: float | None
    """What it must exceed; null where there is no such bound."""
    maximum: float | None
    """The largest value; null where there is none."""
    below: float | None
    """What it must stay below; null where there is no such bound."""
    choices: list[Any] | None
    """All values there are; null where they cannot be listed."""
    unit: str | None
    """Its unit; null where it has none."""
    description: str
    """What it does."""


class Parameters(BaseModel):
    """All settings of a service that may be changed while it runs."""

    parameters: list[Parameter]
    """In the order in which the service's help lists them."""


class NewValues(Request):
    """Values for some of the parameters."""

    values: dict[str, Any] = Field(min_length=1)
    """The new values, by name."""


class LiveParameters(Generic[S]):
    """Offers some of a service's settings to be read and changed while it runs.

    Args:
        settings: as they are now.
        names: of those that may be changed.
        apply: makes the service use new settings.
    """

    def __init__(self, settings: S, names: Sequence[str], apply: Callable[[S], None]) -> None:
        self._settings, self._names, self._apply = settings, names, apply

    @property
    def commands(self) -> tuple[Command[NoFields, Parameters], Command[NewValues, Parameters]]:
        """The commands `parameters` and `set_parameters`."""
        return (
            Command("parameters", NoFields, Parameters, self.describe),
            Command("set_parameters", NewValues, Parameters, self.set),
        )

    def describe(self, _request: NoFields) -> Parameters:
        """List the settings that can be changed while the service runs, with ranges and units."""
        schemas = type(self._settings).model_json_schema()["properties"]
        values = self._settings.model_dump(mode="json", include=set(self._names))
        return Parameters(parameters=[_parameter(name, values[name], schemas[name]) for name in self._names])

    def set(self, request: NewValues) -> Parameters:
        """Change settings until the service ends; a value that is refused changes nothing.

        Raises:
            Refusal: a name is none of them, or a value is out of range.
        """
        if unknown := sorted(request.values.keys() - set(self._names)):
            raise Refusal(
                f"{', '.join(unknown)} cannot be changed while the service runs: restart the service with the new "
                f"value. The settings that can be changed are {', '.join(self._names)}"
            )
        changed = self._settings.model_copy()
        for name, value in request.values.items():
            try:
                type(changed).__pydantic_validator__.validate_assignment(changed, name, value)
            except ValidationError as error:
                raise Refusal(problems(error)) from None
        self._apply(changed)
        self._settings = changed
        return self.describe(NoFields())


def _parameter(name: str, value: Any, schema: Mapping[str, Any]) -> Parameter:
    """Describe a setting by its value and its JSON Schema, in which an optional one has the constraints one deeper."""
    kind = next((each for each in schema.get("anyOf", ()) if each.get("type") != "null"), schema)
    return Parameter(
        name=name,
        value=value,
        default=schema.get("default"),
        type=kind.get("type", "string"),
        optional=kind is not schema,
        minimum=kind.get("minimum"),
        above=kind.get("exclusiveMinimum"),
        maximum=kind.get("maximum"),
        below=kind.get("exclusiveMaximum"),
        choices=kind.get("enum"),
        unit=next((unit for ending, unit in UNITS.items() if name.endswith(ending)), None),
        description=schema.get("description", ""),
    )
