"""How people's postures go on, predicted up to a second ahead."""
