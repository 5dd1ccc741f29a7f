"""Tool and payload in use: chosen, ramped, measured by the wizard. Uses equipment/, limits/, walls/."""
