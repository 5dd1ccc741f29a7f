"""Settings for people: their plain names, presets with the changes that they bring. Uses files/, session/."""
