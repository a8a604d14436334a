"""What the pages show of the code: messages, problems, settings, the diagram. `python -m docs.generate` writes them."""
