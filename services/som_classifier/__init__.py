"""The paper's hierarchy: two self-organizing maps and a supervised layer, over marked segments."""
