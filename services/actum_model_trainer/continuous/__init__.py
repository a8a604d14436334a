"""How well actions are found in whole recordings that nobody marked."""
