"""What all network interfaces share: state, fields and wishes of the one robot. Uses files/, session/."""
