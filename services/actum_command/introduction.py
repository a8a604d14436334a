"""What a system prints when it starts: which model it uses, how actions are found, and what is missing."""

from actum_command.model_in_use import NO_MODEL, ModelInUse, lack_of_file
from actum_command.service_settings import Given
from actum_command.simulated_model import SIMULATED_MODEL
from som_classifier.model_loading import ModelError, load_model
from som_classifier.settings import Settings as ClassifierSettings
from som_classifier.spotting.spotted import SpottingOptions

SCENE_MARKS = "the simulated scene marks its own actions, as a switch would"
"""How actions are found where the simulated scene marks them."""
FOUND = {
    "marks": "only marked actions are recognised, and nobody marks here: mark with 'actum segment toggle', or have "
    "'actum play' play marks beside --source none",
    "auto": "actions are found by the model; marks are refused, and --segments both takes them as well",
    "both": "actions are found by the model, or marked by you: 'actum segment toggle'",
}
"""How actions are found, by the setting `segments`."""


def segments_of(given: Given) -> str:
    """Return which segments are answered, as the classifier's setting says."""
    named = given.get("segments")
    return named[-1] if isinstance(named, list) else ClassifierSettings().segments


def how_found(segments: str, marked: bool) -> str:
    """Return in words how actions are found; a setting that there is not is refused by the classifier."""
    return SCENE_MARKS if marked else FOUND.get(segments, f"segments {segments}")


def source_of(model: ModelInUse) -> str:
    """Return in words where the model in use is from."""
    if model.original is None:
        return "the one that was put into use last"
    if model.original == SIMULATED_MODEL:
        return "the one for the simulated scene that ships with actum"
    return f"{model.original}, which is only read: what is put into use on the page replaces a copy"


def lack_of_model(model: ModelInUse, segments: str, marked: bool) -> str | None:
    """Return what the model cannot do with which the system starts; None where it does what is needed."""
    file = model.original or model.file
    if not file.exists():
        return lack_of_file(model) or NO_MODEL
    try:
        loaded = load_model(file)
    except ModelError as error:
        return str(error)
    if marked or segments == "marks" or loaded.spotter(SpottingOptions()) is not None:
        return None
    return (
        f"{file} finds no actions by itself, since it was trained without continuous recordings: mark each one, with "
        "'actum segment toggle' or, in the simulated scene, --marked"
    )
