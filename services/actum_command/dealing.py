"""Settings for several sensors: a value that is given once for each sensor is dealt out, any other holds for all."""

from typing import Any

from actum.command_line import from_command_line
from actum.settings import ServiceSettings
from actum_command.service_settings import SETTINGS, Given, arguments_of


def dealt(given: Given, service: str, settings: ServiceSettings) -> list[Given]:
    """Return the given settings for a service's process of each sensor, in the order of the sensors.

    Of a setting of that service that is given as often as there are sensors, each process takes one value.
    """
    own, count = SETTINGS[service].model_fields, len(settings.of_each_sensor)
    return [
        {
            name: [value[number]] if isinstance(value, list) and name in own and len(value) == count else value
            for name, value in given.items()
        }
        for number in range(count)
    ]


def counted_on(given: Given, service: str, name: str, settings: ServiceSettings) -> Given:
    """Return the given settings with a number that is one higher for each further sensor, such as a port.

    A number that is given for each sensor stays as it is, and so does one that is not set.

    Raises:
        ValidationError: a setting of the service cannot be used.
    """
    each, value = settings.of_each_sensor, given.get(name)
    if len(each) == 1 or (isinstance(value, list) and len(value) == len(each)):
        return given
    flags = [f"--sensor={each[0].sensor}", *arguments_of(service, given)]
    first: Any = getattr(from_command_line(SETTINGS[service], service, flags), name)
    return given if first is None else {**given, name: [str(first + number) for number in range(len(each))]}
