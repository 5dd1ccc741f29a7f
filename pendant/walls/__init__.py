"""Virtual walls and areas: shapes, anchors, resistance, containment. Uses limits/."""
