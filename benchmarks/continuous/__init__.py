"""Finding actions in whole recordings that nobody marked, beside peers that are given the same frames."""
