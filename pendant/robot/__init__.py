"""Robot mode and safety mode, safety inputs, stops, requests. Uses freedrive/, limits/, program/, safety/, signals/."""
