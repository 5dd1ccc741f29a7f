"""Connections: ports that listen, senders that never wait, who is there."""
